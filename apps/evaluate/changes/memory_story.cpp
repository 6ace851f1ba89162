#include "apps/evaluate/changes/story.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::apps::changes {

Moments read_moments(const memory::Store& store, std::optional<memory::Id> recording) {
  Moments moments;
  for (const memory::SceneRow& scene : store.scenes()) {
    if (!scene.frame_index || (recording && scene.recording != recording)) continue;
    Moment& moment = moments[*scene.frame_index];
    moment.scene = scene.id;
    moment.camera = scene.camera;
    if (scene.map_from_camera) moment.map_from_camera = *scene.map_from_camera;
    const std::optional<memory::SceneReasoning> reasoning = load_reasoning(store, scene.id);
    for (const memory::ObservationRow& row : store.observations(scene.id)) {
      if (!row.position) continue;
      Sight sight{row.id, *row.position, row.roi, {}};
      if (reasoning) sight.evidence = reasoning->evidence.observations.at(static_cast<size_t>(row.number));
      moment.sights.push_back(std::move(sight));
    }
  }
  if (moments.empty()) throw Error("the memory has no frame of a recording", {store.path().string(), 0, {}});
  return moments;
}

Story memory_story(const memory::Store& store, const Moments& moments) {
  Story story;
  std::map<memory::Id, int64_t> frame_of_scene;
  std::set<memory::Id> put_elsewhere;  // observations whose object was found in another place than before
  for (const auto& [frame, moment] : moments) {
    frame_of_scene[moment.scene] = frame;
    const std::vector<memory::AssociationRow>& rows = story[frame].alternatives =
        store.associations(moment.scene);
    for (const memory::AssociationRow& row : rows) {
      if (!row.chosen || !row.observation || !row.object) continue;
      story[frame].object_of[*row.observation] = *row.object;
      double& probability = story[frame].probability[*row.observation];
      for (const memory::AssociationRow& other : rows)
        if (other.observation == row.observation && other.object == row.object)
          probability += other.probability;
      if (row.explanation == memory::Explanation::move) put_elsewhere.insert(*row.observation);
    }
  }
  for (const memory::EventRow& event : store.events()) {
    if (!event.object || !event.scene || !frame_of_scene.contains(*event.scene)) continue;
    std::set<std::string>& events = story[frame_of_scene.at(*event.scene)].events[*event.object];
    events.insert(to_text(event.kind));
    // What was missed in its place and turns up in another one was moved; that it was missed was told before.
    const bool elsewhere = event.observation && put_elsewhere.contains(*event.observation);
    if (event.kind == memory::EventKind::reappeared && elsewhere) events.insert("moved");
  }
  return story;
}

}  // namespace loci::apps::changes
