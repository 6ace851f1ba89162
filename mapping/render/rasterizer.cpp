#include "mapping/render/rasterizer.h"

#include <algorithm>
#include <cmath>

namespace loci::render_detail {
namespace {

using Eigen::Vector3d;

constexpr int kTile = 16;             ///< side of the tiles that occlusion is tested on, pixels
constexpr int kSmallWidth = 8;        ///< triangles at most this wide are tested pixel by pixel
constexpr int kSmallArea = 16;        ///< pixels
constexpr double kBoundSlack = 1e-6;  ///< pixels; edges decide exactly, bounds need not

/// Smallest integer >= x, clamped to [low, high + 1]; std::ceil is a call on plain x86-64.
int first_pixel(double x, int low, int high) {
  if (!(x > low)) return low;
  if (x > high) return high + 1;
  const int i = static_cast<int>(x);
  return i + (i < x ? 1 : 0);
}

/// Largest integer <= x, clamped to [low - 1, high].
int last_pixel(double x, int low, int high) {
  if (!(x < high)) return high;
  if (x < low) return low - 1;
  return static_cast<int>(x);
}

/// A·u + B·v + C over pixel offsets from the principal point. Evaluated by the same operations wherever a
/// pixel is, so that two triangles that share an edge get exactly opposite values for it: that is what makes
/// surfaces watertight.
struct Edge {
  double a, b, c;
  double
      limit;  ///< inside means value > limit: 0, or the number just below it where the edge itself is owned

  Edge(const Vector3d& from, const Vector3d& to, double sign)
      : a(sign * (from.y() * to.z() - from.z() * to.y())),
        b(sign * (from.z() * to.x() - from.x() * to.z())),
        c(sign * (from.x() * to.y() - from.y() * to.x())),
        limit(a > 0 || (a == 0 && b > 0) ? -std::numeric_limits<double>::denorm_min() : 0) {}
};

/// Homogeneous pixel position (fx·X, fy·Y, Z) and, in front of the near plane, its projection.
struct Vertex {
  Vector3d p;
  double u, v, w;  ///< offsets from the principal point, pixels; 1/Z
};

struct Bounds {
  double u_min = std::numeric_limits<double>::infinity(), u_max = -u_min;
  double v_min = u_min, v_max = -u_min;

  void add(double u, double v) {
    u_min = std::min(u_min, u);
    u_max = std::max(u_max, u);
    v_min = std::min(v_min, v);
    v_max = std::max(v_max, v);
  }
};

class RowBand {
 public:
  RowBand(const PinholeCamera& camera, double near_m, double far_m, int row_begin, int row_end,
          Raster& raster)
      : camera_(camera),
        near_(near_m),
        w_near_(1 / near_m),
        w_far_(1 / far_m),
        far_(far_m),
        row_begin_(row_begin),
        row_end_(row_end),
        raster_(raster),
        tiles_across_((camera.width + kTile - 1) / kTile) {
    const size_t tiles = static_cast<size_t>(tiles_across_ * ((row_end - row_begin + kTile - 1) / kTile));
    tile_w_.assign(tiles, 0.f);
    tile_dirty_.assign(tiles, 0);
    left_ = Vector3d(camera.fx, 0, camera.cx + 0.5).normalized();
    right_ = Vector3d(-camera.fx, 0, camera.width - 0.5 - camera.cx).normalized();
    top_ = Vector3d(0, camera.fy, camera.cy - row_begin + 0.5).normalized();
    bottom_ = Vector3d(0, -camera.fy, row_end - 0.5 - camera.cy).normalized();
  }

  void draw(const PlacedChunk& placed) {
    const Chunk& chunk = *placed.chunk;
    const Vector3d centre = *placed.camera_from_link * chunk.centre;
    if (outside(centre, chunk.radius)) return;
    int u0 = 0, u1 = camera_.width - 1, v0 = row_begin_, v1 = row_end_ - 1;
    if (centre.z() - chunk.radius > near_) {
      sphere_bounds(centre, chunk.radius, u0, u1, v0, v1);
      if (u0 > u1 || v0 > v1) return;
      if (hidden(u0, u1, v0, v1, static_cast<float>(1 / (centre.z() - chunk.radius)))) return;
    }
    place_vertices(chunk, *placed.camera_from_link);
    bool drawn = false;
    for (size_t i = 0; i < chunk.triangles.size(); ++i)
      drawn |= draw_triangle(chunk.triangles[i], chunk.first_triangle + static_cast<uint32_t>(i));
    if (drawn) mark_dirty(u0, u1, v0, v1);
  }

