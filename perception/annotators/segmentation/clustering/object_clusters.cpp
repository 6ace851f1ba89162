#include "perception/annotators/segmentation/clustering/object_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/color_outlines.h"
#include "perception/annotators/segmentation/clustering/color_splitting.h"
#include "perception/annotators/segmentation/clustering/row_splitting.h"
#include "perception/annotators/segmentation/clustering/standing_points.h"
#include "perception/annotators/structure/surface_samples.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {

cv::Rect box_of(const std::vector<int>& pixels, const cv::Size& image) {
  int left = image.width;
  int right = 0;
  int top = image.height;
  int bottom = 0;
  for (const int pixel : pixels) {
    left = std::min(left, pixel % image.width);
    right = std::max(right, pixel % image.width);
    top = std::min(top, pixel / image.width);
    bottom = std::max(bottom, pixel / image.width);
  }
  return {left, top, right - left + 1, bottom - top + 1};
}

bool is_at_image_border(const cv::Rect& box, const cv::Size& image) {
  constexpr int kBorder = 4;  // Kinects leave the outermost columns empty.
  return box.x < kBorder || box.y < kBorder || box.x + box.width > image.width - kBorder - 8 ||
         box.y + box.height > image.height - kBorder;
}
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// How far from a surface of the map something may seem to be although it is that surface: the map's error,
/// beside kDistortion.
constexpr double kFlush = 0.02;
constexpr double kMinFlush = 0.7;   ///< of a piece of the surroundings
constexpr double kBeforeMap = 0.3;  ///< metres: what stands before a wall is not farther from it

class ClusterMaker {
 public:
  ClusterMaker(const ClusterImages& images, const mapping::PinholeCamera& camera, const SupportGround& ground,
               int index, const ClusterOptions& options)
      : points_(images.points),
        normals_(images.normals),
        map_depth_(images.map_depth),
        camera_(camera),
        support_(ground.plane),
        outline_(ground.outline),
        height_error_(ground.color ? 0 : ground.plane.uncertainty),
        index_(index),
        options_(options) {}

  /// A cluster of these points, or nothing when they do not look like an object on the support.
  std::optional<ObjectCluster> make(const Standing& object) const {
    ObjectCluster cluster;
    cluster.support = index_;
    cluster.pixels = object.pixels;
    if (static_cast<int>(object.pixels.size()) < options_.min_clear_points) return std::nullopt;
    std::vector<float> axis(object.pixels.size());
    std::array<float, 3> low;
    std::array<float, 3> high;
    for (int a = 0; a < 3; ++a) {
      for (size_t i = 0; i < axis.size(); ++i) axis[i] = object.in_plane[i][a];
      std::tie(low[static_cast<size_t>(a)], high[static_cast<size_t>(a)]) = quantiles(axis, 0.02, 0.98);
    }
    cluster.bottom = static_cast<double>(low[2]);
    cluster.top = static_cast<double>(high[2]);
    cluster.low = {static_cast<double>(low[0]), static_cast<double>(low[1])};
    cluster.high = {static_cast<double>(high[0]), static_cast<double>(high[1])};
    Vector3d middle = Vector3d::Zero();
    for (const Vector3f& p : object.points) middle += p.cast<double>();
    middle /= static_cast<double>(object.points.size());
    const double extent = static_cast<double>(std::max(high[0] - low[0], high[1] - low[1]));
    constexpr float kWide = 0.05f;  // many values measure the height of what is wide
    std::vector<cv::Point2f> footprint;
    for (const Vector3f& p : object.in_plane) footprint.emplace_back(p.x(), p.y());
    const cv::Size2f sides = cv::minAreaRect(types::near_hull(footprint)).size;
    if (is_drawer_side(object, sides, cluster.top)) return std::nullopt;
    const double height = (std::min(sides.width, sides.height) > kWide ? 0.5 : 1) * options_.min_height_m;
    const double least = std::max(height, 3 * height_noise(support_, middle)) + height_error_;
    // What stands out of the noise clearly needs fewer pixels for the same evidence.
    const double clear = cluster.top / least;
    if (clear < 1 || static_cast<double>(object.pixels.size()) * clear * clear < options_.min_points)
      return std::nullopt;
    if (std::max(extent, cluster.top) < options_.min_extent_m || extent > options_.max_extent_m)
      return std::nullopt;
    if (!over_support(object, cluster)) return std::nullopt;
    set_box(cluster);
    return cluster;
  }

