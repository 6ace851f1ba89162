#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/classification/classifier.h"
#include "perception/classification/local_features.h"
#include "perception/classification/shape_features.h"

namespace loci::perception {

/// Conditional logistic regression: the probability of a class is proportional to exp(x · w), x being what
/// is said for that class (a row of an example) and w weights that all classes share, so that few examples
/// are enough.
class SoftmaxRegression {
 public:
  /// The weights that maximise the mean log probability of the labels minus ridge/2 · |w - prior|², by
  /// Newton's method. Each example is a matrix of classes × inputs; `ridge` > 0; without a prior it is 0.
  static SoftmaxRegression fit(const std::vector<Eigen::MatrixXd>& examples,
                               const std::vector<size_t>& labels, double ridge,
                               const Eigen::VectorXd& prior = {});

  std::vector<double> probabilities(const Eigen::MatrixXd& example) const;

  Json to_json() const;
  static SoftmaxRegression from_json(const Json& json);

 private:
  Eigen::VectorXd weights_;
};

/// Descriptors of one object by their names (shape_feature_names()); one that could not be computed is
/// missing.
using FeatureSet = std::map<std::string, FeatureVector>;

/// The descriptors of these names.
FeatureSet feature_set(const std::vector<std::string>& names, const SurfacePoints& surface);

/// Descriptors of an object's key points by their names (local_feature_names()).
using LocalFeatureSet = std::map<std::string, LocalFeatures>;

/// What experts know of an object. Of bags of words ("SIFTBag") the key points: the words are the ensemble's.
struct ObjectFeatures {
  FeatureSet features;
  LocalFeatureSet local;
};

/// Descriptors that experts may rest on: those of shape, "HOG", "Household", and the bags "SIFTBag",
/// "ORBBag", "SHOTBag", "FPFHBag".
std::vector<std::string> expert_feature_names();
/// The descriptors of these names (expert_feature_names()) of what is seen.
ObjectFeatures object_features(const std::vector<std::string>& names, const ObjectView& view);
/// "SIFT" of "SIFTBag": the descriptors that a bag is of. Empty for what is no bag.
std::string local_name_of(const std::string& name);
/// Whether a descriptor is taken of the image rather than of the surface.
bool is_of_image(const std::string& name);

struct TrainingSample {
  std::string label;
  FeatureSet features;
  LocalFeatureSet local{};
};

/// A classifier over one descriptor.
struct ExpertSpec {
  std::string feature;
  ClassifierOptions options;
};

/// "VFH:knn:L1", "SIFTBag:svm", "GRSD:forest": descriptor (expert_feature_names()), classifier and, except
/// for forests and networks, distance (chi-squared unless given). Other options as in `options`. Error that
/// says what is wrong.
ExpertSpec parse_expert(const std::string& text, const ClassifierOptions& options = {});
std::string name_of(const ExpertSpec& expert);

/// What an ensemble thinks of one object.
struct Classification {
  std::vector<double> probabilities;  ///< by class
  size_t best = 0;                    ///< class with the largest
};

/// Several experts that decide together (stacking, Wolpert 1992): a logistic regression over the logarithms
/// of all their scores, with one weight per expert and one offset per class, fitted to what each said about
/// objects that it had not learned (cross-validation), gives calibrated probabilities. With one expert it
/// calibrates that one.
class Ensemble {
 public:
  /// What was said of an object by experts that had not learned it.
  struct HeldOut {
    size_t label = 0;                   ///< the true class
    std::vector<double> probabilities;  ///< by class
  };

  /// Objects without all the descriptors are passed over. Error when fewer than two classes or fewer objects
  /// than `folds` of a class remain. Same seed, same ensemble on any number of threads.
  static Ensemble train(std::vector<TrainingSample> objects, const std::vector<ExpertSpec>& experts,
                        int folds, const Random& random, int threads, Progress& progress,
                        std::vector<HeldOut>* held_out = nullptr);

  const std::vector<std::string>& classes() const { return classes_; }
  const std::vector<ExpertSpec>& experts() const { return specs_; }
  /// Names of the descriptors that classify() needs.
  std::vector<std::string> features() const;
  /// Share of each class's objects that was recognised in cross-validation.
  const std::vector<double>& accuracies() const { return accuracies_; }

  /// Error when a descriptor is missing.
  Classification classify(FeatureSet features, const LocalFeatureSet& local = {}) const;
  /// Whether nothing is missing for classify().
  bool knows_enough(const FeatureSet& features, const LocalFeatureSet& local = {}) const;
  /// The words of bags, by the name of the bag.
  const std::map<std::string, Vocabulary>& vocabularies() const { return vocabularies_; }

  Json to_json() const;
  static Ensemble from_json(const Json& json, const std::string& file);
  /// JSON; load() gives an ensemble that answers the same, or an Error with the file.
  void save(const std::filesystem::path& path) const;
  static Ensemble load(const std::filesystem::path& path);

 private:
  Eigen::MatrixXd inputs(const std::vector<std::vector<double>>& scores) const;

  void add_bags(FeatureSet& features, const LocalFeatureSet& local) const;

  std::vector<std::string> classes_;
  std::map<std::string, Vocabulary> vocabularies_;
  std::vector<ExpertSpec> specs_;
  std::vector<std::unique_ptr<Classifier>> classifiers_;
  SoftmaxRegression fusion_;
  std::vector<double> accuracies_;
};

}  // namespace loci::perception
