#include "memory/recorder/scene_reasoning.h"

#include "memory/belief/archive.h"

namespace loci::memory {
namespace {

constexpr uint8_t kVersion = 3;  ///< 1 had no matrices, 2 no log ratios

}  // namespace

void save_reasoning(SceneTransaction& transaction, Id scene, const belief::Scene& evidence,
                    const belief::Decisions& decisions, const belief::SceneMatrices& matrices) {
  belief::ArchiveWriter writer;
  writer(kVersion, evidence.time, evidence.seconds_to_next, evidence.view.has_camera, evidence.view.observed,
         evidence.view.near_m, evidence.view.far_m, evidence.observations, evidence.places, decisions,
         matrices, decisions.log_ratios());
  transaction.set_reasoning(scene, writer.take());
}

std::optional<SceneReasoning> load_reasoning(const Store& store, Id scene) {
  const std::optional<std::string> bytes = store.reasoning(scene);
  if (!bytes) return std::nullopt;
  SceneReasoning reasoning;
  belief::Scene& evidence = reasoning.evidence;
  uint8_t version = 0;
  belief::ArchiveReader reader(*bytes);
  reader(version);
  if (version == 0 || version > kVersion)
    throw Error("this reasoning was written by another version of loci", {store.path().string(), 0, {}});
  reader(evidence.time, evidence.seconds_to_next, evidence.view.has_camera, evidence.view.observed,
         evidence.view.near_m, evidence.view.far_m, evidence.observations, evidence.places,
         reasoning.decisions);
  if (version >= 2) reader(reasoning.matrices);
  std::vector<float> log_ratios;
  if (version >= 3) reader(log_ratios);
  reasoning.decisions.set_log_ratios(log_ratios);
  return reasoning;
}

}  // namespace loci::memory
