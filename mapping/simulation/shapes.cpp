#include "mapping/simulation/shapes.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"

namespace loci::mapping {

Paint plain(const Rgba& color) {
  return [color](double, double) { return color; };
}

Profile finely(const Profile& profile, double step) {
  Profile result = {profile.front()};
  for (size_t i = 1; i < profile.size(); ++i) {
    const Vector2d way = profile[i] - profile[i - 1];
    const int parts = std::max(1, static_cast<int>(way.norm() / step));
    for (int k = 1; k <= parts; ++k) result.push_back(profile[i - 1] + way * k / parts);
  }
  return result;
}

void ShapeBuilder::append(const TriangleMesh& mesh) {
  const auto first = static_cast<uint32_t>(mesh_.vertices.size());
  mesh_.vertices.insert(mesh_.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& [a, b, c] : mesh.triangles) mesh_.triangles.push_back({first + a, first + b, first + c});
  mesh_.colors.insert(mesh_.colors.end(), mesh.colors.begin(), mesh.colors.end());
}

uint32_t ShapeBuilder::add(const Vector3d& vertex) {
  mesh_.vertices.push_back(vertex.cast<float>());
  return static_cast<uint32_t>(mesh_.vertices.size() - 1);
}

void ShapeBuilder::triangle(uint32_t a, uint32_t b, uint32_t c, const Rgba& color) {
  const auto& v = mesh_.vertices;
  if (v[a] == v[b] || v[b] == v[c] || v[a] == v[c]) return;  // At the axis of a lathe.
  mesh_.triangles.push_back({a, b, c});
  mesh_.colors.push_back(color);
}

void ShapeBuilder::lathe(const Profile& profile, const Paint& paint, int segments) {
  double length = 0;
  for (size_t i = 1; i < profile.size(); ++i) length += (profile[i] - profile[i - 1]).norm();
  const auto ring = [&](const Vector2d& at) {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    for (int i = 0; i < segments; ++i) {
      const double angle = 2 * kPi * i / segments;
      add({at.x() * std::cos(angle), at.x() * std::sin(angle), at.y()});
    }
    return first;
  };
  uint32_t low = ring(profile.front());
  double way = 0;
  for (size_t p = 1; p < profile.size(); ++p) {
    const uint32_t high = ring(profile[p]);
    const double step = (profile[p] - profile[p - 1]).norm();
    for (int i = 0; i < segments; ++i) {
      const auto a = static_cast<uint32_t>(i), b = static_cast<uint32_t>((i + 1) % segments);
      const Rgba color = paint((i + 0.5) / segments, (way + step / 2) / length);
      triangle(low + a, low + b, high + b, color);
      triangle(low + a, high + b, high + a, color);
    }
    way += step;
    low = high;
  }
}

void ShapeBuilder::grid(const Vector3d& corner, const Vector3d& along, const Vector3d& up, int columns,
                        int rows, const Paint& paint) {
  const auto first = static_cast<uint32_t>(mesh_.vertices.size());
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column)
      add(corner + along * column / columns + up * row / rows);
  const auto stride = static_cast<uint32_t>(columns) + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const uint32_t a = first + static_cast<uint32_t>(row) * stride + static_cast<uint32_t>(column);
      const Rgba color = paint((column + 0.5) / columns, (row + 0.5) / rows);
      triangle(a, a + 1, a + stride + 1, color);
      triangle(a, a + stride + 1, a + stride, color);
    }
  }
}

void ShapeBuilder::box(const Vector3d& low, const Vector3d& high, const Rgba& color, const Paint& front,
                       int columns, int rows) {
  const Vector3d x(high.x() - low.x(), 0, 0), y(0, high.y() - low.y(), 0), z(0, 0, high.z() - low.z());
  const Paint plain = [&](double, double) { return color; };
  grid(low, x, z, columns, rows, front);  // -y
  grid(low + x, y, z, 1, 1, plain);       // +x
  grid(low + x + y, -x, z, 1, 1, plain);  // +y
  grid(low + y, -y, z, 1, 1, plain);      // -x
  grid(low + z, x, y, 1, 1, plain);       // +z
  grid(low + y, x, -y, 1, 1, plain);      // -z
}

void ShapeBuilder::box(const Vector3d& low, const Vector3d& high, const Rgba& color) {
  box(
      low, high, color, [&](double, double) { return color; }, 1, 1);
}

void ShapeBuilder::tube(const std::vector<Vector3d>& path, const std::vector<double>& radii,
                        const Vector3d& plane, const Rgba& color, int segments) {
  const auto ring = [&](size_t at) {
    const Vector3d along = (path[std::min(at + 1, path.size() - 1)] - path[at > 0 ? at - 1 : 0]).normalized();
    const Vector3d side = along.cross(plane);
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    for (int i = 0; i < segments; ++i) {
      const double angle = 2 * kPi * i / segments;
      add(path[at] + radii[at] * (std::cos(angle) * plane + std::sin(angle) * side));
    }
    return first;
  };
  const auto cap = [&](size_t at, uint32_t first, bool end) {
    const uint32_t middle = add(path[at]);
    for (int i = 0; i < segments; ++i) {
      const uint32_t a = first + static_cast<uint32_t>(i),
                     b = first + static_cast<uint32_t>((i + 1) % segments);
      end ? triangle(middle, a, b, color) : triangle(middle, b, a, color);
    }
  };
  uint32_t low = ring(0);
  cap(0, low, false);
  for (size_t p = 1; p < path.size(); ++p) {
    const uint32_t high = ring(p);
    for (int i = 0; i < segments; ++i) {
      const auto a = static_cast<uint32_t>(i), b = static_cast<uint32_t>((i + 1) % segments);
      triangle(low + a, low + b, high + b, color);
      triangle(low + a, high + b, high + a, color);
    }
    low = high;
  }
  cap(path.size() - 1, low, true);
}

}  // namespace loci::mapping
