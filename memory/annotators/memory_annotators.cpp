#include "memory/annotators/memory_annotators.h"

#include "mapping/base/json.h"
#include "memory/annotators/belief_annotations.h"
#include "memory/annotators/kept_of_cas.h"
#include "memory/annotators/memory_session.h"
#include "memory/annotators/remembered.h"
#include "memory/annotators/scene_of_cas.h"
#include "perception/types/geometry.h"

namespace loci::memory {
namespace {

MemorySession& session_of(const perception::Context& context, const std::string& who) {
  return context.resources.get<MemorySession>("memory for " + who, "name one with -m FILE.loci");
}

/// The scene as the memory takes it, with the numbers of this run.
SceneRecord record_of(const perception::types::SceneCas& scene, const perception::Context& context,
                      MemorySession& session) {
  SceneRecord record = scene_record(scene, context.resources.find<mapping::World>());
  record.row.recording = session.recording();
  record.row.map = session.map();
  record.seconds_to_next = session.seconds_after(record.row.time);
  record.annotations.push_back({kKnownPlanesType, session.planes().to_json().dump(), std::nullopt, {}});
  return record;
}

bool has_pose(const perception::types::SceneCas& scene) {
  return scene.scene().map_from_camera.is_set();
}

}  // namespace

perception::AnnotatorDescriptor PlaceNaming::descriptor() const {
  return {"PlaceNaming",
          "Gives supporting planes found without a map names that stay: plane_1, plane_2, …",
          {"PlanarSupport"},
          {},
          {},
          {"PlanarSupport"}};
}

void PlaceNaming::process(perception::cas::Cas& cas, perception::Context& context) {
  MemorySession* session = context.resources.find<MemorySession>();
  KnownPlanes& planes = session != nullptr ? session->planes() : own_;
  for (const perception::types::PlanarSupport& support : perception::types::SceneCas(cas).supports()) {
    if (!support.name.get().empty()) continue;
    support.name.set(planes.name(perception::types::points_from_values(support.outline.get())));
    support.support_class.set("plane");
  }
}

perception::AnnotatorDescriptor IdentityResolution::descriptor() const {
  return {"IdentityResolution",
          "Decides which cluster is which known object, what moved, appeared, is hidden or has gone.",
          {"Scene", "Cluster"},
          {"TrackingAnnotation", "SimilarityMatrix", "DistanceMatrix", "BeliefStateInstance"},
          {"*"}};
}

void IdentityResolution::start(perception::Context& context) {
  session_of(context, "IdentityResolution").recorder().set_options(options_);
}

void IdentityResolution::process(perception::cas::Cas& cas, perception::Context& context) {
  const perception::types::SceneCas scene(cas);
  if (!has_pose(scene)) return;
  MemorySession& session = session_of(context, "IdentityResolution");
  SceneRecord record = record_of(scene, context, session);
  ResolvedScene resolved = session.recorder().resolve(record);
  annotate_belief(scene, resolved);
  session.pending = MemorySession::Pending{&cas, std::move(record), std::move(resolved)};
}

perception::AnnotatorDescriptor MemoryWriter::descriptor() const {
  return {"MemoryWriter",
          "Keeps each scene, and everything that it changes, in the memory: one transaction per scene.",
          {"Scene", "Cluster"},
          {},
          {"*"}};
}

void MemoryWriter::declare(OptionTable& table) {
  table.flag(
      "clouds", clouds_,
      "Keeps the points of each cluster, for annotators that are asked later and for models of objects.");
}

void MemoryWriter::process(perception::cas::Cas& cas, perception::Context& context) {
  const perception::types::SceneCas scene(cas);
  if (!has_pose(scene)) return;
  MemorySession& session = session_of(context, "MemoryWriter");
  if (!session.pending || session.pending->cas != &cas) {
    SceneRecord record = record_of(scene, context, session);
    add_what_is_kept(scene, clouds_, record);
    session.recorder().record(record);
    return;
  }
  MemorySession::Pending pending = std::move(*session.pending);
  session.pending.reset();
  pending.record.structures.push_back(scene.scene().similarities.get());
  pending.record.structures.push_back(scene.scene().distances.get());
  add_what_is_kept(scene, clouds_, pending.record);
  const std::vector<perception::types::Cluster> clusters = scene.clusters();
  for (size_t k = 0; k < clusters.size(); ++k)
    for (const perception::cas::FeatureStructure& vote : tracker_votes(clusters[k]))
      pending.record.observations[k].structures.push_back(vote);
  session.recorder().record(pending.record, std::move(pending.resolved));
}

void MemoryWriter::finish(perception::Context& context) {
  session_of(context, "MemoryWriter").pending.reset();
}

void add_memory_annotators(perception::AnnotatorRegistry& registry) {
  registry.add_reader<MemoryReader>();
  registry.add<PlaceNaming>();
  registry.add<IdentityResolution>();
  registry.add<MemoryWriter>();
}

}  // namespace loci::memory
