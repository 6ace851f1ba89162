#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "memory/belief/evidence/noise_scale.h"
#include "memory/belief/parameters.h"
#include "memory/belief/scene.h"

namespace loci::memory::belief {

/// Similarity in [0,1] of a distance: exp(-(x/sigma)²). This form reproduces the dissertation's table 6.2;
/// equation 6.1 as printed has twice the sigma.
double gaussian_similarity(double distance, double sigma = 0.25);

/// How two descriptors of one kind are compared: a distance in about [0,1], and its evidence. The table maps
/// a distance to the log-likelihood ratio "same object" against "unrelated objects", linear between its
/// points and constant outside.
struct Comparison {
  std::string kind;
  double (*distance)(const std::vector<float>&, const std::vector<float>&) = nullptr;
  struct Point {
    double distance;
    double log_ratio;
  };
  std::vector<Point> table;
  double sigma = 0.25;   ///< of gaussian_similarity()
  bool of_size = false;  ///< not of surfaces
  bool of_color = false;
  /// Index of an earlier comparison that contains this one's evidence: where both are possible, only that one
  /// counts.
  std::optional<size_t> summarised_by = {};
};

inline constexpr size_t kComparisons = 5;
inline constexpr size_t kMeanColor = 1;  ///< its evidence is a density with learned noise, not a table
/// All known comparisons, in the order in which they are reported.
const std::vector<Comparison>& comparisons();
/// nullptr for an unknown kind: such a descriptor is no evidence.
const Comparison* find_comparison(const std::string& kind);

double log_ratio(const Comparison& comparison, double distance);

/// Hellinger distance of two histograms (each is normalised first), in [0,1].
double histogram_distance(const std::vector<float>& a, const std::vector<float>& b);
/// Euclidean distance over the length of the unit cube's diagonal.
double euclidean_distance(const std::vector<float>& a, const std::vector<float>& b);
/// Root mean square of the log ratios of sorted positive extents: three, in metres, which three more values
/// may follow: 1 where the extent is seen, 0 where it is a lower bound, since the object hides its far side
/// itself. What such an extent lacks does not count as a difference.
double extent_distance(const std::vector<float>& a, const std::vector<float>& b);

/// Learned addition to a comparison's table: log-likelihood ratios at the middles of some distances.
struct Correction {
  static constexpr size_t kBins = 12;
  std::array<double, kBins> values{};

  double at(double distance) const;
};
/// Variance of a channel of the mean colour between two views of one object until a home teaches another: an
/// upper bound, since a low one would take noise for change.
inline constexpr double kColorVariance = 0.02;

/// What a home taught about the evidence of distances, and what follows from the views.
struct Corrections {
  /// By kind, in the order of comparisons(); the second is for two achromatic objects.
  std::array<std::array<Correction, 2>, kComparisons> of{};
  /// Of the factors on the noise of mean colours between two views of one object.
  NoiseScale::Levels color_noise = NoiseScale().main_weights(kParameters.calibration_spread);
  /// Share of partial views whose extents are those of anything: more is hidden than can be told, or part of
  /// what hides it was taken along. From one frame of a video to the next the same is missing.
  double misleading_partial = 0;
};

/// Log-likelihood ratio of the table. Achromatic objects are common: that two of them agree in colour counts
/// less.
double prior_log_ratio(const Comparison& comparison, double distance, bool achromatic);

/// Logarithm of an extent.
struct LogExtent {
  double value = 0;
  bool hidden = false;  ///< a lower bound
};
using LogExtents = std::vector<LogExtent>;

/// Descriptors of a view prepared for many comparisons. Refers to the descriptors, which must outlive it.
class Appearance {
 public:
  explicit Appearance(const std::vector<Descriptor>& descriptors);

  struct Feature {
    const std::vector<float>* values = nullptr;  ///< unset = no descriptor of this kind
    bool named = false;
    std::vector<std::pair<const std::string*, float>> by_name;  ///< in order of the names, each once
    LogExtents log_extents;                                     ///< where extents are compared
  };
  const std::array<Feature, kComparisons>& features() const { return features_; }
  bool achromatic() const { return achromatic_; }

 private:
  std::array<Feature, kComparisons> features_;
  bool achromatic_;
};

/// Result of comparing two views, in the order of comparisons().
struct ViewSimilarity {
  struct Part {
    double distance = std::numeric_limits<double>::quiet_NaN();  ///< NaN = not comparable
    double log_ratio = 0;
  };
  std::array<Part, kComparisons> parts;
  bool achromatic = false;         ///< both are
  size_t count = 0;                ///< of comparable parts
  double log_ratio = 0;            ///< combined evidence; 0 when nothing is comparable
  double mean_log_similarity = 0;  ///< over the parts

  /// The dissertation's similarity: geometric mean over the parts; unset when nothing is comparable.
  std::optional<double> similarity() const;
};

/// Which of two views are cut off: their extents are lower bounds.
struct PartialViews {
  bool first = false, second = false;
  bool any() const { return first || second; }
};

/// Compares two views. Annotations of one object are not independent: the sum of their log ratios is
/// multiplied by `weight` in (0,1].
ViewSimilarity compare(const Appearance& a, const Appearance& b, PartialViews partial, double weight,
                       const Corrections& corrections = {});
ViewSimilarity compare(const std::vector<Descriptor>& a, const std::vector<Descriptor>& b,
                       PartialViews partial, double weight);

}  // namespace loci::memory::belief
