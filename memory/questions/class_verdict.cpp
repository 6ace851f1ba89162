#include "memory/questions/class_verdict.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/json.h"
#include "mapping/base/text.h"

namespace loci::memory {
namespace {

constexpr const char* kClassType = "loci.annotation.ClassificationAnnotation";
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

ClassExperts::ClassExperts(const Store& store, const std::vector<FactRow>& facts, const AsOf& as_of)
    : store_(store), as_of_(as_of) {
  for (const FactRow& fact : facts) {
    if (!fact.object || !fact.value || fact.key != "class" || fact.clock.source == "catalogue") continue;
    const std::string truth = lower_case(*fact.value);
    for (const auto& [expert, names] : votes_of(*fact.object)) {
      double all = 0;
      for (const auto& [name, confidence] : names) all += confidence;
      for (const auto& [name, confidence] : names)
        (lower_case(name) == truth ? records_[expert].right : records_[expert].wrong) += confidence / all;
    }
  }
}

ClassExperts::Votes ClassExperts::votes_of(Id object) const {
  std::vector<AnnotationRow> rows = store_.latest_annotations(object, kClassType, kMaxObservations, as_of_);
  std::erase_if(rows, [](const AnnotationRow& row) { return row.value.empty(); });
  if (rows.empty()) return {};
  // Who says it matters where names differ; reading it takes longer than all else.
  const bool agree =
      std::ranges::all_of(rows, [&](const AnnotationRow& row) { return row.value == rows[0].value; });
  const std::string last = expert_of(store_, rows.back());
  Votes votes;
  for (const AnnotationRow& row : rows)
    votes[agree ? last : expert_of(store_, row)][row.value] +=
        std::max(1e-3, row.confidence.value_or(kDefaultConfidence));
  return votes;
}

double ClassExperts::competence(const std::string& expert) const {
  const auto found = records_.find(expert);
  const Record record = found == records_.end() ? Record() : found->second;
  return (kPriorRight + record.right) / (kPriorRight + kPriorWrong + record.right + record.wrong);
}

std::optional<ClassVerdict> ClassExperts::verdict(Id object) const {
  const Votes votes = votes_of(object);
  if (votes.empty()) return std::nullopt;
  ClassVerdict verdict;
  std::map<std::string, double> evidence;
  for (const auto& [expert, names] : votes) {
    const double right = competence(expert);
    const double weight = std::log(std::max(1e-6, right) * kAlternatives / std::max(1e-6, 1 - right));
    double all = 0;
    for (const auto& [name, confidence] : names) all += confidence;
    for (const auto& [name, confidence] : names) {
      verdict.votes.push_back({expert, name, confidence / all, right});
      evidence[name] += weight * confidence / all;
    }
  }
  double sum = std::max(0.0, kAlternatives - static_cast<double>(evidence.size()));  // none of them
  for (const auto& [name, log_odds] : evidence) sum += std::exp(log_odds);
  const auto best = std::ranges::max_element(evidence, {}, &std::pair<const std::string, double>::second);
  verdict.name = best->first;
  verdict.probability = std::exp(best->second) / sum;
  std::ranges::stable_sort(verdict.votes, [&](const ClassVerdict::Vote& a, const ClassVerdict::Vote& b) {
    return (a.name == verdict.name) > (b.name == verdict.name);
  });
  return verdict;
}

}  // namespace loci::memory
