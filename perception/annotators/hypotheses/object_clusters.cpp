#include "perception/annotators/hypotheses/object_clusters.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/quantile.h"

namespace loci {
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
};

Vector3f vector_of(const cv::Vec3f& v) {
  return {v[0], v[1], v[2]};
}

/// Gives every pixel to the highest support below it.
std::vector<Standing> stand_on_supports(const cv::Mat& points, const cv::Mat& normals, const cv::Mat& region,
                                        const PinholeCamera& camera,
                                        const std::vector<SupportPlane>& supports,
                                        const ClusterOptions& options) {
  // Beyond the outline by this much things are still looked at, to tell what merely reaches over the support.
  constexpr double kAround = 0.15;
  std::vector<Standing> standing(supports.size());
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* normal = normals.ptr<cv::Vec3f>();
  const auto focal_squared = static_cast<float>(camera.fx * camera.fy);
  for (int i = 0; i < points.rows * points.cols; ++i) {
    if (std::isnan(point[i][2])) continue;
    const int label = region.empty() ? 0 : region.ptr<uint16_t>()[i];
    if (!region.empty() && label == 0) continue;
    const Vector3f p = vector_of(point[i]);
    int best = -1;
    Vector3d best_position = Vector3d::Zero();
    for (size_t s = 0; s < supports.size(); ++s) {
      if (supports[s].region != label) continue;
      const Vector3d position = supports[s].in_plane(p.cast<double>());
      if (position.z() > options.max_height_m || position.z() < -0.03) continue;
      const double inside = supports[s].inside(position.head<2>());
      if (inside < -kAround) continue;
      const double floor =
          options.floor_m + supports[s].uncertainty + 1.5 * depth_noise(static_cast<double>(p.z()));
      if (std::abs(position.z()) <= floor && inside > -options.margin_m) {
        best = -1;  // The support itself.
        break;
      }
      if (position.z() <= floor) continue;
      if (best < 0 || position.z() < best_position.z()) {
        best = static_cast<int>(s);
        best_position = position;
      }
    }
    if (best < 0) continue;
    Standing& target = standing[static_cast<size_t>(best)];
    target.pixels.push_back(i);
    target.points.push_back(p);
    target.normals.push_back(vector_of(normal[i]));
    target.in_plane.push_back(best_position.cast<float>());
    target.normals_in_plane.push_back(
        (supports[static_cast<size_t>(best)].camera_from_plane.linear().transpose().cast<float>() *
         target.normals.back()));
    target.areas.push_back(p.z() * p.z() / focal_squared);
  }
  return standing;
}

Standing subset(const Standing& all, const std::vector<size_t>& members) {
  Standing part;
  for (const size_t i : members) {
    part.pixels.push_back(all.pixels[i]);
    part.points.push_back(all.points[i]);
    part.normals.push_back(all.normals[i]);
    part.in_plane.push_back(all.in_plane[i]);
    part.normals_in_plane.push_back(all.normals_in_plane[i]);
    part.areas.push_back(all.areas[i]);
  }
  return part;
}

std::vector<std::vector<size_t>> members_of(const std::vector<int>& group_of, int count) {
  std::vector<std::vector<size_t>> members(static_cast<size_t>(count));
  for (size_t i = 0; i < group_of.size(); ++i) members[static_cast<size_t>(group_of[i])].push_back(i);
  return members;
}

class ClusterMaker {
 public:
  ClusterMaker(const cv::Mat& points, const cv::Mat& region, const SupportPlane& support, int index,
               const ClusterOptions& options)
      : points_(points), region_(region), support_(support), index_(index), options_(options) {}

