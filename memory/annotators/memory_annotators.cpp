#include "memory/annotators/memory_annotators.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "mapping/base/text/json.h"
#include "mapping/sensor/depth_noise.h"
#include "memory/annotators/cas_to_scene.h"
#include "memory/annotators/memory_reader.h"
#include "memory/annotators/memory_session.h"
#include "memory/recorder/recorder.h"
#include "memory/store/store.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {
namespace {

constexpr const char* kSource = "IdentityResolution";
constexpr const char* kArbiter = "Arbiter";

/// Name of a believed object; tentative ones have no reported number.
std::string name_of(const belief::ObjectOutcome& outcome) {
  return outcome.object != 0 ? object_name(outcome.object) : "tentative_" + std::to_string(outcome.key);
}

void fill(const perception::types::PairMatrix& matrix, const ResolvedScene& resolved,
          const std::vector<double>& values) {
  std::vector<std::string> rows, columns;
  for (size_t k = 0; k < resolved.scene.observations.size(); ++k)
    rows.push_back("cluster_" + std::to_string(k));
  for (const belief::ObjectOutcome& outcome : resolved.update.objects) columns.push_back(name_of(outcome));
  matrix.source.set(kSource);
  matrix.rows.set(static_cast<int32_t>(rows.size()));
  matrix.cols.set(static_cast<int32_t>(columns.size()));
  matrix.row_ids.set(rows);
  matrix.col_ids.set(columns);
  matrix.values.set(values);
}

/// Of one of belief::kTrackers: "PositionTracker".
std::string tracker_id(size_t tracker) {
  std::string name = std::string(belief::kTrackers.at(tracker)) + "Tracker";
  name.front() = static_cast<char>(std::toupper(name.front()));
  return name;
}

void track(perception::cas::Cas& cas, const perception::types::Cluster& cluster, int64_t object,
           const std::string& annotator) {
  if (object == 0) return;
  const auto tracking = perception::types::TrackingAnnotation::create(cas);
  tracking.source.set(kSource);
  tracking.annotator_id.set(annotator);
  tracking.tracking_id.set(object);
  cluster.annotations.push_back(tracking);
}

/// Proposals of the single-cue trackers and their arbiter; tentative objects have no number.
void add_votes(perception::cas::Cas& cas, const perception::types::Cluster& cluster,
               const belief::TrackerVotes& votes, const belief::BeliefUpdate& update) {
  const auto vote = [&](const std::optional<int64_t>& key, const std::string& annotator) {
    if (!key) return;
    const auto found = std::ranges::find(update.objects, *key, &belief::ObjectOutcome::key);
    if (found != update.objects.end()) track(cas, cluster, found->object, annotator);
  };
  for (size_t t = 0; t < belief::kTrackers.size(); ++t) vote(votes.key[t], tracker_id(t));
  vote(votes.settled, kArbiter);
}

void add_matrices(const perception::types::SceneCas& cas, const ResolvedScene& resolved) {
  std::vector<double> similarities, distances;
  const belief::PairEvidence& evidence = resolved.update.evidence;
  for (Eigen::Index k = 0; k < evidence.offset.cols(); ++k) {
    for (Eigen::Index o = 0; o < evidence.offset.rows(); ++o) {
      similarities.push_back(evidence.similarity(o, k));
      distances.push_back(evidence.offset(o, k));
    }
  }
  fill(cas.scene().similarities.get_or_create(), resolved, similarities);
  fill(cas.scene().distances.get_or_create(), resolved, distances);
}

perception::types::Object object_of(perception::cas::Cas& cas, const belief::ProtoObject& object,
                                    const ResolvedScene& resolved) {
  const auto fs = perception::types::Object::create(cas);
  fs.name.set(object_name(object.id));
  fs.last_seen.set(object.last_seen);
  if (!object.place.empty()) fs.place.set(object.place);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = belief::box_in_map(object, resolved.scene.places).centre;
  fs.map_from_object.set(perception::types::to(cas, pose));
  fs.presence_probability.set(object.status == belief::Status::gone ? 0.0 : object.probability_here);
  for (const belief::ObjectOutcome& outcome : resolved.update.objects) {
    if (outcome.key != object.key) continue;
    if (object.status != belief::Status::gone) fs.presence_probability.set(outcome.probability_here);
    fs.in_view.set(outcome.visibility.out_of_view < 0.5);
    fs.occluded.set(outcome.visibility.hidden > 0.5);
  }
  return fs;
}

perception::types::AssociationDistribution distribution(
    const perception::types::SceneCas& cas, const ResolvedScene& resolved,
    const std::map<int64_t, perception::types::Object>& object_of_key) {
  const auto fs = perception::types::AssociationDistribution::create(cas.cas());
  fs.source.set(kSource);
  fs.kind.set("identity");
  std::vector<double> probabilities, fresh, clutter, missing;
  std::vector<int64_t> keys;
  for (const belief::ObjectOutcome& outcome : resolved.update.objects) {
    const auto found = object_of_key.find(outcome.key);
    if (found == object_of_key.end()) continue;
    fs.candidates.push_back(found->second);
    keys.push_back(outcome.key);
    missing.push_back(1 - outcome.matched);
  }
  const std::vector<perception::types::Cluster> clusters = cas.clusters();
  for (size_t k = 0; k < clusters.size(); ++k) {
    fs.clusters.push_back(clusters[k]);
    const belief::ObservationOutcome& outcome = resolved.update.observations[k];
    for (const int64_t key : keys) {
      double probability = 0;
      for (const belief::PartnerProbability& partner : outcome.partners)
        if (partner.key == key) probability = partner.probability();
      probabilities.push_back(probability);
    }
    fresh.push_back(outcome.appear);
    clutter.push_back(outcome.clutter);
  }
  fs.probabilities.set(probabilities);
  fs.new_probabilities.set(fresh);
  fs.false_probabilities.set(clutter);
  fs.missing_probabilities.set(missing);
  return fs;
}

/// Proposals of trackers and arbiter for a cluster, stored with it.
std::vector<perception::cas::FeatureStructure> tracker_votes(const perception::types::Cluster& cluster) {
  std::vector<perception::cas::FeatureStructure> votes;
  for (const perception::types::Annotation& annotation : cluster.annotations)
    if (const auto tracking = perception::types::try_as<perception::types::TrackingAnnotation>(annotation))
      if (tracking->source.get() == kSource && tracking->annotator_id.get() != kSource)
        votes.push_back(*tracking);
  return votes;
}

/// Writes the result into the CAS: per cluster of a known object a TrackingAnnotation, and those of the
/// trackers and the arbiter; the matrices of similarities and distances; and the BeliefStateInstance (§3.2.5,
/// §6.1.2).
void annotate_belief(const perception::types::SceneCas& cas, const ResolvedScene& resolved) {
  const std::vector<perception::types::Cluster> clusters = cas.clusters();
  const auto belief = perception::types::BeliefStateInstance::create(cas.cas());
  belief.timestamp.set(resolved.scene.time);
  belief.scene.set(cas.scene());
  for (size_t k = 0; k < clusters.size(); ++k) {
    belief.current_clusters.push_back(clusters[k]);
    track(cas.cas(), clusters[k], resolved.update.observations[k].object, kSource);
    add_votes(cas.cas(), clusters[k], resolved.update.evidence.votes[k], resolved.update);
  }
  std::map<int64_t, perception::types::Object> objects;
  for (const belief::ProtoObject& object : resolved.after.objects) {
    if (object.id == 0) continue;
    const perception::types::Object fs = object_of(cas.cas(), object, resolved);
    objects.emplace(object.key, fs);
    belief.known_objects.push_back(fs);
    if (object.status == belief::Status::present && object.last_seen != resolved.scene.time)
      belief.persisting_objects.push_back(fs);
  }
  belief.identities.set(distribution(cas, resolved, objects));
  belief.add_to_index();
  add_matrices(cas, resolved);
}

MemorySession& session_of(const perception::Context& context, const std::string& annotator) {
  return context.resources.get<MemorySession>("memory for " + annotator, "name one with -m FILE.loci");
}

/// Of what few pixels show, and so far away that the noise of the depth counts, a part is lost in that noise:
/// its centre and size are biased.
void mark_what_noise_hides(SceneRecord& record) {
  constexpr int kWholePixels = 500;
  constexpr double kFarNoise_m = 0.003;
  for (ObservationRecord& one : record.observations)
    if (one.evidence.points < kWholePixels && mapping::depth_noise(one.evidence.range) > kFarNoise_m)
      one.evidence.partial = true;
}

/// The scene as the memory takes it, with the numbers of this run.
SceneRecord record_of(const perception::types::SceneCas& scene, const perception::Context& context,
                      MemorySession& session) {
  const mapping::World* world = context.resources.find<mapping::World>();
  SceneRecord record = scene_record(scene, world, session.people());
  for (PlaceRow& place : record.places)
    if (world != nullptr && world->find_link(place.name) != nullptr) place.map = session.map();
  record.row.recording = session.recording();
  record.row.map = session.map();
  if (context.next) record.seconds_to_next = in_seconds(context.next->time_ns - record.row.time);
  // In a video other frames make up for it.
  if (!context.in_video(record.row.time)) mark_what_noise_hides(record);
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
          {"PlanarSupport"},
          {kSharedMemory}};
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
          {"TrackingAnnotation", "SimilarityMatrix", "DistanceMatrix", "AssociationDistribution",
           "BeliefStateInstance"},
          {"*"},
          {},
          {kSharedMemory}};
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
          {"*"},
          {},
          {kSharedMemory}};
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
    add_stored_data(scene, clouds_, record);
    session.recorder().record(record);
    return;
  }
  MemorySession::Pending pending = std::move(*session.pending);
  session.pending.reset();
  pending.record.structures.push_back(scene.scene().similarities.get());
  pending.record.structures.push_back(scene.scene().distances.get());
  add_stored_data(scene, clouds_, pending.record);
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
