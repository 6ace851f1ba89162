// How likely each believed object and each observation are the same, pair by pair.

#include <algorithm>
#include <cmath>
#include <limits>

#include "memory/belief/appearance.h"
#include "memory/belief/evidence.h"
#include "memory/belief/proximity.h"
#include "memory/belief/trackers.h"

namespace loci::memory::belief {
namespace {

constexpr double kMaxEvidence = 30;
/// What is out of view by this much is not about the place that is looked at.
constexpr double kOutOfView = 0.99;

Eigen::Index index(size_t i) {
  return static_cast<Eigen::Index>(i);
}

/// The looks of an object, ready to be compared with what is seen.
class Bag {
 public:
  explicit Bag(const ProtoObject& object) {
    for (const Look& look : object.looks) {
      const double weight = 1 + std::log(look.weight);
      looks_.push_back({Appearance(look.descriptors), look.partial, weight, std::log(weight)});
    }
  }

  /// Likeness to the mixture of the looks, weighted by how often each was seen; the parts are those of the
  /// look that is most alike.
  Contrast compare(const Appearance& seen, bool partial, const Corrections& corrections,
                   const BeliefOptions& options) {
    Contrast best;
    ratios_.clear();
    double weights = 0, largest = -std::numeric_limits<double>::infinity();
    for (const Entry& look : looks_) {
      const Contrast one =
          contrast(look.appearance, seen, look.partial || partial, options.appearance_weight, corrections);
      if (one.count == 0) continue;
      ratios_.push_back(one.log_ratio + look.log_weight);
      weights += look.weight;
      largest = std::max(largest, ratios_.back());
      if (best.count == 0 || one.log_ratio > best.log_ratio) best = one;
    }
    if (ratios_.empty()) return best;
    double sum = 0;
    for (const double ratio : ratios_) sum += std::exp(ratio - largest);
    best.log_ratio = largest + std::log(sum / weights);
    return best;
  }

 private:
  struct Entry {
    Appearance appearance;
    bool partial;
    double weight, log_weight;
  };
  std::vector<Entry> looks_;
  std::vector<double> ratios_;
};

/// What is compared about an observation, without what it looks like.
Observation shape_of(const Observation& observation) {
  Observation shape;
  shape.box = observation.box;
  shape.sized = observation.sized;
  shape.sigma_m = observation.sigma_m;
  shape.range = observation.range;
  shape.partial = observation.partial;
  return shape;
}

/// Fills the evidence of a scene, pair by pair.
class PairComparer {
 public:
  PairComparer(const BeliefState& state, const std::vector<Expectation>& expected, const Scene& scene,
               const BeliefOptions& options)
      : state_(state),
        expected_(expected),
        scene_(scene),
        options_(options),
        snapshot_(is_snapshot(state, scene, options)),
        corrections_(state.calibration.corrections()) {
    for (const Observation& observation : scene.observations) {
      appearances_.emplace_back(observation.descriptors);
      shapes_.push_back(shape_of(observation));
    }
    const Eigen::Index rows = index(state.objects.size()), columns = index(shapes_.size());
    evidence_.log_similar.setConstant(rows, columns, -kMaxEvidence);
    evidence_.log_proximity.setConstant(rows, columns, -kMaxEvidence);
    evidence_.log_size.setZero(rows, columns);
    evidence_.offset.setZero(rows, columns);
    evidence_.colorless.setConstant(rows, columns, false);
    evidence_.closeness.setConstant(rows, columns, std::numeric_limits<double>::quiet_NaN());
    for (const Comparison& comparison : comparisons())
      evidence_.distances.push_back({comparison.kind, evidence_.closeness, evidence_.log_size});
    for (Eigen::Index o = 0; o < rows; ++o)
      for (Eigen::Index k = 0; k < columns; ++k)
        evidence_.offset(o, k) = (shapes_[size_t(k)].box.centre - expected[size_t(o)].box.centre).norm();
  }

  /// First what is about the place that is looked at; what is settled by that is not compared with the rest.
  PairEvidence run() {
    std::vector<Eigen::Index> here, elsewhere, all, open;
    for (Eigen::Index o = 0; o < evidence_.offset.rows(); ++o) (is_about(o) ? here : elsewhere).push_back(o);
    for (Eigen::Index k = 0; k < evidence_.offset.cols(); ++k) all.push_back(k);
    for (const Eigen::Index o : here) compare(o, all);
    ask_trackers(here);
    for (const Eigen::Index k : all)
      if (!evidence_.settled[size_t(k)]) open.push_back(k);
    if (!open.empty())
      for (const Eigen::Index o : elsewhere) compare(o, open);
    std::erase_if(evidence_.distances,
                  [](const PairEvidence::Distances& d) { return d.distance.array().isNaN().all(); });
    return std::move(evidence_);
  }

