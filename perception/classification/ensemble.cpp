#include "perception/classification/ensemble.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "mapping/base/error.h"
#include "mapping/base/parallel.h"
#include "mapping/base/text/json.h"
#include "perception/classification/household_features.h"

namespace loci::perception {
namespace {

Eigen::VectorXd softmax(const Eigen::VectorXd& logits) {
  const Eigen::VectorXd powers = (logits.array() - logits.maxCoeff()).exp();
  return powers / powers.sum();
}

Eigen::VectorXd log_softmax(const Eigen::VectorXd& logits) {
  const Eigen::ArrayXd shifted = logits.array() - logits.maxCoeff();
  return shifted - std::log(shifted.exp().sum());
}

constexpr const char* kKind = "loci classifier";
constexpr int kVersion = 1;
constexpr double kRidge = 1e-3;
constexpr std::string_view kBag = "Bag";
constexpr const char* kHousehold = "Household";
constexpr size_t kWords = 100;

/// What one expert says of each object when it has not learned it.
std::vector<std::vector<double>> scores_out_of_fold(const LabelledVectors& data,
                                                    const ClassifierOptions& options,
                                                    const std::vector<size_t>& fold, size_t folds,
                                                    const Random& random) {
  std::vector<std::vector<double>> scores(data.vectors.size());
  for (size_t f = 0; f < folds; ++f) {
    LabelledVectors rest;
    rest.classes = data.classes;
    for (size_t i = 0; i < data.vectors.size(); ++i) {
      if (fold[i] == f) continue;
      rest.vectors.push_back(data.vectors[i]);
      rest.labels.push_back(data.labels[i]);
    }
    const auto classifier = train_classifier(rest, options, random.fork(f + 1));
    for (size_t i = 0; i < data.vectors.size(); ++i)
      if (fold[i] == f) scores[i] = classifier->scores(data.vectors[i]);
  }
  return scores;
}

size_t best_of(const std::vector<double>& probabilities) {
  return static_cast<size_t>(std::max_element(probabilities.begin(), probabilities.end()) -
                             probabilities.begin());
}

bool has_all(const TrainingSample& object, const std::vector<ExpertSpec>& experts) {
  return std::all_of(experts.begin(), experts.end(),
                     [&](const ExpertSpec& expert) { return object.features.contains(expert.feature); });
}

/// Each class is spread evenly over the folds.
std::vector<size_t> folds_of(const std::vector<size_t>& labels, size_t classes, size_t folds) {
  std::vector<size_t> count(classes, 0);
  std::vector<size_t> fold;
  for (const size_t label : labels) fold.push_back(count[label]++ % folds);
  for (const size_t each : count)
    if (each < folds)
      throw Error("a class has fewer objects than there are folds", {},
                  "show more objects, or take fewer folds");
  return fold;
}

/// The words of every bag that experts ask for.
std::map<std::string, Vocabulary> learned_words(const std::vector<TrainingSample>& objects,
                                                const std::vector<ExpertSpec>& experts,
                                                const Random& random) {
  std::map<std::string, Vocabulary> vocabularies;
  for (const ExpertSpec& expert : experts) {
    const std::string name = local_name_of(expert.feature);
    if (name.empty() || vocabularies.contains(expert.feature)) continue;
    std::vector<const LocalFeatures*> examples;
    for (const TrainingSample& object : objects)
      if (const auto found = object.local.find(name); found != object.local.end())
        examples.push_back(&found->second);
    vocabularies.emplace(expert.feature, Vocabulary::learn(examples, kWords, random));
  }
  return vocabularies;
}

}  // namespace

SoftmaxRegression SoftmaxRegression::fit(const std::vector<Eigen::MatrixXd>& examples,
                                         const std::vector<size_t>& labels, double ridge,
                                         const Eigen::VectorXd& prior) {
  if (labels.empty() || labels.size() != examples.size())
    throw Error("a regression needs one label for each example");
  const Eigen::Index size = examples.front().cols();
  const double share = 1.0 / static_cast<double>(labels.size());
  SoftmaxRegression regression;
  const Eigen::VectorXd centre = prior.size() > 0 ? prior : Eigen::VectorXd::Zero(size);
  const auto loss = [&](const Eigen::VectorXd& weights) {
    double sum = 0.5 * ridge * (weights - centre).squaredNorm();
    for (size_t i = 0; i < examples.size(); ++i)
      sum -= share * log_softmax(examples[i] * weights)[static_cast<Eigen::Index>(labels[i])];
    return sum;
  };
  regression.weights_ = centre;
  double lost = loss(centre);
  constexpr int kSteps = 50;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::VectorXd gradient = ridge * (regression.weights_ - centre);
    Eigen::MatrixXd hessian = ridge * Eigen::MatrixXd::Identity(size, size);
    for (size_t i = 0; i < examples.size(); ++i) {
      const Eigen::MatrixXd& x = examples[i];
      const Eigen::VectorXd p = softmax(x * regression.weights_);
      const Eigen::VectorXd mean = x.transpose() * p;
      gradient += share * (mean - x.row(static_cast<Eigen::Index>(labels[i])).transpose());
      hessian += share * (x.transpose() * p.asDiagonal() * x - mean * mean.transpose());
    }
    // Far from the optimum a whole step of Newton's overshoots: half of it, until it is one.
    Eigen::VectorXd move = hessian.llt().solve(gradient);
    double next = loss(regression.weights_ - move);
    for (int halving = 0; halving < 40 && !(next <= lost); ++halving) {
      move /= 2;
      next = loss(regression.weights_ - move);
    }
    if (!(next <= lost)) break;
    regression.weights_ -= move;
    lost = next;
    if (move.norm() < 1e-8) break;
  }
  if (!regression.weights_.allFinite()) throw Error("the regression has no finite weights");
  return regression;
}

