#pragma once

#include <functional>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/world/mesh.h"

namespace loci::mapping {

/// Colour by position on a surface, both in [0,1]: along or around it, and up it.
using Paint = std::function<Rgba(double u, double v)>;
/// The same everywhere.
Paint plain(const Rgba& color);

/// Points (radius, height) from bottom to top.
using Profile = std::vector<Vector2d>;
/// Cuts the long straight parts of a profile, so that paint can change along them.
Profile finely(const Profile& profile, double step);

/// Puts simple shapes together as one mesh; all are closed, triangles counter-clockwise from outside.
class ShapeBuilder {
 public:
  /// Turns a profile of (radius, height) points about z. Going up the profile, the outside is where the
  /// radius grows to. Colours are asked by angle and by part of the way along the profile.
  void lathe(const Profile& profile, const Paint& paint, int segments = 40);

  /// Axis-parallel box between two corners; its front (-y) is cut into columns × rows cells, so that it can
  /// carry an image (v = 1 at the top).
  void box(const Vector3d& low, const Vector3d& high, const Rgba& color, const Paint& front, int columns,
           int rows);
  void box(const Vector3d& low, const Vector3d& high, const Rgba& color);

  /// A round bar along a path that lies in a plane with normal `plane`, with one radius per point.
  void tube(const std::vector<Vector3d>& path, const std::vector<double>& radii, const Vector3d& plane,
            const Rgba& color, int segments = 14);

  /// Triangles made elsewhere, with a colour each.
  void append(const TriangleMesh& mesh);

  TriangleMesh take() { return std::move(mesh_); }

 private:
  uint32_t add(const Vector3d& vertex);
  void triangle(uint32_t a, uint32_t b, uint32_t c, const Rgba& color);
  void grid(const Vector3d& corner, const Vector3d& along, const Vector3d& up, int columns, int rows,
            const Paint& paint);

  TriangleMesh mesh_;
};

}  // namespace loci::mapping
