#include "perception/annotators/segmentation/object_clusters.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "mapping/base/math.h"
#include "mapping/base/parallel.h"
#include "perception/annotators/scene_data.h"

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

/// Everything that stands over one support, before it is taken apart.
struct Standing {
  std::vector<int> pixels;
  std::vector<Vector3f> points;    ///< camera frame
  std::vector<Vector3f> normals;   ///< camera frame
  std::vector<Vector3f> in_plane;  ///< z = height over the support
  std::vector<Vector3f> normals_in_plane;
  std::vector<float> areas;  ///< of a pixel on the surface, m²

  void add(const Standing& other, size_t i) {
    pixels.push_back(other.pixels[i]);
    points.push_back(other.points[i]);
    normals.push_back(other.normals[i]);
    in_plane.push_back(other.in_plane[i]);
    normals_in_plane.push_back(other.normals_in_plane[i]);
    areas.push_back(other.areas[i]);
  }
  void reserve(size_t count) {
    pixels.reserve(count);
    points.reserve(count);
    normals.reserve(count);
    in_plane.reserve(count);
    normals_in_plane.reserve(count);
    areas.reserve(count);
  }
};

/// A support made ready to be asked about many points.
struct Ground {
  const SupportPlane& plane;
  ConvexOutline outline;
  Eigen::Matrix3f plane_from_camera;  ///< rotation

  explicit Ground(const SupportPlane& support)
      : plane(support),
        outline(support.outline),
        plane_from_camera(support.camera_from_plane.linear().transpose().cast<float>()) {}
};

/// The highest support below a point, -1 = none or the support itself, and the point in its frame.
int support_below(const Vector3f& p, int label, const std::vector<Ground>& grounds,
                  const ClusterOptions& options, Vector3d& position) {
  // Beyond the outline by this much objects are still looked at, to tell what merely reaches over the
  // support.
  constexpr double kAround = 0.15;
  int best = -1;
  for (size_t s = 0; s < grounds.size(); ++s) {
    const SupportPlane& support = grounds[s].plane;
    if (support.region != label) continue;
    const Vector3d at = support.in_plane(p.cast<double>());
    if (at.z() > options.max_height_m || at.z() < -0.03) continue;
    const double floor =
        options.floor_m + support.uncertainty + 1.5 * depth_noise(static_cast<double>(p.z()));
    if (at.z() < -floor || (best >= 0 && at.z() > floor && at.z() >= position.z())) continue;
    const double inside = grounds[s].outline.inside(at.head<2>());
    if (inside < -kAround) continue;
    if (std::abs(at.z()) <= floor && inside > -options.margin_m) return -1;  // The support itself.
    if (at.z() <= floor) continue;
    best = static_cast<int>(s);
    position = at;
  }
  return best;
}

/// Gives every pixel to the highest support below it.
std::vector<Standing> stand_on_supports(const cv::Mat& points, const cv::Mat& normals, const cv::Mat& region,
                                        const mapping::PinholeCamera& camera,
                                        const std::vector<Ground>& grounds, const ClusterOptions& options,
                                        int threads) {
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* normal = normals.ptr<cv::Vec3f>();
  const auto* label_of = region.empty() ? nullptr : region.ptr<uint16_t>();
  const auto focal_squared = static_cast<float>(camera.fx * camera.fy);
  constexpr int kRows = 16;
  const auto blocks = static_cast<size_t>((points.rows + kRows - 1) / kRows);
  std::vector<std::vector<Standing>> of_block(blocks, std::vector<Standing>(grounds.size()));
  parallel_each(blocks, threads, [&](size_t block) {
    const int end = std::min(points.rows, static_cast<int>(block + 1) * kRows) * points.cols;
    for (int i = static_cast<int>(block) * kRows * points.cols; i < end; ++i) {
      if (std::isnan(point[i][2]) || (label_of && label_of[i] == 0)) continue;
      const Vector3f p = to_vector3f(point[i]);
      Vector3d position;
      const int best = support_below(p, label_of ? label_of[i] : 0, grounds, options, position);
      if (best < 0) continue;
      const auto s = static_cast<size_t>(best);
      Standing& target = of_block[block][s];
      target.pixels.push_back(i);
      target.points.push_back(p);
      target.normals.push_back(to_vector3f(normal[i]));
      target.in_plane.push_back(position.cast<float>());
      target.normals_in_plane.push_back(grounds[s].plane_from_camera * target.normals.back());
      target.areas.push_back(p.z() * p.z() / focal_squared);
    }
  });
  std::vector<Standing> standing(grounds.size());
  for (size_t s = 0; s < standing.size(); ++s) {
    size_t count = 0;
    for (const auto& part : of_block) count += part[s].pixels.size();
    standing[s].reserve(count);
    for (const auto& part : of_block)
      for (size_t i = 0; i < part[s].pixels.size(); ++i) standing[s].add(part[s], i);
  }
  return standing;
}

