#include "perception/annotators/io/recording_reader.h"

#include <algorithm>
#include <filesystem>

#include "mapping/recording/gravity.h"
#include "perception/annotators/frame_outcome.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/annotators/structure/normals.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

/// What is up in the camera, where the recording or its images say that it was not held upright.
std::optional<Vector3d> known_up(const mapping::Recording& recording) {
  if (recording.info().up_in_camera) return recording.info().up_in_camera;
  const std::optional<Vector3d> up = mapping::find_up(recording);
  constexpr double kUpright = 0.7;  // Within 45 degrees the supports themselves say it more exactly.
  return up && -up->y() < kUpright ? up : std::nullopt;
}

/// The pose of a camera that stands still, from the first frame that shows a supporting plane. Error when
/// none of the first ones does.
Isometry3d pose_over_first_support(const mapping::Recording& recording, const std::optional<Vector3d>& up) {
  constexpr size_t kTries = 10;
  Tally tries;
  for (size_t i = 0; i < std::min(recording.size(), kTries); ++i) {
    const mapping::RgbdFrame frame = recording.frame(i);
    if (!frame.damage.empty() && !mapping::has_depth(frame)) {
      tries.add(Reason::damaged, frame.damage);
      continue;
    }
    const cv::Mat depth = smooth_depth(frame.depth, frame.camera.depth, NormalOptions::for_objects());
    const cv::Mat points = points_from_depth(depth, frame.camera.depth);
    const cv::Mat normals = normals_from_depth(depth, frame.camera.depth, NormalOptions::for_objects());
    const auto supports = find_supports(points, normals, frame.camera.depth, up, SupportOptions());
    const auto largest =
        std::max_element(supports.begin(), supports.end(),
                         [](const SupportPlane& a, const SupportPlane& b) { return a.inliers < b.inliers; });
    if (largest != supports.end()) return largest->camera_from_plane.inverse();
    tries.add(no_support_because(frame.depth, points, normals, frame.camera.depth, up));
  }
  throw Error("the recording has no poses and shows no support: " + tries.reasons(),
              {recording.info().path, 0, {}}, tries.hint());
}

void set_joints(const types::Scene& scene, const JointState& joints) {
  std::vector<std::string> names;
  std::vector<double> positions;
  for (const auto& [name, position] : joints) {
    names.push_back(name);
    positions.push_back(position);
  }
  const auto state = scene.joint_state.get_or_create();
  state.names.set(names);
  state.positions.set(positions);
}

}  // namespace

AnnotatorDescriptor RecordingReader::descriptor() const {
  return {"RecordingReader",
          "Reads the frames of a recording.",
          {},
          {"Scene", "view:depth", "view:color", "CameraInfo", "JointState"}};
}

void RecordingReader::declare(OptionTable& table) {
  table.integer("every", every_, "frames", "Takes every n-th frame.", 1, 1000000);
}

void RecordingReader::start(Context& context) {
  recording_ = &context.resources.get<mapping::Recording>("recording to read", "give its folder");
  const mapping::RecordingInfo& info = recording_->info();
  if (info.frames_with_pose > 0) {
    // A map that was made of poses which were not level says how they are moved; poses in the frame of the
    // map stay.
    const auto map = context.resources.find<KnownMap>();
    if (map && map->semantics.map_from_input && info.map_frame != map->semantics.frame) {
      map_from_poses_ = *map->semantics.map_from_input;
      map_frame_ = map->semantics.frame;
    }
    return;
  }
  // Where up is known, each frame's supports are looked for by it; else its dominant plane that looks upwards
  // counts.
  const std::optional<Vector3d> up = known_up(*recording_);
  assumed_pose_ = pose_over_first_support(*recording_, up);
  map_frame_ = up ? "support" : kAssumedFrame;
  context.warnings.add(
      "the recording has no poses: the camera is taken as fixed, and the map frame is the first supporting "
      "plane");
}

size_t RecordingReader::count() const {
  const auto every = static_cast<size_t>(every_);
  return recording_ == nullptr ? 0 : (recording_->size() + every - 1) / every;
}

FrameId RecordingReader::upcoming() const {
  const size_t number = frame_number(position_);
  return {recording_->index_of(number), recording_->time_of(number)};
}

void RecordingReader::read_next(cas::Cas& cas, Context& context) {
  const mapping::RgbdFrame frame = recording_->frame(frame_number(position_++));
  const mapping::RecordingInfo& info = recording_->info();
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.create_scene();
  if (!frame.damage.empty()) {
    facade.log("RecordingReader", "error", frame.damage);
    context.warnings.add("frame " + std::to_string(frame.index) + ": " + frame.damage);
  } else if (!mapping::has_depth(frame)) {
    facade.log("RecordingReader", "warning", "the depth image is empty");
    context.warnings.add("frame " + std::to_string(frame.index) +
                         ": the depth image is empty; nothing is found there, nor missed");
  }
  scene.timestamp.set(frame.time_ns);
  scene.time_assumed.set(info.time_assumed);
  scene.frame_index.set(frame.index);
  scene.frame_name.set(frame.name);
  scene.recording.set(std::filesystem::path(info.path).lexically_normal().filename().string());
  types::set_cameras(facade, frame.camera);
  types::set_view_image(facade, types::SceneCas::kDepth, frame.depth);
  if (!frame.color.empty()) types::set_view_image(facade, types::SceneCas::kColor, frame.color);
  std::optional<Isometry3d> pose = assumed_pose_;
  if (!pose && frame.map_from_camera) pose = map_from_poses_ * *frame.map_from_camera;
  if (pose) {
    const std::string map_frame = map_frame_.empty() ? info.map_frame : map_frame_;
    scene.map_from_camera.set(types::to_stamped(cas, *pose, map_frame, "depth_camera", frame.time_ns));
  } else {
    facade.log("RecordingReader", "warning", "the pose of the camera is not known");
    context.warnings.add("frame " + std::to_string(frame.index) + " has no pose: it is left out of the map");
  }
  if (!frame.joints.empty()) set_joints(scene, frame.joints);
}

}  // namespace loci::perception