std::vector<double> SoftmaxRegression::probabilities(const Eigen::MatrixXd& example) const {
  if (example.cols() != weights_.size()) throw Error("a regression was given inputs of another size");
  const Eigen::VectorXd p = softmax(example * weights_);
  return {p.begin(), p.end()};
}

Json SoftmaxRegression::to_json() const {
  return std::vector<double>(weights_.begin(), weights_.end());
}

SoftmaxRegression SoftmaxRegression::from_json(const Json& json) {
  const std::vector<double> weights = json;
  SoftmaxRegression regression;
  regression.weights_ =
      Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  return regression;
}

std::vector<std::string> expert_feature_names() {
  std::vector<std::string> names = shape_feature_names();
  names.emplace_back("HOG");
  names.emplace_back(kHousehold);
  for (const std::string& name : local_feature_names()) names.push_back(name + std::string(kBag));
  return names;
}

std::string local_name_of(const std::string& name) {
  return name.ends_with(kBag) ? name.substr(0, name.size() - kBag.size()) : std::string();
}

bool is_of_image(const std::string& name) {
  return name == "HOG" || name.starts_with("SIFT") || name.starts_with("ORB");
}

ObjectFeatures object_features(const std::vector<std::string>& names, const ObjectView& view) {
  ObjectFeatures all;
  for (const std::string& name : names) {
    if (const std::string local = local_name_of(name); !local.empty()) {
      LocalFeatures found = local_features(local, view);
      if (found.count() > 0) all.local[local] = std::move(found);
      continue;
    }
    FeatureVector vector = name == "HOG"        ? hog_of(view.image, view.mask)
                           : name == kHousehold ? household_features(view)
                                                : shape_feature(name, view.surface);
    if (!vector.empty()) all.features[name] = std::move(vector);
  }
  return all;
}

FeatureSet feature_set(const std::vector<std::string>& names, const SurfacePoints& surface) {
  FeatureSet set;
  for (const std::string& name : names)
    if (FeatureVector vector = shape_feature(name, surface); !vector.empty()) set[name] = std::move(vector);
  return set;
}

ExpertSpec parse_expert(const std::string& text, const ClassifierOptions& options) {
  ExpertSpec expert{{}, options};
  std::istringstream stream(text);
  std::string distance, rest;
  std::getline(stream, expert.feature, ':');
  expert.options.method.clear();
  std::getline(stream, expert.options.method, ':');
  if (std::getline(stream, distance, ':')) expert.options.distance = distance;
  if (expert.feature.empty() || expert.options.method.empty() || std::getline(stream, rest))
    throw Error("\"" + text + "\" is no expert", {},
                "write DESCRIPTOR:CLASSIFIER[:DISTANCE], such as VFH:knn:L1");
  const std::vector<std::string> known = expert_feature_names();
  if (std::find(known.begin(), known.end(), expert.feature) == known.end()) {
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    throw Error("there is no descriptor " + expert.feature, {}, "there are " + list);
  }
  table_of(expert.options).validate();
  return expert;
}