Standing subset(const Standing& all, const std::vector<size_t>& members) {
  Standing part;
  part.reserve(members.size());
  for (const size_t i : members) part.add(all, i);
  return part;
}

std::vector<std::vector<size_t>> members_of(const std::vector<int>& group_of, int count) {
  std::vector<std::vector<size_t>> members(static_cast<size_t>(count));
  for (size_t i = 0; i < group_of.size(); ++i) members[static_cast<size_t>(group_of[i])].push_back(i);
  return members;
}

class ClusterMaker {
 public:
  ClusterMaker(const cv::Mat& points, const cv::Mat& region, const Ground& ground, int index,
               const ClusterOptions& options)
      : points_(points),
        region_(region),
        support_(ground.plane),
        outline_(ground.outline),
        index_(index),
        options_(options) {}

  /// A cluster of these points, or nothing when they do not look like an object on the support.
  std::optional<ObjectCluster> make(const Standing& object) const {
    ObjectCluster cluster;
    cluster.support = index_;
    cluster.pixels = object.pixels;
    if (static_cast<int>(object.pixels.size()) < options_.min_points) return std::nullopt;
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
    double depth = 0;
    for (const Vector3f& p : object.points) depth += static_cast<double>(p.z());
    depth /= static_cast<double>(object.points.size());
    const double extent = static_cast<double>(std::max(high[0] - low[0], high[1] - low[1]));
    const double least = std::max(options_.min_height_m, 3 * depth_noise(depth)) + support_.uncertainty;
    if (cluster.top < least) return std::nullopt;
    if (std::max(extent, cluster.top) < options_.min_extent_m || extent > options_.max_extent_m)
      return std::nullopt;
    if (!over_support(object, cluster)) return std::nullopt;
    set_box(cluster);
    set_hidden(cluster);
    return cluster;
  }

  /// Adds what is enclosed by the object in the image and lies within its footprint, though it is as low as
  /// the support: the bottom of a pot. `taken` marks the pixels of all objects.
  void fill_holes(ObjectCluster& cluster, const cv::Mat& taken) const {
    cv::Mat outside(cluster.box.height + 2, cluster.box.width + 2, CV_8U, cv::Scalar(255));
    for (const int pixel : cluster.pixels)
      outside.at<unsigned char>(pixel / points_.cols - cluster.box.y + 1,
                                pixel % points_.cols - cluster.box.x + 1) = 0;
    cv::floodFill(outside, {0, 0}, cv::Scalar(0));
    const size_t before = cluster.pixels.size();
    for (int v = 1; v <= cluster.box.height; ++v)
      for (int u = 1; u <= cluster.box.width; ++u) {
        if (!outside.at<unsigned char>(v, u)) continue;
        const int pixel = (v - 1 + cluster.box.y) * points_.cols + u - 1 + cluster.box.x;
        const cv::Vec3f& p = points_.ptr<cv::Vec3f>()[pixel];
        if (std::isnan(p[2]) || taken.ptr<unsigned char>()[pixel]) continue;
        const Vector3d at = support_.in_plane(to_vector(p));
        if ((at.head<2>().array() > cluster.low.array()).all() &&
            (at.head<2>().array() < cluster.high.array()).all())
          cluster.pixels.push_back(pixel);
      }
    if (cluster.pixels.size() > before) std::sort(cluster.pixels.begin(), cluster.pixels.end());
  }

