#include "memory/belief/belief.h"

#include "memory/belief/association/scene_update.h"

namespace loci::memory::belief {

BeliefUpdate advance(BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  if (state.last_scene && scene.time < *state.last_scene)
    throw Error(
        "a scene at " + format_time(scene.time) + " comes after one at " + format_time(*state.last_scene), {},
        "perceive recordings in the order of time");
  return SceneUpdate(state, scene, options).run();
}

}  // namespace loci::memory::belief
