#include "memory/edits/forget.h"

#include <algorithm>

#include "memory/recorder/checkpoint.h"
#include "memory/store/erasure/retention.h"

namespace loci::memory {
namespace {

/// Whether all scenes that remain can be reasoned about anew.
bool has_evidence(const Store& store) {
  return store.scenes_without_reasoning() == 0 && !unreadable_belief(store);
}

/// Whether later looks decided what the observations of a scene are of.
bool is_decided_by_hindsight(const Store& store, const SceneRow& scene) {
  return std::ranges::any_of(store.associations(scene.id), [](const AssociationRow& row) {
    return row.chosen && row.clock.source == kHindsight;
  });
}

void reason_after(Store& store, TimeNs period_end, Id run, Progress& progress) {
  const std::vector<SceneRow> scenes = store.scenes();
  const std::vector<ForgottenRow> forgotten = store.forgotten();
  const auto first = std::ranges::find_if(scenes, [&](const SceneRow& scene) {
    return !was_forgotten(forgotten, scene.time) &&
           (scene.time > period_end || is_decided_by_hindsight(store, scene));
  });
  SceneTransaction rows(store, run);
  rows.postpone_derived();
  revise(store, rows,
         {.from = first == scenes.end() ? 0 : first->id,
          .known = known_identities(store),
          .source = "forget",
          .replace_reasoning = true},
         progress);
  rows.commit();
  store.replace_forgotten(run);
}

}  // namespace

ForgetResult forget(const std::filesystem::path& memory, const ForgetRequest& request,
                    const std::filesystem::path& output, Progress& progress) {
  ForgetResult result;
  rewrite_memory(memory, output, [&](Store& store) {
    if (request.object && !store.belief(*request.object))
      throw Error("there is no " + object_name(*request.object), {memory.string(), 0, {}},
                  "loci-memory objects lists them");
    const Id run = store.begin_run("loci-memory forget", "{}");
    result = forget(store, request, run);
    if (request.to && result.scenes > 0 && has_evidence(store))
      reason_after(store, *request.to, run, progress);
    store.finish_run(run);
  });
  return result;
}

}  // namespace loci::memory