  /// Whether below the object there is something as near or nearer, or nothing was measured, so that it may
  /// well stand on the support. Where one looks under it, what is seen is farther away.
  bool foot_hidden(const ObjectCluster& cluster) const {
    const int rows = points_.rows;
    const int cols = points_.cols;
    const auto* point = points_.ptr<cv::Vec3f>();
    std::vector<int> lowest(static_cast<size_t>(cluster.box.width), -1);
    for (const int pixel : cluster.pixels) {
      int& row = lowest[static_cast<size_t>(pixel % cols - cluster.box.x)];
      row = std::max(row, pixel / cols);
    }
    int hidden = 0;
    int seen = 0;
    for (size_t i = 0; i < lowest.size(); ++i) {
      if (lowest[i] < 0) continue;
      const int col = cluster.box.x + static_cast<int>(i);
      const float z = point[lowest[i] * cols + col][2];
      int row = lowest[i] + 1;
      while (row < rows && row < lowest[i] + 12 && std::isnan(point[row * cols + col][2])) ++row;
      ++seen;
      if (row >= rows || std::isnan(point[row * cols + col][2])) {
        ++hidden;
        continue;
      }
      // A known wall right behind the object hides nothing: the object hangs there.
      const bool known = !region_.empty() && region_.ptr<uint16_t>()[row * cols + col] == 0;
      hidden += point[row * cols + col][2] < z + (known ? -0.03f : 0.01f) ? 1 : 0;
    }
    return hidden > 0.5 * seen;
  }

 private:
  /// Most of an object is over the support; a chair or a wall behind it is not. Notes whether it reaches
  /// over.
  bool over_support(const Standing& object, ObjectCluster& cluster) const {
    size_t over = 0;
    size_t beyond = 0;
    for (const Vector3f& p : object.in_plane) {
      const double inside = outline_.inside(p.head<2>().cast<double>());
      over += inside > -options_.margin_m ? 1 : 0;
      beyond += inside < 0 ? 1 : 0;
    }
    const auto count = static_cast<double>(object.in_plane.size());
    cluster.at_region_border = static_cast<double>(beyond) > 0.02 * count;
    return static_cast<double>(over) >= 0.6 * count;
  }

  void set_box(ObjectCluster& cluster) const {
    cluster.box = box_of(cluster.pixels, points_.size());
    cluster.at_image_border = is_at_image_border(cluster.box, points_.size());
  }

  /// Whether along a good part of its outline something nearer begins.
  void set_hidden(ObjectCluster& cluster) const {
    const int cols = points_.cols;
    const auto* point = points_.ptr<cv::Vec3f>();
    // Edges are ragged and measured with gaps: a few pixels further are looked at.
    constexpr int kFar = 6;
    cv::Mat own = cv::Mat::zeros(cluster.box.height + 2 * kFar, cluster.box.width + 2 * kFar, CV_8U);
    const auto in_own = [&](int pixel) {
      return (pixel / cols - cluster.box.y + kFar) * own.cols + pixel % cols - cluster.box.x + kFar;
    };
    for (const int pixel : cluster.pixels) own.ptr<unsigned char>()[in_own(pixel)] = 1;
    int border = 0;
    int nearer = 0;
    for (const int pixel : cluster.pixels) {
      const unsigned char* here = own.ptr<unsigned char>() + in_own(pixel);
      const int row = pixel / cols;
      const int col = pixel % cols;
      for (const auto& [du, dv] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
        if (here[dv * own.cols + du]) continue;
        const int room = du < 0 ? col : du > 0 ? cols - 1 - col : dv < 0 ? row : points_.rows - 1 - row;
        if (room == 0) continue;
        ++border;
        for (int far = 1; far <= std::min(kFar, room); ++far) {
          const float z = point[pixel + far * (dv * cols + du)][2];
          if (std::isnan(z)) continue;
          nearer += z < point[pixel][2] - 0.03f && !here[far * (dv * own.cols + du)] ? 1 : 0;
          break;
        }
      }
    }
    cluster.partly_hidden = nearer > 0.1 * border;
  }

