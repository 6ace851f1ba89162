#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "memory/belief/belief.h"
#include "memory/belief/serialization.h"

namespace loci::memory::belief {

/// A box-shaped object on a table, for scenes with known truth.
struct SyntheticObject {
  std::string name;
  Vector3d centre = Vector3d::Zero();
  Vector3d size = Vector3d(0.08, 0.08, 0.1);
  std::vector<float> color = {0.8F, 0.2F, 0.2F};
  bool detected = true;  ///< whether the cluster extraction finds it
};

/// A table top at z = 0.7 and a camera that looks down at it; measures depth exactly by intersecting rays
/// with boxes.
class SyntheticKitchen {
 public:
  std::vector<SyntheticObject> objects;
  mapping::PinholeCamera camera{320, 240, 290, 290, 160, 120};
  Isometry3d map_from_camera = look_from({0, -1.0, 1.4}, {0, 0, 0.72});

  /// A camera at `from` that looks at `at`, its image upright.
  static Isometry3d look_from(const Vector3d& from, const Vector3d& at) {
    const Vector3d forward = (at - from).normalized();
    const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
    Isometry3d pose = Isometry3d::Identity();
    pose.linear().col(0) = right;
    pose.linear().col(1) = forward.cross(right);
    pose.linear().col(2) = forward;
    pose.translation() = from;
    return pose;
  }

  static Vector3d on_table(double x, double y, double height = 0.1) { return {x, y, 0.7 + height / 2}; }

  SyntheticObject& object(const std::string& name) {
    for (SyntheticObject& o : objects)
      if (o.name == name) return o;
    throw Error("no such object: " + name);
  }

  /// What is measured and found at `seconds` after the epoch. Objects of which less than a tenth of the
  /// pixels are visible are not found.
  Scene scene(double seconds, std::optional<double> to_next = {}) const {
    Scene scene;
    scene.time = static_cast<TimeNs>(seconds * 1e9);
    scene.seconds_to_next = to_next;
    scene.view.camera = camera;
    scene.view.map_from_camera = map_from_camera;
    scene.view.depth = cv::Mat(camera.height, camera.width, CV_32F, std::numeric_limits<float>::quiet_NaN());
    scene.view.labels = cv::Mat(camera.height, camera.width, CV_32S, cv::Scalar(-1));
    std::vector<int> pixels(objects.size(), 0), alone(objects.size(), 0);
    std::vector<bool> cut(objects.size(), false);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) measure(u, v, scene.view, pixels, alone, cut);
    std::vector<int> label_of(objects.size(), -1);
    for (size_t i = 0; i < objects.size(); ++i) {
      if (!objects[i].detected || pixels[i] < 15 || pixels[i] < alone[i] / 10) continue;
      label_of[i] = static_cast<int>(scene.observations.size());
      Observation o;
      o.id = next_observation++;
      o.box = {objects[i].centre, objects[i].size};
      o.range = (map_from_camera.inverse() * objects[i].centre).z();
      o.partial = cut[i] || pixels[i] < alone[i] * 8 / 10;
      o.points = pixels[i];
      o.place = "table_1";
      o.descriptors = {
          {"mean_color", objects[i].color},
          {"extents", {float(objects[i].size.x()), float(objects[i].size.y()), float(objects[i].size.z())}}};
      scene.observations.push_back(o);
    }
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        int& label = scene.view.labels.at<int>(v, u);
        if (label >= 0) label = label_of[size_t(label)];
      }
    return scene;
  }

 private:
  void measure(int u, int v, SceneView& view, std::vector<int>& pixels, std::vector<int>& alone,
               std::vector<bool>& cut) const {
    const Vector3d origin = map_from_camera.translation();
    const Vector3d ray = map_from_camera.linear() * camera.unproject(u, v, 1.0);
    double depth = std::numeric_limits<double>::infinity();
    int who = -1;
    if (ray.z() < 0) depth = (0.7 - origin.z()) / ray.z();  // the table has no edges
    for (size_t i = 0; i < objects.size(); ++i) {
      double enter = 0, leave = 1e9;
      for (int axis = 0; axis < 3; ++axis) {
        const double low = objects[i].centre[axis] - objects[i].size[axis] / 2;
        const double high = low + objects[i].size[axis];
        const double a = (low - origin[axis]) / ray[axis], b = (high - origin[axis]) / ray[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter >= leave) continue;
      ++alone[i];
      if (u == 0 || v == 0 || u == camera.width - 1 || v == camera.height - 1) cut[i] = true;
      if (enter < depth) {
        depth = enter;
        who = static_cast<int>(i);
      }
    }
    if (who >= 0) ++pixels[size_t(who)];
    if (std::isfinite(depth)) view.depth.at<float>(v, u) = static_cast<float>(depth);
    view.labels.at<int>(v, u) = who;
  }

  mutable int64_t next_observation = 1;
};

/// Key points of a print, on the side that the camera sees.
inline Texture print_on(const AxisBox& box, uint64_t seed) {
  Random random(seed);
  Texture texture(40);
  for (SurfaceKeypoint& keypoint : texture) {
    const Vector3d share(random.uniform(-0.5, 0.5), -0.5, random.uniform(-0.5, 0.5));
    keypoint.position = (box.centre + box.size.cwiseProduct(share)).cast<float>();
    keypoint.diameter_m = 0.02F;
    for (uint8_t& byte : keypoint.descriptor) byte = static_cast<uint8_t>(random.index(256));
  }
  return texture;
}

/// Kinds of the events of an update, with the object: "moved 2".
inline std::vector<std::string> events(const BeliefUpdate& update) {
  std::vector<std::string> texts;
  for (const Event& event : update.events)
    texts.push_back(std::string(to_text(event.kind)) + " " + std::to_string(event.object));
  return texts;
}

/// A belief as bytes: the common part, then the objects.
inline std::vector<std::string> stored(const BeliefState& state) {
  std::vector<std::string> bytes = {to_bytes(state)};
  for (const ProtoObject& object : state.objects) bytes.push_back(to_bytes(object));
  return bytes;
}

inline BeliefState restored(const std::vector<std::string>& bytes) {
  BeliefState state = state_from_bytes(bytes.front());
  for (size_t i = 1; i < bytes.size(); ++i) state.objects.push_back(object_from_bytes(bytes[i]));
  return state;
}

}  // namespace loci::memory::belief