  /// Whether an object on the bottom of a drawer is one of its sides. Maps have the box of a drawer by
  /// assumption, so its upright boards are seen some centimetres from where the map has them.
  bool is_drawer_side(const Standing& object, const cv::Size2f& footprint, double top) const {
    constexpr float kMaxThickness = 0.02f, kMinLength = 0.1f;
    constexpr double kMinHeight = 0.03;  // cutlery lies lower
    constexpr double kMaxOff = 0.06;
    const auto [thickness, length] = std::minmax(footprint.width, footprint.height);
    return support_.in_drawer && thickness < kMaxThickness && length > kMinLength && top > kMinHeight &&
           std::ranges::all_of(object.in_plane, [&](const Vector3f& p) {
             return outline_.inside(p.head<2>().cast<double>()) < kMaxOff;
           });
  }

  /// Adds what is enclosed by the object in the image, or a gap in it, and lies within its footprint, though
  /// as low as the support: the bottom of a pot, a plate in noise. `taken` marks the pixels of all objects.
  void fill_holes(ObjectCluster& cluster, cv::Mat& taken) const {
    constexpr int kGap = 3;  // pixels: rims are measured with gaps
    cv::Mat outside(cluster.box.height + 2 * kGap, cluster.box.width + 2 * kGap, CV_8U, cv::Scalar(255));
    for (const int pixel : cluster.pixels)
      outside.at<unsigned char>(pixel / points_.cols - cluster.box.y + kGap,
                                pixel % points_.cols - cluster.box.x + kGap) = 0;
    cv::morphologyEx(outside, outside, cv::MORPH_OPEN,
                     cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kGap - 1, 2 * kGap - 1}));
    constexpr unsigned char kBeside = 1;
    cv::floodFill(outside, {0, 0}, cv::Scalar(kBeside));
    const size_t before = cluster.pixels.size();
    for (int v = kGap; v < cluster.box.height + kGap; ++v)
      for (int u = kGap; u < cluster.box.width + kGap; ++u) {
        if (outside.at<unsigned char>(v, u) == kBeside) continue;
        const int pixel = (v - kGap + cluster.box.y) * points_.cols + u - kGap + cluster.box.x;
        const cv::Vec3f& p = points_.ptr<cv::Vec3f>()[pixel];
        if (std::isnan(p[2]) || taken.ptr<unsigned char>()[pixel]) continue;
        const Eigen::Array2d at = support_.in_plane(to_vector(p)).head<2>();
        if ((at <= cluster.low.array()).any() || (at >= cluster.high.array()).any()) continue;
        cluster.pixels.push_back(pixel);
        taken.ptr<unsigned char>()[pixel] = 255;
      }
    if (cluster.pixels.size() > before) std::sort(cluster.pixels.begin(), cluster.pixels.end());
  }

  /// Whether nothing speaks against the object's reaching down to the support: where one looks through below
  /// its middle, or sees the surroundings there, it hangs. What is round below narrows towards its foot, so
  /// that one looks through below its outline. `shows` as of look_around().
  bool may_reach_support(const ObjectCluster& cluster, const cv::Mat& shows) const {
    const double low = cluster.bottom + 0.2 * (cluster.top - cluster.bottom);
    const Vector2d middle = 0.5 * (cluster.low + cluster.high);
    const size_t stride = std::max<size_t>(1, cluster.pixels.size() / 1000);
    int judged = 0;
    int free = 0;
    for (size_t k = 0; k < cluster.pixels.size(); k += stride) {
      const Vector3d at = support_.in_plane(to_vector(points_.ptr<cv::Vec3f>()[cluster.pixels[k]]));
      if (at.z() > low) continue;
      const Vector2d inner = 0.5 * (at.head<2>() + middle);
      for (const double part : {0.35, 0.65}) {
        const Vector3d below =
            support_.camera_from_plane * Vector3d(inner.x(), inner.y(), (1 - part) * at.z());
        if (!(below.z() > 0.1)) continue;
        const Vector2d pixel = camera_.project(below);
        if (!camera_.contains(pixel)) continue;
        const cv::Point seen(static_cast<int>(std::lround(pixel.x())),
                             static_cast<int>(std::lround(pixel.y())));
        const auto behind = static_cast<double>(points_.at<cv::Vec3f>(seen)[2]) - below.z();
        const double reach = 0.01 + 3 * depth_noise(below.z());
        if (std::isnan(behind)) continue;
        ++judged;
        const bool surroundings = static_cast<Shows>(shows.at<uint8_t>(seen)) == Shows::surroundings;
        free += behind > reach || (surroundings && behind > -reach) ? 1 : 0;
      }
    }
    return free <= 0.5 * judged;
  }

  /// The share of a cluster that protrudes so little from a surface of the map other than the supports that
  /// it cannot be told from it: all of a patch of a wall, and of what is stuck on it. Where that surface is
  /// seen around it, its error there is known, and the noise remains. `shows` as of look_around().
  double flush_with_map(const ObjectCluster& cluster, const cv::Mat& shows) const {
    if (map_depth_.empty()) return 0;
    constexpr double kNoise = 2.5;
    const std::optional<double> error = map_error_around(cluster.box, shows);
    int flush = 0;
    for (const int pixel : cluster.pixels) {
      const Vector3d p = to_vector(points_.ptr<cv::Vec3f>()[pixel]);
      const auto behind = static_cast<double>(map_depth_.ptr<float>()[pixel]);
      const bool is_near =
          error ? behind - p.z() - *error < kFlush + kNoise * depth_noise(p.z()) : near_map(pixel, 0);
      flush += is_near && support_.in_plane(p * (behind / p.z())).z() > kFlush ? 1 : 0;
    }
    return flush / static_cast<double>(cluster.pixels.size());
  }

  /// Whether the surfaces of two clusters meet somewhere in the image.
  bool touch(const ObjectCluster& a, const ObjectCluster& b) const {
    constexpr int kFar = 6;
    const cv::Rect around(b.box.x - kFar, b.box.y - kFar, b.box.width + 2 * kFar, b.box.height + 2 * kFar);
    if ((around & a.box).empty()) return false;
    cv::Mat depth(around.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    const auto* point = points_.ptr<cv::Vec3f>();
    for (const int pixel : b.pixels)
      depth.at<float>(pixel / points_.cols - around.y, pixel % points_.cols - around.x) = point[pixel][2];
    constexpr double kGap = 0.05;  // sides that are seen at a flat angle are hardly measured
    constexpr int kMinPixels = 3;
    int meeting = 0;
    for (const int pixel : a.pixels) {
      const cv::Point at(pixel % points_.cols, pixel / points_.cols);
      if (!around.contains(at)) continue;
      const float z = point[pixel][2];
      const auto reach = static_cast<float>(kGap + 2.5 * depth_noise(static_cast<double>(z)));
      for (const cv::Point& step : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)})
        for (int far = 1; far <= kFar; ++far) {
          const cv::Point other = at + far * step;
          if (!around.contains(other)) break;
          if (!(std::abs(depth.at<float>(other - around.tl()) - z) < reach)) continue;
          if (++meeting == kMinPixels) return true;
          break;
        }
    }
    return false;
  }

  /// Looks along the outline of a cluster: whether something nearer begins along a good part of it, and
  /// across which share of it the same surface goes on in what is not an object. What stands off the map does
  /// not go on in a surface that the map has: it only comes near it.
  void look_around(ObjectCluster& cluster, const cv::Mat& shows) const {
    const int cols = points_.cols;
    const auto* point = points_.ptr<cv::Vec3f>();
    const auto* shown = shows.ptr<uint8_t>();
    // Edges are ragged and measured with gaps: a few pixels further are looked at, and across the shadow that
    // something nearer casts in structured light.
    constexpr int kFar = 6;
    constexpr int kShadow = 16;
    constexpr int kAside = 4;
    cv::Mat own = cv::Mat::zeros(cluster.box.height + 2 * kFar, cluster.box.width + 2 * kFar, CV_8U);
    const auto in_own = [&](int pixel) {
      return (pixel / cols - cluster.box.y + kFar) * own.cols + pixel % cols - cluster.box.x + kFar;
    };
    const auto own_at = [&](int pixel) { return own.ptr<unsigned char>()[in_own(pixel)] != 0; };
    for (const int pixel : cluster.pixels) own.ptr<unsigned char>()[in_own(pixel)] = 1;
    const bool flush = flush_with_map(cluster, shows) > kMinFlush;
    int nearer = 0;
    int measured = 0;
    int open = 0;
    for (const int pixel : cluster.pixels) {
      const unsigned char* here = own.ptr<unsigned char>() + in_own(pixel);
      const int row = pixel / cols;
      const int col = pixel % cols;
      for (const auto& [du, dv] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
        if (here[dv * own.cols + du]) continue;
        const int room = du < 0 ? col : du > 0 ? cols - 1 - col : dv < 0 ? row : points_.rows - 1 - row;
        if (room == 0) continue;
        const int behind = (du != 0 ? cols : points_.rows) - 1 - room;  // pixels up to the image's other edge
        for (int far = 1; far <= std::min(kShadow, room); ++far) {
          const int other = pixel + far * (dv * cols + du);
          const float z = point[other][2];
          if (std::isnan(z)) continue;
          if (far <= kFar && here[far * (dv * own.cols + du)]) break;
          if (z < point[pixel][2] - 0.03f) {
            ++nearer;
            break;
          }
          if (far > kFar) break;
          ++measured;
          if (static_cast<Shows>(shown[other]) != Shows::surroundings) break;
          if (!flush && near_map(other, 0) && near_map(pixel, kBeforeMap)) break;
          // Smoothing rounds the edge: the surfaces on either side of it are compared.
          int inner = pixel;
          int outer = other;
          for (int step = 0; step < std::min(kAside, behind) && own_at(inner - dv * cols - du); ++step)
            inner -= dv * cols + du;
          for (int step = 0; step < std::min(kAside, room - far); ++step)
            if (!std::isnan(point[outer + dv * cols + du][2])) outer += dv * cols + du;
          open += goes_on(inner, outer) ? 1 : 0;
          break;
        }
      }
    }
    // A tenth of the outline of something compact: what is long is cut across by less.
    cluster.partly_hidden = nearer > 0.4 * std::sqrt(static_cast<double>(cluster.pixels.size()));
    cluster.open = measured == 0 ? 0 : static_cast<double>(open) / measured;
  }

  /// Whether two pixels near each other, on either side of an edge, show one surface: each lies on the
  /// other's tangent plane.
  bool goes_on(int from, int to) const {
    const cv::Vec3f apart = points_.ptr<cv::Vec3f>()[to] - points_.ptr<cv::Vec3f>()[from];
    const cv::Vec3f& a = normals_.ptr<cv::Vec3f>()[from];
    const cv::Vec3f& b = normals_.ptr<cv::Vec3f>()[to];
    const auto z = static_cast<double>(points_.ptr<cv::Vec3f>()[from][2]);
    const auto reach = static_cast<float>(0.002 + 2.5 * depth_noise(z));
    constexpr float kMinCosine = 0.8f;
    return a.dot(b) > kMinCosine && std::abs(a.dot(apart)) < reach && std::abs(b.dot(apart)) < reach;
  }

 private:
  /// Whether the map has a surface where a pixel is measured, or up to `behind` metres behind it.
  bool near_map(int pixel, double behind) const {
    if (map_depth_.empty()) return false;
    const auto z = static_cast<double>(points_.ptr<cv::Vec3f>()[pixel][2]);
    return static_cast<double>(map_depth_.ptr<float>()[pixel]) - z <
           std::max(behind, kFlush + kDistortion * depth_noise(z));
  }

  /// How much nearer what the map has around a part of the image is measured than the map has it: the map's
  /// error and the distortion of the depth there. Unset where too little of it is seen.
  std::optional<double> map_error_around(const cv::Rect& box, const cv::Mat& shows) const {
    constexpr int kMargin = 12;
    constexpr size_t kMinPixels = 50;
    const cv::Rect around =
        cv::Rect(box.x - kMargin, box.y - kMargin, box.width + 2 * kMargin, box.height + 2 * kMargin) &
        cv::Rect({}, points_.size());
    std::vector<float> errors;
    for (int v = around.y; v < around.br().y; ++v)
      for (int u = around.x; u < around.br().x; ++u) {
        const int pixel = v * points_.cols + u;
        const auto shown = static_cast<Shows>(shows.ptr<uint8_t>()[pixel]);
        if (shown == Shows::surroundings && near_map(pixel, 0))
          errors.push_back(map_depth_.ptr<float>()[pixel] - points_.ptr<cv::Vec3f>()[pixel][2]);
      }
    if (errors.size() < kMinPixels) return std::nullopt;
    return static_cast<double>(median(std::move(errors)));
  }

  /// Most of an object is over the support, as far as one can see; a chair or a wall behind it is not. The
  /// support reaches at least as far as it was measured, and may go on below what hides it. Notes whether the
  /// object reaches over what was measured.
  bool over_support(const Standing& object, ObjectCluster& cluster) const {
    constexpr double kMinOver = 0.2, kMinPossible = 0.6;
    size_t over = 0, beyond = 0, hidden = 0;
    for (const Vector3f& p : object.in_plane) {
      const double inside = outline_.inside(p.head<2>().cast<double>());
      if (inside > -options_.margin_m)
        ++over;
      else
        hidden += is_hidden(p) ? 1 : 0;
      beyond += inside < 0 ? 1 : 0;
    }
    const auto count = static_cast<double>(object.in_plane.size());
    cluster.at_region_border = static_cast<double>(beyond) > 0.02 * count;
    return static_cast<double>(over) >= kMinOver * count &&
           static_cast<double>(over + hidden) >= kMinPossible * count;
  }

  /// Whether the support's plane below a point (in the plane's frame) is out of view or behind something.
  bool is_hidden(const Vector3f& p) const {
    const Vector3d foot = support_.camera_from_plane * Vector3d(double(p.x()), double(p.y()), 0);
    if (!(foot.z() > 0.1)) return true;
    const Vector2d pixel = camera_.project(foot);
    if (!camera_.contains(pixel)) return true;
    const float depth = points_.at<cv::Vec3f>(static_cast<int>(std::lround(pixel.y())),
                                              static_cast<int>(std::lround(pixel.x())))[2];
    return static_cast<double>(depth) < foot.z() - 3 * depth_noise(foot.z());
  }

  void set_box(ObjectCluster& cluster) const {
    cluster.box = box_of(cluster.pixels, points_.size());
    cluster.at_image_border = is_at_image_border(cluster.box, points_.size());
  }

  const cv::Mat& points_;
  const cv::Mat& normals_;
  const cv::Mat& map_depth_;
  const mapping::PinholeCamera& camera_;
  const SupportPlane& support_;
  const PolygonOutline& outline_;
  double height_error_;  ///< of the support, metres
  int index_;
  const ClusterOptions& options_;
};