  const cv::Mat& points_;
  const cv::Mat& region_;
  const SupportPlane& support_;
  const ConvexOutline& outline_;
  int index_;
  const ClusterOptions& options_;
};

ConvexParts parts_of_group(const Standing& group, const ClusterOptions& options) {
  ConvexParts parts;
  if (!options.split) {
    parts.part_of_point.assign(group.pixels.size(), 0);
    parts.count = 1;
    return parts;
  }
  std::vector<float> depths;
  depths.reserve(group.points.size());
  for (const Vector3f& p : group.points) depths.push_back(p.z());
  const auto depth = static_cast<double>(median(std::move(depths)));
  const double scale = std::max(1.0, depth_noise(depth) / depth_noise(1.0));
  return split_at_concave_edges(group.points, group.normals, scale, options.parts);
}

/// Convex parts of everything on a support: connected groups first, then each split at its concave edges.
ConvexParts parts_of(const Standing& all, const ClusterOptions& options, int threads) {
  int groups = 0;
  const std::vector<int> group_of =
      euclidean_groups(all.points, static_cast<float>(options.tolerance_m * 0.6), groups);
  const std::vector<std::vector<size_t>> members = members_of(group_of, groups);
  std::vector<ConvexParts> of_group(members.size());
  parallel_each(members.size(), threads,
                [&](size_t g) { of_group[g] = parts_of_group(subset(all, members[g]), options); });
  ConvexParts parts;
  parts.part_of_point.assign(all.pixels.size(), -1);
  for (size_t g = 0; g < members.size(); ++g) {
    const ConvexParts& own = of_group[g];
    for (size_t i = 0; i < members[g].size(); ++i)
      parts.part_of_point[members[g][i]] = parts.count + own.part_of_point[i];
    for (const auto& [pair, contact] : own.contacts)
      parts.contacts.push_back({{pair[0] + parts.count, pair[1] + parts.count}, contact});
    parts.count += own.count;
  }
  return parts;
}

/// Finds what stands on what, and leaves out what neither stands on anything nor has a foot that may be
/// hidden: people who lean over, lamps that hang down.
void keep_what_rests(std::vector<ObjectCluster>& clusters, const ClusterMaker& maker,
                     const ClusterOptions& options) {
  const auto below = [&](const ObjectCluster& upper) {
    for (size_t i = 0; i < clusters.size(); ++i) {
      const ObjectCluster& lower = clusters[i];
      if (&lower == &upper || lower.bottom > upper.bottom - 0.01) continue;
      if (std::abs(upper.bottom - lower.top) > options.resting_m) continue;
      if ((upper.low.array() < lower.high.array() + 0.01).all() &&
          (upper.high.array() > lower.low.array() - 0.01).all())
        return static_cast<int>(i);
    }
    return -1;
  };
  std::vector<bool> keep(clusters.size(), true);
  for (size_t i = 0; i < clusters.size(); ++i) {
    if (clusters[i].bottom <= options.resting_m) continue;
    clusters[i].stands_on = below(clusters[i]);
    keep[i] = clusters[i].stands_on >= 0 || clusters[i].at_image_border || maker.foot_hidden(clusters[i]);
  }
  std::vector<int> number(clusters.size(), -1);
  std::vector<ObjectCluster> kept;
  for (size_t i = 0; i < clusters.size(); ++i)
    if (keep[i]) {
      number[i] = static_cast<int>(kept.size());
      kept.push_back(clusters[i]);
    }
  for (ObjectCluster& cluster : kept)
    if (cluster.stands_on >= 0) cluster.stands_on = number[static_cast<size_t>(cluster.stands_on)];
  clusters = std::move(kept);
}

}  // namespace

