#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "perception/classification/ensemble.h"

namespace loci::perception {

/// What is called so when it is not clear which of its kinds an object is: "cup" of "mug" and "glass", "box"
/// of "book". The class itself where nothing is coarser.
const std::string& household_group(const std::string& class_name);

/// The classes of household objects by shape, size and colour ("Household"), and how sure it has to be.
/// Open-set: examples of the class "other" are what a household has besides; it is never answered.
class HouseholdModel {
 public:
  struct Answer {
    std::string label;       ///< a class or, where only that may be sure enough, its group
    double probability = 0;  ///< calibrated
    bool sure = false;       ///< enough to name the object by this view alone
    /// All classes but "other", most probable first.
    std::vector<std::pair<std::string, double>> classes = {};
  };

  /// Thresholds follow from cross-validation: of the answers that are given, `wanted` name the right group.
  static HouseholdModel train(std::vector<TrainingSample> samples, double wanted, const Random& random,
                              int threads, Progress& progress);
  /// The one that is compiled in, made by `loci-evaluate description --household --model-out FILE`.
  static const HouseholdModel& shipped();
  static HouseholdModel load(const std::filesystem::path& path);
  void save(const std::filesystem::path& path) const;

  /// None when the view shows too little, or what belongs to no class is more probable.
  std::optional<Answer> classify(const ObjectView& view) const;
  std::optional<Answer> classify(const FeatureSet& features) const;
  const Ensemble& ensemble() const { return ensemble_; }

 private:
  static HouseholdModel from_json(const Json& json, const std::string& file);
  std::optional<Answer> answer(const std::vector<double>& probabilities) const;

  Ensemble ensemble_;
  double min_class_ = 1, min_group_ = 1;
};

}  // namespace loci::perception
