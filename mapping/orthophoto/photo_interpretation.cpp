#include "mapping/orthophoto/photo_interpretation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/base/math/tally.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/text.h"
#include "mapping/interpretation/fronts/fixtures.h"
#include "mapping/interpretation/fronts/fronts.h"
#include "mapping/interpretation/fronts/ribs.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/interpretation/furniture/prior_joints.h"
#include "mapping/orthophoto/face_points.h"
#include "mapping/orthophoto/parameters.h"
#include "mapping/orthophoto/photo_fronts.h"

namespace loci::mapping {
namespace {

/// Pose of each frame in the map; unset without pose or colour, which a note says. Error when fewer than a
/// tenth have both.
std::vector<std::optional<Isometry3d>> poses_of(const Recording& recording, InterpretedMap& map,
                                                int threads) {
  const Isometry3d map_from_recording = map.semantics.map_from_input.value_or(Isometry3d::Identity());
  std::vector<std::optional<Isometry3d>> poses(recording.size());
  std::vector<std::pair<Reason, std::string>> left_out(recording.size());
  parallel_each(recording.size(), threads, [&](size_t i) {
    const RgbdFrame frame = recording.frame(i);
    if (!frame.map_from_camera)
      left_out[i].first = Reason::no_pose;
    else if (frame.color.empty())
      left_out[i] = {frame.damage.empty() ? Reason::no_color : Reason::damaged, frame.damage};
    else
      poses[i] = map_from_recording * *frame.map_from_camera;
  });
  Tally frames;
  for (size_t i = 0; i < poses.size(); ++i)
    poses[i] ? frames.add_used() : frames.add(left_out[i].first, left_out[i].second);
  if (!frames.usable())
    throw Error(fmt::format("only {} of {} have both a pose and a colour image: {}", frames.used(),
                            counted(frames.total(), "frame"), frames.reasons()),
                {recording.info().path, 0, {}},
                "interpret the scans without --recording, or estimate the poses with loci-map track");
  if (const std::string reasons = frames.reasons(); !reasons.empty())
    map.notes.push_back(
        fmt::format("orthophotos are made of {} of {} frames: {}", frames.used(), frames.total(), reasons));
  return poses;
}

/// Whether a front is on a face: nearly in its plane and within its extent.
bool is_on(const FurnitureFace& face, const Front& front) {
  const Vector3d at = face.coordinates(front.centre);
  return face.normal3().dot(front.normal) > kFaces.parallel_cosine &&
         std::abs(at.z()) < kFronts.same_wall_m && at.x() > face.u_min && at.x() < face.u_max &&
         at.y() > face.v_min - kFronts.same_wall_m && at.y() < face.v_max + kFronts.same_wall_m;
}

/// Whether one of two fronts in one plane has the middle of the other, or their fixtures are one.
bool same_furniture(const Front& a, const Front& b) {
  const Vector3d apart = a.centre - b.centre;
  if (a.normal.dot(b.normal) < kFaces.parallel_cosine || std::abs(b.normal.dot(apart)) > kFronts.same_wall_m)
    return false;
  return (std::abs(b.right().dot(apart)) < std::max(a.width, b.width) / 2 &&
          std::abs(b.up.dot(apart)) < std::max(a.height, b.height) / 2) ||
         (a.fixture && b.fixture &&
          (a.fixture->centre - b.fixture->centre).norm() < kPhotoFronts.same_fixture_m);
}

/// Errors of depth divide a face into planes a few centimetres apart: whether a larger one covers most of it.
bool is_part_of_larger(const FurnitureFace& face, const std::vector<FurnitureFace>& faces) {
  const auto overlap = [](double a0, double a1, double b0, double b1) {
    return std::max(0.0, std::min(a1, b1) - std::max(a0, b0));
  };
  return std::any_of(faces.begin(), faces.end(), [&](const FurnitureFace& other) {
    const double extent = (face.u_max - face.u_min) * (face.v_max - face.v_min);
    return !other.wall && other.area > face.area && face.normal.dot(other.normal) > kFaces.parallel_cosine &&
           std::abs(face.offset - other.offset) < kPhoto.same_face_m &&
           overlap(face.u_min, face.u_max, other.u_min, other.u_max) *
                   overlap(face.v_min, face.v_max, other.v_min, other.v_max) >
               kPhoto.same_face_cover * extent;
  });
}

/// The planes of furniture of which orthophotos are made.
std::vector<FurnitureFace> photographed_planes(const Recording& recording,
                                               const std::vector<std::optional<Isometry3d>>& poses,
                                               const std::vector<FurnitureFace>& faces, int threads) {
  std::vector<FurnitureFace> planes;
  for (const FurnitureFace& face : faces) {
    if (face.wall || face.area < kPhoto.min_area_m2 || is_part_of_larger(face, faces)) continue;
    for (const FurnitureFace& part : divided_at_steps(recording, poses, face, threads))
      if (part.area >= kPhoto.min_area_m2) planes.push_back(part);
  }
  return planes;
}

/// Appends fronts, but for those of which a better one is there.
void unite(std::vector<Front>& fronts, const std::vector<Front>& more) {
  for (const Front& front : more)
    if (std::none_of(fronts.begin(), fronts.end(),
                     [&](const Front& other) { return same_furniture(front, other); }))
      fronts.push_back(front);
}

/// A handle or knob that many points show.
bool is_certain(const Front& front) {
  return front.fixture && front.fixture->confidence >= kFronts.min_wall_fixture_confidence;
}

/// Relief along a fixture where the frames show it: the median along it of the largest across it; NaN where
/// the frames measured too little.
double relief_along(const Orthophoto& photo, const Fixture& fixture) {
  std::vector<float> along;
  const bool knob = fixture.kind == Fixture::Kind::knob;
  const int steps = knob ? 0 : std::max(1, static_cast<int>(fixture.length / 2 / photo.pixel_m));
  const int reach = static_cast<int>(std::lround((fixture.radius + kRangeSigma) / photo.pixel_m));
  for (int i = -steps; i <= steps; ++i) {
    const Vector3d point =
        fixture.centre + (knob ? 0.0 : i * fixture.length / (2 * steps + 1)) * fixture.axis;
    const Vector2d at = photo.seen_at(point);
    const cv::Point pixel(static_cast<int>(std::lround(photo.column(at.x()))),
                          static_cast<int>(std::lround(photo.row(at.y()))));
    const cv::Rect around = cv::Rect(pixel.x - reach, pixel.y - reach, 2 * reach + 1, 2 * reach + 1) &
                            cv::Rect({}, photo.relief.size());
    if (around.empty()) continue;
    cv::Mat relief = photo.relief(around).clone();
    cv::patchNaNs(relief, -1);
    double largest = -1;
    cv::minMaxLoc(relief, nullptr, &largest);
    if (largest > -1) along.push_back(static_cast<float>(largest));
  }
  if (along.size() <= static_cast<size_t>(steps)) return std::nan("");
  return static_cast<double>(median(std::move(along)));
}

/// Whether the depths of the frames show the face where a fixture should stand.
bool is_refuted(const Orthophoto& photo, const Fixture& fixture) {
  return relief_along(photo, fixture) < kBars.min_relief_m;
}

/// Handles and knobs on the face of a photo that many points of the scans show.
std::vector<Fixture> known_fixtures(const std::vector<Front>& from_scans, const Orthophoto& photo) {
  std::vector<Fixture> known;
  for (const Front& front : from_scans)
    if (is_on(photo.face, front) && is_certain(front)) known.push_back(*front.fixture);
  return known;
}

/// The fronts of all faces; of those from scans the ones that have a certain fixture which no photo refutes,
/// and those without one where no photo shows their face.
std::vector<Front> all_fronts(std::vector<Front> from_scans, const std::vector<PhotographedFace>& faces,
                              const std::vector<Fixture>& ribs) {
  std::vector<Front> photographed;
  for (const PhotographedFace& face : faces)
    photographed.insert(photographed.end(), face.fronts.begin(), face.fronts.end());
  // Two faces may show the same furniture.
  std::stable_sort(photographed.begin(), photographed.end(),
                   [](const Front& a, const Front& b) { return a.confidence > b.confidence; });
  std::vector<Front> all;
  unite(all, photographed);
  for (Front& front : all) set_prior_joint(front);
  std::erase_if(from_scans, [&](const Front& front) {
    if (front.fixture && !is_certain(front)) return true;
    return std::any_of(faces.begin(), faces.end(), [&](const PhotographedFace& one) {
      return is_on(one.photo.face, front) && (!front.fixture || is_refuted(one.photo, *front.fixture));
    });
  });
  unite(all, from_scans);
  std::erase_if(all, [&](const Front& front) { return is_of_ribs(front, ribs); });
  drop_side_panels(all);
  follow_neighbours(all);
  return all;
}

/// The orthophoto with its rows level in the map.
FacePhoto level_photo(const Orthophoto& photo) {
  FacePhoto level{photo.face, photo.pixel_m, photo.u0, photo.v0, photo.color};
  if (photo.roll == 0) return level;
  cv::Mat from(photo.color.size(), CV_32FC2);
  for (int row = 0; row < from.rows; ++row)
    for (int column = 0; column < from.cols; ++column) {
      const Vector2d at = photo.turned({photo.u(column), photo.v(row)});
      from.at<cv::Vec2f>(row, column) = {static_cast<float>(photo.column(at.x())),
                                         static_cast<float>(photo.row(at.y()))};
    }
  level.color.release();
  cv::remap(photo.color, level.color, from, cv::noArray(), cv::INTER_LINEAR);
  return level;
}

}  // namespace

std::vector<PhotographedFace> interpret_photos(const Recording& recording, int threads, Progress& progress,
                                               InterpretedMap& map) {
  Stopwatch watch;
  const std::vector<std::optional<Isometry3d>> poses = poses_of(recording, map, threads);
  progress.check(0.1, "orthophotos");
  std::vector<PhotographedFace> faces;
  std::vector<Fixture> ribs = map.ribs;
  const std::vector<FurnitureFace> planes = photographed_planes(recording, poses, map.faces, threads);
  for (size_t i = 0; i < planes.size(); ++i) {
    PhotographedFace one{make_orthophoto(recording, poses, planes[i], threads), {}};
    PhotoFrontSearch found = find_photo_fronts(one.photo, known_fixtures(map.fronts, one.photo));
    one.fronts = std::move(found.fronts);
    ribs.insert(ribs.end(), found.ribs.begin(), found.ribs.end());
    one.photo.drop_evidence();
    if (!one.photo.frames.empty()) {
      map.photos.push_back(level_photo(one.photo));
      faces.push_back(std::move(one));
    }
    progress.check(0.1 + 0.9 * static_cast<double>(i + 1) / static_cast<double>(planes.size()),
                   "orthophotos");
  }
  replace_fronts(all_fronts(map.fronts, faces, ribs), map);
  map.notes.push_back(fmt::format("fronts were taken from the orthophotos of {} faces", faces.size()));
  map.times.push_back({"orthophotos", watch.lap()});
  return faces;
}

cv::Mat drawn(const PhotographedFace& face) {
  const Orthophoto& photo = face.photo;
  cv::Mat image = photo.color.clone(), relief;
  photo.relief.convertTo(relief, CV_8U, 255 / 0.1, 128);
  cv::cvtColor(relief, relief, cv::COLOR_GRAY2BGR);
  const auto pixel = [&](const Vector3d& point) {
    const Vector2d at = photo.seen_at(point);
    return cv::Point(static_cast<int>(std::lround(photo.column(at.x()))),
                     static_cast<int>(std::lround(photo.row(at.y()))));
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
