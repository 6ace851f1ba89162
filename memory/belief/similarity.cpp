#include "memory/belief/similarity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace loci::belief {

double gaussian_closeness(double distance, double sigma) {
  return std::exp(-(distance / sigma) * (distance / sigma));
}

double linear_closeness(double distance) {
  return 2.0 / (1.0 + std::exp(distance));
}

double histogram_distance(const std::vector<float>& a, const std::vector<float>& b) {
  const double sum_a = std::accumulate(a.begin(), a.end(), 0.0);
  const double sum_b = std::accumulate(b.begin(), b.end(), 0.0);
  if (!(sum_a > 0) || !(sum_b > 0)) return 1.0;
  double overlap = 0;
  for (size_t i = 0; i < a.size(); ++i) overlap += std::sqrt(std::max(0.0, double(a[i]) * double(b[i])));
  return std::sqrt(std::max(0.0, 1.0 - overlap / std::sqrt(sum_a * sum_b)));
}

double euclidean_distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  return a.empty() ? 0.0 : std::sqrt(sum / double(a.size()));
}

double extent_distance(const std::vector<float>& a, const std::vector<float>& b) {
  thread_local std::vector<float> x, y;  // compared far too often to ask for memory each time
  x = a;
  y = b;
  std::sort(x.begin(), x.end());
  std::sort(y.begin(), y.end());
  double sum = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    // A centimetre is added so that the thickness of flat things, mostly noise, does not dominate.
    const double ratio = std::log((double(x[i]) + 0.01) / (double(y[i]) + 0.01));
    sum += ratio * ratio;
  }
  return x.empty() ? 0.0 : std::sqrt(sum / double(x.size()));
}

const std::vector<Comparison>& comparisons() {
  // Log ratios were read off distances between labelled views of the same and of different objects, then
  // flattened: other kitchens have other objects, so no single annotation may decide alone.
  static const std::vector<Comparison> all = {
      {"color_histogram",
       histogram_distance,
       {{0.0, 2.0}, {0.2, 1.7}, {0.4, 0.9}, {0.6, 0.0}, {0.75, -1.5}, {0.9, -3.5}, {1.0, -5.0}},
       0.5,
       false,
       true},
      {"mean_color",
       euclidean_distance,
       {{0.0, 1.8}, {0.05, 1.3}, {0.12, 0.0}, {0.25, -2.5}, {0.5, -6.0}},
       0.25,
       false,
       true},
      {"extents",
       extent_distance,
       {{0.0, 2.2}, {0.08, 1.4}, {0.15, 0.2}, {0.25, -2.0}, {0.4, -4.0}, {0.55, -5.0}, {1.0, -6.0}},
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
  if (distance <= table.front().distance) return table.front().log_ratio;
  for (size_t i = 1; i < table.size(); ++i) {
    if (distance > table[i].distance) continue;
    const double t = (distance - table[i - 1].distance) / (table[i].distance - table[i - 1].distance);
    return table[i - 1].log_ratio + t * (table[i].log_ratio - table[i - 1].log_ratio);
  }
  return table.back().log_ratio;
}

namespace {

/// Whether a look is nearly without colour. Most things in kitchens are white or grey: that two are alike in
/// this says little.
bool is_colorless(const std::vector<Descriptor>& look) {
  for (const Descriptor& d : look) {
    if (d.kind != "mean_color" || d.values.empty()) continue;
    const auto [least, most] = std::minmax_element(d.values.begin(), d.values.end());
    return *most - *least < 0.25F * std::max(*most, 0.2F);
  }
  return false;
}

/// The values of both over the same names, in their order; what one does not name has none of it.
void align(const Descriptor& a, const Descriptor& b, std::vector<float>& x, std::vector<float>& y) {
  struct Entry {
    const std::string* name;
    float of_a, of_b;
  };
  thread_local std::vector<Entry> entries;
  entries.clear();
  for (size_t i = 0; i < a.values.size(); ++i) entries.push_back({&a.names[i], a.values[i], 0});
  for (size_t i = 0; i < b.values.size(); ++i) entries.push_back({&b.names[i], 0, b.values[i]});
  std::sort(entries.begin(), entries.end(),
            [](const Entry& one, const Entry& other) { return *one.name < *other.name; });
  x.clear();
  y.clear();
  for (size_t i = 0; i < entries.size(); ++i) {
    if (i > 0 && *entries[i].name == *entries[i - 1].name) {
      x.back() += entries[i].of_a;
      y.back() += entries[i].of_b;
    } else {
      x.push_back(entries[i].of_a);
      y.push_back(entries[i].of_b);
    }
  }
}

bool comparable(const Descriptor& a, const Descriptor& b) {
  return a.names.empty() == b.names.empty() && (!a.names.empty() || a.values.size() == b.values.size());
}

double distance_of(const Comparison& comparison, const Descriptor& a, const Descriptor& b) {
  if (a.names.empty()) return comparison.distance(a.values, b.values);
  thread_local std::vector<float> x, y;
  align(a, b, x, y);
  return comparison.distance(x, y);
}

}  // namespace

Likeness compare(const std::vector<Descriptor>& a, const std::vector<Descriptor>& b, bool partial,
                 double weight) {
  Likeness likeness;
  likeness.parts.reserve(a.size());
  double log_closeness = 0;
  const bool colorless = is_colorless(a) && is_colorless(b);
  for (const Comparison& comparison : comparisons()) {
    const auto of_kind = [&](const Descriptor& d) { return d.kind == comparison.kind; };
    const auto in_a = std::find_if(a.begin(), a.end(), of_kind);
    const auto in_b = std::find_if(b.begin(), b.end(), of_kind);
    if (in_a == a.end() || in_b == b.end() || !comparable(*in_a, *in_b)) continue;
    if (partial && comparison.whole_only) continue;
    const double distance = distance_of(comparison, *in_a, *in_b);
    if (!std::isfinite(distance)) continue;
    double ratio = log_ratio(comparison, distance);
    if (colorless && comparison.of_color && ratio > 0) ratio *= 0.5;
    likeness.parts.push_back({comparison.kind, distance, ratio});
    likeness.log_ratio += weight * likeness.parts.back().log_ratio;
    // The log of gaussian_closeness(), which ends at 1e-12.
    const double relative = distance / comparison.sigma;
    log_closeness += std::max(std::log(1e-12), -relative * relative);
  }
  if (!likeness.parts.empty()) likeness.closeness = std::exp(log_closeness / double(likeness.parts.size()));
  return likeness;
}

}  // namespace loci::belief
