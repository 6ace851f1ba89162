#include "memory/belief/evidence/visibility.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/polygon.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

enum class RayResult { out_of_view, hidden, unmeasured, occupied, seen_through };

struct Ray {
  RayResult result = RayResult::out_of_view;
  int label = -1;  ///< of the pixel, where the place is occupied
};

float depth_at(const cv::Mat& depth, const Vector2d& pixel) {
  const int u = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, depth.cols - 1);
  const int v = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, depth.rows - 1);
  return depth.at<float>(v, u);
}

/// Depths at which the line of sight to `point` (camera frame) enters and leaves a box given in the map
/// frame.
std::pair<double, double> depth_interval(const SceneView& view, const Vector3d& point, const AxisBox& box) {
  const Vector3d origin = view.map_from_camera.translation();
  const Vector3d direction = view.map_from_camera.linear() * (point / point.z());  // one metre of depth
  double enter = -1e9, leave = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) continue;
    double first = (box.low()[axis] - origin[axis]) / direction[axis];
    double second = (box.high()[axis] - origin[axis]) / direction[axis];
    if (first > second) std::swap(first, second);
    enter = std::max(enter, first);
    leave = std::min(leave, second);
  }
  return {enter, std::max(enter, leave)};
}

/// Casts the line of sight to a point of the box.
Ray cast(const SceneView& view, const Isometry3d& camera_from_map, const Vector3d& map_point,
         const AxisBox& box, const VisibilityOptions& options) {
  const Vector3d point = camera_from_map * map_point;
  if (point.z() < view.near_m || point.z() > view.far_m) return {};
  const Vector2d pixel = view.camera.project(point);
  if (!view.camera.contains(pixel)) return {};
  const auto [enter, leave] = depth_interval(view, point, box);
  const double tolerance = options.tolerance_m + options.tolerance_per_m2 * point.z() * point.z();
  if (!view.map_depth.empty()) {
    const double map_depth = depth_at(view.map_depth, pixel);
    // Drawer fronts and walls occlude even where the sensor has no measurement.
    if (std::isfinite(map_depth) && map_depth < enter - 2 * tolerance) return {RayResult::hidden, -1};
  }
  const double measured = depth_at(view.depth, pixel);
  if (!std::isfinite(measured)) return {RayResult::unmeasured, -1};
  if (measured < enter - tolerance) return {RayResult::hidden, -1};
  if (measured > leave + tolerance / 2) return {RayResult::seen_through, -1};
  int label = -1;
  if (!view.labels.empty()) {
    label =
        view.labels.at<int>(std::clamp(static_cast<int>(std::lround(pixel.y())), 0, view.labels.rows - 1),
                            std::clamp(static_cast<int>(std::lround(pixel.x())), 0, view.labels.cols - 1));
  }
  return {RayResult::occupied, label};
}

/// The part of a box that the object's body must occupy, without its corners and its footing.
AxisBox core_of(const AxisBox& box, const VisibilityOptions& options) {
  AxisBox core = box;
  core.size.x() *= options.core;
  core.size.y() *= options.core;
  const double lift = std::min(kParameters.footing_m, kParameters.footing_share * box.size.z());
  core.size.z() -= lift;
  core.centre.z() += lift / 2;
  return core;
}

/// Share of what is in the image that the detector searched.
double searched_part(const SceneView& view, const std::string& place) {
  if (!view.observed || place.empty()) return view.has_camera ? kParameters.unobstructed : 0.0;
  for (const ObservedPlace& observed : *view.observed)
    if (observed.name == place) return observed.fraction;
  return 0.0;
}

bool lies_in(const AxisBox& box, const Vector3d& point) {
  return (point.array() >= box.low().array()).all() && (point.array() <= box.high().array()).all();
}

/// Whether a box intersects the line from the camera to a point.
bool occludes(const SceneView& view, const AxisBox& box, const Vector3d& camera_point) {
  const auto [enter, leave] = depth_interval(view, camera_point, box);
  return enter < leave && enter > 0 && leave < camera_point.z();
}

double share_at(int i, int steps) {
  return steps > 1 ? double(i) / double(steps - 1) - 0.5 : 0.0;
}

}  // namespace

BoxVisibility box_visibility(const SceneView& view, const AxisBox& box, double sigma, size_t observations,
                             const VisibilityOptions& options) {
  BoxVisibility result;
  result.occupied_by.assign(view.labels.empty() ? 0 : observations, 0.0);
  const Isometry3d camera_from_map = view.map_from_camera.inverse();
  const AxisBox core = core_of(box, options);
  std::vector<Vector3d> offsets = {Vector3d::Zero()};
  if (sigma > kParameters.min_sigma_m)
    for (int axis = 0; axis < 2; ++axis)
      for (const double side : {-sigma, sigma}) offsets.push_back(side * Vector3d::Unit(axis));
  const int n = options.steps;
  const double one = 1.0 / (double(n) * n * n * double(offsets.size()));
  for (const Vector3d& offset : offsets) {
    AxisBox moved = core;
    moved.centre += offset;
    for (int i = 0; i < n * n * n; ++i) {
      const Vector3d share(share_at(i % n, n), share_at(i / n % n, n), share_at(i / (n * n), n));
      const Ray ray =
          cast(view, camera_from_map, moved.centre + moved.size.cwiseProduct(share), moved, options);
      switch (ray.result) {
        case RayResult::out_of_view:
          result.visibility.out_of_view += one;
          break;
        case RayResult::hidden:
          result.visibility.hidden += one;
          break;
        case RayResult::unmeasured:
          result.visibility.unmeasured += one;
          break;
        case RayResult::seen_through:
          result.visibility.seen_through += one;
          break;
        case RayResult::occupied:
          result.visibility.occupied += one;
          if (ray.label >= 0 && static_cast<size_t>(ray.label) < result.occupied_by.size())
            result.occupied_by[static_cast<size_t>(ray.label)] += one;
          break;
      }
    }
  }
  return result;
}

