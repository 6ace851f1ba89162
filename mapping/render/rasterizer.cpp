#include "mapping/render/rasterizer.h"

#include <algorithm>
#include <cmath>

#include "mapping/render/depth_tiles.h"
#include "mapping/render/placed_vertices.h"
#include "mapping/render/triangle_fill.h"

namespace loci::mapping::render_detail {
namespace {

using Eigen::Vector3d;

constexpr int kSmallArea =
    16;  ///< triangles within so many pixels are compared with them before they are set up
constexpr double kBoundSlack = 1e-6;  ///< pixels; edges decide exactly, bounds need not

/// A box before the camera, its sides along the camera's axes: what a cluster can reach.
struct Reach {
  Vector3d low, high;

  Reach(const Vector3d& centre, const Vector3d& half) : low(centre - half), high(centre + half) {}
};

class RowBand {
 public:
  RowBand(const PinholeCamera& camera, const DrawOptions& options, int row_begin, int row_end, Raster& raster)
      : camera_(camera),
        options_(options),
        w_near_(1 / options.near_m),
        w_far_(1 / options.far_m),
        row_begin_(row_begin),
        row_end_(row_end),
        most_{0, static_cast<int16_t>(1 - camera.width), static_cast<int16_t>(row_begin),
              static_cast<int16_t>(1 - row_end)},
        raster_(raster),
        tiles_(raster.inverse_depth.data(), camera.width, row_begin, row_end),
        fill_(camera, options, raster) {}

  void draw(const PlacedSurface& placed) {
    const Surface& surface = *placed.surface;
    const Eigen::Matrix3d rotation = placed.camera_from_link->linear();
    const Eigen::Matrix3d extent = rotation.cwiseAbs() * (1 + 1e-12);  // Never smaller for rounding.
    const Vector3d translation = placed.camera_from_link->translation();
    PixelBox box;
    if (!may_be_seen({rotation * surface.centre + translation, extent * surface.half}, box)) return;
    set_projection(*placed.camera_from_link);
    // What is nearer hides what is behind it: the far side of a body behind its near side.
    order_.clear();
    for (const Cluster& cluster : surface.clusters)
      order_.emplace_back(
          static_cast<float>(rotation.row(2).dot(cluster.centre) - extent.row(2).dot(cluster.half)),
          &cluster);
    if (options_.occlusion_culling) std::ranges::sort(order_);
    for (const auto& [depth, cluster] : order_) {
      const Reach reach(rotation * cluster->centre + translation, extent * cluster->half);
      if (!may_be_seen(reach, box)) continue;
      place_vertices(&surface.x[cluster->first_vertex], &surface.y[cluster->first_vertex],
                     &surface.z[cluster->first_vertex], cluster->vertices, projection_, vertices_);
      const bool before = reach.low.z() > options_.near_m;
      // Its corners say more closely where it is than its box did.
      if (before && options_.occlusion_culling && corners_hidden(cluster->vertices, box)) continue;
      if (draw_cluster(surface, *cluster, before, placed.number)) tiles_.changed(box);
    }
  }

 private:
  /// Whether something in a box may be seen, and in which pixels.
  bool may_be_seen(const Reach& reach, PixelBox& box) {
    const Vector3d &low = reach.low, &high = reach.high;
    if (high.z() < options_.near_m || low.z() > options_.far_m) return false;
    box = {0, camera_.width - 1, row_begin_, row_end_ - 1};
    if (!(low.z() > options_.near_m)) return in_frustum(reach);
    const double w0 = 1 / low.z(), w1 = 1 / high.z();
    const double slack = 1e-3;
    box.u_first = first_pixel(camera_.fx * std::min(low.x() * w0, low.x() * w1) + camera_.cx - slack, 0,
                              camera_.width - 1);
    box.u_last = last_pixel(camera_.fx * std::max(high.x() * w0, high.x() * w1) + camera_.cx + slack, 0,
                            camera_.width - 1);
    box.v_first = first_pixel(camera_.fy * std::min(low.y() * w0, low.y() * w1) + camera_.cy - slack,
                              row_begin_, row_end_ - 1);
    box.v_last = last_pixel(camera_.fy * std::max(high.y() * w0, high.y() * w1) + camera_.cy + slack,
                            row_begin_, row_end_ - 1);
    return !box.empty() &&
           !(options_.occlusion_culling && tiles_.hidden(box, static_cast<float>(w0 * (1 + 1e-12))));
  }

  /// Whether everything between the placed corners, all before the near plane, is outside the band or hidden;
  /// `box` is set to the pixels that they can cover otherwise.
  bool corners_hidden(uint32_t count, PixelBox& box) {
    PixelReach reach = vertices_.reach[0];
    double w_high = vertices_.w[0];
    for (uint32_t i = 1; i < count; ++i) {
      reach = vertices_.reach[i] < reach ? vertices_.reach[i] : reach;
      w_high = std::max(w_high, vertices_.w[i]);
    }
    reach = reach > most_ ? reach : most_;
    const PixelBox exact{reach[0], -reach[1], reach[2], -reach[3]};
    if (exact.empty() || tiles_.hidden(exact, static_cast<float>(w_high))) return true;
    box = exact;
    return false;
  }

