#include "perception/annotators/segmentation/clustering/color_outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/recognition/image_features.h"

namespace loci::perception {
namespace {

constexpr double kMaxTop = 0.045;  ///< metres: what is higher is found by its depth
constexpr int kEdge = 3;           ///< pixels at an edge show a bit of both
constexpr int kAround = 10;        ///< pixels: the ground that a region is compared with

/// The part of the image that shows a support.
struct SupportView {
  cv::Size image;
  cv::Rect box;    ///< in the depth image
  cv::Mat inside;  ///< CV_8U, of the box's size: within the outline of the support
};

SupportView view_of(const SupportGround& ground, const mapping::PinholeCamera& camera, const cv::Mat& region,
                    const cv::Size& size) {
  std::vector<cv::Point> corners;
  for (const Vector2d& corner : ground.plane.outline) {
    const Vector3d p = ground.plane.camera_from_plane * Vector3d(corner.x(), corner.y(), 0);
    if (p.z() < 0.1) return {};
    const Vector2d pixel = camera.project(p);
    if (pixel.cwiseAbs().maxCoeff() > 1e4) return {};
    corners.emplace_back(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  }
  SupportView view;
  view.image = size;
  if (corners.size() < 3) return view;
  view.box = cv::boundingRect(corners) & cv::Rect({}, size);
  if (view.box.empty()) return view;
  for (cv::Point& corner : corners) corner -= view.box.tl();
  view.inside = cv::Mat::zeros(view.box.size(), CV_8U);
  cv::fillConvexPoly(view.inside, corners, cv::Scalar(255));
  if (!region.empty()) view.inside &= region(view.box) == ground.plane.region;
  return view;
}

/// Where an outline within the support is closed: off the edge of the support, or where a Kinect's image
/// ends.
cv::Mat closed_within(const SupportView& view) {
  constexpr int kImageEdge = 12;
  cv::Mat within;
  cv::erode(view.inside, within, cv::Mat::ones(3, 3, CV_8U));
  const cv::Rect image({}, view.image);
  const cv::Rect middle(kImageEdge, kImageEdge, image.width - 2 * kImageEdge, image.height - 2 * kImageEdge);
  cv::Mat inner = cv::Mat::zeros(within.size(), CV_8U);
  if (const cv::Rect part = middle & view.box; !part.empty()) inner(part - view.box.tl()) = 255;
  within |= ~inner;
  return within;
}

/// The colours of a box of the depth image, as they would be seen if all of it lay in the plane of the
/// support; CIE Lab, CV_8UC3.
cv::Mat lab_on_plane(const ClusterImages& images, const mapping::PinholeCamera& camera,
                     const SupportPlane& plane, const cv::Rect& box) {
  const auto intrinsics = [](const mapping::PinholeCamera& c) {
    Eigen::Matrix3d k;
    k << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
    return k;
  };
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift.col(2) << box.x, box.y, 1;
  const Eigen::Matrix3d color_from_depth =
      intrinsics(images.color_camera) *
      (images.color_from_depth.linear() +
       images.color_from_depth.translation() * plane.normal.transpose() / plane.offset) *
      intrinsics(camera).inverse() * shift;
  cv::Matx33d homography;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) homography(r, c) = color_from_depth(r, c);
  cv::Mat seen;
  cv::warpPerspective(images.color, seen, homography, box.size(), cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  cv::GaussianBlur(seen, seen, {3, 3}, 0);
  return lab_of(seen);
}

/// How far each pixel's colour is from that of most of the support, in standard deviations of the latter;
/// CV_32F. Empty where little of the support is seen.
cv::Mat distance_from_support(const cv::Mat& lab, const cv::Mat& support) {
  constexpr int kStep = 3;
  constexpr size_t kMinSamples = 100;
  constexpr float kMinSpread = 1.5f;  // colours come in steps of one
  std::array<std::vector<float>, 3> values;
  for (int v = 0; v < lab.rows; v += kStep)
    for (int u = 0; u < lab.cols; u += kStep)
      if (support.at<uint8_t>(v, u))
        for (int c = 0; c < 3; ++c)
          values[static_cast<size_t>(c)].push_back(static_cast<float>(lab.at<cv::Vec3b>(v, u)[c]));
  if (values[0].size() < kMinSamples) return {};
  std::array<std::array<float, 256>, 3> squared;
  for (size_t c = 0; c < 3; ++c) {
    const float middle = median(values[c]);
    for (float& value : values[c]) value = std::abs(value - middle);
    const float spread = std::max(kMinSpread, 1.4826f * median(std::move(values[c])));
    for (size_t i = 0; i < 256; ++i) {
      const float apart = (static_cast<float>(i) - middle) / spread;
      squared[c][i] = apart * apart;
    }
  }
  cv::Mat distance(lab.size(), CV_32F);
  for (int v = 0; v < lab.rows; ++v) {
    const auto* color = lab.ptr<cv::Vec3b>(v);
    auto* to = distance.ptr<float>(v);
    for (int u = 0; u < lab.cols; ++u)
      to[u] = std::sqrt(squared[0][color[u][0]] + squared[1][color[u][1]] + squared[2][color[u][2]]);
  }
  return distance;
}

/// Heights over the support, or over what the map has on it (a hob), CV_32F, metres, of a box of the depth
/// image; NaN = nothing near it is measured.
cv::Mat heights_over(const SupportPlane& plane, const ClusterImages& images, const cv::Rect& box) {
  cv::Mat heights(box.size(), CV_32F, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  const Eigen::Vector3f normal = plane.normal.cast<float>();
  const auto offset = static_cast<float>(plane.offset);
  for (int v = 0; v < box.height; ++v) {
    const auto* point = images.points.ptr<cv::Vec3f>(v + box.y) + box.x;
    const auto* map_depth =
        images.map_depth.empty() ? nullptr : images.map_depth.ptr<float>(v + box.y) + box.x;
    auto* height = heights.ptr<float>(v);
    for (int u = 0; u < box.width; ++u) {
      const Eigen::Vector3f p = to_vector3f(point[u]);
      const float h = normal.dot(p) - offset;
      if (!(std::abs(h) < static_cast<float>(kMaxTop))) continue;
      height[u] = h;
      if (map_depth && map_depth[u] > 0)
        height[u] -= std::max(0.0f, normal.dot(p) * map_depth[u] / p.z() - offset);
    }
  }
  return heights;
}

/// Mean over windows of what is measured; 0 = nothing.
cv::Mat mean_height(const cv::Mat& heights) {
  constexpr int kWindow = 5;
  const cv::Mat known = heights == heights;
  cv::Mat values = cv::Mat::zeros(heights.size(), CV_32F), share;
  heights.copyTo(values, known);
  cv::boxFilter(values, values, CV_32F, {kWindow, kWindow}, {-1, -1}, true, cv::BORDER_CONSTANT);
  known.convertTo(share, CV_32F, 1.0 / 255);
  cv::boxFilter(share, share, CV_32F, {kWindow, kWindow}, {-1, -1}, true, cv::BORDER_CONSTANT);
  values /= share + 1e-6;
  return values;
}

/// Adds to distances of colour those of height, in standard deviations, as of independent evidence.
void add_height(cv::Mat& distance, const cv::Mat& heights, const SupportPlane& plane, const cv::Mat& points,
                const cv::Rect& box) {
  constexpr double kUneven = 0.0015;  // metres: what is left of the bend of surface and sensor
  constexpr float kMaxByHeight = 6;
  const cv::Mat mean = mean_height(heights);
  for (int v = 0; v < box.height; ++v) {
    const auto* height = mean.ptr<float>(v);
    const auto* point = points.ptr<cv::Vec3f>(v + box.y) + box.x;
    auto* to = distance.ptr<float>(v);
    for (int u = 0; u < box.width; ++u) {
      if (!(height[u] > static_cast<float>(kUneven)) || std::isnan(point[u][2])) continue;
      const double noise = std::hypot(kUneven, height_noise(plane, to_vector(point[u])));
      const float by_height = std::min(kMaxByHeight, height[u] / static_cast<float>(noise));
      to[u] = std::hypot(to[u], by_height);
    }
  }
}

constexpr double kDifferent = 4;  ///< standard deviations

/// Pixels that differ from the support. The edge of an object is where the difference is half of its own.
cv::Mat different_from_support(const cv::Mat& distance) {
  const cv::Mat window = cv::Mat::ones(5, 5, CV_8U), different = distance > kDifferent;
  cv::Mat strongest, inner;
  cv::dilate(distance, strongest, window);
  cv::erode(different, inner, window);
  return different & (inner | (distance > 0.5 * strongest));
}

/// One outline: a connected region.
struct Outline {
  cv::Rect box;  ///< in the box of the support
  cv::Mat mask;  ///< CV_8U, of its size: 255
  int pixels = 0;
  bool rises = false;  ///< it is one object, and lies higher than what is around it
};

/// Whether one object explains the outline: two that lie beside each other leave a bay between them.
bool is_of_one(const Outline& outline) {
  constexpr double kMinSolid = 0.75, kMinLong = 4;
  std::vector<cv::Point> points, hull;
  cv::findNonZero(outline.mask, points);
  cv::convexHull(points, hull);
  const cv::Size2f sides = cv::minAreaRect(hull).size;
  const auto [thin, length] = std::minmax({sides.width + 1, sides.height + 1});
  // The hull runs through the middle of pixels.
  const double area = cv::contourArea(hull) + cv::arcLength(hull, true) / 2 + 1;
  return length > kMinLong * static_cast<double>(thin) || outline.pixels > kMinSolid * area;
}

/// The filled outlines of the connected regions of a mask that have `min_pixels` and lie within another;
/// `taken`: what is not looked at. All CV_8U, of one size.
std::vector<Outline> closed_outlines(const cv::Mat& mask, const cv::Mat& within, const cv::Mat& taken,
                                     int min_pixels) {
  cv::Mat labels, boxes, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, boxes, centres, 8, CV_32S);
  std::vector<Outline> outlines;
  for (int label = 1; label < count; ++label) {
    if (boxes.at<int>(label, cv::CC_STAT_AREA) < min_pixels) continue;
    Outline outline;
    outline.box = {boxes.at<int>(label, cv::CC_STAT_LEFT), boxes.at<int>(label, cv::CC_STAT_TOP),
                   boxes.at<int>(label, cv::CC_STAT_WIDTH), boxes.at<int>(label, cv::CC_STAT_HEIGHT)};
    outline.mask = labels(outline.box) == label;
    if (cv::countNonZero(outline.mask & ~within(outline.box)) > 0) continue;
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(outline.mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(outline.mask, contours, -1, cv::Scalar(255), cv::FILLED);
    outline.mask &= ~taken(outline.box);
    outline.pixels = cv::countNonZero(outline.mask);
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

/// Mean of heights, as good as its pixels are many.
struct MeanHeight {
  double sum = 0;
  int count = 0;

  void add(float height) {
    sum += static_cast<double>(height);
    ++count;
  }
  double mean() const { return sum / std::max(1, count); }
};

/// The length of a region, cut in three parts of the same number of pixels if it is a bar.
class Thirds {
 public:
  explicit Thirds(const cv::Mat& region) {
    const cv::Moments m = cv::moments(region, true);
    const double turn = 0.5 * std::atan2(2 * m.mu11, m.mu20 - m.mu02);
    axis_ = {std::cos(turn), std::sin(turn)};
    middle_ = {m.m10 / m.m00, m.m01 / m.m00};
    const double variance =
        (m.mu20 * axis_.x * axis_.x + 2 * m.mu11 * axis_.x * axis_.y + m.mu02 * axis_.y * axis_.y) / m.m00;
    third_ = std::sqrt(variance / 3);  // a bar of length l has the variance l² / 12
  }

  size_t of(const cv::Point& pixel) const {
    const double along = (cv::Point2d(pixel) - middle_).dot(axis_);
    return along < -third_ ? 0 : along < third_ ? 1 : 2;
  }

 private:
  cv::Point2d axis_, middle_;
  double third_ = 0;
};

/// Heights of an outline and of the ground beside it.
struct Rise {
  std::array<MeanHeight, 3> parts;  ///< of its length
  MeanHeight all, ground;
  double noise = 0;  ///< standard deviation of a pixel's height, metres

  /// Whether it is higher than the ground, in all three parts.
  bool is_certain(int pixels) const {
    constexpr double kMinRise = 0.002, kSigmas = 3, kMinPart = 0.25;
    constexpr int kMinGround = 50;  // pixels
    constexpr double kShared = 40;  // pixels whose noise is one: a Kinect correlates windows
    if (2 * all.count < pixels || ground.count < kMinGround) return false;
    const double error = noise * std::sqrt(kShared / all.count + kShared / ground.count);
    const double rise = all.mean() - ground.mean();
    return rise > std::max(kMinRise, kSigmas * error) &&
           std::ranges::all_of(parts, [&](const MeanHeight& part) {
             return part.count == 0 || part.mean() - ground.mean() > kMinPart * rise;
           });
  }
};

class OutlineFinder {
 public:
  OutlineFinder(const ClusterImages& images, const SupportGround& ground, const cv::Mat& shows,
                const ClusterOptions& options)
      : points_(images.points), ground_(ground), shows_(shows), options_(options) {}

  /// Closed outlines. `lab`: of the box of `view`; `taken`: CV_8U,
  /// of the same size, what is not looked at.
  std::vector<Outline> find(const SupportView& view, const cv::Mat& lab, const cv::Mat& heights,
                            const cv::Mat& taken) const;

 private:
  Rise rise_of(const Outline& outline, const SupportView& view, const cv::Mat& heights,
               const cv::Mat& ground) const;
  const cv::Mat& points_;
  const SupportGround& ground_;
  const cv::Mat& shows_;
  const ClusterOptions& options_;
};

std::vector<Outline> OutlineFinder::find(const SupportView& view, const cv::Mat& lab, const cv::Mat& heights,
                                         const cv::Mat& taken) const {
  constexpr double kMinByColor = 0.4;  // waves of the surface rise, too
  const cv::Mat support = view.inside & (shows_(view.box) == static_cast<uint8_t>(Shows::support));
  cv::Mat distance = distance_from_support(lab, support);
  if (distance.empty()) return {};
  const cv::Mat other_color = distance > kDifferent;
  add_height(distance, heights, ground_.plane, points_, view.box);
  const cv::Mat different = different_from_support(distance);
  std::vector<Outline> outlines =
      closed_outlines(different & view.inside & ~taken, closed_within(view), taken, options_.min_points);
  std::erase_if(outlines, [&](const Outline& outline) {
    return cv::countNonZero(outline.mask & other_color(outline.box)) <= kMinByColor * outline.pixels;
  });
  const cv::Mat ground = support & ~different;
  for (Outline& outline : outlines)
    outline.rises = is_of_one(outline) && rise_of(outline, view, heights, ground).is_certain(outline.pixels);
  return outlines;
}

Rise OutlineFinder::rise_of(const Outline& outline, const SupportView& view, const cv::Mat& heights,
                            const cv::Mat& ground) const {
  const cv::Rect around = cv::Rect(outline.box.x - kAround, outline.box.y - kAround,
                                   outline.box.width + 2 * kAround, outline.box.height + 2 * kAround) &
                          cv::Rect({}, view.box.size());
  cv::Mat own = cv::Mat::zeros(around.size(), CV_8U);
  outline.mask.copyTo(own(outline.box - around.tl()));
  cv::Mat near, at_edge;
  cv::dilate(own, near, cv::Mat::ones(2 * kAround + 1, 2 * kAround + 1, CV_8U));
  cv::dilate(own, at_edge, cv::Mat::ones(2 * kEdge + 1, 2 * kEdge + 1, CV_8U));
  const cv::Mat beside = near & ~at_edge & ground(around);
  const Thirds thirds(own);
  Rise rise;
  for (int v = 0; v < around.height; ++v)
    for (int u = 0; u < around.width; ++u) {
      const cv::Point pixel = cv::Point(u, v) + around.tl();
      const float height = heights.at<float>(pixel);
      if (std::isnan(height)) continue;
      if (own.at<uint8_t>(v, u)) {
        rise.all.add(height);
        rise.parts[thirds.of({u, v})].add(height);
        rise.noise += height_noise(ground_.plane, to_vector(points_.at<cv::Vec3f>(pixel + view.box.tl())));
      } else if (beside.at<uint8_t>(v, u)) {
        rise.ground.add(height);
      }
    }
  rise.noise /= std::max(1, rise.all.count);
  return rise;
}

/// The pixels of an outline that are measured and not high.
std::vector<int> pixels_of(const Outline& outline, const SupportView& view, const cv::Mat& points) {
  std::vector<int> pixels;
  for (int v = 0; v < outline.box.height; ++v)
    for (int u = 0; u < outline.box.width; ++u) {
      if (!outline.mask.at<uint8_t>(v, u)) continue;
      const cv::Point at = cv::Point(u, v) + outline.box.tl() + view.box.tl();
      if (!std::isnan(points.at<cv::Vec3f>(at)[2])) pixels.push_back(at.y * points.cols + at.x);
    }
  return pixels;
}

/// Whether nearly all of these pixels lie within the footprint of a cluster: the bottom of a pan.
bool is_within(const std::vector<int>& pixels, const ObjectCluster& cluster, const SupportPlane& support,
               const cv::Mat& points) {
  constexpr double kNearlyAll = 0.9;
  const auto position = [&](int pixel) {
    return Vector2d(support.in_plane(to_vector(points.ptr<cv::Vec3f>()[pixel])).head<2>());
  };
  if ((box_of(pixels, points.size()) & cluster.box).empty()) return false;
  std::vector<cv::Point2f> footprint, hull;
  for (const int pixel : cluster.pixels) {
    const Eigen::Vector2f at = position(pixel).cast<float>();
    footprint.emplace_back(at.x(), at.y());
  }
  cv::convexHull(types::near_hull(footprint), hull);
  std::vector<Vector2d> corners;
  for (const cv::Point2f& at : hull)
    corners.emplace_back(static_cast<double>(at.x), static_cast<double>(at.y));
  const PolygonOutline outline(corners);
  const auto inside =
      std::ranges::count_if(pixels, [&](int pixel) { return outline.inside(position(pixel)) > 0; });
  return static_cast<double>(inside) > kNearlyAll * static_cast<double>(pixels.size());
}

/// Whether a cluster is seen nearly all around an outline: a shadow lies beside what casts it.
bool encloses(const cv::Mat& own, const Outline& outline, const SupportView& view) {
  constexpr double kMostly = 0.6;
  const int gap = 2 * kEdge - 1, far = 4 * kEdge - 1;  // pixels next to high clusters are in no outline
  const cv::Rect box = outline.box + view.box.tl();
  const cv::Rect around = cv::Rect(box.x - far, box.y - far, box.width + 2 * far, box.height + 2 * far) &
                          cv::Rect({}, view.image);
  cv::Mat region = cv::Mat::zeros(around.size(), CV_8U), inner, outer;
  outline.mask.copyTo(region(box - around.tl()));
  cv::dilate(region, inner, cv::Mat::ones(gap, gap, CV_8U));
  cv::dilate(region, outer, cv::Mat::ones(far, far, CV_8U));
  const cv::Mat ring = outer & ~inner;
  return cv::countNonZero(ring & own(around)) > kMostly * cv::countNonZero(ring);
}

ObjectCluster cluster_of(std::vector<int> pixels, const SupportPlane& support, int index,
                         const cv::Mat& points) {
  ObjectCluster cluster;
  cluster.support = index;
  std::array<std::vector<float>, 3> along;
  for (const int pixel : pixels) {
    const Vector3d p = support.in_plane(to_vector(points.ptr<cv::Vec3f>()[pixel]));
    for (int a = 0; a < 3; ++a) along[static_cast<size_t>(a)].push_back(static_cast<float>(p[a]));
  }
  std::array<std::pair<float, float>, 3> range;
  for (size_t a = 0; a < 3; ++a) range[a] = quantiles(along[a], 0.02, 0.98);
  cluster.low = {static_cast<double>(range[0].first), static_cast<double>(range[1].first)};
  cluster.high = {static_cast<double>(range[0].second), static_cast<double>(range[1].second)};
  cluster.bottom = static_cast<double>(range[2].first);
  cluster.top = static_cast<double>(range[2].second);
  cluster.pixels = std::move(pixels);
  cluster.box = box_of(cluster.pixels, points.size());
  cluster.at_image_border = is_at_image_border(cluster.box, points.size());
  return cluster;
}

/// Clusters on one support, by pixel.
class ClusterMap {
 public:
  ClusterMap(std::vector<ObjectCluster>& clusters, const cv::Mat& points, const SupportPlane& support,
             int index)
      : clusters_(clusters),
        points_(points),
        support_(support),
        index_(index),
        cluster_of_(points.size(), CV_32S, cv::Scalar(-1)) {
    for (size_t i = 0; i < clusters.size(); ++i)
      for (const int pixel : clusters[i].pixels) cluster_of_.ptr<int>()[pixel] = static_cast<int>(i);
  }

  /// What is found by its depth, and the pixels next to it; CV_8U.
  cv::Mat high() const {
    cv::Mat high = cv::Mat::zeros(points_.size(), CV_8U);
    for (const ObjectCluster& cluster : clusters_)
      if (!is_low(cluster))
        for (const int pixel : cluster.pixels) high.ptr<uint8_t>()[pixel] = 255;
    cv::dilate(high, high, cv::Mat::ones(2 * kEdge - 1, 2 * kEdge - 1, CV_8U));
    return high;
  }

  /// Gives pixels to the high cluster that they are the inside of, if there is one.
  bool fill_hollow(std::vector<int> pixels, const Outline& outline, const SupportView& view) {
    for (size_t i = 0; i < clusters_.size(); ++i) {
      ObjectCluster& hollow = clusters_[i];
      if (hollow.pixels.empty() || is_low(hollow) || !is_within(pixels, hollow, support_, points_) ||
          !encloses(cluster_of_ == static_cast<int>(i), outline, view))
        continue;
      std::erase_if(pixels, [&](int pixel) { return at(pixel) >= 0; });
      hollow.pixels.insert(hollow.pixels.end(), pixels.begin(), pixels.end());
      std::ranges::sort(hollow.pixels);
      hollow.box = box_of(hollow.pixels, points_.size());
      return true;
    }
    return false;
  }

  /// Makes one cluster of pixels and the low clusters that lie in them, unless one fills them already.
  void join(std::vector<int> pixels, int min_points) {
    constexpr double kFilled = 0.75;
    std::vector<int> shared(clusters_.size());
    for (const int pixel : pixels)
      if (at(pixel) >= 0) ++shared[static_cast<size_t>(at(pixel))];
    const double filled = kFilled * static_cast<double>(pixels.size());
    if (std::ranges::any_of(shared, [&](int count) { return count > filled; })) return;
    const auto is_inside = [&](int cluster) {
      const auto c = static_cast<size_t>(cluster);
      return shared[c] > 0 && shared[c] >= kFilled * static_cast<double>(clusters_[c].pixels.size());
    };
    std::erase_if(pixels, [&](int pixel) { return at(pixel) >= 0 && !is_inside(at(pixel)); });
    if (std::ssize(pixels) < min_points) return;  // most is of clusters that reach beyond the outline
    for (int c = 0; c < static_cast<int>(shared.size()); ++c) {
      if (!is_inside(c)) continue;
      ObjectCluster& piece = clusters_[static_cast<size_t>(c)];
      pixels.insert(pixels.end(), piece.pixels.begin(), piece.pixels.end());
      piece.pixels.clear();
      for (ObjectCluster& upper : clusters_)
        if (upper.stands_on == c) upper.stands_on = static_cast<int>(clusters_.size());
    }
    std::ranges::sort(pixels);
    pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    for (const int pixel : pixels) cluster_of_.ptr<int>()[pixel] = static_cast<int>(clusters_.size());
    clusters_.push_back(cluster_of(std::move(pixels), support_, index_, points_));
  }

 private:
  static bool is_low(const ObjectCluster& cluster) { return cluster.top < kMaxTop; }
  int at(int pixel) const { return cluster_of_.ptr<int>()[pixel]; }

  std::vector<ObjectCluster>& clusters_;
  const cv::Mat& points_;
  const SupportPlane& support_;
  int index_;
  cv::Mat cluster_of_;  ///< CV_32S, -1 = none
};

}  // namespace

void join_by_color_outline(std::vector<ObjectCluster>& clusters, const ClusterImages& images,
                           const mapping::PinholeCamera& camera, const SupportGround& ground, int index,
                           const cv::Mat& shows, const ClusterOptions& options) {
  // The boards of a drawer, which the map has by assumption, differ in colour from its bottom and rise.
  if (images.color.empty() || ground.plane.in_drawer) return;
  const SupportView view = view_of(ground, camera, images.region, images.points.size());
  if (view.box.empty()) return;
  const cv::Mat lab = lab_on_plane(images, camera, ground.plane, view.box);
  const cv::Mat heights = heights_over(ground.plane, images, view.box);
  ClusterMap map(clusters, images.points, ground.plane, index);
  const OutlineFinder finder(images, ground, shows, options);
  for (const Outline& outline : finder.find(view, lab, heights, map.high()(view.box))) {
    const std::vector<int> pixels = pixels_of(outline, view, images.points);
    if (!pixels.empty() && !map.fill_hollow(pixels, outline, view) && outline.rises)
      map.join(pixels, options.min_points);
  }
  std::vector<bool> keep;
  for (const ObjectCluster& cluster : clusters) keep.push_back(!cluster.pixels.empty());
  keep_only(keep, clusters);
}

}  // namespace loci::perception