/// Convex parts of everything on a support.
ConvexParts parts_of(const Standing& all, const std::vector<cv::Vec3b>& lab, const ClusterMaker& maker,
                     const cv::Size& image, const ClusterOptions& options, int threads) {
  ConvexParts groups;
  const std::vector<int> near =
      euclidean_groups(all.points, static_cast<float>(options.tolerance_m * 0.6), groups.count);
  groups.part_of_point = join_groups(
      near, all.pixels, image, [&](int from, int to) { return maker.goes_on(from, to); }, groups.count);
  if (!options.split) return groups;
  return split_groups(all.points, all.normals, lab, members_of(groups.part_of_point, groups.count),
                      options.parts, threads);
}

/// Takes apart what touches beside each other or stands upon each other in each of `objects` (indices into
/// `all`).
std::vector<std::vector<size_t>> split_objects(const std::vector<std::vector<size_t>>& objects,
                                               const Standing& all, const std::vector<cv::Vec3b>& lab,
                                               const ClusterImages& images,
                                               const mapping::PinholeCamera& camera,
                                               const Vector2f& viewpoint, const ClusterOptions& options,
                                               int threads) {
  const StackCloud cloud{all.in_plane, all.normals_in_plane, all.pixels, lab, viewpoint,
                         camera.fx,    images.points};
  std::vector<std::vector<std::vector<size_t>>> parts(objects.size());
  parallel_each(objects.size(), threads, [&](size_t object) {
    for (const std::vector<size_t>& row : split_row(cloud, objects[object]))
      for (std::vector<size_t>& beside :
           split_colors(all.in_plane, all.normals_in_plane, all.areas, lab, row))
        for (std::vector<size_t>& part : split_stack(cloud, std::move(beside), options.stacks))
          parts[object].push_back(std::move(part));
  });
  std::vector<std::vector<size_t>> all_parts;
  for (auto& of_object : parts)
    for (auto& part : of_object) all_parts.push_back(std::move(part));
  return all_parts;
}

