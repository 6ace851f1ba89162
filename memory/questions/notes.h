#pragma once

#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

/// How the names and times of a query are read where they may mean something else: "no place is called
/// 'cutlery drawer'; any drawer is meant". Names that mean nothing have no note: the answer reports them.
std::vector<std::string> notes_on(const Snapshot& snapshot, const Query& query);

}  // namespace loci::memory
