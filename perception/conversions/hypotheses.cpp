#include "perception/conversions/hypotheses.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/math.h"

namespace loci::perception::types {
namespace {

/// x, y, z of any cloud whose points begin with them.
class Positions {
 public:
  explicit Positions(const PointCloud& cloud) {
    if (!cloud) throw Error("a hypothesis without its cloud");
    if (is<NormalMap>(cloud)) throw Error("a map of normals has no positions");
    step_ = static_cast<size_t>(cloud.point_step.get());
    bytes_ = cloud.points.get();
    if (step_ < 3 * sizeof(float) || bytes_.size() % step_ != 0)
      throw Error("a cloud of " + cloud.point_type.get() + " has no positions");
  }

  size_t size() const { return bytes_.size() / step_; }

  std::optional<Vector3d> at(size_t index) const {
    float values[3];
    std::memcpy(values, bytes_.data() + index * step_, sizeof values);
    const Vector3d point(values[0], values[1], values[2]);
    return point.allFinite() ? std::optional(point) : std::nullopt;
  }

 private:
  cas::Buffer<uint8_t> bytes_;
  size_t step_ = 0;
};

template <typename Hypothesis>
Hypothesis made_from(const ObjectHypothesis& origin) {
  const Hypothesis made = Hypothesis::create(origin.cas());
  if (origin.source.is_set()) made.source.set(origin.source.get());
  return made;
}

template <typename Keep>
ReferenceClusterPoints points_that(const ObjectHypothesis& origin, const PointCloud& cloud, Keep keep) {
  const Positions positions(cloud);
  std::vector<int32_t> indices;
  for (size_t i = 0; i < positions.size(); ++i)
    if (const auto point = positions.at(i); point && keep(*point)) indices.push_back(static_cast<int32_t>(i));
  const auto made = made_from<ReferenceClusterPoints>(origin);
  made.cloud.set(cloud);
  made.indices.get_or_create().indices.set(std::move(indices));
  if (const Header header = cloud.header.get()) made.indices.get().header.set(header);
  return made;
}

/// The pixel that a point falls on.
std::optional<cv::Point> pixel_of(const Vector3d& in_camera, const mapping::PinholeCamera& camera) {
  if (in_camera.z() <= 0) return std::nullopt;
  const Vector2d pixel = camera.project(in_camera);
  if (!camera.contains(pixel)) return std::nullopt;
  return cv::Point(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
}

Eigen::AlignedBox3d extent_of(const ClusterPoints& points, const Isometry3d& frame_from_cloud) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : positions_of(points)) box.extend(frame_from_cloud * point);
  if (box.isEmpty()) throw Error("a cluster without points has no extent");
  return box;
}

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

std::vector<Vector3d> positions_of(const ClusterPoints& points) {
  std::vector<Vector3d> found;
  if (const auto alone = try_as<StandaloneClusterPoints>(points)) {
    const Positions positions(alone->cloud.get());
    for (size_t i = 0; i < positions.size(); ++i)
      if (const auto point = positions.at(i)) found.push_back(*point);
    return found;
  }
  const auto reference = as<ReferenceClusterPoints>(points);
  const Positions positions(reference.cloud.get());
  if (!reference.indices.is_set()) return found;
  for (const int32_t index : reference.indices.get().indices.get()) {
    if (index < 0 || static_cast<size_t>(index) >= positions.size())
      throw Error("point " + std::to_string(index) + " of a cloud of " + std::to_string(positions.size()));
    if (const auto point = positions.at(static_cast<size_t>(index))) found.push_back(*point);
  }
  return found;
}

std::optional<ReferenceImageROI> image_roi(const ClusterPoints& points, const Mat& image,
                                           const mapping::PinholeCamera& camera,
                                           const Isometry3d& camera_from_cloud, int reach) {
  const cv::Rect whole(0, 0, camera.width, camera.height);
  cv::Mat1b covered(camera.height, camera.width, uint8_t{0});
  cv::Rect region;
  for (const Vector3d& point : positions_of(points)) {
    const auto pixel = pixel_of(camera_from_cloud * point, camera);
    if (!pixel) continue;
    const cv::Rect square =
        cv::Rect(pixel->x - reach, pixel->y - reach, 2 * reach + 1, 2 * reach + 1) & whole;
    covered(square).setTo(255);
    region = region.empty() ? square : region | square;
  }
  if (region.empty()) return std::nullopt;
  const auto roi = made_from<ReferenceImageROI>(points);
  roi.image.set(image);
  roi.roi.set(to(points.cas(), region));
  roi.mask.set(to(points.cas(), cv::Mat(covered(region))));
  return roi;
}

ReferenceClusterPoints points_in_image(const ImageROI& roi, const PointCloud& cloud,
                                       const mapping::PinholeCamera& camera,
                                       const Isometry3d& camera_from_cloud) {
  const cv::Rect region = from<cv::Rect>(roi.roi.get());
  const cv::Mat1b mask = from<cv::Mat_<uint8_t>>(roi.mask.get());
  if (mask.size() != region.size()) throw Error("the mask of an image region is not of its size");
  return points_that(roi, cloud, [&](const Vector3d& point) {
    const auto pixel = pixel_of(camera_from_cloud * point, camera);
    return pixel && region.contains(*pixel) && mask(*pixel - region.tl()) != 0;
  });
}

ReferenceClusterPoints points_in_volume(const TFLinkROI& volume, const PointCloud& cloud,
                                        const Isometry3d& frame_from_cloud) {
  if (const auto sphere = try_as<TFLinkSphereROI>(volume)) {
    const Vector3d center = from<Vector3d>(sphere->center.get());
    const double radius = sphere->radius.get();
    return points_that(volume, cloud, [&](const Vector3d& point) {
      return (frame_from_cloud * point - center).norm() <= radius;
    });
  }
  const BoundingBox box = as<TFLinkBBoxROI>(volume).bbox.get();
  if (!box) throw Error("a volume without its box");
  const Isometry3d box_from_cloud = from<Isometry3d>(box.pose.get()).inverse() * frame_from_cloud;
  const Vector3d half = from<Vector3d>(box.size.get()) / 2;
  return points_that(volume, cloud, [&](const Vector3d& point) {
    return ((box_from_cloud * point).array().abs() <= half.array()).all();
  });
}

TFLinkBBoxROI bounding_box(const ClusterPoints& points, const std::string& frame,
                           const Isometry3d& frame_from_cloud) {
  const Eigen::AlignedBox3d extent = extent_of(points, frame_from_cloud);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = extent.center();
  const auto made = made_from<TFLinkBBoxROI>(points);
  made.tf_frame.set(frame);
  made.bbox.get_or_create().pose.set(to(points.cas(), pose));
  made.bbox.get().size.set(to(points.cas(), Vector3d(extent.sizes())));
  return made;
}

TFLinkSphereROI bounding_sphere(const ClusterPoints& points, const std::string& frame,
                                const Isometry3d& frame_from_cloud) {
  const Vector3d center = extent_of(points, frame_from_cloud).center();
  double radius = 0;
  for (const Vector3d& point : positions_of(points))
    radius = std::max(radius, (frame_from_cloud * point - center).norm());
  const auto made = made_from<TFLinkSphereROI>(points);
  made.tf_frame.set(frame);
  made.center.set(to(points.cas(), center));
  made.radius.set(radius);
  return made;
}

StandaloneImageROI standalone(const ReferenceImageROI& reference) {
  const cv::Mat image = from<cv::Mat>(reference.image.get());
  const cv::Rect region = from<cv::Rect>(reference.roi.get());
  if ((region & cv::Rect({0, 0}, image.size())) != region)
    throw Error("a region that reaches beyond its image of " + std::to_string(image.cols) + " x " +
                std::to_string(image.rows) + " pixels");
  const auto made = made_from<StandaloneImageROI>(reference);
  made.image.set(to(reference.cas(), cv::Mat(image(region))));
  made.roi.set(reference.roi.get());
  made.mask.set(reference.mask.get());
  if (reference.phash.is_set()) made.phash.set(reference.phash.get());
  return made;
}

ReferenceImageROI within(const StandaloneImageROI& alone, const Mat& image) {
  const cv::Rect region = from<cv::Rect>(alone.roi.get());
  if ((region & cv::Rect(0, 0, image.cols.get(), image.rows.get())) != region)
    throw Error("a region that reaches beyond the image of " + std::to_string(image.cols.get()) + " x " +
                std::to_string(image.rows.get()) + " pixels");
  const auto made = made_from<ReferenceImageROI>(alone);
  made.image.set(image);
  made.roi.set(alone.roi.get());
  made.mask.set(alone.mask.get());
  if (alone.phash.is_set()) made.phash.set(alone.phash.get());
  return made;
}

StandaloneClusterPoints standalone(const ReferenceClusterPoints& reference) {
  const PointCloud whole = reference.cloud.get();
  const Positions positions(whole);
  const cas::Buffer<uint8_t> bytes = whole.points.get();
  const auto step = static_cast<size_t>(whole.point_step.get());
  std::vector<uint8_t> kept;
  int32_t count = 0;
  for (const int32_t index : reference.indices.get().indices.get()) {
    if (index < 0 || static_cast<size_t>(index) >= positions.size())
      throw Error("point " + std::to_string(index) + " of a cloud of " + std::to_string(positions.size()));
    if (!positions.at(static_cast<size_t>(index))) continue;
    const uint8_t* point = bytes.data() + static_cast<size_t>(index) * step;
    kept.insert(kept.end(), point, point + step);
    ++count;
  }
  const auto cloud = PointCloud::create(reference.cas());
  if (const Header header = whole.header.get()) cloud.header.set(header);
  cloud.point_type.set(whole.point_type.get());
  cloud.point_step.set(whole.point_step.get());
  cloud.width.set(count);
  cloud.height.set(1);
  cloud.is_dense.set(true);
  cloud.points.set(std::move(kept));
  const auto made = made_from<StandaloneClusterPoints>(reference);
  made.cloud.set(cloud);
  return made;
}

ReferenceClusterPoints within(const StandaloneClusterPoints& alone, const PointCloud& cloud,
                              const Isometry3d& cloud_from_alone, double reach) {
  if (!(reach > 0)) throw Error("points are looked for within a reach above 0");
  const Positions positions(cloud);
  CellIndex cells;
  std::vector<std::vector<size_t>> members;
  for (size_t i = 0; i < positions.size(); ++i)
    if (const auto point = positions.at(i)) {
      const uint32_t cell = cells.insert(cell_of(*point, reach));
      if (cell == members.size()) members.emplace_back();
      members[cell].push_back(i);
    }
  std::vector<bool> chosen(positions.size(), false);
  for (const Vector3d& original : positions_of(alone)) {
    const Vector3d wanted = cloud_from_alone * original;
    const Eigen::Vector3i middle = cell_of(wanted, reach);
    double nearest = reach;
    std::optional<size_t> best;
    for (int near = 0; near < 27; ++near) {
      const uint32_t cell =
          cells.find(middle + Eigen::Vector3i(near % 3 - 1, near / 3 % 3 - 1, near / 9 - 1));
      if (cell == CellIndex::kNone) continue;
      for (const size_t i : members[cell])
        if (const double away = (*positions.at(i) - wanted).norm(); away <= nearest) {
          nearest = away;
          best = i;
        }
    }
    if (best) chosen[*best] = true;
  }
  std::vector<int32_t> indices;
  for (size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) indices.push_back(static_cast<int32_t>(i));
  const auto made = made_from<ReferenceClusterPoints>(alone);
  made.cloud.set(cloud);
  made.indices.get_or_create().indices.set(std::move(indices));
  return made;
}

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