/// Leaves out pieces of the surroundings: what goes on beyond their outline goes on in them. What is left out
/// belongs to the surroundings of the others, unless it is so small that it may be a piece of one of them.
void drop_surroundings(std::vector<ObjectCluster>& clusters, const ClusterMaker& maker, int min_points,
                       cv::Mat& shows) {
  constexpr double kMaxOpen = 0.25;
  constexpr double kSurelyOpen = 0.4;  // a mere neighbour of something dropped by mistake has to stay
  for (bool changed = true; changed;) {
    for (ObjectCluster& cluster : clusters) maker.look_around(cluster, shows);
    changed = std::erase_if(clusters, [&](const ObjectCluster& cluster) {
                const bool flush = maker.flush_with_map(cluster, shows) > kMinFlush;
                if (cluster.open <= kMaxOpen && !flush) return false;
                if (cluster.open <= kSurelyOpen && !flush) return true;
                if (static_cast<int>(cluster.pixels.size()) < min_points) return true;
                for (const int pixel : cluster.pixels)
                  shows.ptr<uint8_t>()[pixel] = static_cast<uint8_t>(Shows::surroundings);
                return true;
              }) > 0;
  }
}

/// Leaves out what few pixels show beside something larger, which it is rather a piece of, and the tips of
/// what is hidden.
void drop_fragments(std::vector<ObjectCluster>& clusters, const ClusterMaker& maker,
                    const ClusterOptions& options) {
  const auto shown_by = [](const ObjectCluster& cluster) { return static_cast<int>(cluster.pixels.size()); };
  const auto is_small = [&](const ObjectCluster& cluster) { return shown_by(cluster) < options.min_points; };
  const auto is_fragment = [&](const ObjectCluster& cluster) {
    if (!is_small(cluster)) return false;
    return (cluster.partly_hidden && shown_by(cluster) < 2 * options.min_clear_points) ||
           std::ranges::any_of(clusters, [&](const ObjectCluster& other) {
             return !is_small(other) && maker.touch(cluster, other);
           });
  };
  std::vector<ObjectCluster> kept;
  for (const ObjectCluster& cluster : clusters)
    if (!is_fragment(cluster)) kept.push_back(cluster);
  clusters = std::move(kept);
}