std::string name_of(const ExpertSpec& expert) {
  const std::string name = expert.feature + ":" + expert.options.method;
  const bool compares = expert.options.method == "knn" || expert.options.method == "svm";
  return compares ? name + ":" + expert.options.distance : name;
}

Eigen::MatrixXd Ensemble::inputs(const std::vector<std::vector<double>>& scores) const {
  constexpr double kMin = 0.01;
  const auto classes = static_cast<Eigen::Index>(classes_.size());
  const auto experts = static_cast<Eigen::Index>(scores.size());
  Eigen::MatrixXd inputs(classes, experts + classes);
  inputs.rightCols(classes).setIdentity();
  for (Eigen::Index e = 0; e < experts; ++e)
    for (Eigen::Index c = 0; c < classes; ++c)
      inputs(c, e) = std::log(std::max(scores[static_cast<size_t>(e)][static_cast<size_t>(c)], kMin));
  return inputs;
}

Ensemble Ensemble::train(std::vector<TrainingSample> objects, const std::vector<ExpertSpec>& experts,
                         int folds, const Random& random, int threads, Progress& progress,
                         std::vector<HeldOut>* held_out) {
  if (experts.empty()) throw Error("there is no expert to train");
  Ensemble ensemble;
  ensemble.specs_ = experts;
  ensemble.vocabularies_ = learned_words(objects, experts, random.fork(experts.size()));
  for (TrainingSample& object : objects) ensemble.add_bags(object.features, object.local);
  std::set<std::string> names;
  for (const TrainingSample& object : objects)
    if (has_all(object, experts)) names.insert(object.label);
  ensemble.classes_.assign(names.begin(), names.end());
  const size_t classes = ensemble.classes_.size();
  if (classes < 2) throw Error("there are fewer than two classes to tell apart");
  std::vector<size_t> labels;
  std::vector<const TrainingSample*> used;
  for (const TrainingSample& object : objects) {
    if (!has_all(object, experts)) continue;
    const auto name = std::lower_bound(ensemble.classes_.begin(), ensemble.classes_.end(), object.label);
    labels.push_back(static_cast<size_t>(name - ensemble.classes_.begin()));
    used.push_back(&object);
  }
  const auto parts = static_cast<size_t>(folds);
  const std::vector<size_t> fold = folds_of(labels, classes, parts);
  progress.check(0, "experts learn");
  ensemble.classifiers_.resize(experts.size());
  std::vector<std::vector<std::vector<double>>> scores(experts.size());
  parallel_for(experts.size(), threads, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e) {
      LabelledVectors data{{}, labels, classes};
      for (const TrainingSample* object : used)
        data.vectors.push_back(object->features.at(experts[e].feature));
      const Random draw = random.fork(e);
      scores[e] = scores_out_of_fold(data, experts[e].options, fold, parts, draw);
      ensemble.classifiers_[e] = train_classifier(data, experts[e].options, draw.fork(0));
    }
  });
  std::vector<Eigen::MatrixXd> all;
  for (size_t i = 0; i < used.size(); ++i) {
    std::vector<std::vector<double>> of_thing;
    for (const auto& of_expert : scores) of_thing.push_back(of_expert[i]);
    all.push_back(ensemble.inputs(of_thing));
  }
  progress.check(0.9, "they are weighed");
  // What the examples do not decide stays with all experts alike: those that are best on examples of one
  // origin are not those that are best elsewhere.
  Eigen::VectorXd alike = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(experts.size() + classes));
  alike.head(static_cast<Eigen::Index>(experts.size())).setConstant(1 / static_cast<double>(experts.size()));
  ensemble.fusion_ = SoftmaxRegression::fit(all, labels, kRidge, alike);
  std::vector<double> right(classes, 0.0), count(classes, 0.0);
  for (size_t i = 0; i < used.size(); ++i) {
    const std::vector<double> probabilities = ensemble.fusion_.probabilities(all[i]);
    count[labels[i]] += 1;
    right[labels[i]] += best_of(probabilities) == labels[i];
    if (held_out) held_out->push_back({labels[i], probabilities});
  }
  for (size_t c = 0; c < classes; ++c) ensemble.accuracies_.push_back(right[c] / count[c]);
  return ensemble;
}

