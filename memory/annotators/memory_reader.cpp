#include "memory/annotators/memory_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"
#include "memory/annotators/cas_to_scene.h"
#include "memory/annotators/memory_session.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_images.h"
#include "perception/cas/json.h"
#include "perception/conversions/opencv.h"
#include "perception/types/geometry.h"

namespace loci::memory {
namespace {

cv::Mat stored_image(const Store& store, Id id) {
  const BlobRow blob = store.blob(id);
  return mapping::decode_image({blob.bytes.begin(), blob.bytes.end()}, blob.hash);
}

/// The image of an observation as a hypothesis. Its mask is that of the depth image, stretched to it.
void add_image(const Store& store, const ObservationRow& row, const perception::types::Cluster& cluster) {
  if (!row.crop) return;
  perception::cas::Cas& cas = cluster.cas();
  const cv::Mat image = stored_image(store, *row.crop);
  cv::Mat mask(image.size(), CV_8U, cv::Scalar(255));
  if (row.mask) cv::resize(stored_image(store, *row.mask), mask, image.size(), 0, 0, cv::INTER_NEAREST);
  const auto roi = perception::types::StandaloneImageROI::create(cas);
  roi.source.set("MemoryReader");
  roi.roi.set(perception::types::to(cas, cv::Rect(cv::Point(), image.size())));
  roi.image.set(perception::types::to(cas, image));
  roi.mask.set(perception::types::to(cas, mask));
  cluster.hypotheses.push_back(roi);
}

perception::types::Cluster make_cluster(const Store& store, const ObservationRow& row,
                                        perception::cas::Cas& cas) {
  const auto cluster = perception::types::Cluster::create(cas);
  if (row.position) cluster.centroid.set(perception::types::to(cas, *row.position));
  add_image(store, row, cluster);
  return cluster;
}

/// A depth image in which nothing was measured yet; empty without a camera.
cv::Mat blank_depth(const SceneRow& scene) {
  if (!scene.camera) return {};
  const double none = std::numeric_limits<double>::quiet_NaN();
  return {scene.camera->height, scene.camera->width, CV_32F, cv::Scalar(none)};
}

/// The points of an observation as a hypothesis, and in the depth image.
void add_points(const Store& store, const SceneRow& scene, const ObservationRow& row,
                const perception::types::Cluster& cluster, cv::Mat& depth) {
  const std::optional<ClusterPoints> kept = cluster_points(store, scene, row);
  if (!kept || kept->pixels.empty()) return;
  for (size_t i = 0; i < kept->pixels.size(); ++i) depth.ptr<float>()[kept->pixels[i]] = kept->points[i].z();
  const auto reference = perception::types::ReferenceClusterPoints::create(cluster.cas());
  reference.source.set("MemoryReader");
  reference.indices.get_or_create().indices.set(kept->pixels);
  cluster.hypotheses.push_back(reference);
}

bool is_annotated(const perception::types::Cluster& cluster, const std::set<std::string>& by) {
  std::set<std::string> sources;
  for (const perception::types::Annotation& annotation : cluster.annotations)
    sources.insert(annotation.source.get());
  return !by.empty() && std::includes(sources.begin(), sources.end(), by.begin(), by.end());
}

}  // namespace

perception::AnnotatorDescriptor MemoryReader::descriptor() const {
  return {
      "MemoryReader",
      "Reads the scenes of a memory: clusters with their images and points, and what was said about them.",
      {},
      {"Scene", "CameraInfo", "view:color", "view:depth", "Cluster", "StandaloneImageROI",
       "ReferenceClusterPoints", "PlanarSupport", "GeometryAnnotation", "ColorAnnotation", "ColorHistogram",
       "TFLocationAnnotation"},
      {},
      {},
      {kSharedMemory}};
}

void MemoryReader::start(perception::Context& context) {
  memory_ = &context.resources.get<MemorySource>("memory for MemoryReader", "name one with -m FILE.loci");
  scenes_ = memory_->store.scenes();
}

perception::FrameId MemoryReader::upcoming() const {
  const SceneRow& scene = scenes_.at(position_);
  return {scene.id, scene.time};
}

void MemoryReader::read_next(perception::cas::Cas& cas, perception::Context& context) {
  const Store& store = memory_->store;
  const SceneRow& row = scenes_.at(position_++);
  const perception::types::SceneCas scene(cas);
  const perception::types::Scene made = scene.create_scene();
  made.timestamp.set(row.time);
  made.frame_index.set(row.id);
  if (row.map_from_camera)
    made.map_from_camera.set(
        perception::types::to_stamped(cas, *row.map_from_camera, "map", "depth_camera", row.time));
  if (row.image)
    perception::types::set_view_image(scene, perception::types::SceneCas::kColor,
                                      stored_image(store, *row.image));
  memory_->current = {row.id, {}, 0};
  std::map<Id, perception::types::Cluster> clusters;
  cv::Mat depth = blank_depth(row);
  for (const ObservationRow& observation : store.observations(row.id)) {
    const perception::types::Cluster cluster = make_cluster(store, observation, cas);
    add_points(store, row, observation, cluster, depth);
    clusters.emplace(observation.id, cluster);
    memory_->current.observations.push_back(observation.id);
    scene.add_cluster(cluster);
  }
  if (!depth.empty()) perception::types::set_view_image(scene, perception::types::SceneCas::kDepth, depth);
  for (const FeatureStructureRow& kept : store.feature_structures(row.id)) {
    if (!cas.type_system().find(kept.type)) {
      if (unknown_.insert(kept.type).second)
        context.warnings.add(
            fmt::format("{} is not known here and left out; a plugin may know it", kept.type));
      continue;
    }
    const perception::cas::FeatureStructure structure = read_feature_structure(store, kept.id, cas);
    const auto annotation = perception::types::try_as<perception::types::Annotation>(structure);
    if (const auto support = perception::types::try_as<perception::types::PlanarSupport>(structure))
      scene.add_support(*support);
    if (const auto camera = perception::types::try_as<perception::types::CameraInfo>(structure))
      scene.set_camera(*camera);
    if (annotation && kept.observation) clusters.at(*kept.observation).annotations.push_back(*annotation);
    if (annotation && !kept.observation) made.annotations.push_back(*annotation);
  }
  if (row.camera && !scene.has_camera("depth")) perception::types::set_cameras(scene, cameras_of(store, row));
  for (const auto& [id, cluster] : clusters) {
    if (const auto location = cluster.annotations.first<perception::types::TFLocationAnnotation>())
      cluster.place.set(location.frame_id.get());
    for (const perception::types::PlanarSupport& support : scene.supports())
      if (cluster.place.is_set() && support.name.get() == cluster.place.get()) cluster.support.set(support);
    if (is_annotated(cluster, memory_->annotated_by)) cas.hide(cluster);
  }
  memory_->current.structures = cas.size();
}

namespace {

/// What is new about the scene read last.
class NewAnnotations {
 public:
  NewAnnotations(const MemorySource& memory, perception::cas::Cas& cas)
      : memory_(memory), scene_(cas), clusters_(scene_.scene().clusters.to_vector()) {
    for (const AnnotationRow& row : memory.store.annotations(memory.current.scene))
      if (row.type == perception::types::Relation::kTypeName) relations_.push_back(row);
  }

