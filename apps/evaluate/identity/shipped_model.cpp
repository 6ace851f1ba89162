#include <algorithm>

#include "apps/evaluate/identity/models.h"
#include "memory/belief/belief.h"

namespace loci::apps::identity_experiment {
namespace {

using namespace memory::belief;

constexpr double kCameraHeight = 10;      ///< of the sensor above the tables, metres
constexpr double kTableDistance = 10;     ///< between the tables' corners
constexpr double kPixelsPerMetre = 1000;  ///< at the tables
constexpr TimeNs kStep = 600 * kSecond;   ///< between two scenes

std::string place_of(int table) {
  return "table_" + std::to_string(table);
}

/// A detector without depth above one table. The strip is the image; across it the image exceeds the table,
/// since noise does not hide anything there.
SceneView scene_view(const View& view) {
  SceneView result;
  result.map_from_camera.linear() = Vector3d(1, -1, -1).asDiagonal();
  result.map_from_camera.translation() =
      Vector3d(kTableDistance * view.table + view.centre, 0.5, kCameraHeight);
  const int width = static_cast<int>(std::lround(2 * view.half * kPixelsPerMetre)),
            height = 2 * int(kPixelsPerMetre);
  result.camera = {width,
                   height,
                   kCameraHeight * kPixelsPerMetre,
                   kCameraHeight * kPixelsPerMetre,
                   (width - 1) / 2.0,
                   (height - 1) / 2.0};
  result.observed = {{place_of(view.table), 1}};
  result.near_m = kCameraHeight / 2;
  result.far_m = 2 * kCameraHeight;
  return result;
}

Observation observation_of(const Measurement& seen) {
  Observation observation;
  observation.box.centre = Vector3d(kTableDistance * seen.table + seen.position.x(), seen.position.y(), 0);
  observation.has_size = false;
  observation.range = 1;
  observation.place = place_of(seen.table);
  observation.descriptors.push_back(
      {"mean_color", {float(seen.color[0]), float(seen.color[1]), float(seen.color[2])}});
  return observation;
}

/// How exact the detector is, is not known: the belief starts from an upper bound and learns.
BeliefOptions options_of_detections() {
  BeliefOptions options;
  options.noise_m = 0.1;
  options.pose_noise_m = 0;
  options.noise_spread = 1;
  return options;
}

/// The belief that `loci-perceive run` and `loci-memory ingest` use, with options_of_detections(). What it
/// has learned about habits, noise and similarity goes on from one world to the next.
class ShippedModel : public Model {
 public:
  bool own_belief_only() const override { return true; }

  void begin(const Sequence&) override {
    state_.objects.clear();
    state_.last_scene.reset();
    state_.places.clear();
    keys_.clear();
  }

  Judgement judge(const View& view, int step, const std::vector<Entry>&,
                  const std::vector<Measurement>& seen) override {
    Scene scene;
    scene.time = step * kStep;
    scene.seconds_to_next = in_seconds(kStep);
    scene.view = scene_view(view);
    for (const Measurement& measurement : seen) scene.observations.push_back(observation_of(measurement));
    const BeliefUpdate update = advance(state_, scene, options_);

    Judgement judgement;
    std::vector<int64_t> next;
    for (size_t o = 0; o < keys_.size(); ++o) {
      judgement.old.push_back(object_decision(update, keys_[o]));
      const bool linked = std::ranges::any_of(
          update.observations, [&](const ObservationOutcome& outcome) { return outcome.key == keys_[o]; });
      const auto object = std::ranges::find(state_.objects, keys_[o], &ProtoObject::key);
      judgement.kept.push_back(!linked && object != state_.objects.end() && object->status != Status::gone);
      if (judgement.kept.back()) next.push_back(keys_[o]);
    }
    for (size_t k = 0; k < seen.size(); ++k) {
      const ObservationOutcome& outcome = update.observations[k];
      judgement.seen.push_back(observation_decision(outcome));
      if (const std::optional<size_t> o = index_of(outcome.key)) judgement.links.push_back({*o, k});
      next.push_back(outcome.key);
    }
    keys_ = std::move(next);
    return judgement;
  }

 private:
  std::optional<size_t> index_of(int64_t key) const {
    const auto found = std::ranges::find(keys_, key);
    return found == keys_.end() || key == 0 ? std::nullopt
                                            : std::optional(static_cast<size_t>(found - keys_.begin()));
  }

  /// The most probable partner and, judged on its own, the most probable explanation. Partners that the
  /// experiment no longer lists have been gone: to it, what they are now is new.
  memory::IdentityDecision observation_decision(const ObservationOutcome& outcome) const {
    double appear = outcome.appear + outcome.clutter, stay = 0, move = 0, newview = 0, best = 0;
    std::optional<size_t> partner;
    for (const PartnerProbability& each : outcome.partners) {
      const std::optional<size_t> o = index_of(each.key);
      if (!o) {
        appear += each.probability();
        continue;
      }
      stay += each.stay;
      move += each.move;
      newview += each.newview;
      if (each.probability() > best) {
        best = each.probability();
        partner = o;
      }
    }
    memory::IdentityDecision decision{partner, best, memory::Explanation::stay, stay};
    if (appear >= best) decision = {std::nullopt, appear, memory::Explanation::stay, stay};
    for (const auto& [explanation, probability] : {std::pair(memory::Explanation::move, move),
                                                   {memory::Explanation::newview, newview},
                                                   {memory::Explanation::appear, appear}})
      if (probability > decision.explanation_probability) {
        decision.explanation = explanation;
        decision.explanation_probability = probability;
      }
    return decision;
  }

  static memory::IdentityDecision object_decision(const BeliefUpdate& update, int64_t key) {
    memory::IdentityDecision decision{std::nullopt, 1, memory::Explanation::hidden, 1};
    const auto found = std::ranges::find(update.objects, key, &ObjectOutcome::key);
    if (key == 0 || found == update.objects.end()) return decision;
    const double none = found->disappear + found->missed + found->hidden;
    decision = {std::nullopt, none, memory::Explanation::hidden, found->hidden + found->missed};
    double stay = 0, move = 0, newview = 0, best = none;
    for (size_t k = 0; k < update.observations.size(); ++k)
      for (const PartnerProbability& each : update.observations[k].partners) {
        if (each.key != key) continue;
        stay += each.stay;
        move += each.move;
        newview += each.newview;
        if (each.probability() <= best) continue;
        best = each.probability();
        decision.partner = k;
        decision.partner_probability = best;
      }
    for (const auto& [explanation, probability] :
         {std::pair(memory::Explanation::disappear, found->disappear),
          {memory::Explanation::stay, stay},
          {memory::Explanation::move, move},
          {memory::Explanation::newview, newview}})
      if (probability > decision.explanation_probability) {
        decision.explanation = explanation;
        decision.explanation_probability = probability;
      }
    return decision;
  }

  BeliefOptions options_ = options_of_detections();
  BeliefState state_;
  std::vector<int64_t> keys_;  ///< of the entries, in the experiment's order; 0 = taken for clutter
};

}  // namespace

std::unique_ptr<Model> make_shipped_model() {
  return std::make_unique<ShippedModel>();
}

}  // namespace loci::apps::identity_experiment
