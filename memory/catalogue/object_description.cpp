#include "memory/catalogue/object_description.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "memory/belief/evidence/similarity.h"

namespace loci::memory {
namespace {

constexpr const char* kClassType = "loci.annotation.ClassificationAnnotation";

std::string class_by_annotators(const Store& store, Id object) {
  std::map<std::string, double> confidence;
  for (const ObjectObservation& observed : store.observations_of(object))
    for (const AnnotationRow& row : store.annotations(observed.observation.scene))
      if (row.observation == observed.observation.id && row.type == kClassType)
        confidence[row.value] += row.confidence.value_or(0.5);
  const auto most = std::ranges::max_element(confidence, {}, &std::pair<const std::string, double>::second);
  return most == confidence.end() ? std::string() : most->first;
}

constexpr size_t kMaxObservations = 100;

/// How terms of one kind are compared. Texts and labels are compared as by the belief. A recogniser of
/// products confuses flavours of one brand; the digits of a barcode are checked, but all objects of one
/// product share it.
struct TermKind {
  const char* kind;
  const char* type;
  belief::Comparison comparison;
};

const std::vector<TermKind>& term_kinds() {
  const auto of_belief = [](const char* kind) { return *belief::find_comparison(kind); };
  static const std::vector<TermKind> kinds = {
      {"text", "loci.annotation.TextAnnotation", of_belief("text")},
      {"product",
       "loci.annotation.ProductAnnotation",
       {.kind = "product", .table = {{0.0, 4.0}, {0.55, 2.5}, {0.8, 0.0}, {1.0, -2.0}}}},
      {"barcode",
       "loci.annotation.BarcodeAnnotation",
       {.kind = "barcode", .table = {{0.0, 5.0}, {0.55, 3.0}, {0.8, 0.0}, {1.0, -4.0}}}},
      {"label", "loci.annotation.ClassificationAnnotation", of_belief("class")},
  };
  return kinds;
}

/// In lower case; a text as its words of at least two letters.
std::map<std::string, double> comparable(const std::string& kind,
                                         const std::map<std::string, double>& values) {
  std::map<std::string, double> result;
  for (const auto& [value, agreement] : values) {
    std::string lower = value;
    std::ranges::transform(lower, lower.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (kind != "text") {
      result[lower] += agreement;
      continue;
    }
    std::istringstream words(lower);
    for (std::string word; words >> word;)
      if (word.size() > 1) result[word] += agreement;
  }
  return result;
}

/// Hellinger distance of two normalised bags of words; in [0,1].
double distance(const std::map<std::string, double>& a, const std::map<std::string, double>& b) {
  double shared = 0, all_a = 0, all_b = 0;
  for (const auto& [word, weight] : a) {
    all_a += weight;
    if (const auto found = b.find(word); found != b.end()) shared += std::sqrt(weight * found->second);
  }
  for (const auto& [word, weight] : b) all_b += weight;
  return std::sqrt(std::max(0.0, 1 - shared / std::sqrt(all_a * all_b)));
}

}  // namespace

ObjectClass class_of(const Store& store, Id object) {
  for (const FactRow& fact : store.facts())
    if (fact.object == object && fact.key == "class" && fact.value)
      return {*fact.value, fact.clock.source == "catalogue" ? "catalogue" : "fact"};
  const std::string name = class_by_annotators(store, object);
  return {name, name.empty() ? "" : "annotators"};
}

ObjectTerms terms_of(const Store& store, Id object) {
  std::vector<ObjectObservation> observations = store.observations_of(object);
  if (observations.size() > kMaxObservations)
    observations.erase(observations.begin(),
                       observations.end() - static_cast<std::ptrdiff_t>(kMaxObservations));
  ObjectTerms terms;
  for (const AnnotationSupport& evidence : annotation_support(store, observations))
    for (const TermKind& kind : term_kinds())
      if (evidence.type == kind.type) terms[kind.kind][evidence.value] = evidence.agreement;
  if (const ObjectClass stated = class_of(store, object); stated.by == "fact")
    terms["label"] = {{stated.name, 1.0}};
  return terms;
}

double terms_log_ratio(const ObjectTerms& a, const ObjectTerms& b) {
  double sum = 0;
  for (const TermKind& kind : term_kinds()) {
    const auto in_a = a.find(kind.kind), in_b = b.find(kind.kind);
    if (in_a == a.end() || in_b == b.end()) continue;
    const auto words_a = comparable(kind.kind, in_a->second), words_b = comparable(kind.kind, in_b->second);
    if (words_a.empty() || words_b.empty()) continue;  // missing evidence is missing, not zero
    sum += belief::log_ratio(kind.comparison, distance(words_a, words_b));
  }
  return sum;
}

void remove_terms(ObjectViews& views) {
  for (auto& view : views)
    std::erase_if(view, [](const belief::Descriptor& d) { return d.kind == "class" || d.kind == "text"; });
}

ObjectViews ViewReader::views_of(Id object) {
  constexpr size_t kMax = 6;
  std::vector<const belief::Observation*> seen;
  for (const ObjectObservation& observed : store_.observations_of(object))
    if (const belief::Observation* one = evidence(observed.observation);
        one != nullptr && !one->descriptors.empty())
      seen.push_back(one);
  const auto is_part = [](const belief::Observation* one) { return one->partial; };
  if (!std::ranges::all_of(seen, is_part)) std::erase_if(seen, is_part);
  ObjectViews views;
  const size_t count = std::min(kMax, seen.size());
  for (size_t i = 0; i < count; ++i) views.push_back(seen[i * seen.size() / count]->descriptors);
  remove_terms(views);
  return views;
}

const belief::Observation* ViewReader::evidence(const ObservationRow& row) {
  const auto [slot, fresh] = scenes_.try_emplace(row.scene);
  if (fresh) slot->second = load_reasoning(store_, row.scene);
  const auto number = static_cast<size_t>(row.number);
  if (!slot->second || number >= slot->second->evidence.observations.size()) return nullptr;
  return &slot->second->evidence.observations[number];
}

}  // namespace loci::memory