void ClusterOptions::declare(OptionTable& table) {
  table.number("tolerance_m", tolerance_m, "m", "Maximum gap inside one object.", 0.001, 1);
  table.number("floor_m", floor_m, "m",
               "Points closer than this to the plane belong to it (plus 1.5 times the depth noise).", 0, 0.1);
  table.number("min_height_m", min_height_m, "m", "Minimum height of an object.", 0, 1);
  table.number("max_height_m", max_height_m, "m", "Maximum height of points above a support.", 0.05, 3);
  table.number("min_extent_m", min_extent_m, "m",
               "Minimum extent of an object in its largest dimension; smaller clusters are noise.", 0, 1);
  table.number("max_extent_m", max_extent_m, "m",
               "Maximum extent of an object; larger clusters are furniture.", 0.05, 10);
  table.integer("min_points", min_points, "px", "Minimum number of pixels of an object.", 1, 100000);
  table.number("resting_m", resting_m, "m", "Maximum gap between an object and the surface it stands on.", 0,
               1);
  table.number("margin_m", margin_m, "m",
               "Distance by which an object may extend beyond the edge of its support.", 0, 1);
  table.flag("split", split, "Splits touching objects at concave edges.");
  parts.declare(table);
  assembly.declare(table);
}

std::vector<ObjectCluster> extract_clusters(const cv::Mat& points, const cv::Mat& normals,
                                            const cv::Mat& region, const mapping::PinholeCamera& camera,
                                            const std::vector<SupportPlane>& supports,
                                            const ClusterOptions& options, int threads) {
  std::vector<ObjectCluster> clusters;
  const std::vector<Ground> grounds(supports.begin(), supports.end());
  const std::vector<Standing> standing =
      stand_on_supports(points, normals, region, camera, grounds, options, threads);
  for (size_t s = 0; s < supports.size(); ++s) {
    const Standing& all = standing[s];
    const ClusterMaker maker(points, region, grounds[s], static_cast<int>(s), options);
    const Vector2f viewpoint = supports[s].in_plane(Vector3d::Zero()).head<2>().cast<float>();
    const ConvexParts parts = parts_of(all, options, threads);
    int count = 0;
    const std::vector<int> object_of_part =
        assemble_parts(parts,
                       {all.in_plane, all.normals_in_plane, all.areas, viewpoint,
                        supports[s].camera_from_plane, camera, points},
                       options.assembly, count);
    std::vector<int> object_of_point(all.pixels.size());
    for (size_t i = 0; i < object_of_point.size(); ++i)
      object_of_point[i] = object_of_part[static_cast<size_t>(parts.part_of_point[i])];
    const std::vector<std::vector<size_t>> objects = members_of(object_of_point, count);
    std::vector<std::optional<ObjectCluster>> made(objects.size());
    parallel_each(objects.size(), threads,
                  [&](size_t object) { made[object] = maker.make(subset(all, objects[object])); });
    std::vector<ObjectCluster> own;
    for (std::optional<ObjectCluster>& cluster : made)
      if (cluster) own.push_back(std::move(*cluster));
    keep_what_rests(own, maker, options);
    cv::Mat taken = cv::Mat::zeros(points.size(), CV_8U);
    for (const ObjectCluster& cluster : own)
      for (const int pixel : cluster.pixels) taken.ptr<unsigned char>()[pixel] = 255;
    for (ObjectCluster& cluster : own) maker.fill_holes(cluster, taken);
    for (ObjectCluster& cluster : own) {
      if (cluster.stands_on >= 0) cluster.stands_on += static_cast<int>(clusters.size());
    }
    clusters.insert(clusters.end(), own.begin(), own.end());
  }
  return clusters;
}

}  // namespace loci::perception