  size_t clusters() const { return std::min(clusters_.size(), memory_.current.observations.size()); }

  std::vector<perception::types::Annotation> of_cluster(size_t i) const {
    std::set<std::string> sources, known;
    std::vector<perception::types::Annotation> added;
    for (const perception::types::Annotation& annotation : clusters_[i].annotations) {
      const perception::cas::FeatureStructure& structure = annotation;
      const std::string words = to_json(structure).dump();
      if (structure.id() <= memory_.current.structures) {
        sources.insert(annotation.source.get());
        known.insert(words);
      } else if (!is_kept(annotation, sources) && !known.contains(words)) {
        added.push_back(annotation);
      }
    }
    return added;
  }

  /// With the indices of the clusters.
  std::vector<std::pair<size_t, AnnotationRecord>> relations() const {
    std::vector<std::pair<size_t, AnnotationRecord>> added;
    for (const perception::types::Relation& relation : scene_.scene().relations)
      if (const auto record = relation_record(scene_, relation); record && !is_known(*record))
        added.push_back(*record);
    return added;
  }

 private:
  /// Whether the annotator has said something of this cluster before, and is not to say it again.
  bool is_kept(const perception::types::Annotation& annotation, const std::set<std::string>& sources) const {
    const std::string source = annotation.source.get();
    return memory_.annotated_by.contains(source) && sources.contains(source);
  }
  bool is_known(const std::pair<size_t, AnnotationRecord>& relation) const {
    const bool again = memory_.annotated_by.empty();
    return std::ranges::any_of(relations_, [&](const AnnotationRow& row) {
      return row.observation == memory_.current.observations.at(relation.first) &&
             row.value == relation.second.value && (!again || row.confidence == relation.second.confidence);
    });
  }

  const MemorySource& memory_;
  perception::types::SceneCas scene_;
  std::vector<perception::types::Cluster> clusters_;
  std::vector<AnnotationRow> relations_;  ///< that are stored
};

}  // namespace

size_t store_new_annotations(MemorySource& memory, perception::cas::Cas& cas, Id run) {
  const NewAnnotations fresh(memory, cas);
  const MemorySource::Current& current = memory.current;
  SceneTransaction transaction(memory.store, run);
  FeatureStructureWriter writer(transaction, current.scene);
  size_t added = 0;
  const auto add = [&](size_t cluster, const AnnotationRecord& annotation) {
    AnnotationRow row = annotation_row(annotation, current.scene, current.observations[cluster]);
    if (annotation.structure) row.feature_structure = writer.add(annotation.structure, row.observation);
    transaction.add_annotation(row);
    ++added;
  };
  for (size_t i = 0; i < fresh.clusters(); ++i)
    for (const perception::types::Annotation& annotation : fresh.of_cluster(i))
      add(i, annotation_record(annotation));
  for (const auto& [cluster, relation] : fresh.relations()) add(cluster, relation);
  if (added > 0) transaction.commit();
  return added;
}

}  // namespace loci::memory
