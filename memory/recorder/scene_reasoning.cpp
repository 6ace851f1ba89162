#include "memory/recorder/scene_reasoning.h"

#include "mapping/base/hash.h"
#include "memory/belief/archive.h"

namespace loci {
namespace {

constexpr const char* kMedia = "application/x-loci-reasoning";
constexpr uint8_t kVersion = 1;

}  // namespace

void save_reasoning(SceneTransaction& transaction, Id scene, const belief::Scene& evidence,
                    const belief::Decisions& decisions) {
  belief::ArchiveWriter writer;
  writer(kVersion, evidence.time, evidence.seconds_to_next, evidence.view.has_camera, evidence.view.observed,
         evidence.view.near_m, evidence.view.far_m, evidence.observations, evidence.places, decisions);
  const std::string bytes = writer.take();
  transaction.add_blob(bytes, kMedia);
  AnnotationRow row;
  row.scene = scene;
  row.type = kReasoningType;
  row.value = content_hash(bytes);
  transaction.add_annotation(row);
}

std::optional<SceneReasoning> load_reasoning(const Store& store, Id scene) {
  for (const AnnotationRow& row : store.annotations(scene)) {
    if (row.type != kReasoningType) continue;
    const std::optional<Id> blob = store.find_blob(row.value);
    if (!blob)
      throw Error("the reasoning of scene " + std::to_string(scene) + " is missing",
                  {store.path().string(), 0, {}});
    const std::string bytes = store.blob(*blob).bytes;
    SceneReasoning reasoning;
    belief::Scene& evidence = reasoning.evidence;
    uint8_t version = 0;
    belief::ArchiveReader reader(bytes);
    reader(version);
    if (version != kVersion)
      throw Error("this reasoning was written by another version of loci", {store.path().string(), 0, {}});
    reader(evidence.time, evidence.seconds_to_next, evidence.view.has_camera, evidence.view.observed,
           evidence.view.near_m, evidence.view.far_m, evidence.observations, evidence.places,
           reasoning.decisions);
    return reasoning;
  }
  return std::nullopt;
}

}  // namespace loci
