#include "memory/belief/evidence/similarity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "memory/belief/evidence/likelihood.h"

namespace loci::memory::belief {
namespace {

/// In ascending order.
LogExtents log_extents(const std::vector<float>& values) {
  const bool with_bounds = values.size() == 6;
  LogExtents extents;
  // A centimetre is added so that the thickness of flat objects, mostly noise, does not dominate.
  for (size_t i = 0; i < (with_bounds ? 3 : values.size()); ++i)
    extents.push_back({std::log(double(values[i]) + 0.01), with_bounds && values[i + 3] == 0});
  std::ranges::sort(extents, {}, &LogExtent::value);
  return extents;
}

/// Of a partial view the extents are lower bounds: what it lacks counts less.
constexpr double kLackingWeight = 0.5;

/// A distance, and the share of the axes that it is about.
struct ExtentDistance {
  double distance = 0, share = 1;
};

ExtentDistance extent_distance_in_order(const LogExtents& a, const LogExtents& b, PartialViews partial) {
  double sum = 0;
  size_t compared = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double difference = a[i].value - b[i].value;
    if (difference < 0 ? a[i].hidden : b[i].hidden) continue;
    const bool may_lack = difference < 0 ? partial.first : partial.second;
    sum += (may_lack ? kLackingWeight : 1.0) * difference * difference;
    ++compared;
  }
  return {compared == 0 ? 0.0 : std::sqrt(sum / double(compared)),
          a.empty() ? 0.0 : double(compared) / double(a.size())};
}

/// Extents of which a view shows only a lower bound may be of any axis of the other: the best order counts.
ExtentDistance log_extent_distance(const LogExtents& a, LogExtents b, PartialViews partial = {}) {
  ExtentDistance best = extent_distance_in_order(a, b, partial);
  const auto hidden = [](const LogExtent& extent) { return extent.hidden; };
  if (std::ranges::none_of(a, hidden) && std::ranges::none_of(b, hidden)) return best;
  while (std::ranges::next_permutation(b, {}, &LogExtent::value).found) {
    const ExtentDistance other = extent_distance_in_order(a, b, partial);
    if (other.distance * std::sqrt(other.share) < best.distance * std::sqrt(best.share)) best = other;
  }
  return best;
}

}  // namespace

double gaussian_similarity(double distance, double sigma) {
  return std::exp(-(distance / sigma) * (distance / sigma));
}

double histogram_distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum_a = 0, sum_b = 0, overlap = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    // std::max(0, NaN) is 0: a bin that is not a number would make a perfect match.
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) return std::numeric_limits<double>::quiet_NaN();
    sum_a += double(a[i]);
    sum_b += double(b[i]);
    overlap += std::sqrt(std::max(0.0, double(a[i]) * double(b[i])));
  }
  if (!(sum_a > 0) || !(sum_b > 0)) return 1.0;
  return std::sqrt(std::max(0.0, 1.0 - overlap / std::sqrt(sum_a * sum_b)));
}

double euclidean_distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  return a.empty() ? 0.0 : std::sqrt(sum / double(a.size()));
}

double extent_distance(const std::vector<float>& a, const std::vector<float>& b) {
  return log_extent_distance(log_extents(a), log_extents(b)).distance;
}

const std::vector<Comparison>& comparisons() {
  // Log ratios of the distances between labelled views of the same and of different objects on a table,
  // turned and moved between the views.
  static const std::vector<Comparison> all = {
      {"color_histogram",
       histogram_distance,
       {{0.0, 4.5},
        {0.1, 4.0},
        {0.2, 2.6},
        {0.3, 1.2},
        {0.4, 0.2},
        {0.5, -1.0},
        {0.6, -2.2},
        {0.75, -4.2},
        {0.9, -5.8},
        {1.0, -6.5}},
       0.5,
       false,
       true},
      // Its evidence is a density, see color_log_ratio().
      {"mean_color", euclidean_distance, {}, 0.25, false, true, 0},
      {"extents",
       extent_distance,
       {{0.0, 3.5},
        {0.05, 2.8},
        {0.1, 1.3},
        {0.15, 0.1},
        {0.2, -0.9},
        {0.3, -1.6},
        {0.4, -2.9},
        {0.6, -4.8},
        {1.0, -5.8}},
       0.4,
       true,
       false},
      // A detector's classes depend on the view, and it errs in the same way again.
      {"class",
       histogram_distance,
       {{0.0, 2.0}, {0.4, 1.2}, {0.6, 0.3}, {0.8, -1.5}, {1.0, -4.0}},
       0.5,
       false,
       false},
      // Another side bears another text, so that different words say little.
      {"text", histogram_distance, {{0.0, 3.0}, {0.55, 2.0}, {0.8, 0.5}, {1.0, -1.0}}, 0.5, false, false},
  };
  return all;
}

