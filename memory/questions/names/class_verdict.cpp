#include "memory/questions/names/class_verdict.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/names/structure_features.h"

namespace loci::memory {
namespace {

constexpr size_t kMaxObservations = 20;  // the latest
/// That an object which an expert does not name belongs to none of its classes.
constexpr double kUnknown = 0.5;
/// Before anybody has confirmed or corrected an expert.
constexpr double kPriorRight = 4, kPriorWrong = 1;
/// Of an expert that states none.
constexpr double kDefaultConfidence = kPriorRight / (kPriorRight + kPriorWrong);
/// Classes that a wrong expert may choose from.
constexpr double kAlternatives = 10;
/// Views of an object from directions that differ by less than this show the same surfaces.
constexpr double kSameSide = 20 * kPi / 180;
/// Of the names that `HouseholdClassifier` gives by one view from here on, 91 % are right on rendered tables
/// and 88 to 100 % on real ones (asked: 85).
constexpr double kMinProbability = 0.4;

/// Of one expert that is so competent; 1 before anybody has confirmed or corrected it.
double weight_of(double competence) {
  const auto log_odds = [](double right) {
    return std::log(std::max(1e-6, right) * kAlternatives / std::max(1e-6, 1 - right));
  };
  return log_odds(competence) / log_odds(kDefaultConfidence);
}

/// How many sides of an object views show, given the directions to their cameras by observation.
double sides_of(const std::map<Id, std::optional<Vector3d>>& views) {
  double sides = 0;
  for (const auto& [id, one] : views)
    if (one)
      sides += 1 / static_cast<double>(std::ranges::count_if(views, [&](const auto& other) {
                 return other.second && one->dot(*other.second) >= std::cos(kSameSide);
               }));
  return std::max(1.0, sides);
}

/// Who annotated: the source of the annotation and its model.
std::string expert_of(const Store& store, const AnnotationRow& row) {
  const std::vector<Json> features = features_of(store, row, row.type);
  if (features.empty()) return {};
  const std::string model = text_feature(features.front(), "model");
  return text_feature(features.front(), "source") + (model.empty() ? "" : " " + model);
}

}  // namespace

bool ClassVerdict::calls_it(const std::string& class_name) const {
  constexpr double kHardlyLess = 0.5;
  if (name.empty()) return false;
  const auto share_of = [&](const std::string& one) {
    double share = 0;
    for (const Vote& vote : votes)
      if (lower_case(vote.name) == lower_case(one)) share += vote.share;
    return share;
  };
  return share_of(class_name) >= kHardlyLess * share_of(name);
}

ClassExperts::ClassExperts(const Store& store, const std::vector<FactRow>& facts, const AsOf& as_of)
    : store_(store), as_of_(as_of) {
  for (const FactRow& fact : facts) {
    if (!fact.object || !fact.value || fact.key != "class" || fact.clock.source == "catalogue") continue;
    const std::string truth = lower_case(*fact.value);
    const Votes votes =
        votes_of(store.latest_observations(*fact.object, kMaxObservations, {kClassType}, as_of));
    for (const auto& [expert, opinion] : votes) {
      double all = 0;
      for (const auto& [name, confidence] : opinion.names) all += confidence;
      for (const auto& [name, confidence] : opinion.names)
        (lower_case(name) == truth ? records_[expert].right : records_[expert].wrong) += confidence / all;
    }
  }
}

ClassExperts::Votes ClassExperts::votes_of(const Store::LatestObservations& latest) const {
  std::vector<Store::LatestObservations::Annotation> annotations = latest.annotations;
  std::erase_if(annotations,
                [](const auto& one) { return one.row.type != kClassType || one.row.value.empty(); });
  if (annotations.empty()) return {};
  // Who says it matters where names differ; reading it takes longer than all else.
  const bool agree = std::ranges::all_of(
      annotations, [&](const auto& one) { return one.row.value == annotations[0].row.value; });
  const std::string last = expert_of(store_, annotations.back().row);
  Votes votes;
  std::map<std::string, std::map<Id, std::optional<Vector3d>>> named;
  for (const auto& [row, run, towards_camera] : annotations) {
    const std::string expert = agree ? last : expert_of(store_, row);
    Opinion& opinion = votes[expert];
    opinion.names[row.value] += std::max(1e-3, row.confidence.value_or(kDefaultConfidence));
    opinion.runs.insert(run);
    named[expert].emplace(row.observation.value_or(0), towards_camera);
  }
  for (auto& [expert, opinion] : votes) {
    opinion.named = static_cast<double>(named[expert].size());
    for (const auto& [run, count] : latest.by_run)
      if (opinion.runs.contains(run)) opinion.looked += static_cast<double>(count);
    opinion.looked = std::max(opinion.looked, opinion.named);
    opinion.sides = sides_of(named[expert]);
  }
  return votes;
}

double ClassExperts::competence(const std::string& expert) const {
  const auto found = records_.find(expert);
  const Record record = found == records_.end() ? Record() : found->second;
  return (kPriorRight + record.right) / (kPriorRight + kPriorWrong + record.right + record.wrong);
}

const ClassExperts::Judgement& ClassExperts::judgement(Id object) const {
  const auto [slot, fresh] = judgements_.try_emplace(object);
  if (!fresh) return slot->second;
  const Store::LatestObservations latest =
      store_.latest_observations(object, kMaxObservations, {kProductType, kClassType}, as_of_);
  std::map<std::string, size_t> products;
  for (const auto& annotation : latest.annotations)
    if (const AnnotationRow& row = annotation.row; row.type == kProductType && !row.value.empty())
      ++products[row.value];
  if (!products.empty())
    slot->second.product =
        std::ranges::max_element(products, {}, &std::pair<const std::string, size_t>::second)->first;
  slot->second.verdict = verdict_of(votes_of(latest));
  return slot->second;
}

std::optional<ClassVerdict> ClassExperts::verdict_of(const Votes& votes) const {
  if (votes.empty()) return std::nullopt;
  ClassVerdict verdict;
  std::map<std::string, double> evidence;  // logarithms
  for (const auto& [expert, opinion] : votes)
    for (const auto& [name, confidence] : opinion.names) evidence[name] = 0;
  const double unnamed = std::max(1.0, kAlternatives - static_cast<double>(evidence.size()));
  double none = 0, rest = 0;  // of what experts do not know, of each class that none of them names
  for (const auto& [expert, opinion] : votes) {
    const double right = competence(expert), weight = opinion.sides * weight_of(right);
    double all = 0;
    for (const auto& [name, confidence] : opinion.names) all += confidence;
    const double unknown = kUnknown * (1 - opinion.named / opinion.looked);
    const double other = std::max(1e-3, (1 - unknown - all / opinion.looked) /
                                            (kAlternatives + 1 - static_cast<double>(opinion.names.size())));
    for (auto& [name, log_probability] : evidence) {
      const auto said = opinion.names.find(name);
      log_probability +=
          weight * std::log(said == opinion.names.end() ? other : said->second / opinion.looked);
    }
    for (const auto& [name, confidence] : opinion.names)
      verdict.votes.push_back({expert, name, opinion.named / opinion.looked * confidence / all, right});
    none += weight * std::log(std::max(unknown, other));
    rest += weight * std::log(other);
  }
  const auto best = std::ranges::max_element(evidence, {}, &std::pair<const std::string, double>::second);
  double sum = std::exp(none - best->second) + unnamed * std::exp(rest - best->second);
  for (const auto& [name, log_probability] : evidence) sum += std::exp(log_probability - best->second);
  verdict.probability = 1 / sum;
  if (verdict.probability >= kMinProbability) verdict.name = best->first;
  std::ranges::stable_sort(verdict.votes, [&](const ClassVerdict::Vote& a, const ClassVerdict::Vote& b) {
    return (a.name == verdict.name) > (b.name == verdict.name);
  });
  return verdict;
}

}  // namespace loci::memory
