#include "mapping/orthophoto/face_points.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/orthophoto/parameters.h"

namespace loci::mapping {
namespace {

/// Depths of the columns of a face in one frame; unset where it shows too little.
using Profile = std::vector<std::optional<double>>;

size_t columns_of(const FurnitureFace& face) {
  return static_cast<size_t>((face.u_max - face.u_min) / kSteps.column_m);
}

Profile profile_of(const std::vector<FacePoint>& points, const FurnitureFace& face) {
  std::vector<std::vector<double>> depths(columns_of(face));
  for (const FacePoint& point : points)
    if (const auto column = static_cast<size_t>((point.u - face.u_min) / kSteps.column_m);
        column < depths.size())
      depths[column].push_back(point.depth);
  Profile profile(depths.size());
  for (size_t i = 0; i < depths.size(); ++i)
    if (depths[i].size() >= kSteps.min_points) profile[i] = median(std::move(depths[i]));
  return profile;
}

/// Median depth of the `kSteps.reach` columns from `first` on; unset where one is missing.
std::optional<double> level_at(const Profile& profile, size_t first) {
  std::vector<double> depths;
  for (size_t i = first; i < first + kSteps.reach; ++i) {
    if (!profile[i]) return std::nullopt;
    depths.push_back(*profile[i]);
  }
  return median(std::move(depths));
}

/// How much farther towards the observer the surface is from a column on than before it: the median over the
/// frames that show both sides, 0 where they are few.
double step_at(const std::vector<Profile>& profiles, size_t column) {
  std::vector<double> steps;
  for (const Profile& profile : profiles) {
    const auto before = level_at(profile, column - kSteps.reach), after = level_at(profile, column);
    if (before && after) steps.push_back(*after - *before);
  }
  return steps.size() < kSteps.min_frames ? 0 : median(std::move(steps));
}

/// Columns at which steps are, each where it is largest.
std::vector<size_t> steps_of(const std::vector<Profile>& profiles, size_t columns) {
  std::vector<size_t> steps;
  std::vector<double> sizes(columns + 1, 0);
  for (size_t i = kSteps.reach; i + kSteps.reach <= columns; ++i) sizes[i] = std::abs(step_at(profiles, i));
  for (size_t i = kSteps.reach; i + kSteps.reach <= columns; ++i) {
    const auto begin = sizes.begin() + static_cast<std::ptrdiff_t>(i - kSteps.reach),
               end = sizes.begin() + static_cast<std::ptrdiff_t>(std::min(i + kSteps.reach, columns) + 1);
    if (sizes[i] < kSteps.min_step_m || sizes[i] < *std::max_element(begin, end)) continue;
    if (steps.empty() || i - steps.back() > kSteps.reach) steps.push_back(i);
  }
  return steps;
}

/// Where the frames have the columns [first, last), in the median.
double level_of(const std::vector<Profile>& profiles, size_t first, size_t last) {
  std::vector<double> depths;
  for (const Profile& profile : profiles)
    for (size_t i = first; i < last; ++i)
      if (profile[i]) depths.push_back(*profile[i]);
  return depths.empty() ? 0 : median(std::move(depths));
}

}  // namespace

Isometry3d face_from_camera(const FurnitureFace& face, const Isometry3d& map_from_camera) {
  Isometry3d face_from_map = Isometry3d::Identity();
  face_from_map.linear().row(0) = face.right3().transpose();
  face_from_map.linear().row(1) = Vector3d::UnitZ().transpose();
  face_from_map.linear().row(2) = face.normal3().transpose();
  face_from_map.translation().z() = -face.offset;
  return face_from_map * map_from_camera;
}

std::vector<FacePoint> points_near(const RgbdFrame& frame, const Isometry3d& face_from_camera,
                                   const FurnitureFace& face) {
  std::vector<FacePoint> points;
  for (int y = 0; y < frame.depth.rows; y += kPhoto.fit_step_px)
    for (int x = 0; x < frame.depth.cols; x += kPhoto.fit_step_px) {
      const auto z = static_cast<double>(frame.depth.at<float>(y, x));
      if (!(z > 0 && z < kPhoto.max_range_m)) continue;
      const Vector3d at = face_from_camera * frame.camera.depth.unproject(x, y, z);
      if (at.x() > face.u_min && at.x() < face.u_max && at.y() > face.v_min && at.y() < face.v_max &&
          std::abs(at.z()) < kPhoto.max_drift_m + kPhoto.fit_reach_m)
        points.push_back({at.x(), at.y(), at.z()});
    }
  return points;
}

std::vector<FurnitureFace> divided_at_steps(const Recording& recording,
                                            const std::vector<std::optional<Isometry3d>>& map_from_camera,
                                            const FurnitureFace& face, int threads) {
  const size_t columns = columns_of(face);
  if (columns < 2 * kSteps.reach) return {face};
  std::vector<size_t> frames;
  for (size_t i = 0; i < map_from_camera.size(); ++i) {
    if (!map_from_camera[i]) continue;
    const Isometry3d camera_from_face = face_from_camera(face, *map_from_camera[i]).inverse();
    const Vector3d at =
        camera_from_face * Vector3d((face.u_min + face.u_max) / 2, (face.v_min + face.v_max) / 2, 0);
    if (at.z() > 0 && at.z() < kPhoto.max_range_m) frames.push_back(i);
  }
  const size_t stride = std::max<size_t>(1, frames.size() / kPhoto.max_frames);
  std::vector<Profile> profiles((frames.size() + stride - 1) / stride);
  parallel_each(profiles.size(), threads, [&](size_t i) {
    const size_t frame = frames[i * stride];
    profiles[i] = profile_of(
        points_near(recording.frame(frame), face_from_camera(face, *map_from_camera[frame]), face), face);
  });
  std::vector<size_t> ends = steps_of(profiles, columns);
  if (ends.empty()) return {face};
  ends.push_back(columns);
  std::vector<FurnitureFace> parts;
  for (size_t i = 0, first = 0; i < ends.size(); first = ends[i++]) {
    FurnitureFace part = face;
    part.u_min = face.u_min + static_cast<double>(first) * kSteps.column_m;
    if (i + 1 < ends.size()) part.u_max = face.u_min + static_cast<double>(ends[i]) * kSteps.column_m;
    part.offset += level_of(profiles, first, ends[i]);
    part.area *= (part.u_max - part.u_min) / (face.u_max - face.u_min);
    parts.push_back(part);
  }
  return parts;
}

}  // namespace loci::mapping
