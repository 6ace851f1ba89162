#include "perception/annotators/hypotheses/known_structure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "mapping/base/parallel.h"
#include "perception/annotators/hypotheses/in_view.h"
#include "perception/annotators/hypotheses/support_planes.h"

namespace loci::perception {
namespace {

constexpr double kAround = 0.15;  ///< metres

/// A region as its test needs it, prepared once for all points.
struct Prism {
  int region;
  Isometry3d top_from_camera;
  ConvexOutline outline;
};

/// The regions of which something may be in view.
std::vector<Prism> prisms_in_view(const std::vector<Region>& regions, const mapping::PinholeCamera& camera,
                                  const Isometry3d& map_from_camera, const KnownStructureOptions& options) {
  std::vector<Prism> prisms;
  for (size_t r = 0; r < regions.size(); ++r) {
    Eigen::AlignedBox3d box;
    for (const Vector2d& corner : regions[r].surface->outline) {
      box.extend(Vector3d(corner.x(), corner.y(), -options.support_tolerance_m));
      box.extend(Vector3d(corner.x(), corner.y(), options.region_height_m));
    }
    const Isometry3d camera_from_top = map_from_camera.inverse() * regions[r].map_from_top;
    // Around a corner the lines beside the edges meet farther away than the edges are.
    const double around = 4 * std::max(kAround, options.margin_m);
    if (out_of_view(camera_from_top * box.center(), box.diagonal().norm() / 2 + around, camera)) continue;
    prisms.push_back(
        {static_cast<int>(r), camera_from_top.inverse(), ConvexOutline(regions[r].surface->outline)});
  }
  return prisms;
}

/// The region with the highest surface below a point; -1 = none. Gives the height over it.
int region_of(const Vector3d& point, const std::vector<Prism>& prisms, const KnownStructureOptions& options,
              double& height) {
  int best = -1;
  for (const Prism& prism : prisms) {
    const double z =
        prism.top_from_camera.linear().row(2).dot(point) + prism.top_from_camera.translation().z();
    if (z < -options.support_tolerance_m || z > options.region_height_m) continue;
    if (best >= 0 && z >= height) continue;
    const Vector2d position = (prism.top_from_camera * point).head<2>();
    // Above the surface the surroundings are kept too, to tell what merely reaches over it.
    const double margin = z > options.support_tolerance_m ? kAround : options.margin_m;
    if (prism.outline.inside(position) < -margin) continue;
    best = prism.region;
    height = z;
  }
  return best;
}

/// Of a part of the image.
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

KnownStructure find_known_structure(const cv::Mat& points, const mapping::PinholeCamera& camera,
                                    const Isometry3d& map_from_camera, KnownMap& map,
                                    const std::vector<SupportSurface>& surfaces, const JointState& joints,
                                    const KnownStructureOptions& options, int threads) {
  KnownStructure result;
  map.scene.set_joints(map.part, joints);
  const mapping::RenderedView view = map.scene.render(camera, map_from_camera, {}, threads);
  result.map_depth = view.depth;
  for (const SupportSurface& surface : surfaces)
    result.regions.push_back({&surface, map.scene.map_from_link(surface.link_id) * surface.link_from_top, 0});
  const std::vector<Prism> prisms = prisms_in_view(result.regions, camera, map_from_camera, options);
  std::vector<char> is_surface(map.scene.link_names().size(), 0);
  for (const SupportSurface& surface : surfaces) is_surface[surface.link_id] = 1;
  result.region = cv::Mat::zeros(points.size(), CV_16U);
  result.kind = cv::Mat::zeros(points.size(), CV_8U);
  std::mutex counting;
  const auto classify = [&](size_t first_row, size_t end_row) {
    Counts counts(result.regions.size());
    auto* kind_of = result.kind.ptr<uint8_t>();
    auto* region_label = result.region.ptr<uint16_t>();
    const auto set = [&](int pixel, mapping::PixelKind kind, int region) {
      kind_of[pixel] = static_cast<uint8_t>(kind);
      region_label[pixel] = static_cast<uint16_t>(region + 1);
      if (kind == mapping::PixelKind::map_explained) ++counts.known;
      if (kind == mapping::PixelKind::background) ++counts.outside;
      if (kind == mapping::PixelKind::region_of_interest) ++counts.pixels[static_cast<size_t>(region)];
    };
    const auto* point = points.ptr<cv::Vec3f>();
    const auto* model_depth = view.depth.ptr<float>();
    const auto* model_link = view.link.ptr<int>();
    const int end = static_cast<int>(end_row) * points.cols;
    for (int i = static_cast<int>(first_row) * points.cols; i < end; ++i) {
      const auto z = static_cast<double>(point[i][2]);
      if (std::isnan(z)) continue;
      const double noise = 2 * depth_noise(z);
      const bool explained = static_cast<double>(model_depth[i]) - z <= options.epsilon_m + noise;
      const int link = model_link[i];
      const bool by_surface = link >= 0 && is_surface[static_cast<size_t>(link)] != 0;
      if (explained && !by_surface) {  // Known, wherever it lies.
        set(i, mapping::PixelKind::map_explained, -1);
        continue;
      }
      double height = 0;
      const Vector3d p(static_cast<double>(point[i][0]), static_cast<double>(point[i][1]), z);
      const int region = region_of(p, prisms, options, height);
      const double tolerance = options.support_tolerance_m + noise;
      // Around the height of a surface the point belongs to it, even where the map has the surface lower; but
      // not the foot of the wall behind it.
      if (region >= 0 && (!explained || std::abs(height) <= tolerance))
        set(i, mapping::PixelKind::region_of_interest, region);
      else
        set(i, explained ? mapping::PixelKind::map_explained : mapping::PixelKind::background, -1);
    }
    const std::lock_guard lock(counting);
    result.known += counts.known;
    result.outside += counts.outside;
    for (size_t r = 0; r < counts.pixels.size(); ++r) result.regions[r].pixels += counts.pixels[r];
  };
  parallel_for(static_cast<size_t>(points.rows), threads, classify);
  return result;
}

}  // namespace loci::perception