const Comparison* find_comparison(const std::string& kind) {
  for (const Comparison& comparison : comparisons())
    if (comparison.kind == kind) return &comparison;
  return nullptr;
}

double log_ratio(const Comparison& comparison, double distance) {
  const auto& table = comparison.table;
  if (table.empty()) return 0;
  if (distance <= table.front().distance) return table.front().log_ratio;
  for (size_t i = 1; i < table.size(); ++i) {
    if (distance > table[i].distance) continue;
    const double t = (distance - table[i - 1].distance) / (table[i].distance - table[i - 1].distance);
    return table[i - 1].log_ratio + t * (table[i].log_ratio - table[i - 1].log_ratio);
  }
  return table.back().log_ratio;
}

namespace {

bool is_achromatic(const std::vector<Descriptor>& view) {
  for (const Descriptor& d : view) {
    if (d.kind != "mean_color" || d.values.empty()) continue;
    const auto [lowest, highest] = std::minmax_element(d.values.begin(), d.values.end());
    return *highest - *lowest < 0.25F * std::max(*highest, 0.2F);
  }
  return false;
}

std::vector<std::pair<const std::string*, float>> by_name(const Descriptor& descriptor) {
  std::vector<std::pair<const std::string*, float>> sorted;
  for (size_t i = 0; i < descriptor.names.size(); ++i)
    sorted.emplace_back(&descriptor.names[i], descriptor.values[i]);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& one, const auto& other) { return *one.first < *other.first; });
  size_t kept = 0;
  for (size_t i = 0; i < sorted.size(); ++i) {
    if (kept > 0 && *sorted[i].first == *sorted[kept - 1].first)
      sorted[kept - 1].second += sorted[i].second;
    else
      sorted[kept++] = sorted[i];
  }
  sorted.resize(kept);
  return sorted;
}

/// The values of both over the union of their names, in order; 0 for a missing name.
void align(const Appearance::Feature& a, const Appearance::Feature& b, std::vector<float>& x,
           std::vector<float>& y) {
  x.clear();
  y.clear();
  auto in_a = a.by_name.begin();
  auto in_b = b.by_name.begin();
  while (in_a != a.by_name.end() || in_b != b.by_name.end()) {
    const int order = in_a == a.by_name.end()   ? 1
                      : in_b == b.by_name.end() ? -1
                                                : in_a->first->compare(*in_b->first);
    x.push_back(order <= 0 ? (in_a++)->second : 0.0F);
    y.push_back(order >= 0 ? (in_b++)->second : 0.0F);
  }
}

bool comparable(const Appearance::Feature& a, const Appearance::Feature& b) {
  if (a.values == nullptr || b.values == nullptr) return false;
  if (!a.log_extents.empty()) return a.log_extents.size() == b.log_extents.size();
  return a.named == b.named && (a.named || a.values->size() == b.values->size());
}

/// The distance, and in `share` how much of the descriptors it compares.
double distance_of(const Comparison& comparison, const Appearance::Feature& a, const Appearance::Feature& b,
                   PartialViews partial, double& share) {
  share = 1;
  if (comparison.distance == extent_distance) {
    const ExtentDistance extents = log_extent_distance(a.log_extents, b.log_extents, partial);
    share = extents.share;
    return extents.distance;
  }
  if (!a.named) return comparison.distance(*a.values, *b.values);
  thread_local std::vector<float> x, y;
  align(a, b, x, y);
  return comparison.distance(x, y);
}

