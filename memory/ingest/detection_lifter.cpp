#include "memory/ingest/detection_lifter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/world/urdf.h"
#include "memory/recorder/observation_pixels.h"

namespace loci::memory {
namespace {

constexpr TimeNs kMaxTimeOff = kSecond / 20;

/// Hue 0 to 360, saturation and value 0 to 1 of the mean colour of the pixels; unset where they have none.
std::optional<Vector3d> mean_color(const std::vector<int>& pixels, const perception::LiftFrame& frame,
                                   const cv::Mat& color) {
  cv::Vec3d sum(0, 0, 0);
  int count = 0;
  for (const int pixel : pixels) {
    const cv::Vec2f& at = frame.in_color.ptr<cv::Vec2f>()[pixel];
    const int u = cvFloor(at[0]), v = cvFloor(at[1]);
    if (u < 0 || v < 0 || u >= color.cols || v >= color.rows) continue;
    sum += cv::Vec3d(color.at<cv::Vec3b>(v, u));
    ++count;
  }
  if (count == 0) return std::nullopt;
  const cv::Mat3f mean(1, 1, cv::Vec3f(sum * (1.0 / (255.0 * count))));
  cv::Mat3f hsv;
  cv::cvtColor(mean, hsv, cv::COLOR_BGR2HSV);
  return Vector3d(static_cast<double>(hsv(0)[0]), static_cast<double>(hsv(0)[1]),
                  static_cast<double>(hsv(0)[2]));
}

/// What the lifted pixels say about a detection; what it says about itself stays.
void describe(const perception::LiftedRegion& lifted, const perception::LiftFrame& lift_frame,
              const mapping::RgbdFrame& frame, Detection& detection) {
  const Isometry3d& pose = *frame.map_from_camera;
  std::vector<Vector3d> points;
  for (const int pixel : lifted.pixels) {
    const cv::Vec3f& p = lift_frame.points.ptr<cv::Vec3f>()[pixel];
    points.push_back(pose * Vector3d(cv::Vec3d(p)[0], cv::Vec3d(p)[1], cv::Vec3d(p)[2]));
  }
  const belief::AxisBox box = robust_box(points);
  detection.position = box.centre;
  detection.has_position = true;
  if (!detection.size) detection.size = box.size.cwiseMax(0.001);
  if (!detection.color && !frame.color.empty())
    detection.color = mean_color(lifted.pixels, lift_frame, frame.color);
  detection.pixels = lifted.pixels;
  detection.at_image_border = lifted.at_image_border;
  for (const perception::KeyPoint3D& point : lifted.key_points)
    detection.lifted_points.push_back({point.name, pose * point.position});
}

std::optional<Reason> useless_because(const std::optional<mapping::RgbdFrame>& frame) {
  if (!frame) return Reason::no_matching_frame;
  if (!frame->map_from_camera) return Reason::no_pose;
  if (!has_depth(*frame)) return frame->damage.empty() ? Reason::no_depth : Reason::damaged;
  return std::nullopt;
}

}  // namespace

DetectionLifter::DetectionLifter(const mapping::Recording& recording, const std::filesystem::path& map,
                                 Warnings& warnings)
    : recording_(recording) {
  if (map.empty()) return;
  world_ = mapping::read_urdf(map);
  part_ = scene_.add(world_, {{}, map.parent_path()}, Isometry3d::Identity(), warnings);
  has_map_ = true;
}

std::optional<size_t> DetectionLifter::frame_at(TimeNs time) const {
  // The first frame that is not earlier, and the one before it.
  size_t low = 0, high = recording_.size();
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (recording_.time_of(middle) < time)
      low = middle + 1;
    else
      high = middle;
  }
  std::optional<size_t> best;
  auto best_off = static_cast<double>(kMaxTimeOff);
  for (const size_t i : {low, low - 1}) {
    if (i >= recording_.size()) continue;
    const double off = std::abs(static_cast<double>(recording_.time_of(i)) - static_cast<double>(time));
    if (off > best_off) continue;
    best_off = off;
    best = i;
  }
  return best;
}

std::optional<Reason> DetectionLifter::lift(DetectedScene& scene) {
  const auto in_image = [](const Detection& one) { return !one.has_position; };
  if (const std::optional<Reason> reason = useless_because(scene.frame)) {
    detections_.add(*reason, static_cast<size_t>(std::ranges::count_if(scene.detections, in_image)));
    std::erase_if(scene.detections, in_image);
    scene.frame.reset();
    return scene.detections.empty() ? reason : std::nullopt;
  }
  mapping::RgbdFrame& frame = *scene.frame;
  render_map(scene);
  const cv::Mat explained =
      scene.map_depth.empty() ? cv::Mat() : perception::explained_by(frame.depth, scene.map_depth);
  const perception::LiftFrame lift_frame =
      perception::lift_frame(frame.depth, frame.camera, explained,
                             Vector3d(frame.map_from_camera->linear().transpose() * Vector3d::UnitZ()));
  std::optional<Reason> reason = Reason::nothing_new;
  for (Detection& detection : scene.detections) {
    if (detection.has_position) continue;
    const perception::LiftResult lifted =
        perception::lift_region(lift_frame, *detection.region, detection.key_points);
    if (lifted.region) {
      describe(*lifted.region, lift_frame, frame, detection);
      detections_.add_used();
      continue;
    }
    detections_.add(lifted.reason);
    reason = lifted.reason;
    // Something is there: that nothing was found there must not count as an empty place.
    for (const int pixel : perception::pixels_in(lift_frame, *detection.region))
      frame.depth.ptr<float>()[pixel] = std::numeric_limits<float>::quiet_NaN();
  }
  std::erase_if(scene.detections, in_image);
  scene.camera = DetectedScene::Camera{frame.map_from_camera, frame.camera.depth, std::nullopt, std::nullopt};
  return scene.detections.empty() ? reason : std::nullopt;
}

void DetectionLifter::render_map(DetectedScene& scene) {
  if (!has_map_) return;
  JointState joints;
  for (const auto& [name, position] : scene.frame->joints)
    if (world_.find_joint(name) != nullptr) joints[name] = position;
  scene_.set_joints(part_, joints);
  scene.map_depth = scene_.render(scene.frame->camera.depth, *scene.frame->map_from_camera).depth;
}

}  // namespace loci::memory
