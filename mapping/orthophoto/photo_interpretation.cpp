#include "mapping/orthophoto/photo_interpretation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/orthophoto/parameters.h"
#include "mapping/orthophoto/photo_fronts.h"

namespace loci::mapping {
namespace {

/// Pose of each frame in the map; unset without pose or colour.
std::vector<std::optional<Isometry3d>> poses_of(const Recording& recording, const InterpretedMap& map,
                                                int threads) {
  const Isometry3d map_from_recording = map.semantics.map_from_input.value_or(Isometry3d::Identity());
  std::vector<std::optional<Isometry3d>> poses(recording.size());
  parallel_each(recording.size(), threads, [&](size_t i) {
    const RgbdFrame frame = recording.frame(i);
    if (frame.map_from_camera && !frame.color.empty()) poses[i] = map_from_recording * *frame.map_from_camera;
  });
  if (std::none_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); }))
    throw Error("no frame has both a pose and a colour image", {recording.info().path, 0, {}},
                "interpret the scans without --recording, or estimate the poses with loci-map track");
  return poses;
}

/// Whether a front is on a face: nearly in its plane and within its extent.
bool is_on(const FurnitureFace& face, const Front& front) {
  const Vector3d at = face.coordinates(front.centre);
  return face.normal3().dot(front.normal) > kFaces.parallel_cosine &&
         std::abs(at.z()) < kFronts.same_wall_m && at.x() > face.u_min && at.x() < face.u_max &&
         at.y() > face.v_min - kFronts.same_wall_m && at.y() < face.v_max + kFronts.same_wall_m;
}

/// Drops fronts that overlap a better one of another face: two faces may cover the same furniture.
void drop_duplicates(std::vector<Front>& fronts) {
  std::stable_sort(fronts.begin(), fronts.end(),
                   [](const Front& a, const Front& b) { return a.confidence > b.confidence; });
  std::vector<Front> kept;
  for (Front& front : fronts) {
    const auto covers = [&](const Front& other) {
      const Vector3d apart = front.centre - other.centre;
      return front.normal.dot(other.normal) > kFaces.parallel_cosine &&
             std::abs(other.normal.dot(apart)) < kFronts.same_wall_m &&
             std::abs(other.right().dot(apart)) < std::max(front.width, other.width) / 2 &&
             std::abs(other.up.dot(apart)) < std::max(front.height, other.height) / 2;
    };
    if (std::none_of(kept.begin(), kept.end(), covers)) kept.push_back(std::move(front));
  }
  fronts = std::move(kept);
}

}  // namespace

std::vector<PhotographedFace> interpret_photos(const Recording& recording, int threads, Progress& progress,
                                               InterpretedMap& map) {
  Stopwatch watch;
  const std::vector<std::optional<Isometry3d>> poses = poses_of(recording, map, threads);
  progress.check(0.1, "orthophotos");
  std::vector<PhotographedFace> faces;
  std::vector<Front> fronts;
  for (size_t i = 0; i < map.faces.size(); ++i) {
    const FurnitureFace& face = map.faces[i];
    if (!face.wall && face.area >= kPhoto.min_area_m2) {
      PhotographedFace one{make_orthophoto(recording, poses, face, threads), {}};
      one.fronts = find_photo_fronts(one.photo);
      fronts.insert(fronts.end(), one.fronts.begin(), one.fronts.end());
      if (!one.photo.frames.empty()) faces.push_back(std::move(one));
    }
    progress.check(0.1 + 0.9 * static_cast<double>(i + 1) / static_cast<double>(map.faces.size()),
                   "orthophotos");
  }
  drop_duplicates(fronts);
  for (Front& front : fronts) set_prior_joint(front);
  for (const Front& front : map.fronts)
    if (std::none_of(faces.begin(), faces.end(),
                     [&](const PhotographedFace& one) { return is_on(one.photo.face, front); }))
      fronts.push_back(front);
  replace_fronts(std::move(fronts), map);
  map.notes.push_back(fmt::format("fronts were taken from the orthophotos of {} faces", faces.size()));
  map.times.push_back({"orthophotos", watch.lap()});
  return faces;
}

cv::Mat drawn(const PhotographedFace& face) {
  const Orthophoto& photo = face.photo;
  cv::Mat image = photo.color.clone(), relief;
  photo.relief.convertTo(relief, CV_8U, 255 / 0.1, 128);
  cv::cvtColor(relief, relief, cv::COLOR_GRAY2BGR);
  const Vector2d middle(photo.u(photo.width() / 2.0), photo.v(photo.height() / 2.0));
  const auto pixel = [&](const Vector3d& point) {
    const Vector3d on_face = photo.face.coordinates(point);
    const Vector2d turned = middle + Eigen::Rotation2Dd(photo.roll) * (on_face.head<2>() - middle);
    return cv::Point(static_cast<int>(std::lround(photo.column(turned.x()))),
                     static_cast<int>(std::lround(photo.row(turned.y()))));
  };
  for (cv::Mat* one : {&image, &relief})
    for (const Front& front : face.fronts) {
      const Vector3d half_u = front.width / 2 * front.right(), half_v = front.height / 2 * front.up;
      cv::rectangle(*one, pixel(front.centre - half_u + half_v), pixel(front.centre + half_u - half_v),
                    {0, 255, 0});
      if (!front.fixture) continue;
      const Vector3d half = front.fixture->length / 2 * front.fixture->axis;
      cv::line(*one, pixel(front.fixture->centre - half), pixel(front.fixture->centre + half), {0, 255, 255},
               2);
    }
  cv::vconcat(image, relief, image);
  return image;
}

}  // namespace loci::mapping