 private:
  bool outside(const Vector3d& centre, double radius) const {
    return centre.z() + radius < near_ || centre.z() - radius > far_ || left_.dot(centre) < -radius ||
           right_.dot(centre) < -radius || top_.dot(centre) < -radius || bottom_.dot(centre) < -radius;
  }

  /// Pixels that a sphere in front of the near plane can touch, by the box around it.
  void sphere_bounds(const Vector3d& centre, double radius, int& u0, int& u1, int& v0, int& v1) const {
    const double z0 = centre.z() - radius, z1 = centre.z() + radius;
    const double x0 = centre.x() - radius, x1 = centre.x() + radius;
    const double y0 = centre.y() - radius, y1 = centre.y() + radius;
    u0 = first_pixel(camera_.fx * std::min(x0 / z0, x0 / z1) + camera_.cx - 1, u0, u1);
    u1 = last_pixel(camera_.fx * std::max(x1 / z0, x1 / z1) + camera_.cx + 1, u0, u1);
    v0 = first_pixel(camera_.fy * std::min(y0 / z0, y0 / z1) + camera_.cy - 1, v0, v1);
    v1 = last_pixel(camera_.fy * std::max(y1 / z0, y1 / z1) + camera_.cy + 1, v0, v1);
  }

  /// Whether everything drawn so far in these pixels is nearer than 1/w.
  bool hidden(int u0, int u1, int v0, int v1, float w) {
    for (int row = (v0 - row_begin_) / kTile; row <= (v1 - row_begin_) / kTile; ++row)
      for (int column = u0 / kTile; column <= u1 / kTile; ++column)
        if (!(farthest(row, column) > w)) return false;
    return true;
  }

  /// The smallest inverse depth of a tile.
  float farthest(int row, int column) {
    const size_t tile = static_cast<size_t>(row * tiles_across_ + column);
    if (tile_dirty_[tile]) {
      tile_dirty_[tile] = 0;
      float w = std::numeric_limits<float>::infinity();
      const int v_end = std::min(row_end_, row_begin_ + (row + 1) * kTile);
      const int u_end = std::min(camera_.width, (column + 1) * kTile);
      for (int v = row_begin_ + row * kTile; v < v_end; ++v) {
        const float* line = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(v) * camera_.width;
        for (int u = column * kTile; u < u_end; ++u) w = std::min(w, line[u]);
      }
      tile_w_[tile] = w;
    }
    return tile_w_[tile];
  }

  void mark_dirty(int u0, int u1, int v0, int v1) {
    for (int row = (v0 - row_begin_) / kTile; row <= (v1 - row_begin_) / kTile; ++row)
      for (int column = u0 / kTile; column <= u1 / kTile; ++column)
        tile_dirty_[static_cast<size_t>(row * tiles_across_ + column)] = 1;
  }

  void place_vertices(const Chunk& chunk, const Eigen::Isometry3d& camera_from_link) {
    Eigen::Matrix<double, 3, 4> m = camera_from_link.matrix().topRows<3>();
    m.row(0) *= camera_.fx;
    m.row(1) *= camera_.fy;
    vertices_.resize(chunk.vertices.size());
    for (size_t i = 0; i < chunk.vertices.size(); ++i) {
      const double x = chunk.vertices[i].x(), y = chunk.vertices[i].y(), z = chunk.vertices[i].z();
      Vertex& vertex = vertices_[i];
      vertex.p = {m(0, 0) * x + m(0, 1) * y + m(0, 2) * z + m(0, 3),
                  m(1, 0) * x + m(1, 1) * y + m(1, 2) * z + m(1, 3),
                  m(2, 0) * x + m(2, 1) * y + m(2, 2) * z + m(2, 3)};
      if (vertex.p.z() < near_) continue;
      vertex.w = 1 / vertex.p.z();
      vertex.u = vertex.p.x() * vertex.w;
      vertex.v = vertex.p.y() * vertex.w;
    }
  }

