#include "perception/annotators/hypotheses/known_structure.h"

#include <algorithm>
#include <cmath>

#include "perception/annotators/hypotheses/support_planes.h"

namespace loci {
namespace {

constexpr double kAround = 0.15;  ///< metres

double inside_convex(const std::vector<Vector2d>& outline, const Vector2d& position) {
  double least = 1e9;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const double length = edge.norm();
    if (length < 1e-9) continue;
    const Vector2d to = position - outline[i];
    least = std::min(least, (edge.x() * to.y() - edge.y() * to.x()) / length);
  }
  return least;
}

/// The region with the highest surface below a point; -1 = none. Gives the height over it.
int region_of(const Vector3d& point, const std::vector<Region>& regions,
              const std::vector<Isometry3d>& top_from_map, const KnownStructureOptions& options,
              double& height) {
  int best = -1;
  for (size_t r = 0; r < regions.size(); ++r) {
    const Vector3d p = top_from_map[r] * point;
    if (p.z() < -options.support_tolerance_m || p.z() > options.region_height_m) continue;
    if (best >= 0 && p.z() >= height) continue;
    // Above the surface the surroundings are kept too, to tell what merely reaches over it.
    const double margin = p.z() > options.support_tolerance_m ? kAround : options.margin_m;
    if (inside_convex(regions[r].surface->outline, p.head<2>()) < -margin) continue;
    best = static_cast<int>(r);
    height = p.z();
  }
  return best;
}

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
  std::vector<Isometry3d> top_from_map;
  for (const SupportSurface& surface : surfaces) {
    result.regions.push_back({&surface, map.scene.map_from_link(surface.link_id) * surface.link_from_top, 0});
    top_from_map.push_back(result.regions.back().map_from_top.inverse());
  }
  std::vector<bool> is_surface(map.scene.link_names().size(), false);
  for (const SupportSurface& surface : surfaces) is_surface[surface.link_id] = true;
  result.region = cv::Mat::zeros(points.size(), CV_16U);
  result.kind = cv::Mat::zeros(points.size(), CV_8U);
  const auto set_kind = [&](int pixel, PixelKind kind) {
    result.kind.ptr<uint8_t>()[pixel] = static_cast<uint8_t>(kind);
  };
  const auto keep = [&](int pixel, int region) {
    result.region.ptr<uint16_t>()[pixel] = static_cast<uint16_t>(region + 1);
    ++result.regions[static_cast<size_t>(region)].pixels;
    set_kind(pixel, PixelKind::interest);
  };
  const auto* point = points.ptr<cv::Vec3f>();
  for (int i = 0; i < points.rows * points.cols; ++i) {
    const auto z = static_cast<double>(point[i][2]);
    if (std::isnan(z)) continue;
    const Vector3d p =
        map_from_camera * Vector3d(static_cast<double>(point[i][0]), static_cast<double>(point[i][1]), z);
    double height = 0;
    const int region = region_of(p, result.regions, top_from_map, options, height);
    const double tolerance = options.support_tolerance_m + 2 * depth_noise(z);
    const auto model = static_cast<double>(view.depth.ptr<float>()[i]);
    const bool explained = model - z <= options.epsilon_m + 2 * depth_noise(z);
    const int link = view.link.ptr<int>()[i];
    const bool by_surface = link >= 0 && is_surface[static_cast<size_t>(link)];
    // Around the height of a surface the point belongs to it, even where the map has the surface lower; but
    // not the foot of the wall behind it.
    if (region >= 0 && std::abs(height) <= tolerance && (!explained || by_surface)) {
      keep(i, region);
      continue;
    }
    if (explained) {
      ++result.known;
      set_kind(i, PixelKind::known);
      continue;
    }
    if (region < 0) {
      ++result.outside;
      set_kind(i, PixelKind::irrelevant);
      continue;
    }
    keep(i, region);
  }
  return result;
}

}  // namespace loci
