#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math/math.h"
#include "mapping/exchange/furniture_structure.h"
#include "mapping/exchange/map_structure.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/world_triangles.h"

namespace loci::mapping {
namespace {

constexpr double kMinSurface = 0.05;       // m²
constexpr double kMinWall = 0.5;           // m²
constexpr double kReveal = 0.3;            // m; narrower faces of walls
constexpr double kMinSupportHeight = 0.2;  // m; lower surfaces are the floor or plinths
constexpr double kMaxSupportHeight = 2.0;
constexpr double kFreeAbove = 0.25;  // m; less room above and nothing can be put there or seen
constexpr double kSameHeight = 0.01;

bool over(const WorldTriangle& triangle, const Vector3d& point) {
  const Vector2d p = point.head<2>();
  double first = 0;
  for (size_t k = 0; k < 3; ++k) {
    const Vector2d a = triangle.corners[k].head<2>();
    const Vector2d b = triangle.corners[(k + 1) % 3].head<2>();
    const double side = (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
    if (k == 0) first = side;
    if (side * first <= 0) return false;
  }
  const double z = triangle.corners[0].z() -
                   triangle.normal.head<2>().dot(p - triangle.corners[0].head<2>()) / triangle.normal.z();
  return z > point.z() + kSameHeight && z < point.z() + kFreeAbove;
}

/// Fraction of a patch's area with room above, judged at the middles of its triangles.
double open_fraction(const std::vector<const WorldTriangle*>& patch, const std::vector<WorldTriangle>& all) {
  double open = 0;
  double total = 0;
  for (const WorldTriangle* triangle : patch) {
    const Vector3d middle = (triangle->corners[0] + triangle->corners[1] + triangle->corners[2]) / 3;
    const bool covered = std::any_of(all.begin(), all.end(), [&](const WorldTriangle& other) {
      return std::abs(other.normal.z()) > 0.1 && over(other, middle);
    });
    total += triangle->area;
    open += covered ? 0 : triangle->area;
  }
  return open / total;
}

/// Whether a ray hits a triangle within its reach.
bool hit(const WorldTriangle& triangle, const Vector3d& origin, const Vector3d& ray, double reach = 1e9) {
  const double slope = triangle.normal.dot(ray);
  if (std::abs(slope) < 1e-9) return false;
  const double distance = triangle.normal.dot(triangle.corners[0] - origin) / slope;
  if (distance < 1e-3 || distance > reach) return false;
  const Vector3d at = origin + distance * ray;
  for (size_t k = 0; k < 3; ++k) {
    const Vector3d edge = triangle.corners[(k + 1) % 3] - triangle.corners[k];
    if (edge.cross(at - triangle.corners[k]).dot(triangle.normal) < 0) return false;
  }
  return true;
}

/// Whether some ray leaves a surface: boards in closed cabinets show to nobody.
bool seen_from_outside(const std::vector<const WorldTriangle*>& patch,
                       const std::vector<WorldTriangle>& all) {
  constexpr double kOutside = 1.2;  // m; cabinets are less wide from their middle
  constexpr int kDirections = 16;
  const auto leaves = [&](const Vector3d& from, const Vector3d& ray) {
    return std::ranges::none_of(all,
                                [&](const WorldTriangle& other) { return hit(other, from, ray, kOutside); });
  };
  return std::ranges::any_of(patch, [&](const WorldTriangle* triangle) {
    const Vector3d from = (triangle->corners[0] + triangle->corners[1] + triangle->corners[2]) / 3;
    for (const double rise : {45 * kDegree, 10 * kDegree})
      for (int i = 0; i < kDirections; ++i) {
        const double angle = 2 * kPi * i / kDirections;
        if (leaves(from,
                   {std::cos(angle) * std::cos(rise), std::sin(angle) * std::cos(rise), std::sin(rise)}))
          return true;
      }
    return false;
  });
}

void add_supports(const World& world, const std::vector<WorldTriangle>& triangles, MapStructure& structure) {
  const std::vector<bool> moving = moving_links(world);
  std::map<std::pair<size_t, long>, std::vector<const WorldTriangle*>> patches;
  for (const WorldTriangle& triangle : triangles) {
    const double z = triangle.corners[0].z();
    if (triangle.normal.z() > 0.99 && z > kMinSupportHeight && z < kMaxSupportHeight)
      patches[{triangle.link, std::lround(z / kSameHeight)}].push_back(&triangle);
  }
  for (const auto& [key, patch] : patches) {
    SurfacePatch surface;
    double area = 0;
    for (const WorldTriangle* triangle : patch) {
      std::vector<Vector2d> polygon;
      for (const Vector3d& corner : triangle->corners) polygon.push_back(corner.head<2>());
      surface.polygons.push_back(std::move(polygon));
      surface.height += triangle->area * triangle->corners[0].z();
      area += triangle->area;
    }
    if (area < kMinSurface) continue;
    surface.height /= area;
    surface.name = world.links[key.first].name;
    surface.main =
        !moving[key.first] && open_fraction(patch, triangles) > 0.5 && seen_from_outside(patch, triangles);
    structure.supports.push_back(std::move(surface));
  }
}

/// Whether a wall's face looks into the world, not away from it: something stands before a part of it.
bool looks_inwards(const std::vector<const WorldTriangle*>& patch, const std::vector<WorldTriangle>& all) {
  return std::any_of(patch.begin(), patch.end(), [&](const WorldTriangle* triangle) {
    const Vector3d middle = (triangle->corners[0] + triangle->corners[1] + triangle->corners[2]) / 3;
    return std::any_of(all.begin(), all.end(),
                       [&](const WorldTriangle& other) { return hit(other, middle, triangle->normal); });
  });
}

/// Whether a link is called a wall and carries no furniture that opens: a wall cupboard does.
bool is_called_wall(const World& world, const std::string& name) {
  if (name.find("wall") == std::string::npos) return false;
  return std::ranges::none_of(world.joints, [&](const Joint& joint) {
    if (joint.type == JointType::fixed) return false;
    for (const Joint* above = &joint; above != nullptr; above = world.parent_joint(above->parent))
      if (above->child == name || above->parent == name) return true;
    return false;
  });
}

/// Whether nearly all of a world lies before a wall that reaches up to where no furniture does.
bool bounds_room(const WallPatch& wall, const std::vector<WorldTriangle>& triangles) {
  constexpr double kMinTop = 1.9, kThickness = 0.5;  // m
  constexpr double kMaxBeyond = 0.02;                // of the world's surface
  constexpr double kMinLength = 1;                   // m
  if (wall.top < kMinTop || wall.along_max - wall.along_min < kMinLength) return false;
  double all = 0, beyond = 0, before = 0;
  for (const WorldTriangle& triangle : triangles) {
    const Vector3d middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3;
    const double distance = wall.normal.dot(middle) - wall.offset;
    all += triangle.area;
    if (distance < -kThickness) beyond += triangle.area;
    if (distance > 0) before += triangle.area;
  }
  return beyond < kMaxBeyond * all && before > all / 2;
}

void add_walls(const World& world, const std::vector<WorldTriangle>& triangles, MapStructure& structure) {
  std::map<std::array<long, 3>, std::vector<const WorldTriangle*>> patches;  // link, direction, offset
  for (const WorldTriangle& triangle : triangles) {
    if (std::abs(triangle.normal.z()) > 0.05) continue;
    const long angle = std::lround(std::atan2(triangle.normal.y(), triangle.normal.x()) * 60);
    const long offset = std::lround(triangle.normal.dot(triangle.corners[0]) / 0.02);
    patches[{static_cast<long>(triangle.link), angle, offset}].push_back(&triangle);
  }
  for (const auto& [key, patch] : patches) {
    double area = 0;
    WallPatch wall;
    wall.normal = patch.front()->normal;
    wall.offset = wall.normal.dot(patch.front()->corners[0]);
    wall.along_min = wall.bottom = 1e9;
    wall.along_max = wall.top = -1e9;
    for (const WorldTriangle* triangle : patch) {
      area += triangle->area;
      for (const Vector3d& corner : triangle->corners) {
        const double along = wall.normal.x() * corner.y() - wall.normal.y() * corner.x();
        wall.along_min = std::min(wall.along_min, along);
        wall.along_max = std::max(wall.along_max, along);
        wall.bottom = std::min(wall.bottom, corner.z());
        wall.top = std::max(wall.top, corner.z());
      }
    }
    if (area < kMinWall || wall.top < 1.2) continue;
    wall.name = world.links[static_cast<size_t>(key[0])].name;
    // Sides of furniture are vertical planes too; links that are called so are walls to be found, on the side
    // that faces the room, and reveals and ends of walls need not be. Where none is called so, those that
    // bound all else are.
    wall.main = is_called_wall(world, wall.name) && wall.along_max - wall.along_min > kReveal &&
                looks_inwards(patch, triangles);
    structure.walls.push_back(std::move(wall));
  }
  if (std::ranges::any_of(structure.walls, &WallPatch::main)) return;
  for (WallPatch& wall : structure.walls) wall.main = bounds_room(wall, triangles);
}

}  // namespace

MapStructure structure_from_geometry(const World& world, const MeshSearch& search, Warnings& warnings) {
  MapStructure structure;
  structure.source = "geometry of the URDF";
  const std::vector<WorldTriangle> triangles = triangles_of(world, search, warnings);
  add_supports(world, triangles, structure);
  add_walls(world, triangles, structure);
  add_geometry_furniture(world, triangles, structure);
  return structure;
}

}  // namespace loci::mapping
