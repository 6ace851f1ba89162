#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/belief/observation.h"

namespace loci::memory::belief {

/// Closeness in [0,1] of a distance, falling like a Gaussian: exp(-(x/sigma)²) (the form that reproduces the
/// dissertation's table 6.2; equation 6.1 as printed has twice the sigma).
double gaussian_closeness(double distance, double sigma = 0.25);
/// Closeness in [0,1] that falls about linearly at first: 2/(1+e^x) (the sensible reading of equation 6.2).
double linear_closeness(double distance);

/// How two descriptors of one kind are compared: a distance in [0,1] or so, and what it tells. The table maps
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
  double sigma = 0.25;      ///< of gaussian_closeness(), for the dissertation's similarity
  bool whole_only = false;  ///< says nothing about views that are cut off (sizes)
  bool of_color = false;
};

/// The comparisons known to this version, in the order in which they are reported.
const std::vector<Comparison>& comparisons();
/// nullptr when the kind is not known: such a descriptor is no evidence.
const Comparison* find_comparison(const std::string& kind);

double log_ratio(const Comparison& comparison, double distance);

/// Hellinger distance of two histograms (each is normalised first), in [0,1].
double histogram_distance(const std::vector<float>& a, const std::vector<float>& b);
/// Euclidean distance over the length of the unit cube's diagonal.
double euclidean_distance(const std::vector<float>& a, const std::vector<float>& b);
/// Root mean square of the log ratios of sorted positive extents.
double extent_distance(const std::vector<float>& a, const std::vector<float>& b);
/// The same in two steps, for extents that are compared many times.
std::vector<double> log_extents(const std::vector<float>& extents);
double log_extent_distance(const std::vector<double>& a, const std::vector<double>& b);

/// What comparing two sets of descriptors gave.
struct Likeness {
  struct Part {
    std::string kind;
    double distance = 0;
    double log_ratio = 0;
  };
  std::vector<Part> parts;  ///< one per kind that both have
  double log_ratio = 0;     ///< combined evidence; 0 when nothing could be compared
  std::optional<double>
      closeness;  ///< the dissertation's similarity: geometric mean; unset = nothing compared
};

/// Compares two looks. Annotations of one object are not independent: the sum of their log ratios is
/// multiplied by `weight` in (0,1]. `partial`: one of the two is cut off.
Likeness compare(const std::vector<Descriptor>& a, const std::vector<Descriptor>& b, bool partial,
                 double weight);

}  // namespace loci::memory::belief
