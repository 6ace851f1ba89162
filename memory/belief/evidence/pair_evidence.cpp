#include "memory/belief/evidence/pair_evidence.h"

#include <algorithm>
#include <cmath>

#include "memory/belief/evidence/proximity.h"
#include "memory/belief/evidence/texture.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

constexpr double kMaxEvidence = kParameters.max_log_evidence;

Eigen::Index index(size_t i) {
  return static_cast<Eigen::Index>(i);
}

/// The stored views of an object, prepared for comparison.
class ViewSet {
 public:
  explicit ViewSet(const ProtoObject& object) {
    for (const StoredView& view : object.views) {
      const double weight = 1 + std::log(view.weight);
      views_.push_back({Appearance(view.descriptors), view.partial, weight, std::log(weight)});
    }
  }

  /// Similarity to the mixture of the views, weighted by how often each was observed; the parts are those of
  /// the most similar view.
  ViewSimilarity compare(const Appearance& seen, bool partial, const Corrections& corrections,
                         const BeliefOptions& options) {
    ViewSimilarity best;
    ratios_.clear();
    double weights = 0, largest = -std::numeric_limits<double>::infinity();
    for (const Entry& view : views_) {
      const ViewSimilarity one = belief::compare(view.appearance, seen, {view.partial, partial},
                                                 options.appearance_weight, corrections);
      if (one.count == 0) continue;
      ratios_.push_back(one.log_ratio + view.log_weight);
      weights += view.weight;
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
  std::vector<Entry> views_;
  std::vector<double> ratios_;
};

/// An observation without its appearance.
Observation shape_of(const Observation& observation) {
  Observation shape;
  shape.box = observation.box;
  shape.has_size = observation.has_size;
  shape.sigma_m = observation.sigma_m;
  shape.range = observation.range;
  shape.partial = observation.partial;
  return shape;
}

/// Area over which unrelated objects are spread in this view, as their positions show it, in square metres.
double effective_area(const std::vector<Observation>& observations, double prior_area) {
  constexpr double kUniform = 12;  // area of a uniform distribution over the product of its deviations
  constexpr double kPrior = 1;     // observations that the stated area is worth
  const double n = double(observations.size());
  Eigen::Array2d sum(0, 0), squares(0, 0);
  for (const Observation& observation : observations) {
    sum += observation.box.centre.head<2>().array();
    squares += observation.box.centre.head<2>().array().square();
  }
  const Eigen::Array2d scatter = n > 0 ? (squares - sum.square() / n).max(0.0).eval() : squares;
  const Eigen::Array2d variance =
      (scatter + kPrior * prior_area / kUniform) / (std::max(0.0, n - 1) + kPrior);
  return std::min(prior_area, kUniform * std::sqrt(variance.prod()));
}

/// Fills the evidence of a scene, pair by pair.
class PairComparer {
 public:
  PairComparer(const BeliefState& state, const std::vector<Prediction>& predicted, const Scene& scene,
               const BeliefOptions& options)
      : state_(state),
        predicted_(predicted),
        scene_(scene),
        options_(options),
        position_options_(options),
        timing_(state, scene, options),
        corrections_(state.calibration.corrections()),
        noise_weights_(state.view_noise.weights(options.noise_spread)) {
    if (timing_.independent) corrections_.misleading_partial = kParameters.misleading_partial;
    // The area of a detector without depth is that of the places that it states.
    if (!scene.view.depth.empty())
      position_options_.area_m2 = effective_area(scene.observations, options.area_m2);
    for (const Observation& observation : scene.observations) {
      appearances_.emplace_back(observation.descriptors);
      shapes_.push_back(shape_of(observation));
    }
    const Eigen::Index rows = index(state.objects.size()), columns = index(shapes_.size());
    evidence_.log_similar.setConstant(rows, columns, -kMaxEvidence);
    evidence_.log_proximity.setConstant(rows, columns, -kMaxEvidence);
    evidence_.log_size.setZero(rows, columns);
    evidence_.log_class.setZero(rows, columns);
    evidence_.log_same_print.setZero(rows, columns);
    evidence_.offset.setZero(rows, columns);
    evidence_.achromatic.setConstant(rows, columns, false);
    evidence_.similarity.setConstant(rows, columns, std::numeric_limits<double>::quiet_NaN());
    texture_ = {"texture", evidence_.similarity, evidence_.log_size};
    for (const Comparison& comparison : comparisons())
      evidence_.distances.push_back({comparison.kind, evidence_.similarity, evidence_.log_size});
    for (Eigen::Index o = 0; o < rows; ++o)
      for (Eigen::Index k = 0; k < columns; ++k)
        evidence_.offset(o, k) = (shapes_[size_t(k)].box.centre - predicted[size_t(o)].box.centre).norm();
  }

  /// Objects at the observed places come first; observations that they settle are not compared with the rest.
  PairEvidence run() {
    std::vector<Eigen::Index> here, elsewhere, all, open;
    for (Eigen::Index o = 0; o < evidence_.offset.rows(); ++o) (is_near(o) ? here : elsewhere).push_back(o);
    for (Eigen::Index k = 0; k < evidence_.offset.cols(); ++k) all.push_back(k);
    for (const Eigen::Index o : here) compare(o, all);
    run_trackers(here);
    for (const Eigen::Index k : all)
      if (!evidence_.settled[size_t(k)]) open.push_back(k);
    if (!open.empty())
      for (const Eigen::Index o : elsewhere) compare(o, open);
    for (Eigen::Index o = 0; o < evidence_.offset.rows(); ++o) compare_textures(o, open);
    evidence_.distances.push_back(std::move(texture_));
    std::erase_if(evidence_.distances,
                  [](const PairEvidence::Distances& d) { return d.distance.array().isNaN().all(); });
    return std::move(evidence_);
  }

 private:
  bool is_near(Eigen::Index o) const {
    return predicted_[size_t(o)].seen.visibility.out_of_view < kParameters.out_of_view ||
           (evidence_.offset.row(o).array() <= kParameters.tracker_reach_m).any();
  }

  void compare(Eigen::Index o, const std::vector<Eigen::Index>& columns) {
    ViewSet views(state_.objects[size_t(o)]);
    for (const Eigen::Index k : columns) compare(o, k, views);
  }

  void compare(Eigen::Index o, Eigen::Index k, ViewSet& views) {
    const ProtoObject& object = state_.objects[size_t(o)];
    const Prediction& p = predicted_[size_t(o)];
    Observation observation = shapes_[size_t(k)];
    // An unknown size is no evidence: it is taken to be that of the other.
    AxisBox believed = p.box;
    if (!object.has_size) believed.size = observation.box.size;
    if (!observation.has_size) observation.box.size = believed.size;
    if (!timing_.snapshot && is_piece(p, observation.box)) observation.partial = true;
    const ViewSimilarity similar =
        views.compare(appearances_[size_t(k)], observation.partial, corrections_, options_);
    evidence_.achromatic(o, k) = similar.achromatic;
    evidence_.log_similar(o, k) = std::clamp(similar.log_ratio, -kMaxEvidence, kMaxEvidence);
    if (const auto similarity = similar.similarity()) evidence_.similarity(o, k) = *similarity;
    for (size_t i = 0; i < kComparisons; ++i) {
      evidence_.distances[i].distance(o, k) = similar.parts[i].distance;
      evidence_.distances[i].log_ratio(o, k) = similar.parts[i].log_ratio;
      if (comparisons()[i].of_size) evidence_.log_size(o, k) += similar.parts[i].log_ratio;
      if (comparisons()[i].kind == "class") evidence_.log_class(o, k) = similar.parts[i].log_ratio;
    }
    const PositionNoise noise = position_noise(object, p, observation, noise_weights_, options_);
    evidence_.log_proximity(o, k) = std::clamp(
        log_proximity(believed, noise, object.partial, observation, position_options_) + p.log_surface,
        -kMaxEvidence, kMaxEvidence);
  }

  /// Whether a snapshot shows the side of an object whose print is known, and the print is another one.
  bool shows_another_print(const ProtoObject& object, const Observation& observation) const {
    if (!timing_.snapshot) return false;
    const Vector3d towards = towards_camera(observation, scene_);
    for (const TextureView& view : object.textures)
      if (view.in_place && is_same_side(view.towards_camera, towards) &&
          is_another_print(match(texture_in_map(view, scene_.places), view.range, observation), view.texture,
                           observation.texture))
        return true;
    return false;
  }

  static TextureMatch match(const Texture& in_map, double range, const Observation& observation) {
    return match_textures(in_map, observation.texture, texture_tolerance(std::max(range, observation.range)));
  }

  /// Key points are compared last, and only where the rest leaves it open: they cost most.
  void compare_textures(Eigen::Index o, const std::vector<Eigen::Index>& columns) {
    std::vector<Texture> in_map;
    for (const TextureView& view : state_.objects[size_t(o)].textures)
      in_map.push_back(texture_in_map(view, scene_.places));
    for (const Eigen::Index k : columns)
      if (!scene_.observations[size_t(k)].texture.empty() &&
          evidence_.log_similar(o, k) >= -kMaxTextureLogRatio)
        compare_textures(o, k, in_map);
  }

  /// `in_map`: the object's textures.
  void compare_textures(Eigen::Index o, Eigen::Index k, const std::vector<Texture>& in_map) {
    const ProtoObject& object = state_.objects[size_t(o)];
    const Observation& observation = scene_.observations[size_t(k)];
    double& similar = evidence_.log_similar(o, k);
    const Vector3d towards = towards_camera(observation, scene_);
    std::optional<double> best;
    for (size_t i = 0; i < in_map.size(); ++i) {
      const TextureView& view = object.textures[i];
      const TextureMatch found = match(in_map[i], view.range, observation);
      const double ratio = texture_log_ratio(found, view.texture, observation.texture);
      if (found.agreeing >= kTellingKeypoints && view.in_place)
        evidence_.log_proximity(o, k) = log_offset(o, k, found.offset_m);
      const bool whole = !observation.partial && !object.partial;
      if (whole && view.in_place && is_same_side(view.towards_camera, towards) &&
          is_another_print(found, view.texture, observation.texture))
        evidence_.log_same_print(o, k) = kParameters.other_print;
      if (best && ratio <= *best) continue;
      best = ratio;
      texture_.distance(o, k) =
          1 - double(found.agreeing) / double(std::min(view.texture.size(), observation.texture.size()));
    }
    if (!best) return;
    texture_.log_ratio(o, k) = *best;
    // What shows the same print and differs otherwise may be a cluster that is of other objects, too.
    constexpr double kJoined = kParameters.joined_cluster;
    if (*best > 0) similar = std::log((1 - kJoined) * std::exp(similar) + kJoined);
    similar = std::clamp(similar + *best, -kMaxEvidence, kMaxEvidence);
  }

  /// Position evidence of a surface that was found this far from where it was. Unlike a box, it does not
  /// depend on what else of the object is visible.
  double log_offset(Eigen::Index o, Eigen::Index k, double offset_m) const {
    const Observation& observation = scene_.observations[size_t(k)];
    const PositionNoise noise = surface_noise(state_.objects[size_t(o)], scene_.view.map_from_camera,
                                              observation.range, noise_weights_, options_);
    return std::clamp(std::log(position_options_.area_m2) + noise.log_density(offset_m * offset_m, 0),
                      -kMaxEvidence, kMaxEvidence);
  }

  /// Distances of a kind between observations and some objects, infinite where not comparable.
  std::vector<double> distances(std::string_view kind, const std::vector<Eigen::Index>& rows) const {
    const auto& table =
        std::ranges::find(evidence_.distances, kind, &PairEvidence::Distances::kind)->distance;
    std::vector<double> values;
    for (Eigen::Index k = 0; k < table.cols(); ++k)
      for (const Eigen::Index o : rows)
        values.push_back(std::isnan(table(o, k)) ? std::numeric_limits<double>::infinity() : table(o, k));
    return values;
  }

  void run_trackers(const std::vector<Eigen::Index>& rows) {
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
      // Existence and absence are left to the model.
      const size_t k = evidence_.settled.size() - 1;
      if (found->status == Status::present && !shows_another_print(*found, scene_.observations[k]))
        settled = static_cast<size_t>(found - state_.objects.begin());
    }
  }

  const BeliefState& state_;
  const std::vector<Prediction>& predicted_;
  const Scene& scene_;
  const BeliefOptions& options_;
  BeliefOptions position_options_;  ///< with the area of this view
  const SceneTiming timing_;
  Corrections corrections_;
  const NoiseScale::Levels noise_weights_;
  std::vector<Appearance> appearances_;
  std::vector<Observation> shapes_;
  PairEvidence evidence_;
  PairEvidence::Distances texture_;  ///< by the share of the key points that do not agree
};

}  // namespace

PairEvidence pair_evidence(const BeliefState& state, const std::vector<Prediction>& predicted,
                           const Scene& scene, const BeliefOptions& options) {
  return PairComparer(state, predicted, scene, options).run();
}

}  // namespace loci::memory::belief
