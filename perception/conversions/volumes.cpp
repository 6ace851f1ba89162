#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math.h"
#include "perception/conversions/hypotheses.h"

namespace loci::perception::types {
namespace {

constexpr double kNear = 0.01;  ///< metres before the camera: what is nearer is cut off

/// Where a volume is in its frame.
struct Extent {
  Isometry3d frame_from_box = Isometry3d::Identity();
  Vector3d half = Vector3d::Zero();
  std::optional<double> radius;  ///< of a sphere
};

Extent extent_of(const TFLinkROI& volume) {
  Extent extent;
  if (const auto sphere = try_as<TFLinkSphereROI>(volume)) {
    extent.frame_from_box.translation() = from<Vector3d>(sphere->center.get());
    extent.radius = sphere->radius.get();
    extent.half = Vector3d::Constant(*extent.radius);
    return extent;
  }
  const BoundingBox box = as<TFLinkBBoxROI>(volume).bbox.get();
  if (!box) throw Error("a volume without its box");
  extent.frame_from_box = from<Isometry3d>(box.pose.get());
  extent.half = from<Vector3d>(box.size.get()) / 2;
  return extent;
}

Vector3d corner(const Vector3d& half, int number) {
  return {number & 1 ? half.x() : -half.x(), number & 2 ? half.y() : -half.y(),
          number & 4 ? half.z() : -half.z()};
}

/// Points whose hull is the outline of the volume before the camera.
std::vector<Vector3d> outline_points(const Extent& extent, const Isometry3d& camera_from_frame) {
  const Isometry3d camera_from_box = camera_from_frame * extent.frame_from_box;
  std::vector<Vector3d> points;
  if (extent.radius) {
    constexpr int kRings = 32;
    for (int ring = 0; ring <= kRings; ++ring)
      for (int step = 0; step < 2 * kRings; ++step) {
        const double polar = kPi * ring / kRings, turn = kPi * step / kRings;
        const Vector3d on(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                          std::cos(polar));
        const Vector3d point = camera_from_box * Vector3d(*extent.radius * on);
        if (point.z() >= kNear) points.push_back(point);
      }
    return points;
  }
  for (int a = 0; a < 8; ++a) {
    const Vector3d one = camera_from_box * corner(extent.half, a);
    if (one.z() >= kNear) points.push_back(one);
    for (const int axis : {1, 2, 4}) {  // The edge to the corner beyond, where it meets the near plane.
      const Vector3d two = camera_from_box * corner(extent.half, a ^ axis);
      if (one.z() >= kNear && two.z() < kNear)
        points.push_back(one + (one.z() - kNear) / (one.z() - two.z()) * (two - one));
    }
  }
  return points;
}

}  // namespace

std::optional<ReferenceImageROI> image_roi(const TFLinkROI& volume, const Mat& image,
                                           const mapping::PinholeCamera& camera,
                                           const Isometry3d& camera_from_frame) {
  std::vector<cv::Point2f> pixels;
  for (const Vector3d& point : outline_points(extent_of(volume), camera_from_frame)) {
    // What is far out of the image stays within what the filling of polygons can count.
    const Vector2d pixel = camera.project(point).cwiseMax(-1e5).cwiseMin(1e5);
    pixels.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  if (pixels.size() < 3) return std::nullopt;
  std::vector<cv::Point2f> hull;
  cv::convexHull(pixels, hull);
  const std::vector<cv::Point> corners(hull.begin(), hull.end());
  cv::Mat1b covered(camera.height, camera.width, uint8_t{0});
  cv::fillConvexPoly(covered, corners, cv::Scalar(255));
  const cv::Rect region = cv::boundingRect(covered);
  if (region.empty()) return std::nullopt;
  const auto roi = ReferenceImageROI::create(volume.cas());
  if (volume.source.is_set()) roi.source.set(volume.source.get());
  roi.image.set(image);
  roi.roi.set(to(volume.cas(), region));
  roi.mask.set(to(volume.cas(), cv::Mat(covered(region).clone())));
  return roi;
}

TFLinkBBoxROI bounding_box(const TFLinkROI& volume, const std::string& frame,
                           const Isometry3d& frame_from_volume) {
  const Extent extent = extent_of(volume);
  const Isometry3d frame_from_box = frame_from_volume * extent.frame_from_box;
  // A sphere is as wide along every axis.
  const Vector3d half =
      extent.radius ? extent.half : Vector3d(frame_from_box.linear().cwiseAbs() * extent.half);
  const auto made = TFLinkBBoxROI::create(volume.cas());
  if (volume.source.is_set()) made.source.set(volume.source.get());
  made.tf_frame.set(frame);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = frame_from_box.translation();
  made.bbox.get_or_create().pose.set(to(volume.cas(), pose));
  made.bbox.get().size.set(to(volume.cas(), Vector3d(2 * half)));
  return made;
}

TFLinkSphereROI bounding_sphere(const TFLinkROI& volume, const std::string& frame,
                                const Isometry3d& frame_from_volume) {
  const Extent extent = extent_of(volume);
  const auto made = TFLinkSphereROI::create(volume.cas());
  if (volume.source.is_set()) made.source.set(volume.source.get());
  made.tf_frame.set(frame);
  made.center.set(to(volume.cas(), Vector3d((frame_from_volume * extent.frame_from_box).translation())));
  made.radius.set(extent.radius.value_or(extent.half.norm()));
  return made;
}

}  // namespace loci::perception::types
