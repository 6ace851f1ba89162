#pragma once

#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"
#include "memory/sentences/lexicon.h"

namespace loci::memory {

/// "Where is the cup that stood on the table this morning" with the objects that are meant: "where is the
/// object_4". The words as they are where there is no such clause, or none was there then.
Words without_relative_clauses(Words words, const Snapshot& snapshot, const TimeReader& times);

}  // namespace loci::memory