/// The common part of the boxes around two footprints, as a share of the smaller one.
double overlap(const ObjectCluster& a, const ObjectCluster& b) {
  const Vector2d common = (a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low)).cwiseMax(0.0);
  return common.prod() / std::max(1e-6, std::min((a.high - a.low).prod(), (b.high - b.low).prod()));
}

/// Finds what stands on what, and leaves out what neither stands on anything nor has a foot that may be
/// hidden: people who lean over, lamps that hang down.
void keep_what_rests(std::vector<ObjectCluster>& clusters, const ClusterMaker& maker, const cv::Mat& shows,
                     const ClusterOptions& options) {
  constexpr double kMinOverlap = 0.3;
  constexpr double kFooting = 0.03;  // and a quarter of the width: only the sides towards the camera are seen
  const auto below = [&](const ObjectCluster& upper) {
    for (size_t i = 0; i < clusters.size(); ++i) {
      const ObjectCluster& lower = clusters[i];
      if (&lower == &upper || lower.bottom > upper.bottom - 0.01) continue;
      // Round objects sink in between others, and lie in bowls.
      const double sunk = lower.top - upper.bottom;
      if (sunk < -options.resting_m || sunk > std::max(options.resting_m, 0.5 * (upper.top - upper.bottom)))
        continue;
      if (overlap(upper, lower) < kMinOverlap && !maker.touch(upper, lower)) continue;
      // What overhangs by more than half falls.
      const Eigen::Array2d centre = 0.5 * (upper.low + upper.high);
      const double footing = kFooting + 0.25 * (lower.high - lower.low).maxCoeff();
      if ((centre < lower.high.array() + footing).all() && (centre > lower.low.array() - footing).all())
        return static_cast<int>(i);
    }
    return -1;
  };
  std::vector<bool> keep(clusters.size(), true);
  for (size_t i = 0; i < clusters.size(); ++i) {
    if (clusters[i].bottom <= options.resting_m) continue;
    clusters[i].stands_on = below(clusters[i]);
    keep[i] = clusters[i].stands_on >= 0 || maker.may_reach_support(clusters[i], shows);
  }
  keep_only(keep, clusters);
}

}  // namespace