  /// Whether a box that crosses the near plane may reach into the band's frustum.
  bool in_frustum(const Reach& reach) const {
    const Vector3d centre = (reach.low + reach.high) / 2, half = (reach.high - reach.low) / 2;
    const double left = camera_.cx + 0.5, right = camera_.width - 0.5 - camera_.cx;
    const double top = camera_.cy - row_begin_ + 0.5, bottom = row_end_ - 0.5 - camera_.cy;
    for (const Vector3d& inward : {Vector3d(camera_.fx, 0, left), Vector3d(-camera_.fx, 0, right),
                                   Vector3d(0, camera_.fy, top), Vector3d(0, -camera_.fy, bottom)})
      if (inward.dot(centre) + inward.cwiseAbs().dot(half) < 0) return false;
    return true;
  }

  void set_projection(const Eigen::Isometry3d& camera_from_link) {
    const double scale[3] = {camera_.fx, camera_.fy, 1};
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        projection_.m[row][column] = camera_from_link.matrix()(row, column) * scale[row];
    projection_.cx = camera_.cx;
    projection_.cy = camera_.cy;
    projection_.u_limit = camera_.width + 1;
    projection_.v_limit = camera_.height + 1;
  }

  /// `before`: the whole cluster lies before the near plane's far side.
  bool draw_cluster(const Surface& surface, const Cluster& cluster, bool before, uint32_t instance) {
    bool drawn = false;
    const std::array<uint8_t, 3>* triangles = &surface.triangles[cluster.first_triangle];
    for (uint32_t i = 0; i < cluster.triangles; ++i) {
      const auto [a, b, c] = triangles[i];
      const PixelReach reach = held_reach(a, b, c);
      // Most small triangles lie between pixel centres.
      if (before && (reach[0] + reach[1] > 0 || reach[2] + reach[3] > 0)) continue;
      PixelBox box{reach[0], -reach[1], reach[2], -reach[3]};
      double w_low = w_far_, w_high = w_near_;
      bool clipped = false;
      if (before || std::min({vertices_.z[a], vertices_.z[b], vertices_.z[c]}) >= options_.near_m) {
        w_low = std::min({vertices_.w[a], vertices_.w[b], vertices_.w[c]});
        w_high = std::max({vertices_.w[a], vertices_.w[b], vertices_.w[c]});
      } else {
        clipped = true;
        box = clipped_bounds({a, b, c});
      }
      if (box.empty() || covered(box, static_cast<float>(w_high))) continue;
      const PlacedTriangle triangle = {{corner(a), corner(b), corner(c)},
                                       w_low,
                                       w_high,
                                       clipped,
                                       surface_id(instance, cluster.first_triangle + i)};
      drawn |= fill_.fill(triangle, box);
    }
    return drawn;
  }

  Vector3d corner(uint8_t i) const { return {vertices_.x[i], vertices_.y[i], vertices_.z[i]}; }

  /// Pixels of the band that a triangle in front of the near plane can cover.
  PixelReach held_reach(uint8_t a, uint8_t b, uint8_t c) const {
    const PixelReach &p = vertices_.reach[a], &q = vertices_.reach[b], &r = vertices_.reach[c];
    PixelReach least = p < q ? p : q;
    least = least < r ? least : r;
    return least > most_ ? least : most_;
  }

  /// Those of one that crosses it; may be empty. Coverage itself needs no clipping: the edge functions are
  /// homogeneous.
  PixelBox clipped_bounds(const std::array<uint8_t, 3>& corners) const {
    Eigen::AlignedBox2d bounds;
    for (size_t i = 0; i < 3; ++i) {
      const Vector3d from = corner(corners[i]), to = corner(corners[(i + 1) % 3]);
      const bool from_in = from.z() >= options_.near_m, to_in = to.z() >= options_.near_m;
      if (from_in) bounds.extend(Eigen::Vector2d(from.head<2>() / from.z()));
      if (from_in != to_in) {
        const Vector3d cut = from + (options_.near_m - from.z()) / (to.z() - from.z()) * (to - from);
        bounds.extend(Eigen::Vector2d(cut.head<2>() * w_near_));
      }
    }
    if (bounds.isEmpty()) return {0, -1, 0, -1};
    return {first_pixel(bounds.min().x() + camera_.cx - kBoundSlack, 0, camera_.width - 1),
            last_pixel(bounds.max().x() + camera_.cx + kBoundSlack, 0, camera_.width - 1),
            first_pixel(bounds.min().y() + camera_.cy - kBoundSlack, row_begin_, row_end_ - 1),
            last_pixel(bounds.max().y() + camera_.cy + kBoundSlack, row_begin_, row_end_ - 1)};
  }

  /// Whether a small triangle has only nearer surfaces in front of it: cheaper to find out than to set it up.
  bool covered(const PixelBox& box, float w_high) const {
    if (!options_.occlusion_culling || box.area() > kSmallArea) return false;
    for (int row = box.v_first; row <= box.v_last; ++row) {
      const float* line = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(row) * camera_.width;
      for (int u = box.u_first; u <= box.u_last; ++u)
        if (!(line[u] > w_high)) return false;
    }
    return true;
  }

  const PinholeCamera& camera_;
  const DrawOptions& options_;
  double w_near_, w_far_;
  int row_begin_, row_end_;
  PixelReach most_;  ///< the band
  Raster& raster_;
  DepthTiles tiles_;
  TriangleFill fill_;
  Projection projection_{};
  PlacedVertices vertices_;
  std::vector<std::pair<float, const Cluster*>> order_;
};

}  // namespace

void draw_rows(const std::vector<PlacedSurface>& surfaces, const PinholeCamera& camera,
               const DrawOptions& options, int row_begin, int row_end, Raster& raster) {
  RowBand band(camera, options, row_begin, row_end, raster);
  for (const PlacedSurface& surface : surfaces) band.draw(surface);
}

}  // namespace loci::mapping::render_detail
