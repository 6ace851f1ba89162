#include "memory/belief/state.h"

#include <algorithm>

namespace loci::memory::belief {

double ProtoObject::probability_itself() const {
  double rest = 1;
  for (const Alternative& alternative : alternatives) rest -= alternative.probability;
  return std::max(0.0, rest);
}

const ProtoObject* BeliefState::find(int64_t id) const {
  for (const ProtoObject& object : objects)
    if (object.id == id && id != 0) return &object;
  return nullptr;
}

InteractionKey interaction_key(const ProtoObject& object) {
  return {object.class_name, object.place, object.interaction, object.uses};
}

double interaction_probability(const ProtoObject& object, double exposure_s, const BeliefState& state,
                               const BeliefOptions& options) {
  return state.interaction.probability(interaction_key(object),
                                       object.exposure_s - object.last_seen_exposure_s,
                                       exposure_s - object.last_seen_exposure_s, options);
}

double probability_here(const ProtoObject& object, const BeliefState& state, const BeliefOptions& options) {
  return object.probability_here * (1 - interaction_probability(object, state.exposure_s, state, options));
}

double probability_on_place(const ProtoObject& object, const BeliefState& state,
                            const BeliefOptions& options) {
  const double left = 1 - state.interaction.moved_to(object.place, object.place);
  return object.probability_here *
         (1 - left * interaction_probability(object, state.exposure_s, state, options));
}

Surface surface_in_map(const ProtoObject& object, const std::vector<PlacePose>& places) {
  const Eigen::Isometry3f map_from_place = place_pose(object.place, places).cast<float>();
  Surface surface = object.surface;
  for (Eigen::Vector3f& point : surface) point = map_from_place * point;
  return surface;
}

Texture texture_in_map(const TextureView& view, const std::vector<PlacePose>& places) {
  const Eigen::Isometry3f map_from_place = place_pose(view.place, places).cast<float>();
  Texture texture = view.texture;
  for (SurfaceKeypoint& keypoint : texture) keypoint.position = map_from_place * keypoint.position;
  return texture;
}

AxisBox box_in_map(const ProtoObject& object, const std::vector<PlacePose>& places) {
  return {place_pose(object.place, places) * object.box.centre, object.box.size};
}

}  // namespace loci::memory::belief
