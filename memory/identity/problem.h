#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"

namespace loci::memory {

/// Numbers of pairs: one row per old object, one column per new observation.
using PairTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Weight zero in the log domain.
inline constexpr double kNever = -std::numeric_limits<double>::infinity();

/// Evidence about pairs as the dissertation states it (section 6.2): similarity in [0,1], one row per old
/// object, one entry per new observation; unset = this pair was not compared.
struct IdentityProblem {
  size_t old_count = 0;
  size_t new_count = 0;
  std::vector<std::vector<std::optional<double>>> similar;
  std::vector<std::vector<std::optional<double>>> proximity;
  std::vector<double> out_of_view;  ///< per old object: probability that its place is not in view
};

/// Log prior odds of the explanations (unit formulas of the network). kNever switches one off.
struct ExplanationPriors {
  double stay = 0;
  double move = 0;
  double newview = 0;
  double appear = 0;
  double clutter = kNever;  ///< a false detection
  double disappear = 0;
  double missed = kNever;  ///< in view, still there, not detected
  double hidden = 0;

  bool operator==(const ExplanationPriors&) const = default;
};

struct IdentityOptions {
  double eps = 1e-6;             ///< similar and proximity are clamped to at most 1 - eps
  double floor = 0;              ///< and to at least this; 0 keeps impossible pairs impossible
  double prior_similar = 0.5;    ///< stands in for a missing similarity
  double prior_proximity = 0.5;  ///< stands in for a missing proximity
  double gate = 1e-9;            ///< how much total variation may be given up to split the problem
  int best = 5;                  ///< how many ranked matchings to list
  ExplanationPriors priors;

  void declare(OptionTable& table);
};

/// The same problem from calibrated evidence: log-likelihood ratios (same object against unrelated), not
/// clamped except where doubles end. Priors may differ per pair, per object and per observation: those given
/// are added to the common ones of the options.
struct LogOddsProblem {
  PairTable log_similar;            ///< kNever = impossible
  PairTable log_proximity;          ///< same shape
  std::vector<double> out_of_view;  ///< per row, in [0,1]

  // Optional additions; empty = none.
  PairTable stay_prior, move_prior, newview_prior;
  std::vector<double> appear_prior, clutter_prior;                  ///< per column
  std::vector<double> disappear_prior, missed_prior, hidden_prior;  ///< per row
};

/// What inference works on: log weights of each explanation, with everything folded in. A matching's weight
/// is the product of its pairs' weights (summed over stay, move, newview) and of the weights of what stays
/// unmatched.
struct IdentityWeights {
  PairTable stay, move, newview;
  PairTable total;                                ///< log of the sum of the three
  std::vector<double> appear, clutter;            ///< per column
  std::vector<double> disappear, missed, hidden;  ///< per row; the view flag is folded in
  std::vector<double> out_of_view;                ///< per row, for the posterior of the flag
  double log_reference = 0;                       ///< sum of log((1 - s)(1 - p)) over the pairs

  size_t old_count() const { return disappear.size(); }
  size_t new_count() const { return appear.size(); }
};

/// Checks shapes (invalid_shape) and values (invalid_value) and folds everything in. Error names the entry,
/// e.g. "similar[0][1]"; `file` is for its message.
IdentityWeights weights_of(const IdentityProblem& problem, const IdentityOptions& options,
                           const std::string& file = {});
IdentityWeights weights_of(const LogOddsProblem& problem, const IdentityOptions& options);

/// log(e^a + e^b), also for kNever.
double log_add(double a, double b);

}  // namespace loci::memory