  /// Bounds of the part of a triangle that lies in front of the near plane; false when there is none.
  /// Coverage itself needs no clipping: the edge functions are homogeneous.
  bool clipped_bounds(const std::array<const Vertex*, 3>& corners, Bounds& bounds) const {
    bool any = false;
    for (size_t i = 0; i < 3; ++i) {
      const Vertex &from = *corners[i], &to = *corners[(i + 1) % 3];
      const bool from_in = from.p.z() >= near_, to_in = to.p.z() >= near_;
      if (from_in) bounds.add(from.u, from.v);
      if (from_in != to_in) {
        const double t = (near_ - from.p.z()) / (to.p.z() - from.p.z());
        const Vector3d cut = from.p + t * (to.p - from.p);
        bounds.add(cut.x() * w_near_, cut.y() * w_near_);
      }
      any |= from_in;
    }
    return any;
  }

  /// Whether a small triangle has only nearer surfaces in front of it: cheaper to find out than to set it up.
  bool covered(int u0, int u1, int v0, int v1, float w_high) const {
    if ((u1 - u0 + 1) * (v1 - v0 + 1) > kSmallArea) return false;
    for (int row = v0; row <= v1; ++row) {
      const float* line = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(row) * camera_.width;
      for (int u = u0; u <= u1; ++u)
        if (!(line[u] > w_high)) return false;
    }
    return true;
  }

  bool draw_triangle(const std::array<uint32_t, 3>& triangle, uint32_t number) {
    const std::array<const Vertex*, 3> corners = {&vertices_[triangle[0]], &vertices_[triangle[1]],
                                                  &vertices_[triangle[2]]};
    const double z_min = std::min({corners[0]->p.z(), corners[1]->p.z(), corners[2]->p.z()});
    Bounds bounds;
    double w_low = w_far_, w_high = w_near_;
    if (z_min >= near_) {
      for (const Vertex* corner : corners) bounds.add(corner->u, corner->v);
      w_low = std::min({corners[0]->w, corners[1]->w, corners[2]->w});
      w_high = std::max({corners[0]->w, corners[1]->w, corners[2]->w});
    } else if (!clipped_bounds(corners, bounds)) {
      return false;
    }
    const int u0 = first_pixel(bounds.u_min + camera_.cx - kBoundSlack, 0, camera_.width - 1);
    const int u1 = last_pixel(bounds.u_max + camera_.cx + kBoundSlack, 0, camera_.width - 1);
    if (u0 > u1) return false;
    const int v0 = first_pixel(bounds.v_min + camera_.cy - kBoundSlack, row_begin_, row_end_ - 1);
    const int v1 = last_pixel(bounds.v_max + camera_.cy + kBoundSlack, row_begin_, row_end_ - 1);
    if (v0 > v1 || covered(u0, u1, v0, v1, static_cast<float>(w_high))) return false;

    const Vector3d &p0 = corners[0]->p, &p1 = corners[1]->p, &p2 = corners[2]->p;
    const double determinant = p0.dot(p1.cross(p2));
    if (determinant == 0 || !std::isfinite(determinant)) return false;  // Seen edge-on.
    const double sign = determinant < 0 ? -1 : 1;
    const std::array<Edge, 3> edges = {Edge(p1, p2, sign), Edge(p2, p0, sign), Edge(p0, p1, sign)};
    const double scale = sign / determinant;
    const Plane plane = {(edges[0].a + edges[1].a + edges[2].a) * scale,
                         (edges[0].b + edges[1].b + edges[2].b) * scale,
                         (edges[0].c + edges[1].c + edges[2].c) * scale,
                         w_low,
                         w_high,
                         z_min < near_};
    if (u1 - u0 < kSmallWidth)
      fill_small(edges, plane, u0, u1, v0, v1, number);
    else
      fill_spans(edges, plane, u0, u1, v0, v1, number);
    return true;
  }

  /// 1/z over the picture. Within a triangle it lies between those of its corners; slivers, whose plane is
  /// badly determined, are held to that.
  struct Plane {
    double a, b, c;
    double low, high;
    bool clipped;  ///< crosses the near plane: what lies beyond the range is cut off, not held
  };

