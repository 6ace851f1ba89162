#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "perception/classification/classifier.h"
#include "perception/classification/shape_features.h"
#include "perception/classification/softmax_regression.h"

namespace loci {

/// Descriptors of one thing by their names (shape_feature_names()); one that could not be computed is
/// missing.
using FeatureSet = std::map<std::string, FeatureVector>;

/// The descriptors of these names.
FeatureSet feature_set(const std::vector<std::string>& names, const SurfacePoints& surface);

struct LabelledThing {
  std::string label;
  FeatureSet features;
};

/// A classifier over one descriptor.
struct ExpertSpec {
  std::string feature;
  ClassifierOptions options;
};

/// "VFH:knn:L1", "ESF:svm", "GRSD:forest": descriptor, classifier and, except for forests, distance
/// (chi-squared unless given). Other options as in `options`. Error that says what is wrong.
ExpertSpec parse_expert(const std::string& text, const ClassifierOptions& options = {});
std::string name_of(const ExpertSpec& expert);

/// What an ensemble thinks of one thing.
struct Classification {
  std::vector<double> probabilities;  ///< by class
  size_t best = 0;                    ///< class with the largest
};

/// Several experts that decide together (stacking, Wolpert 1992): a logistic regression over the logarithms
/// of all their scores, with one weight per expert and one offset per class, fitted to what each said about
/// things that it had not learned (cross-validation), gives calibrated probabilities. With one expert it
/// calibrates that one.
class Ensemble {
 public:
  /// Things without all the descriptors are passed over. Error when fewer than two classes or fewer things
  /// than `folds` of a class remain. Same seed, same ensemble on any number of threads.
  static Ensemble train(const std::vector<LabelledThing>& things, const std::vector<ExpertSpec>& experts,
                        int folds, const Random& random, int threads, Progress& progress);

  const std::vector<std::string>& classes() const { return classes_; }
  const std::vector<ExpertSpec>& experts() const { return specs_; }
  /// Names of the descriptors that classify() needs.
  std::vector<std::string> features() const;
  /// Share of each class's things that was recognised in cross-validation.
  const std::vector<double>& accuracies() const { return accuracies_; }

  /// Error when a descriptor is missing.
  Classification classify(const FeatureSet& features) const;

  /// JSON; load() gives an ensemble that answers the same, or an Error with the file.
  void save(const std::filesystem::path& path) const;
  static Ensemble load(const std::filesystem::path& path);

 private:
  Eigen::MatrixXd inputs(const std::vector<std::vector<double>>& scores) const;

  std::vector<std::string> classes_;
  std::vector<ExpertSpec> specs_;
  std::vector<std::unique_ptr<Classifier>> classifiers_;
  SoftmaxRegression fusion_;
  std::vector<double> accuracies_;
};

}  // namespace loci