std::vector<std::string> Ensemble::features() const {
  std::set<std::string> names;
  for (const ExpertSpec& expert : specs_) names.insert(expert.feature);
  return {names.begin(), names.end()};
}

void Ensemble::add_bags(FeatureSet& features, const LocalFeatureSet& local) const {
  for (const auto& [name, vocabulary] : vocabularies_) {
    const auto found = local.find(local_name_of(name));
    if (features.contains(name) || found == local.end()) continue;
    if (FeatureVector bag = vocabulary.bag_of(found->second); !bag.empty()) features[name] = std::move(bag);
  }
}

bool Ensemble::knows_enough(const FeatureSet& features, const LocalFeatureSet& local) const {
  return std::all_of(specs_.begin(), specs_.end(), [&](const ExpertSpec& expert) {
    return features.contains(expert.feature) || local.contains(local_name_of(expert.feature));
  });
}

Classification Ensemble::classify(FeatureSet features, const LocalFeatureSet& local) const {
  add_bags(features, local);
  std::vector<std::vector<double>> scores;
  for (size_t e = 0; e < specs_.size(); ++e) {
    const auto found = features.find(specs_[e].feature);
    if (found == features.end())
      throw Error("there is no " + specs_[e].feature + " of what is to be classified");
    scores.push_back(classifiers_[e]->scores(found->second));
  }
  Classification result;
  result.probabilities = fusion_.probabilities(inputs(scores));
  result.best = best_of(result.probabilities);
  return result;
}

Json Ensemble::to_json() const {
  Json experts = Json::array();
  for (size_t e = 0; e < specs_.size(); ++e)
    experts.push_back({{"expert", name_of(specs_[e])}, {"trained", classifiers_[e]->to_json()}});
  Json vocabularies = Json::object();
  for (const auto& [name, vocabulary] : vocabularies_) vocabularies[name] = vocabulary.to_json();
  return {{"kind", kKind},
          {"vocabularies", std::move(vocabularies)},
          {"version", kVersion},
          {"classes", classes_},
          {"accuracies", accuracies_},
          {"experts", std::move(experts)},
          {"fusion", fusion_.to_json()}};
}

void Ensemble::save(const std::filesystem::path& path) const {
  write_json(path, to_json());
}

Ensemble Ensemble::load(const std::filesystem::path& path) {
  return from_json(read_json(path), path.string());
}

Ensemble Ensemble::from_json(const Json& json, const std::string& file) try {
  if (!json.is_object() || json.value("kind", "") != kKind)
    throw Error("this is no classifier", {}, "make one with `loci-perceive train`");
  if (json.at("version") != kVersion)
    throw Error("the classifier has another version than this program reads", {}, "train it anew");
  Ensemble ensemble;
  ensemble.classes_ = json.at("classes").get<std::vector<std::string>>();
  ensemble.accuracies_ = json.at("accuracies").get<std::vector<double>>();
  if (json.contains("vocabularies"))
    for (const auto& [name, words] : json.at("vocabularies").items())
      ensemble.vocabularies_.emplace(name, Vocabulary::from_json(words));
  for (const Json& each : json.at("experts")) {
    ensemble.specs_.push_back(parse_expert(each.at("expert")));
    ensemble.classifiers_.push_back(classifier_from_json(each.at("trained")));
  }
  ensemble.fusion_ = SoftmaxRegression::from_json(json.at("fusion"));
  return ensemble;
} catch (const Error& error) {
  if (!error.location().file.empty()) throw;
  throw Error(error.message(), {file, 0, {}}, error.hint());
} catch (const nlohmann::json::exception&) {
  throw Error("the classifier contradicts itself", {file, 0, {}}, "train it anew");
}

}  // namespace loci::perception
