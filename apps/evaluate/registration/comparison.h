#pragma once

#include <string>
#include <vector>

#include "apps/evaluate/registration/pairs.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/registration/registration.h"

namespace loci::apps::registration_evaluation {

/// How far starts are off in a comparison.
struct Disturbance {
  std::string name;
  double shift_m = 0, turn_deg = 0;
};

/// One method over one set of pairs with one disturbance.
struct MethodRow {
  std::string set, disturbance, method;
  size_t pairs = 0, right = 0, claimed = 0, false_claims = 0;
  std::vector<std::string> names;  ///< of the pairs, as the errors
  std::vector<double> errors_m, errors_deg, seconds;

  double median_m() const;
  double median_deg() const;
  double mean_seconds() const;
};

/// Ours (plane, point, generalised) and the peers on the same thinned clouds from the same starts, one
/// thread.
std::vector<MethodRow> compare_methods(const PairSet& set, const std::vector<Disturbance>& disturbances,
                                       double voxel_m, bool with_peers, const Random& random,
                                       Progress& progress);

/// What the verdict of one pair was worth.
struct VerdictRow {
  std::string name;
  bool same_place = true, trusted = false, right = false;
  double overlap = 0, error_m = 0, error_deg = 0;
  mapping::PairAlignment alignment;

  /// Trusted although it is wrong.
  bool false_trust() const { return trusted && !right; }
  /// Refused although half of the surface is in both scans.
  bool missed() const { return !trusted && same_place && overlap >= 0.5; }
};

/// Whole scans, from starts that are off by up to `shift_m` and `turn_deg`.
std::vector<VerdictRow> test_verdicts(const PairSet& set, double shift_m, double turn_deg,
                                      const mapping::RegistrationOptions& options, const Random& random,
                                      Progress& progress);

/// Pose errors of a tour after the pose graph against the truth, first scan at its true pose.
struct TourRow {
  std::string world;
  size_t scans = 0, connected = 0;
  double max_m = 0, max_deg = 0, mean_m = 0, mean_deg = 0, seconds = 0;
};
TourRow test_tour(const std::string& world, const std::vector<mapping::Scan>& scans, double shift_m,
                  double turn_deg, const mapping::RegistrationOptions& options, const Random& random,
                  Progress& progress);

/// Rows of the same method put together, in the order in which methods appear.
std::vector<MethodRow> over_all_pairs(const std::vector<MethodRow>& rows);

struct Evaluation {
  std::vector<MethodRow> methods;
  std::vector<VerdictRow> verdicts;
  std::vector<TourRow> tours;

  std::string text(bool verbose) const;
  Json to_json() const;
};

}  // namespace loci::apps::registration_evaluation