  void write(const Plane& plane, double row_w, int u, float* inverse_depth, uint32_t* triangle,
             uint32_t number) const {
    double w = plane.a * (u - camera_.cx) + row_w;
    if (plane.clipped) {
      if (!(w >= w_far_ && w <= w_near_)) return;
    } else {
      w = std::min(std::max(w, plane.low), plane.high);
      if (w < w_far_) return;
    }
    const float value = static_cast<float>(w);
    if (value > inverse_depth[u] || (value == inverse_depth[u] && number < triangle[u])) {
      inverse_depth[u] = value;
      triangle[u] = number;
    }
  }

  void fill_small(const std::array<Edge, 3>& e, const Plane& plane, int u0, int u1, int v0, int v1,
                  uint32_t number) {
    for (int row = v0; row <= v1; ++row) {
      const double v = row - camera_.cy;
      const double r0 = e[0].b * v + e[0].c, r1 = e[1].b * v + e[1].c, r2 = e[2].b * v + e[2].c;
      float* inverse_depth = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(row) * camera_.width;
      uint32_t* triangle = raster_.triangle.data() + static_cast<ptrdiff_t>(row) * camera_.width;
      for (int column = u0; column <= u1; ++column) {
        const double u = column - camera_.cx;
        const bool inside =
            (e[0].a * u + r0 > e[0].limit) & (e[1].a * u + r1 > e[1].limit) & (e[2].a * u + r2 > e[2].limit);
        if (inside) write(plane, plane.b * v + plane.c, column, inverse_depth, triangle, number);
      }
    }
  }

  /// Narrows [first, last] to the pixels of a row that are inside an edge. The division only guesses; the
  /// edge function, which rounding leaves monotonic, decides.
  void narrow(const Edge& edge, double row_value, int& first, int& last) const {
    const auto inside = [&](int u) { return edge.a * (u - camera_.cx) + row_value > edge.limit; };
    if (edge.a == 0) {
      if (!(row_value > edge.limit)) last = first - 1;
      return;
    }
    const double guess = camera_.cx - row_value / edge.a;
    if (edge.a > 0) {
      int u = first_pixel(guess, first, last);
      while (u > first && inside(u - 1)) --u;
      while (u <= last && !inside(u)) ++u;
      first = u;
    } else {
      int u = last_pixel(guess, first, last);
      while (u < last && inside(u + 1)) ++u;
      while (u >= first && !inside(u)) --u;
      last = u;
    }
  }

  void fill_spans(const std::array<Edge, 3>& edges, const Plane& plane, int u0, int u1, int v0, int v1,
                  uint32_t number) {
    for (int row = v0; row <= v1; ++row) {
      const double v = row - camera_.cy;
      int first = u0, last = u1;
      for (const Edge& edge : edges) {
        narrow(edge, edge.b * v + edge.c, first, last);
        if (first > last) break;
      }
      float* inverse_depth = raster_.inverse_depth.data() + static_cast<ptrdiff_t>(row) * camera_.width;
      uint32_t* triangle = raster_.triangle.data() + static_cast<ptrdiff_t>(row) * camera_.width;
      const double row_w = plane.b * v + plane.c;
      for (int u = first; u <= last; ++u) write(plane, row_w, u, inverse_depth, triangle, number);
    }
  }

  const PinholeCamera& camera_;
  double near_, w_near_, w_far_, far_;
  int row_begin_, row_end_;
  Raster& raster_;
  int tiles_across_;
  std::vector<float> tile_w_;
  std::vector<uint8_t> tile_dirty_;
  Vector3d left_, right_, top_, bottom_;  ///< inward normals of the band's frustum
  std::vector<Vertex> vertices_;
};

}  // namespace

void draw_rows(const std::vector<PlacedChunk>& chunks, const PinholeCamera& camera, double near_m,
               double far_m, int row_begin, int row_end, Raster& raster) {
  RowBand band(camera, near_m, far_m, row_begin, row_end, raster);
  for (const PlacedChunk& chunk : chunks) band.draw(chunk);
}

}  // namespace loci::render_detail