void keep_only(const std::vector<bool>& keep, std::vector<ObjectCluster>& clusters) {
  std::vector<int> number(clusters.size(), -1);
  std::vector<ObjectCluster> kept;
  for (size_t i = 0; i < clusters.size(); ++i)
    if (keep[i]) {
      number[i] = static_cast<int>(kept.size());
      kept.push_back(std::move(clusters[i]));
    }
  for (ObjectCluster& cluster : kept)
    if (cluster.stands_on >= 0) cluster.stands_on = number[static_cast<size_t>(cluster.stands_on)];
  clusters = std::move(kept);
}

void ClusterOptions::declare(OptionTable& table) {
  table.number("tolerance_m", tolerance_m, "m", "Maximum gap inside one object.", 0.001, 1);
  table.number("floor_m", floor_m, "m",
               "Points closer than this to the plane belong to it (plus 1.5 times the depth noise).", 0, 0.1);
  table.number("min_height_m", min_height_m, "m",
               "Minimum height of an object; half of it where it is wider than 5 cm.", 0, 1);
  table.number("max_height_m", max_height_m, "m", "Maximum height of points above a support.", 0.05, 3);
  table.number("min_extent_m", min_extent_m, "m",
               "Minimum extent of an object in its largest dimension; smaller clusters are noise.", 0, 1);
  table.number("max_extent_m", max_extent_m, "m",
               "Maximum extent of an object; larger clusters are furniture.", 0.05, 10);
  table.integer("min_points", min_points, "px",
                "Minimum number of pixels of an object of the least height; twice as high, a quarter of them "
                "is enough.",
                1, 100000);
  table.integer(
      "min_clear_points", min_clear_points, "px",
      "Minimum number of pixels of any object. In a video it is min_points: what is far away comes nearer.",
      1, 100000);
  table.number("resting_m", resting_m, "m", "Maximum gap between an object and the surface it stands on.", 0,
               1);
  table.number("margin_m", margin_m, "m",
               "Distance by which an object may extend beyond the edge of its support.", 0, 1);
  table.flag("split", split, "Splits touching objects at concave edges.");
  parts.declare(table);
  assembly.declare(table);
  stacks.declare(table);
}

