#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

struct HouseholdOptions {
  int train_scenes = 0;
  int test_scenes = 60;
  int seed = 1;
  double precision = 0.92;

  void declare(OptionTable& table);
};

/// How objects were named.
struct NamingScore {
  int objects = 0;                                         ///< all that are labelled
  int found = 0;                                           ///< by the segmentation
  int answered = 0;                                        ///< called anything
  int right = 0;                                           ///< by the group: a mug called cup, glass or mug
  int exact = 0;                                           ///< by the class itself
  std::map<std::string, std::map<std::string, int>> said;  ///< by the true class: answers, "-" = none
  std::vector<std::pair<double, bool>> probabilities;      ///< of answers, and whether they are right

  /// Mean difference of probability and share of right answers over ten parts of the answers, most certain
  /// first.
  double calibration_error() const;
};

struct HouseholdResult {
  size_t trained_on = 0;                                    ///< 0 = the shipped model
  std::vector<std::pair<std::string, NamingScore>> by_set;  ///< in order of the sets
  double milliseconds = 0;                                  ///< per object

  std::string text() const;
  Json to_json() const;
};

/// Names objects with the shipped model, or one trained on `train_scenes` rendered tables (written to `out`
/// unless empty), on other rendered tables and on labelled recordings whose objects.csv names them, or whose
/// scenes.csv speaks of boxes.
HouseholdResult evaluate_household(const std::vector<std::string>& folders, const HouseholdOptions& options,
                                   const std::filesystem::path& out, int threads, Progress& progress,
                                   Warnings& warnings);

}  // namespace loci::apps::description_evaluation
