#include "perception/classification/household_model.h"

#include <algorithm>
#include <numeric>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci::perception {

/// The shipped model, JSON (household_model.cpp.in).
std::string_view shipped_household_model();

namespace {

constexpr const char* kModelKind = "loci household model";
constexpr const char* kOther = "other";
constexpr const char* kModelFeature = "Household";
constexpr int kModelFolds = 4;
/// Of the classes that are answered rather than their group, so many are exactly right.
constexpr double kExactlyRight = 0.9;
constexpr int kMinExamples = 3 * kModelFolds;  ///< classes with fewer are not learned

/// Answers that are given anyway, and how many of them are right.
struct Given {
  double right = 0, all = 0;
};

/// The probability from which on answers are given, so that `wanted` of all are right.
double threshold(std::vector<std::pair<double, bool>> answers, double wanted, Given given = {}) {
  std::ranges::sort(answers, std::greater<>());
  double min = 1;
  for (const auto& [probability, right] : answers) {
    given.right += right ? 1 : 0;
    given.all += 1;
    if (given.right >= wanted * given.all) min = probability;
  }
  return min;
}

}  // namespace

const std::string& household_group(const std::string& class_name) {
  static const std::map<std::string, std::string> groups = {
      {"apple", "fruit"},    {"banana", "fruit"},  {"lemon", "fruit"}, {"orange", "fruit"},
      {"pear", "fruit"},     {"book", "box"},      {"carton", "box"},  {"sponge", "box"},
      {"tin", "can"},        {"jar", "can"},       {"glass", "cup"},   {"mug", "cup"},
      {"kettle", "pot"},     {"pan", "pot"},       {"teapot", "pot"},  {"fork", "cutlery"},
      {"knife", "cutlery"},  {"spoon", "cutlery"}, {"tray", "board"},  {"cutting board", "board"},
      {"spatula", "cutlery"}};
  const auto found = groups.find(class_name);
  return found == groups.end() ? class_name : found->second;
}

HouseholdModel HouseholdModel::train(std::vector<TrainingSample> samples, double wanted, const Random& random,
                                     int threads, Progress& progress) {
  for (TrainingSample& sample : samples)
    if (sample.label == "mug") sample.label = "cup";  // one word for both, with which people find them
  std::map<std::string, int> count;
  for (const TrainingSample& sample : samples) count[sample.label] += sample.features.contains(kModelFeature);
  std::erase_if(samples, [&](const TrainingSample& sample) { return count[sample.label] < kMinExamples; });
  HouseholdModel model;
  std::vector<Ensemble::HeldOut> held_out;
  model.ensemble_ =
      Ensemble::train(std::move(samples), {parse_expert(std::string(kModelFeature) + ":network")},
                      kModelFolds, random, threads, progress, &held_out);
  std::vector<std::pair<double, bool>> of_class, of_group;
  model.min_class_ = model.min_group_ = 0;
  for (const Ensemble::HeldOut& one : held_out)
    if (const auto said = model.answer(one.probabilities))
      of_class.emplace_back(said->probability, said->label == model.ensemble_.classes()[one.label]);
  model.min_class_ = threshold(std::move(of_class), kExactlyRight);
  Given classes;
  for (const Ensemble::HeldOut& one : held_out) {
    const auto said = model.answer(one.probabilities);
    if (!said) continue;
    const bool right = household_group(said->label) == household_group(model.ensemble_.classes()[one.label]);
    if (said->probability < model.min_class_) {
      of_group.emplace_back(said->probability, right);
      continue;
    }
    classes.all += 1;
    classes.right += right;
  }
  model.min_group_ = threshold(std::move(of_group), wanted, classes);
  return model;
}

std::optional<HouseholdModel::Answer> HouseholdModel::answer(const std::vector<double>& probabilities) const {
  Answer answer;
  double other = 0;
  std::map<std::string, double> groups;
  const std::vector<std::string>& names = ensemble_.classes();
  for (size_t c = 0; c < names.size(); ++c) {
    if (names[c] == kOther) {
      other = probabilities[c];
      continue;
    }
    answer.classes.emplace_back(names[c], probabilities[c]);
    groups[household_group(names[c])] += probabilities[c];
  }
  std::ranges::stable_sort(answer.classes, std::greater<>(), &std::pair<std::string, double>::second);
  std::tie(answer.label, answer.probability) = answer.classes.front();
  answer.sure = answer.probability >= min_class_;
  if (answer.sure) return answer;
  const auto best = std::ranges::max_element(groups, {}, &std::pair<const std::string, double>::second);
  std::tie(answer.label, answer.probability) = *best;
  answer.sure = answer.probability >= min_group_;
  return answer.probability > other ? std::optional(answer) : std::nullopt;
}

std::optional<HouseholdModel::Answer> HouseholdModel::classify(const FeatureSet& features) const {
  if (!ensemble_.knows_enough(features)) return std::nullopt;
  return answer(ensemble_.classify(features).probabilities);
}

std::optional<HouseholdModel::Answer> HouseholdModel::classify(const ObjectView& view) const {
  return classify(object_features({kModelFeature}, view).features);
}

void HouseholdModel::save(const std::filesystem::path& path) const {
  write_json(path, {{"kind", kModelKind},
                    {"min_class", min_class_},
                    {"min_group", min_group_},
                    {"ensemble", ensemble_.to_json()}});
}

HouseholdModel HouseholdModel::from_json(const Json& json, const std::string& file) try {
  if (!json.is_object() || json.value("kind", "") != kModelKind)
    throw Error("this is no model of household objects", {file, 0, {}},
                "make one with `loci-evaluate description --household --model-out FILE`");
  HouseholdModel model;
  model.ensemble_ = Ensemble::from_json(json.at("ensemble"), file);
  model.min_class_ = json.at("min_class");
  model.min_group_ = json.at("min_group");
  return model;
} catch (const nlohmann::json::exception&) {
  throw Error("the model contradicts itself", {file, 0, {}}, "make it anew");
}

HouseholdModel HouseholdModel::load(const std::filesystem::path& path) {
  return from_json(read_json(path), path.string());
}

const HouseholdModel& HouseholdModel::shipped() {
  static const HouseholdModel model =
      from_json(parse_json(std::string(shipped_household_model()), "the shipped model"), "the shipped model");
  return model;
}

}  // namespace loci::perception
