#include "memory/questions/names/class_verdict.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"

namespace loci::memory {
namespace {

constexpr size_t kMaxObservations = 20;  // the latest
constexpr double kDefaultConfidence = 0.5;
/// Before anybody has confirmed or corrected an expert.
constexpr double kPriorRight = 4, kPriorWrong = 1;
/// Classes that a wrong expert may choose from.
constexpr double kAlternatives = 10;

/// Who annotated: the source of the annotation and its model.
std::string expert_of(const Store& store, const AnnotationRow& row) {
  if (!row.feature_structure) return {};
  const Json json = parse_json(store.feature_structure(*row.feature_structure).json, "feature_structure");
  for (const Json& structure : json.value("structures", Json::array())) {
    if (structure.value("type", std::string()) != row.type) continue;
    const Json features = structure.value("features", Json::object());
    const std::string model = features.value("model", std::string());
    return features.value("source", std::string()) + (model.empty() ? "" : " " + model);
  }
  return {};
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
  std::map<std::string, std::set<std::pair<Id, std::optional<Id>>>> named;
  for (const auto& [row, run] : annotations) {
    const std::string expert = agree ? last : expert_of(store_, row);
    Opinion& opinion = votes[expert];
    opinion.names[row.value] += std::max(1e-3, row.confidence.value_or(kDefaultConfidence));
    opinion.runs.insert(run);
    named[expert].emplace(row.scene, row.observation);
  }
  for (auto& [expert, opinion] : votes) {
    opinion.named = static_cast<double>(named[expert].size());
    for (const auto& [run, count] : latest.by_run)
      if (opinion.runs.contains(run)) opinion.looked += static_cast<double>(count);
    opinion.looked = std::max(opinion.looked, opinion.named);
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
  for (const auto& [row, run] : latest.annotations)
    if (row.type == kProductType && !row.value.empty()) ++products[row.value];
  if (!products.empty())
    slot->second.product =
        std::ranges::max_element(products, {}, &std::pair<const std::string, size_t>::second)->first;
  slot->second.verdict = verdict_of(votes_of(latest));
  return slot->second;
}

std::optional<ClassVerdict> ClassExperts::verdict_of(const Votes& votes) const {
  if (votes.empty()) return std::nullopt;
  ClassVerdict verdict;
  std::map<std::string, double> evidence;
  double none = 0;
  for (const auto& [expert, opinion] : votes) {
    const double right = competence(expert);
    const double weight = std::log(std::max(1e-6, right) * kAlternatives / std::max(1e-6, 1 - right));
    const double known = opinion.named / opinion.looked;
    double all = 0;
    for (const auto& [name, confidence] : opinion.names) all += confidence;
    for (const auto& [name, confidence] : opinion.names) {
      verdict.votes.push_back({expert, name, known * confidence / all, right});
      evidence[name] += weight * known * confidence / all;
    }
    none += weight * (1 - known);
  }
  double sum = std::exp(none) + std::max(0.0, kAlternatives - 1 - static_cast<double>(evidence.size()));
  for (const auto& [name, log_odds] : evidence) sum += std::exp(log_odds);
  const auto best = std::ranges::max_element(evidence, {}, &std::pair<const std::string, double>::second);
  if (best->second >= none) verdict.name = best->first;
  verdict.probability = std::exp(best->second) / sum;
  std::ranges::stable_sort(verdict.votes, [&](const ClassVerdict::Vote& a, const ClassVerdict::Vote& b) {
    return (a.name == verdict.name) > (b.name == verdict.name);
  });
  return verdict;
}

}  // namespace loci::memory
