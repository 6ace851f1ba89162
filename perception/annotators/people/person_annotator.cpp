#include "perception/annotators/people/person_annotator.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>

#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/conversions/opencv.h"
#include "perception/detection/arms.h"
#include "perception/detection/lift.h"

namespace loci::perception {
namespace {

PeopleFrame frame_of(const types::SceneCas& scene) {
  PeopleFrame frame;
  frame.color = types::view_image(scene, types::SceneCas::kColor);
  frame.camera = types::cameras(scene);
  frame.points = scene.has(types::SceneCas::kCloud)
                     ? cloud_points(scene)
                     : points_of(types::view_image(scene, types::SceneCas::kDepth), frame.camera.depth);
  if (scene.has(kStructureView))
    frame.explained =
        types::view_image(scene, kStructureView) == static_cast<int>(mapping::PixelKind::map_explained);
  if (has_measured_pose(scene.scene())) frame.map_from_camera = map_from_camera(scene.scene());
  return frame;
}

/// Extents of a person in the map frame.
std::optional<Eigen::AlignedBox3d> extents(const Person& person, const PeopleFrame& frame) {
  if (!frame.map_from_camera || person.pixels.empty()) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (const int pixel : person.pixels)
    box.extend(*frame.map_from_camera * to_vector(frame.points.ptr<cv::Vec3f>()[pixel]));
  return box;
}

void annotate(const types::SceneCas& scene, const Person& person, const PeopleFrame& frame) {
  cas::Cas& cas = scene.cas();
  const auto annotation = types::PersonAnnotation::create(cas);
  annotation.source.set(PersonAnnotator::kName);
  annotation.confidence.set(person.score);
  annotation.body.set(types::to(cas, person.body));
  if (!person.head.empty()) annotation.head.set(types::to(cas, person.head));
  annotation.has_face.set(person.has_face);
  if (const auto box = extents(person, frame)) {
    const auto bbox = annotation.bbox.get_or_create();
    bbox.pose.set(types::to(cas, Isometry3d(Eigen::Translation3d(box->center()))));
    bbox.size.set(types::to(cas, Vector3d(box->sizes())));
  }
  scene.scene().annotations.push_back(annotation);
}

/// The arms of people who are not in view themselves.
std::vector<Person> arms_besides(const std::vector<Person>& people, const PeopleFrame& frame) {
  std::vector<Person> arms = find_arms(frame);
  std::erase_if(arms, [&](const Person& arm) {
    return std::ranges::any_of(people, [&](const Person& person) {
      return std::ranges::binary_search(person.pixels, arm.pixels[arm.pixels.size() / 2]);
    });
  });
  return arms;
}

/// Points of people belong to no object and no support.
void take_out(const types::SceneCas& scene, const cv::Mat& people) {
  const cv::Scalar nan = cv::Scalar::all(std::numeric_limits<double>::quiet_NaN());
  cv::Mat points = cloud_points(scene).clone();
  points.setTo(nan, people);
  set_cloud_points(scene, points);
  if (scene.has(types::SceneCas::kNormals)) {
    cv::Mat normals = cloud_normals(scene).clone();
    normals.setTo(nan, people);
    set_cloud_normals(scene, normals);
  }
  if (scene.has(kRegionsView)) {
    cv::Mat regions = types::view_image(scene, kRegionsView).clone();
    regions.setTo(0, people);
    types::set_view_image(scene, kRegionsView, regions);
  }
}

}  // namespace

AnnotatorDescriptor PersonAnnotator::descriptor() const {
  return {
      kName,
      "Finds people by face or body, where the depth shows a head on a body, and by arms that reach in over "
      "a table; takes their points out.",
      {"Scene", "CameraInfo", "view:depth"},
      {"PersonAnnotation", "view:people"},
      {"view:color", "view:cloud", "view:normals", "view:structure", "view:regions", "Cluster"},
      {"Scene", "view:cloud", "view:normals", "view:regions"}};
}

void PersonAnnotator::start(Context& /*context*/) {
  detector_.emplace();
}

void PersonAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  if (!scene.has(types::SceneCas::kColor)) return;
  const PeopleFrame frame = frame_of(scene);
  std::vector<Person> people = detector_->detect(frame);
  std::ranges::move(arms_besides(people, frame), std::back_inserter(people));
  cv::Mat mask = cv::Mat::zeros(frame.points.size(), CV_8U);
  for (const Person& person : people) {
    annotate(scene, person, frame);
    for (const int pixel : person.pixels) mask.data[pixel] = 255;
  }
  types::set_view_image(scene, kPeopleView, mask);
  if (people.empty()) return;
  if (scene.clusters().empty() && scene.has(types::SceneCas::kCloud)) take_out(scene, mask);
  scene.log(kName, "info", fmt::format("people in view: {}", people.size()));
}

}  // namespace loci::perception
