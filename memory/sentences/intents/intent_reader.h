#pragma once

#include <string>
#include <vector>

#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

/// One question of a sentence in plain words that the grammar reads.
struct PlainQuestion {
  std::string text = {};    ///< "Where is the red cup?"
  bool reworded = false;    ///< it is a form of the classifier; else what was said, without what surrounds it
  double probability = 1;   ///< of the form
  bool names_known = true;  ///< all its names mean something in the memory
};

/// The questions of a sentence that no rule fits: what surrounds them is left out, a pronoun becomes what it
/// stands for, and what no rule says is classified (intent_model.h). For each question its readings, the most
/// literal first; no readings where it is not understood.
std::vector<std::vector<PlainQuestion>> plain_questions(const std::string& sentence, const Snapshot& snapshot,
                                                        const TimeReader& times);

}  // namespace loci::memory
