#include "perception/annotators/hypotheses/known_structure.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "mapping/base/parallel.h"
#include "perception/annotators/hypotheses/support_planes.h"

namespace loci {
namespace {

constexpr double kAround = 0.15;  ///< metres

/// A region as its test needs it, prepared once for all points.
struct Prism {
  struct Edge {
    Vector2d from, along;
    double length;
  };
  Isometry3d top_from_map;
  std::vector<Edge> edges;  ///< of the outline

  explicit Prism(const Region& region) : top_from_map(region.map_from_top.inverse()) {
    const std::vector<Vector2d>& outline = region.surface->outline;
    for (size_t i = 0; i < outline.size(); ++i) {
      const Vector2d along = outline[(i + 1) % outline.size()] - outline[i];
      if (const double length = along.norm(); length >= 1e-9) edges.push_back({outline[i], along, length});
    }
  }

  /// Whether a position lies within the outline, or at most `margin` outside.
  bool holds(const Vector2d& position, double margin) const {
    for (const Edge& edge : edges) {
      const Vector2d to = position - edge.from;
      if ((edge.along.x() * to.y() - edge.along.y() * to.x()) / edge.length < -margin) return false;
    }
    return true;
  }
};

/// The region with the highest surface below a point; -1 = none. Gives the height over it.
int region_of(const Vector3d& point, const std::vector<Prism>& prisms, const KnownStructureOptions& options,
              double& height) {
  int best = -1;
  for (size_t r = 0; r < prisms.size(); ++r) {
    const Vector3d p = prisms[r].top_from_map * point;
    if (p.z() < -options.support_tolerance_m || p.z() > options.region_height_m) continue;
    if (best >= 0 && p.z() >= height) continue;
    // Above the surface the surroundings are kept too, to tell what merely reaches over it.
    const double margin = p.z() > options.support_tolerance_m ? kAround : options.margin_m;
    if (!prisms[r].holds(p.head<2>(), margin)) continue;
    best = static_cast<int>(r);
    height = p.z();
  }
  return best;
}

/// Of a part of the picture.
struct Counts {
  explicit Counts(size_t regions) : pixels(regions, 0) {}
  int known = 0, outside = 0;
  std::vector<int> pixels;  ///< by region
};

}  // namespace

void KnownStructureOptions::declare(OptionTable& table) {
  table.texts("regions", regions,
              "Links or classes of the map above whose tops objects are looked for (* and ?).");
  table.number("epsilon_m", epsilon_m, "m",
               "A point is known when it is at most this far before a surface of the map (plus the noise).",
               0, 1);
  table.number("region_height_m", region_height_m, "m", "Height of the box above a surface.", 0.01, 5);
  table.number("support_tolerance_m", support_tolerance_m, "m",
               "Within this height a point belongs to the surface, whatever the map says.", 0, 0.2);
  table.number("margin_m", margin_m, "m", "How far the region reaches over the edge of its surface.", 0, 0.5);
}

KnownStructure find_known_structure(const cv::Mat& points, const PinholeCamera& camera,
                                    const Isometry3d& map_from_camera, KnownMap& map,
                                    const std::vector<SupportSurface>& surfaces, const JointState& joints,
                                    const KnownStructureOptions& options, int threads) {
  KnownStructure result;
  map.scene.set_joints(map.part, joints);
  const RenderedView view = map.scene.render(camera, map_from_camera, {}, threads);
  result.map_depth = view.depth;
  std::vector<Prism> prisms;
  for (const SupportSurface& surface : surfaces) {
    result.regions.push_back({&surface, map.scene.map_from_link(surface.link_id) * surface.link_from_top, 0});
    prisms.emplace_back(result.regions.back());
  }
  std::vector<bool> is_surface(map.scene.link_names().size(), false);
  for (const SupportSurface& surface : surfaces) is_surface[surface.link_id] = true;
  result.region = cv::Mat::zeros(points.size(), CV_16U);
  result.kind = cv::Mat::zeros(points.size(), CV_8U);
  std::mutex counting;
  const auto classify = [&](size_t first_row, size_t end_row) {
    Counts counts(prisms.size());
    const auto set = [&](int pixel, PixelKind kind, int region) {
      result.kind.ptr<uint8_t>()[pixel] = static_cast<uint8_t>(kind);
      result.region.ptr<uint16_t>()[pixel] = static_cast<uint16_t>(region + 1);
      if (kind == PixelKind::known) ++counts.known;
      if (kind == PixelKind::irrelevant) ++counts.outside;
      if (kind == PixelKind::interest) ++counts.pixels[static_cast<size_t>(region)];
    };
    const auto* point = points.ptr<cv::Vec3f>();
    const int end = static_cast<int>(end_row) * points.cols;
    for (int i = static_cast<int>(first_row) * points.cols; i < end; ++i) {
      const auto z = static_cast<double>(point[i][2]);
      if (std::isnan(z)) continue;
      const auto model = static_cast<double>(view.depth.ptr<float>()[i]);
      const bool explained = model - z <= options.epsilon_m + 2 * depth_noise(z);
      const int link = view.link.ptr<int>()[i];
      const bool by_surface = link >= 0 && is_surface[static_cast<size_t>(link)];
      if (explained && !by_surface) {  // Known, wherever it lies.
        set(i, PixelKind::known, -1);
        continue;
      }
      const Vector3d p =
          map_from_camera * Vector3d(static_cast<double>(point[i][0]), static_cast<double>(point[i][1]), z);
      double height = 0;
      const int region = region_of(p, prisms, options, height);
      const double tolerance = options.support_tolerance_m + 2 * depth_noise(z);
      // Around the height of a surface the point belongs to it, even where the map has the surface lower; but
      // not the foot of the wall behind it.
      if (region >= 0 && (!explained || std::abs(height) <= tolerance))
        set(i, PixelKind::interest, region);
      else
        set(i, explained ? PixelKind::known : PixelKind::irrelevant, -1);
    }
    const std::lock_guard lock(counting);
    result.known += counts.known;
    result.outside += counts.outside;
    for (size_t r = 0; r < counts.pixels.size(); ++r) result.regions[r].pixels += counts.pixels[r];
  };
  parallel_for(static_cast<size_t>(points.rows), threads, classify);
  return result;
}

}  // namespace loci