 private:
  bool is_about(Eigen::Index o) const {
    return expected_[size_t(o)].seen.visibility.out_of_view < kOutOfView ||
           (evidence_.offset.row(o).array() <= kTrackersReach).any();
  }

  void compare(Eigen::Index o, const std::vector<Eigen::Index>& columns) {
    Bag bag(state_.objects[size_t(o)]);
    for (const Eigen::Index k : columns) compare(o, k, bag);
  }

  void compare(Eigen::Index o, Eigen::Index k, Bag& bag) {
    const ProtoObject& object = state_.objects[size_t(o)];
    const Expectation& e = expected_[size_t(o)];
    Observation observation = shapes_[size_t(k)];
    // Missing evidence is missing: where one size is unknown, they agree.
    AxisBox believed = e.box;
    if (!object.sized) believed.size = observation.box.size;
    if (!observation.sized) observation.box.size = believed.size;
    if (!snapshot_ && is_piece(e, observation.box)) observation.partial = true;
    const Contrast alike = bag.compare(appearances_[size_t(k)], observation.partial, corrections_, options_);
    evidence_.colorless(o, k) = alike.colorless;
    evidence_.log_similar(o, k) = std::clamp(alike.log_ratio, -kMaxEvidence, kMaxEvidence);
    if (alike.count > 0) evidence_.closeness(o, k) = std::exp(alike.log_closeness);
    for (size_t i = 0; i < kComparisons; ++i) {
      evidence_.distances[i].distance(o, k) = alike.parts[i].distance;
      evidence_.distances[i].log_ratio(o, k) = alike.parts[i].log_ratio;
      if (comparisons()[i].whole_only) evidence_.log_size(o, k) += alike.parts[i].log_ratio;
    }
    const double variance = e.variance + observation_variance(observation, options_);
    const double extent_variance = variance + e.view_variance * (1 / view_noise(state_) - 1);
    evidence_.log_proximity(o, k) =
        std::clamp(log_proximity(believed, variance, extent_variance, object.partial, observation, options_),
                   -kMaxEvidence, kMaxEvidence);
  }

  /// Table of a kind between observations and some objects, infinite where they cannot be compared.
  std::vector<double> distances(std::string_view kind, const std::vector<Eigen::Index>& rows) const {
    const auto& table =
        std::ranges::find(evidence_.distances, kind, &PairEvidence::Distances::kind)->distance;
    std::vector<double> values;
    for (Eigen::Index k = 0; k < table.cols(); ++k)
      for (const Eigen::Index o : rows)
        values.push_back(std::isnan(table(o, k)) ? std::numeric_limits<double>::infinity() : table(o, k));
    return values;
  }

  void ask_trackers(const std::vector<Eigen::Index>& rows) {
    TrackerDistances seen{scene_.observations.size(), {}, {}};
    for (const Eigen::Index o : rows) seen.keys.push_back(state_.objects[size_t(o)].key);
    for (Eigen::Index k = 0; k < evidence_.offset.cols(); ++k)
      for (const Eigen::Index o : rows) seen.of[0].push_back(evidence_.offset(o, k));
    seen.of[1] = distances("extents", rows);
    seen.of[2] = distances("color_histogram", rows);
    if (std::ranges::none_of(seen.of[2], [](double distance) { return std::isfinite(distance); }))
      seen.of[2] = distances("mean_color", rows);
    evidence_.votes = votes(seen);
    for (const TrackerVotes& vote : evidence_.votes) {
      std::optional<size_t>& settled = evidence_.settled.emplace_back();
      if (!options_.settle || !vote.settled) continue;
      const auto found = std::ranges::find(state_.objects, *vote.settled, &ProtoObject::key);
      // Whether something exists at all, or has left, is the model's to say.
      if (found->status == Status::present) settled = static_cast<size_t>(found - state_.objects.begin());
    }
  }

  const BeliefState& state_;
  const std::vector<Expectation>& expected_;
  const Scene& scene_;
  const BeliefOptions& options_;
  const bool snapshot_;
  const Corrections corrections_;
  std::vector<Appearance> appearances_;
  std::vector<Observation> shapes_;
  PairEvidence evidence_;
};

}  // namespace

PairEvidence pair_evidence(const BeliefState& state, const std::vector<Expectation>& expected,
                           const Scene& scene, const BeliefOptions& options) {
  return PairComparer(state, expected, scene, options).run();
}

}  // namespace loci::memory::belief