/// Mean colours of one object against those of unrelated ones, which are anywhere in the colour cube.
/// `noise_levels`: of the factors on the noise of the home: bright and dark, near and far objects differ.
double color_log_ratio(const std::vector<float>& a, const std::vector<float>& b,
                       const NoiseScale::Levels& noise_levels) {
  constexpr double kImpossible = 60;  // more than any pair's evidence counts
  double squares = 0, likelihood = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  const Domain cube;
  for (size_t level = 0; level < NoiseScale::kLevels; ++level) {
    const double noise = kColorVariance * NoiseScale::kFactors[level] * NoiseScale::kFactors[level];
    if (noise_levels[level] == 0 || squares > 2 * kImpossible * noise) continue;
    double log_ratio = 0;
    for (size_t i = 0; i < a.size(); ++i)
      log_ratio += log_same({a[i], noise / 2}, cube, {b[i], noise / 2}, cube);
    likelihood += noise_levels[level] * std::exp(log_ratio);
  }
  return likelihood > 0 ? std::max(-kImpossible, std::log(likelihood)) : -kImpossible;
}

}  // namespace

Appearance::Appearance(const std::vector<Descriptor>& descriptors) : achromatic_(is_achromatic(descriptors)) {
  const std::vector<Comparison>& known = comparisons();
  for (const Descriptor& descriptor : descriptors) {
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const Comparison& one) { return one.kind == descriptor.kind; });
    if (found == known.end()) continue;
    Feature& feature = features_.at(static_cast<size_t>(found - known.begin()));
    if (feature.values != nullptr) continue;  // the first of a kind counts
    feature.values = &descriptor.values;
    feature.named = !descriptor.names.empty();
    feature.by_name = by_name(descriptor);
    if (found->distance == extent_distance) feature.log_extents = log_extents(descriptor.values);
  }
}

std::optional<double> ViewSimilarity::similarity() const {
  return count > 0 ? std::optional(std::exp(mean_log_similarity)) : std::nullopt;
}

ViewSimilarity compare(const Appearance& a, const Appearance& b, PartialViews partial, double weight,
                       const Corrections& corrections) {
  static const double min_log_similarity = std::log(1e-12);  // bounds gaussian_similarity()
  ViewSimilarity result;
  result.achromatic = a.achromatic() && b.achromatic();
  size_t informative = 0;
  for (size_t i = 0; i < kComparisons; ++i) {
    const Comparison& comparison = comparisons()[i];
    const Appearance::Feature &of_a = a.features()[i], &of_b = b.features()[i];
    if (!comparable(of_a, of_b)) continue;
    double share = 1;
    const double distance = distance_of(comparison, of_a, of_b, partial, share);
    if (!std::isfinite(distance)) continue;
    double ratio = (i == kMeanColor ? color_log_ratio(*of_a.values, *of_b.values, corrections.color_noise)
                                    : prior_log_ratio(comparison, distance, result.achromatic)) +
                   corrections.of[i][result.achromatic].at(distance);
    if (comparison.of_size && partial.any() && corrections.misleading_partial > 0)
      ratio = std::log(std::lerp(std::exp(ratio), 1.0, corrections.misleading_partial));
    ratio *= share;
    if (comparison.summarised_by && result.parts[*comparison.summarised_by].distance >= 0) ratio = 0;
    result.parts[i] = {distance, ratio};
    ++result.count;
    result.log_ratio += ratio;
    if (ratio != 0) ++informative;
    const double relative = distance / comparison.sigma;
    result.mean_log_similarity += std::max(min_log_similarity, -relative * relative);
  }
  if (informative > 1) result.log_ratio *= weight;
  if (result.count > 0) result.mean_log_similarity /= double(result.count);
  return result;
}

ViewSimilarity compare(const std::vector<Descriptor>& a, const std::vector<Descriptor>& b,
                       PartialViews partial, double weight) {
  return compare(Appearance(a), Appearance(b), partial, weight);
}

}  // namespace loci::memory::belief