std::vector<ObjectCluster> extract_clusters(const ClusterImages& images, const mapping::PinholeCamera& camera,
                                            const std::vector<SupportPlane>& supports,
                                            const ClusterOptions& options, int threads) {
  const cv::Mat& points = images.points;
  std::vector<ObjectCluster> clusters;
  std::vector<SupportGround> grounds(supports.begin(), supports.end());
  for (SupportGround& ground : grounds)
    if (ground.plane.uncertainty > 0) ground.color = color_of_support(ground, images, camera);
  cv::Mat shows;
  std::vector<Standing> standing = stand_on_supports(images, camera, grounds, options, threads, shows);
  for (size_t s = 0; s < supports.size(); ++s) {
    drop_specks(standing[s], supports[s], options, shows);
    if (grounds[s].color) drop_like_support(standing[s], grounds[s], options, images, shows);
    const Standing& all = standing[s];
    const ClusterMaker maker(images, camera, grounds[s], static_cast<int>(s), options);
    const Vector2f viewpoint = supports[s].in_plane(Vector3d::Zero()).head<2>().cast<float>();
    const std::vector<cv::Vec3b> lab = lab_colors(all.points, images);
    const ConvexParts parts = parts_of(all, lab, maker, points.size(), options, threads);
    int count = 0;
    const std::vector<int> object_of_part =
        assemble_parts(parts,
                       {all.in_plane, all.normals_in_plane, all.areas, lab, viewpoint,
                        supports[s].camera_from_plane, camera, points},
                       options.assembly, count);
    std::vector<int> object_of_point(all.pixels.size());
    for (size_t i = 0; i < object_of_point.size(); ++i)
      object_of_point[i] = object_of_part[static_cast<size_t>(parts.part_of_point[i])];
    const std::vector<std::vector<size_t>> objects = split_objects(
        members_of(object_of_point, count), all, lab, images, camera, viewpoint, options, threads);
    std::vector<std::optional<ObjectCluster>> made(objects.size());
    parallel_each(objects.size(), threads,
                  [&](size_t object) { made[object] = maker.make(subset(all, objects[object])); });
    std::vector<ObjectCluster> own;
    for (size_t object = 0; object < made.size(); ++object) {
      if (made[object])
        own.push_back(std::move(*made[object]));
      else if (static_cast<int>(objects[object].size()) >= options.min_points)
        for (const size_t i : objects[object])
          shows.ptr<uint8_t>()[all.pixels[i]] = static_cast<uint8_t>(Shows::surroundings);
    }
    drop_surroundings(own, maker, options.min_points, shows);
    drop_fragments(own, maker, options);
    keep_what_rests(own, maker, shows, options);
    join_by_color_outline(own, images, camera, grounds[s], static_cast<int>(s), shows, options);
    cv::Mat taken = cv::Mat::zeros(points.size(), CV_8U);
    for (const ObjectCluster& cluster : own)
      for (const int pixel : cluster.pixels) taken.ptr<unsigned char>()[pixel] = 255;
    for (ObjectCluster& cluster : own) {
      maker.fill_holes(cluster, taken);
      if (cluster.stands_on >= 0) cluster.stands_on += static_cast<int>(clusters.size());
    }
    clusters.insert(clusters.end(), own.begin(), own.end());
  }
  return clusters;
}

}  // namespace loci::perception
