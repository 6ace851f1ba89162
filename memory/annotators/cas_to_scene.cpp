#include "memory/annotators/cas_to_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "mapping/image/hsv.h"
#include "mapping/sensor/depth_noise.h"
#include "mapping/world/kinematics.h"
#include "memory/recorder/observation_pixels.h"
#include "memory/store/scene_images.h"
#include "perception/conversions/opencv.h"
#include "perception/detection/people_detector.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_json.h"

namespace loci::memory {
namespace {

void describe_place(const perception::types::PlanarSupport& support, const mapping::World* world,
                    SceneRecord& record) {
  if (support.name.get().empty()) return;
  PlaceRow row;
  row.name = support.name.get();
  row.class_name = support.support_class.get_or("plane");
  row.height = support.height.get();
  for (const Vector3d& corner : perception::types::points_from_values(support.outline.get()))
    row.outline.push_back(corner.head<2>());
  if (support.map_from_support.is_set())
    row.map_from_place = perception::types::from<Isometry3d>(support.map_from_support.get());
  row.container = row.class_name.starts_with("drawer") || row.class_name == "cabinet";
  if (world != nullptr && world->find_link(row.name) != nullptr) {
    for (const mapping::Joint* joint = world->parent_joint(row.name); joint != nullptr;
         joint = world->parent_joint(joint->parent)) {
      if (joint->type == mapping::JointType::fixed) continue;
      row.joint = joint->name;
      break;
    }
  }
  // A place of the map is stored as the map has it.
  for (const belief::PlacePose& moved : record.moved_places)
    if (moved.name == row.name && !row.joint) {
      const Isometry3d before_from_now = moved.map_from_place.inverse();
      for (Vector2d& corner : row.outline)
        corner = (before_from_now * Vector3d(corner.x(), corner.y(), 0)).head<2>();
      if (row.map_from_place) row.map_from_place = before_from_now * *row.map_from_place;
    }
  record.places.push_back(std::move(row));
}

/// Furniture that is not where the map has it.
void add_moved_places(const perception::types::Scene& scene, SceneRecord& record) {
  for (const auto& piece : scene.annotations.filter<perception::types::FurnitureAnnotation>()) {
    if (!piece.moved.get()) continue;
    const Isometry3d motion = perception::types::from<Isometry3d>(piece.motion.get());
    for (const std::string& link : piece.links.to_vector())
      record.moved_places.push_back({link, motion, piece.found.get()});
  }
}

/// Poses of movable links: objects on them move along.
void add_place_poses(const mapping::World& world, SceneRecord& record) {
  const std::vector<Isometry3d> poses = root_from_links(world, record.row.joints);
  const std::vector<bool> moving = mapping::moving_links(world);
  for (size_t i = 0; i < world.links.size(); ++i) {
    if (!moving[i]) continue;
    belief::PlacePose pose{world.links[i].name, poses[i]};
    for (const belief::PlacePose& moved : record.moved_places)
      if (moved.name == pose.name) {
        pose.map_from_place = moved.map_from_place * pose.map_from_place;
        pose.known = moved.known;
      }
    record.place_poses.push_back(std::move(pose));
  }
}

/// JPEG of a colour image whose top left corner is `offset` in that of the scene.
BlobRecord stored_image(const cv::Mat& image, const cv::Point& offset, const std::vector<cv::Rect>& heads) {
  if (heads.empty()) return {encoded_image(image, ".jpg"), "image/jpeg"};
  cv::Mat anonymous = image.clone();
  perception::anonymise(anonymous, heads, offset);
  return {encoded_image(anonymous, ".jpg"), "image/jpeg"};
}

void read_camera(const perception::types::SceneCas& cas, const perception::types::Scene& scene,
                 const std::vector<cv::Rect>& heads, SceneRecord& record) {
  const mapping::RgbdCamera cameras = perception::types::cameras(cas);
  record.view.camera = cameras.depth;
  record.view.map_from_camera = perception::types::from<Isometry3d>(scene.map_from_camera.get());
  record.view.depth = perception::types::view_image(cas, perception::types::SceneCas::kDepth);
  if (cas.has(perception::types::SceneCas::kMapDepth))
    record.view.map_depth = perception::types::view_image(cas, perception::types::SceneCas::kMapDepth);
  SceneCamera row;
  row.width = cameras.depth.width;
  row.height = cameras.depth.height;
  row.fx = cameras.depth.fx;
  row.fy = cameras.depth.fy;
  row.cx = cameras.depth.cx;
  row.cy = cameras.depth.cy;
  row.range_min = record.view.near_m;
  row.range_max = record.view.far_m;
  record.row.camera = row;
  record.row.map_from_camera = record.view.map_from_camera;
  if (cas.has(perception::types::SceneCas::kColor))
    record.image =
        stored_image(perception::types::view_image(cas, perception::types::SceneCas::kColor), {}, heads);
  // The columns of the scene describe the depth camera; drawing on the image needs the colour camera.
  if (cas.has_camera("color")) record.structures.push_back(cas.camera("color"));
}

/// Searchable value of an unknown type: its first text.
std::string first_word(const perception::cas::FeatureStructure& structure) {
  if (structure.type().name().starts_with("loci.")) return {};
  const perception::cas::Type base =
      structure.cas().type_system().type(perception::types::Annotation::kTypeName);
  for (const perception::cas::Feature& feature : structure.type().features())
    if (!base.find_feature(feature.name()) && feature.range().kind() == perception::cas::Kind::kString &&
        structure.is_set(feature))
      return structure.text(feature);
  return {};
}

std::string value_of(const perception::types::Annotation& annotation) {
  const perception::cas::FeatureStructure& structure = annotation;
  if (const auto color = perception::types::try_as<perception::types::ColorAnnotation>(structure))
    return color->names.size() > 0 ? color->names.get()[0] : std::string();
  if (const auto size = perception::types::try_as<perception::types::SizeAnnotation>(structure))
    return size->size.get();
  if (const auto location = perception::types::try_as<perception::types::TFLocationAnnotation>(structure))
    return location->sentence.get();
  if (const auto location = perception::types::try_as<perception::types::LocationAnnotation>(structure))
    return location->frame_id.get();
  if (const auto label = perception::types::try_as<perception::types::ClassificationAnnotation>(structure))
    // What is not sure enough in one view may be so in several: the most probable class.
    return label->label.is_set() || label->confidences.size() == 0 ? label->label.get()
                                                                   : (*label->confidences.begin()).name.get();
  if (const auto product = perception::types::try_as<perception::types::ProductAnnotation>(structure))
    return product->name.get();
  if (const auto code = perception::types::try_as<perception::types::BarcodeAnnotation>(structure))
    return code->code.get();
  if (const auto text = perception::types::try_as<perception::types::TextAnnotation>(structure))
    return text->text.get();
  if (const auto logo = perception::types::try_as<perception::types::LogoAnnotation>(structure))
    return logo->brand.get();
  if (const auto landmark = perception::types::try_as<perception::types::LandmarkAnnotation>(structure))
    return landmark->name.get();
  if (const auto similar = perception::types::try_as<perception::types::SimilarImageAnnotation>(structure))
    return similar->name.get();
  if (const auto said = perception::types::try_as<perception::types::UserSubmittedAnnotation>(structure))
    return said->name.get();
  if (const auto result = perception::types::try_as<perception::types::VisualSearchAnnotation>(structure))
    return result->title.get();
  if (const auto geometry = perception::types::try_as<perception::types::GeometryAnnotation>(structure))
    return geometry->place.get();
  if (perception::types::try_as<perception::types::PersonAnnotation>(structure)) return "person";
  return first_word(structure);
}

belief::Texture texture_of(const perception::types::Cluster& cluster) {
  const auto annotation = cluster.annotations.first<perception::types::TextureAnnotation>();
  if (!annotation) return {};
  const auto positions = annotation.positions.get(), diameters = annotation.diameters.get();
  const auto bytes = annotation.descriptors.get();
  constexpr size_t kBytes = sizeof(belief::SurfaceKeypoint::descriptor);
  belief::Texture texture(std::min({diameters.size(), positions.size() / 3, bytes.size() / kBytes}));
  for (size_t i = 0; i < texture.size(); ++i) {
    texture[i].position = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
    texture[i].diameter_m = diameters[i];
    std::memcpy(texture[i].descriptor.data(), bytes.data() + i * kBytes, kBytes);
  }
  return texture;
}

void read_annotations(const perception::types::Cluster& cluster, ObservationRecord& observation) {
  for (const perception::types::Annotation& annotation : cluster.annotations)
    // Textures are stored with the evidence.
    if (!perception::types::try_as<perception::types::TextureAnnotation>(annotation))
      observation.annotations.push_back(annotation_record(annotation));
  if (const auto geometry = cluster.annotations.first<perception::types::GeometryAnnotation>()) {
    observation.row.map_from_box = perception::types::from<Isometry3d>(geometry.map_from_object.get());
    observation.row.size = perception::types::from<Vector3d>(geometry.size.get());
  } else {
    observation.row.size = observation.evidence.box.size;
  }
  if (const auto color = cluster.annotations.first<perception::types::ColorAnnotation>()) {
    observation.row.hsv = HsvColor{color.mean_hue.get(), color.mean_saturation.get(), color.mean_value.get()};
    if (color.names.size() > 0) observation.row.color = color.names.get()[0];
  }
  if (const auto location = cluster.annotations.first<perception::types::TFLocationAnnotation>())
    if (location.sentence.is_set()) observation.row.location = location.sentence.get();
}

ObservationRecord read_cluster(const perception::types::Cluster& cluster, const std::vector<cv::Rect>& heads,
                               SceneRecord& record) {
  ObservationRecord observation;
  set_pixels(cluster_indices(cluster).span(), record, observation);
  observation.evidence.partial = cluster.at_image_border.get() || cluster.partly_hidden.get();
  observation.evidence.place = place_of(cluster);
  observation.evidence.descriptors = descriptors_of(cluster, record.view.map_from_camera.translation());
  observation.evidence.texture = texture_of(cluster);
  observation.row.position = observation.evidence.box.centre;
  read_annotations(cluster, observation);
  if (const auto roi = cluster.hypotheses.first<perception::types::StandaloneImageROI>())
    observation.crop = stored_image(perception::types::from<cv::Mat>(roi.image.get()),
                                    perception::types::from<cv::Rect>(roi.roi.get()).tl(), heads);
  return observation;
}

std::vector<LogRow> log_of(const perception::types::Scene& scene) {
  std::vector<LogRow> lines;
  if (!scene.log.is_set()) return lines;
  for (const perception::types::LogEntry& entry : scene.log.get().entries) {
    LogRow line;
    line.annotator = entry.annotator.get();
    line.level = entry.level.get();
    line.text = entry.text.get();
    if (entry.milliseconds.is_set()) line.milliseconds = entry.milliseconds.get();
    if (line.milliseconds && line.text == "done") line.text.clear();
    lines.push_back(std::move(line));
  }
  return lines;
}

BlobRecord cloud_of(const perception::types::Cluster& cluster, const cv::Mat& depth) {
  const auto reference = cluster.hypotheses.first<perception::types::ReferenceClusterPoints>();
  if (!reference) return {};
  std::vector<int32_t> pixels = reference.indices.get().indices.to_vector();
  // Ascending and unique, as in the mask.
  std::ranges::sort(pixels);
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  std::vector<float> values;
  values.reserve(pixels.size());
  for (const int32_t pixel : pixels)
    values.push_back(depth.at<float>(pixel / depth.cols, pixel % depth.cols));
  return {encode_cluster_depth(values), kClusterDepthMedia};
}

}  // namespace

AnnotationRecord annotation_record(const perception::types::Annotation& annotation) {
  AnnotationRecord record;
  record.type = annotation.type().name();
  record.value = value_of(annotation);
  if (annotation.confidence.is_set()) record.confidence = annotation.confidence.get();
  record.structure = annotation;
  return record;
}

std::optional<std::pair<size_t, AnnotationRecord>> relation_record(
    const perception::types::SceneCas& scene, const perception::types::Relation& relation) {
  const auto first = number_of(scene, relation.object1.get());
  if (!first) return std::nullopt;
  AnnotationRecord record;
  record.type = relation.type().name();
  record.value = relation.name.get();
  record.confidence = relation.probability.get();
  const perception::types::Identifiable other = relation.object2.get();
  if (const auto second = number_of(scene, other))
    record.value += fmt::format(" cluster {}", *second);
  else if (const auto support = perception::types::try_as<perception::types::PlanarSupport>(other))
    record.value += " " + support->name.get();
  return std::pair(*first - 1, record);
}

namespace {

/// Which extents of a box its faces show. An extent is seen on faces that run along it; a face is seen from
/// beyond its plane, and not at grazing incidence, where depth cameras measure little. What is as thin as the
/// noise and seen face-on shows no other face.
std::array<float, 3> seen_extents(const Isometry3d& map_from_box, const Vector3d& size,
                                  const Vector3d& camera) {
  constexpr double kMinIncidence = 0.17;  // sine of the angle to the face: 10 degrees
  constexpr double kNoiseBand = 5.2;      // standard deviations that hold 99 % of the points of a plane
  const Vector3d from = map_from_box.inverse() * camera;
  const Vector3d beyond = (from.cwiseAbs() - 0.5 * size) / std::max(1e-6, from.norm());
  const double sheet = kNoiseBand * mapping::depth_noise(from.norm());
  std::array<float, 3> seen{};
  for (int axis = 0; axis < 3; ++axis)
    for (int face = 0; face < 3; ++face)
      if (face != axis && beyond[face] > kMinIncidence && (size[axis] > sheet || beyond[axis] < beyond[face]))
        seen[size_t(axis)] = 1;
  return seen;
}

}  // namespace

std::vector<belief::Descriptor> descriptors_of(const perception::types::Cluster& cluster,
                                               const Vector3d& camera) {
  std::vector<belief::Descriptor> descriptors;
  if (const auto histogram = cluster.annotations.first<perception::types::ColorHistogram>())
    descriptors.push_back({"color_histogram", histogram.histogram.to_vector()});
  if (const auto color = cluster.annotations.first<perception::types::ColorAnnotation>()) {
    const auto rgb =
        mapping::rgb_from_hsv(color.mean_hue.get(), color.mean_saturation.get(), color.mean_value.get());
    descriptors.push_back({"mean_color", {rgb.begin(), rgb.end()}});
  }
  if (const auto geometry = cluster.annotations.first<perception::types::GeometryAnnotation>()) {
    const Vector3d size = perception::types::from<Vector3d>(geometry.size.get());
    const auto seen =
        seen_extents(perception::types::from<Isometry3d>(geometry.map_from_object.get()), size, camera);
    descriptors.push_back({"extents",
                           {static_cast<float>(size.x()), static_cast<float>(size.y()),
                            static_cast<float>(size.z()), seen[0], seen[1], seen[2]}});
  }
  return descriptors;
}

SceneRecord scene_record(const perception::types::SceneCas& cas, const mapping::World* world, People people) {
  const perception::types::Scene scene = cas.scene();
  const std::vector<cv::Rect> heads =
      people == People::blurred ? perception::types::heads_of_people(scene) : std::vector<cv::Rect>();
  SceneRecord record;
  record.row.time = scene.timestamp.get();
  record.row.frame_index = scene.frame_index.get();
  if (const perception::types::JointState joints = scene.joint_state.get()) {
    const auto names = joints.names.get();
    const auto positions = joints.positions.get();
    for (size_t i = 0; i < names.size() && i < positions.size(); ++i)
      record.row.joints[names[i]] = positions[i];
    if (world != nullptr) record.row.joints = joints_of_world(*world, std::move(record.row.joints));
    record.structures.push_back(joints);
  }
  read_camera(cas, scene, heads, record);
  add_moved_places(scene, record);
  if (world != nullptr) add_place_poses(*world, record);
  for (const perception::types::PlanarSupport& support : cas.supports()) {
    describe_place(support, world, record);
    record.structures.push_back(support);
  }
  for (const perception::types::Annotation& annotation : scene.annotations) {
    if (perception::types::try_as<perception::types::PersonAnnotation>(annotation)) {
      record.annotations.push_back(annotation_record(annotation));
      continue;
    }
    const auto joint = perception::types::try_as<perception::types::JointAnnotation>(annotation);
    if (!joint || joint->moved.get())
      record.structures.push_back(annotation);  // An assumed position is not stored.
  }
  record.view.labels = cv::Mat(record.view.depth.size(), CV_32S, cv::Scalar(-1));
  for (const perception::types::Cluster& cluster : cas.clusters())
    record.observations.push_back(read_cluster(cluster, heads, record));
  for (const perception::types::Relation& relation : scene.relations)
    if (const auto said = relation_record(cas, relation))
      record.observations[said->first].annotations.push_back(said->second);
  return record;
}

void add_stored_data(const perception::types::SceneCas& scene, bool clouds, SceneRecord& record) {
  if (scene.has(perception::types::SceneCas::kStructure))
    record.kinds = perception::types::view_image(scene, perception::types::SceneCas::kStructure);
  record.log = log_of(scene.scene());
  if (!clouds) return;
  // The depth that the annotators used: smoothed where available.
  const cv::Mat depth =
      perception::types::view_image(scene, scene.has(perception::types::SceneCas::kSmoothedDepth)
                                               ? perception::types::SceneCas::kSmoothedDepth
                                               : perception::types::SceneCas::kDepth);
  const std::vector<perception::types::Cluster> clusters = scene.clusters();
  for (size_t i = 0; i < std::min(clusters.size(), record.observations.size()); ++i)
    record.observations[i].cloud = cloud_of(clusters[i], depth);
}

}  // namespace loci::memory
