#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/evaluate/changes/calibration.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/store/store.h"

namespace loci::apps::changes {

/// Answers about where objects are, against the truth of a simulated recording (truth.jsonl).
struct AnswerScore {
  /// `was X on P` over windows of looks, for each place.
  struct Windows {
    size_t there = 0, away = 0;  ///< questions by the truth
    size_t yes = 0, no = 0;      ///< right ones
    size_t false_yes = 0, false_no = 0;
    size_t not_observed = 0;
  };
  Windows was;
  size_t asked = 0;          ///< `was` at the moment of each scene
  size_t disagreements = 0;  ///< no where `where` says it is there, or yes where it says elsewhere or gone
  size_t unlisted = 0;       ///< `where` says it is there and `on` does not list it, or the other way round
  Stated was_stated;         ///< of yes and no
  Stated place_stated;       ///< an object that is not seen now is on the place that `where` says
  Stated existence_stated;   ///< it is in the home at all
  void add(const AnswerScore& other);
};

/// `folder`: of the recording from which the memory was made.
AnswerScore score_answers(const std::filesystem::path& folder, const memory::Store& store);

std::string text(const AnswerScore& score);
Json to_json(const AnswerScore& score);

}  // namespace loci::apps::changes