  /// A cluster of these points, or nothing when they do not look like a thing on the support.
  std::optional<ObjectCluster> make(const Standing& thing) const {
    ObjectCluster cluster;
    cluster.support = index_;
    cluster.pixels = thing.pixels;
    if (static_cast<int>(thing.pixels.size()) < options_.min_points) return std::nullopt;
    std::vector<float> axis(thing.pixels.size());
    std::array<float, 3> low;
    std::array<float, 3> high;
    for (int a = 0; a < 3; ++a) {
      for (size_t i = 0; i < axis.size(); ++i) axis[i] = thing.in_plane[i][a];
      low[static_cast<size_t>(a)] = quantile(axis, 0.02);
      high[static_cast<size_t>(a)] = quantile(axis, 0.98);
    }
    cluster.bottom = static_cast<double>(low[2]);
    cluster.top = static_cast<double>(high[2]);
    cluster.low = {static_cast<double>(low[0]), static_cast<double>(low[1])};
    cluster.high = {static_cast<double>(high[0]), static_cast<double>(high[1])};
    double depth = 0;
    for (const Vector3f& p : thing.points) depth += static_cast<double>(p.z());
    depth /= static_cast<double>(thing.points.size());
    const double extent = static_cast<double>(std::max(high[0] - low[0], high[1] - low[1]));
    const double least = std::max(options_.min_height_m, 3 * depth_noise(depth)) + support_.uncertainty;
    if (cluster.top < least) return std::nullopt;
    if (std::max(extent, cluster.top) < options_.min_extent_m || extent > options_.max_extent_m)
      return std::nullopt;
    if (!over_support(thing, cluster)) return std::nullopt;
    set_box(cluster);
    set_hidden(cluster);
    return cluster;
  }

  /// Adds what is enclosed by the thing in the picture and lies within its footprint, though it is as low as
  /// the support: the bottom of a pot. `taken` marks the pixels of all things.
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
        const Vector3d at = support_.in_plane(vector_of(p).cast<double>());
        if ((at.head<2>().array() > cluster.low.array()).all() &&
            (at.head<2>().array() < cluster.high.array()).all())
          cluster.pixels.push_back(pixel);
      }
    if (cluster.pixels.size() > before) std::sort(cluster.pixels.begin(), cluster.pixels.end());
  }

  /// Whether below the thing there is something as near or nearer, or nothing was measured, so that it may
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
      // A known wall right behind the thing hides nothing: the thing hangs there.
      const bool known = !region_.empty() && region_.ptr<uint16_t>()[row * cols + col] == 0;
      hidden += point[row * cols + col][2] < z + (known ? -0.03f : 0.01f) ? 1 : 0;
    }
    return hidden > 0.5 * seen;
  }

 private:
  /// Most of a thing is over the support; a chair or a wall behind it is not. Notes whether it reaches over.
  bool over_support(const Standing& thing, ObjectCluster& cluster) const {
    size_t over = 0;
    size_t beyond = 0;
    for (const Vector3f& p : thing.in_plane) {
      const double inside = support_.inside(p.head<2>().cast<double>());
      over += inside > -options_.margin_m ? 1 : 0;
      beyond += inside < 0 ? 1 : 0;
    }
    const auto count = static_cast<double>(thing.in_plane.size());
    cluster.at_region_border = static_cast<double>(beyond) > 0.02 * count;
    return static_cast<double>(over) >= 0.6 * count;
  }

  void set_box(ObjectCluster& cluster) const {
    const int cols = points_.cols;
    int left = cols;
    int right = 0;
    int top = points_.rows;
    int bottom = 0;
    for (const int pixel : cluster.pixels) {
      left = std::min(left, pixel % cols);
      right = std::max(right, pixel % cols);
      top = std::min(top, pixel / cols);
      bottom = std::max(bottom, pixel / cols);
    }
    cluster.box = {left, top, right - left + 1, bottom - top + 1};
    constexpr int kBorder = 4;  // Kinects leave the outermost columns empty.
    cluster.at_image_border =
        left < kBorder || top < kBorder || right >= cols - kBorder - 8 || bottom >= points_.rows - kBorder;
  }

  /// Whether along a good part of its outline something nearer begins.
  void set_hidden(ObjectCluster& cluster) const {
    const int cols = points_.cols;
    const auto* point = points_.ptr<cv::Vec3f>();
    const auto own = [&](int pixel) {
      return std::binary_search(cluster.pixels.begin(), cluster.pixels.end(), pixel);
    };
    int border = 0;
    int nearer = 0;
    for (const int pixel : cluster.pixels) {
      for (const int step : {-1, 1, -cols, cols}) {
        const int next = pixel + step;
        if (next < 0 || next >= points_.rows * cols || own(next)) continue;
        ++border;
        // Edges are ragged and measured with gaps: look a few pixels further.
        for (int far = 1; far <= 6; ++far) {
          const int other = pixel + far * step;
          if (other < 0 || other >= points_.rows * cols) break;
          if (std::isnan(point[other][2])) continue;
          nearer += point[other][2] < point[pixel][2] - 0.03f && !own(other) ? 1 : 0;
          break;
        }
      }
    }
    cluster.partly_hidden = nearer > 0.1 * border;
  }

  const cv::Mat& points_;
  const cv::Mat& region_;
  const SupportPlane& support_;
  int index_;
  const ClusterOptions& options_;
};