BoxVisibility box_visibility_without_depth(const SceneView& view, const AxisBox& box, double sigma,
                                           const std::string& place, const std::vector<Observation>& found,
                                           const VisibilityOptions& options) {
  BoxVisibility result;
  result.occupied_by.assign(found.size(), 0.0);
  const double part = searched_part(view, place);
  if (part <= 0) {
    result.visibility.out_of_view = 1;
    return result;
  }
  const Isometry3d camera_from_map = view.map_from_camera.inverse();
  AxisBox core = core_of(box, options);
  core.size.head<2>().array() +=
      2 * std::sqrt(3.0) * sigma;  // as wide as the uniform distribution of that sigma
  const int n = options.steps;
  const double one = 1.0 / (double(n) * n * n);
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3d share(share_at(i % n, n), share_at(i / n % n, n), share_at(i / (n * n), n));
    const Vector3d point = core.centre + core.size.cwiseProduct(share);
    const auto there = std::find_if(found.begin(), found.end(), [&](const Observation& observation) {
      return observation.has_size && lies_in(observation.box, point);
    });
    if (there != found.end()) {
      result.visibility.occupied += one;
      result.occupied_by[static_cast<size_t>(there - found.begin())] += one;
      continue;
    }
    const Vector3d seen = camera_from_map * point;
    const bool in_image =
        seen.z() >= view.near_m && seen.z() <= view.far_m && view.camera.contains(view.camera.project(seen));
    if (view.has_camera && !in_image) {
      result.visibility.out_of_view += one;
    } else if (view.has_camera && std::any_of(found.begin(), found.end(), [&](const Observation& o) {
                 return o.has_size && occludes(view, o.box, seen);
               })) {
      result.visibility.hidden += one;
    } else {
      result.visibility.searched += one * part;
      result.visibility.unmeasured += one * (1 - part);
    }
  }
  return result;
}

Visibility visibility_of(const SceneView& view, const AxisBox& box, double sigma,
                         const VisibilityOptions& options) {
  return box_visibility(view, box, sigma, 0, options).visibility;
}

double undetectable(const Visibility& visibility, double seconds) {
  const double apart = std::clamp(2 * seconds - 1, 0.0, 1.0);  // from half a second to a second on
  const double least = std::lerp(kParameters.min_detectable_in_video, kParameters.min_detectable, apart),
               range = std::lerp(kParameters.detectable_range_in_video, kParameters.detectable_range, apart);
  const double visible = (visibility.observed() - least) / range;
  return 1.0 - std::clamp(visible, 0.0, 1.0);
}

double resolved(const SceneView& view, const Isometry3d& map_from_camera, const AxisBox& box) {
  const Vector3d line = box.centre - map_from_camera.translation();
  const double depth = line.dot(map_from_camera.linear().col(2));
  if (depth <= 0) return 1;
  // The silhouette of a box is that of the faces it turns to the camera.
  const Vector3d faces(box.size.y() * box.size.z(), box.size.x() * box.size.z(), box.size.x() * box.size.y());
  const double silhouette = line.normalized().cwiseAbs().dot(faces);
  const double pixels = kParameters.filled_silhouette * silhouette * view.camera.fx * view.camera.fy /
                        (depth * depth) * view.sensor_pixels;
  return 1 /
         (1 + std::pow(kParameters.resolved_pixels / std::max(1.0, pixels), kParameters.resolved_steepness));
}

double observed_fraction(const SceneView& view, const std::vector<Vector3d>& outline, double step_m,
                         const VisibilityOptions& options) {
  if (outline.size() < 3) return 0.0;
  Vector3d low = outline.front(), high = outline.front();
  for (const Vector3d& corner : outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  Polygon plan;
  for (const Vector3d& corner : outline) plan.emplace_back(corner.head<2>());
  const Isometry3d camera_from_map = view.map_from_camera.inverse();
  const int columns = std::max(1, static_cast<int>((high.x() - low.x()) / step_m));
  const int rows = std::max(1, static_cast<int>((high.y() - low.y()) / step_m));
  size_t total = 0, seen = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vector3d point(low.x() + (column + 0.5) * (high.x() - low.x()) / columns,
                           low.y() + (row + 0.5) * (high.y() - low.y()) / rows, (low.z() + high.z()) / 2);
      if (!contains(plan, point.head<2>())) continue;
      ++total;
      // A slab from just below the surface to above the footing of objects: an object on the place occludes
      // the spot under it and yet shows what is there, so both count as observed.
      const AxisBox slab{point + Vector3d(0, 0, 0.05), Vector3d(step_m, step_m, 0.14)};
      const RayResult result = cast(view, camera_from_map, point, slab, options).result;
      seen += result == RayResult::occupied || result == RayResult::seen_through ? 1 : 0;
    }
  }
  return total == 0 ? 0.0 : double(seen) / double(total);
}

}  // namespace loci::memory::belief
