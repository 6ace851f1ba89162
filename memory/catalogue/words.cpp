#include "memory/catalogue/words.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "memory/belief/similarity.h"
#include "memory/catalogue/said_class.h"
#include "memory/store/object_evidence.h"

namespace loci::memory {
namespace {

constexpr size_t kMaxSightings = 100;

/// How words of one kind are compared. Texts and labels are what they are to the belief. A recogniser of
/// products mixes up flavours of one brand; the digits of a barcode are checked, but things of one product
/// share it.
struct WordKind {
  const char* kind;
  const char* type;
  belief::Comparison comparison;
};

const std::vector<WordKind>& word_kinds() {
  const auto of_belief = [](const char* kind) { return *belief::find_comparison(kind); };
  static const std::vector<WordKind> kinds = {
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

/// Without regard to case; a text as its words, of which those of one letter say nothing.
std::map<std::string, double> comparable(const std::string& kind, const std::map<std::string, double>& said) {
  std::map<std::string, double> result;
  for (const auto& [value, agreement] : said) {
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

/// Hellinger distance of two bags of words, each normalised; in [0,1].
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

Words words_of(const Store& store, Id object) {
  std::vector<ObjectObservation> sightings = store.observations_of(object);
  if (sightings.size() > kMaxSightings)
    sightings.erase(sightings.begin(), sightings.end() - static_cast<std::ptrdiff_t>(kMaxSightings));
  Words words;
  for (const AnnotationSupport& evidence : annotation_support(store, sightings))
    for (const WordKind& kind : word_kinds())
      if (evidence.type == kind.type) words[kind.kind][evidence.value] = evidence.agreement;
  if (const SaidClass said = class_of(store, object); said.by == "fact") words["label"] = {{said.name, 1.0}};
  return words;
}

double words_log_ratio(const Words& a, const Words& b) {
  double sum = 0;
  for (const WordKind& kind : word_kinds()) {
    const auto in_a = a.find(kind.kind), in_b = b.find(kind.kind);
    if (in_a == a.end() || in_b == b.end()) continue;
    const auto words_a = comparable(kind.kind, in_a->second), words_b = comparable(kind.kind, in_b->second);
    if (words_a.empty() || words_b.empty()) continue;  // missing evidence is missing, not zero
    sum += belief::log_ratio(kind.comparison, distance(words_a, words_b));
  }
  return sum;
}

}  // namespace loci::memory