/// Convex parts of everything on a support: connected groups first, then each split at its concave edges.
ConvexParts parts_of(const Standing& all, const ClusterOptions& options) {
  ConvexParts parts;
  parts.part_of_point.assign(all.pixels.size(), -1);
  int groups = 0;
  const std::vector<int> group_of =
      euclidean_groups(all.points, static_cast<float>(options.tolerance_m * 0.6), groups);
  for (const std::vector<size_t>& members : members_of(group_of, groups)) {
    const Standing group = subset(all, members);
    ConvexParts own;
    if (options.split) {
      std::vector<float> depths;
      for (const Vector3f& p : group.points) depths.push_back(p.z());
      const auto depth = static_cast<double>(median(depths));
      const double scale = std::max(1.0, depth_noise(depth) / depth_noise(1.0));
      own = split_at_concave_edges(group.points, group.normals, scale, options.parts);
    } else {
      own.part_of_point.assign(members.size(), 0);
      own.count = 1;
    }
    for (size_t i = 0; i < members.size(); ++i)
      parts.part_of_point[members[i]] = parts.count + own.part_of_point[i];
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
  table.number("tolerance_m", tolerance_m, "m", "Largest gap inside one object.", 0.001, 1);
  table.number("floor_m", floor_m, "m",
               "Points this near to the plane belong to it (plus 1.5 times the noise).", 0, 0.1);
  table.number("min_height_m", min_height_m, "m", "Lower things are part of the support.", 0, 1);
  table.number("max_height_m", max_height_m, "m", "Points further above a support do not belong to it.", 0.05,
               3);
  table.number("min_extent_m", min_extent_m, "m", "Things that are smaller in every direction are noise.", 0,
               1);
  table.number("max_extent_m", max_extent_m, "m", "Things that are longer are furniture.", 0.05, 10);
  table.integer("min_points", min_points, "px", "Fewest pixels of an object.", 1, 100000);
  table.number("resting_m", resting_m, "m", "An object's foot is at most this far above what it stands on.",
               0, 1);
  table.number("margin_m", margin_m, "m", "How far an object may reach over the edge of its support.", 0, 1);
  table.flag("split", split, "Split touching things where their surface is concave.");
  parts.declare(table);
  assembly.declare(table);
}

std::vector<ObjectCluster> extract_clusters(const cv::Mat& points, const cv::Mat& normals,
                                            const cv::Mat& region, const PinholeCamera& camera,
                                            const std::vector<SupportPlane>& supports,
                                            const ClusterOptions& options) {
  std::vector<ObjectCluster> clusters;
  const std::vector<Standing> standing =
      stand_on_supports(points, normals, region, camera, supports, options);
  for (size_t s = 0; s < supports.size(); ++s) {
    const Standing& all = standing[s];
    const ClusterMaker maker(points, region, supports[s], static_cast<int>(s), options);
    const Vector2f viewpoint = supports[s].in_plane(Vector3d::Zero()).head<2>().cast<float>();
    const ConvexParts parts = parts_of(all, options);
    int count = 0;
    const std::vector<int> thing_of_part =
        assemble_parts(parts,
                       {all.in_plane, all.normals_in_plane, all.areas, viewpoint,
                        supports[s].camera_from_plane, camera, points},
                       options.assembly, count);
    std::vector<int> thing_of_point(all.pixels.size());
    for (size_t i = 0; i < thing_of_point.size(); ++i)
      thing_of_point[i] = thing_of_part[static_cast<size_t>(parts.part_of_point[i])];
    std::vector<ObjectCluster> own;
    for (const std::vector<size_t>& thing : members_of(thing_of_point, count))
      if (auto cluster = maker.make(subset(all, thing))) own.push_back(std::move(*cluster));
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

}  // namespace loci
