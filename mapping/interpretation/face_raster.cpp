#include "mapping/interpretation/face_raster.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/quantile.h"

namespace loci {
namespace {

constexpr double kAlignReach = 0.03;  // m; points used to align a scan with the face
constexpr double kAboveFloor = 0.03;  // m; what is lower is floor
constexpr size_t kFewestToAlign = 100;
constexpr float kLeastCosine = 0.15F;  // of incidence; intensity over less is noise

/// Looks along a ray from `origin` to `end` (face coordinates); false when it says nothing about the face.
bool meet(const Vector3d& origin, const Vector3d& end, bool known_origin, FaceRay& ray) {
  ray.depth = static_cast<float>(end.z());
  ray.u = static_cast<float>(end.x());
  ray.v = static_cast<float>(end.y());
  if (!known_origin) return std::abs(end.z()) < kBeforeFace;
  if (origin.z() < 0.05 || end.z() > kBeforeFace) return false;  // from behind, or ended long before
  const Vector3d way = end - origin;
  if (way.z() > -1e-6) return false;
  ray.slope_u = static_cast<float>(way.x() / way.z());
  ray.slope_v = static_cast<float>(way.y() / way.z());
  ray.u -= ray.slope_u * ray.depth;
  ray.v -= ray.slope_v * ray.depth;
  return true;
}

/// Median and slope along u of the depths of each scan become zero.
void align_scans(FaceRays& result, size_t scans) {
  for (size_t scan = 0; scan < scans; ++scan) {
    std::vector<FaceRay*> near;
    for (FaceRay& ray : result.rays)
      if (ray.scan == scan && ray.returned && std::abs(ray.depth) < kAlignReach) near.push_back(&ray);
    if (near.size() < kFewestToAlign) continue;
    double offset = 0;
    double slope = 0;
    double mean_u = 0;
    for (const FaceRay* ray : near) mean_u += static_cast<double>(ray->u) / static_cast<double>(near.size());
    for (int round = 0; round < 2; ++round) {
      std::vector<double> depths;
      double uu = 0;
      double ud = 0;
      for (const FaceRay* ray : near) {
        const double u = static_cast<double>(ray->u) - mean_u;
        depths.push_back(static_cast<double>(ray->depth) - slope * u);
      }
      offset = median(depths);
      for (const FaceRay* ray : near) {
        const double u = static_cast<double>(ray->u) - mean_u;
        const double d = static_cast<double>(ray->depth) - offset;
        if (std::abs(d - slope * u) > 0.015) continue;
        uu += u * u;
        ud += u * d;
      }
      const double spread = uu / static_cast<double>(near.size());
      if (spread > 0.04) slope = std::clamp(ud / uu, -0.01, 0.01);
    }
    for (FaceRay& ray : result.rays)
      if (ray.scan == scan && ray.returned)
        ray.depth -= static_cast<float>(offset + slope * (static_cast<double>(ray.u) - mean_u));
    ++result.scans;
  }
}

}  // namespace

FaceRays gather_rays(const Surface& surface, const Face& face, double floor_height) {
  FaceRays result;
  result.face = face;
  std::vector<Vector3d> origins;
  for (const Eigen::Vector3f& origin : surface.origins)
    origins.push_back(face.coordinates(origin.cast<double>()));
  FaceRect reach = FaceRect{face.u_min, face.u_max, face.v_min, face.v_max}.grown(kFaceMargin);
  reach.v0 = std::max(reach.v0, floor_height + kAboveFloor);
  const auto add = [&](const Eigen::Vector3f& end, uint32_t origin, FaceRay& ray) {
    const Vector3d at = face.coordinates(end.cast<double>());
    if (at.z() > kBeforeFace) return false;
    // A board that stands out of the face is met by rays that would cross the plane beside it.
    return meet(surface.free_space ? origins[origin] : Vector3d::Zero(), at, surface.free_space, ray) &&
           (reach.contains(static_cast<double>(ray.u), static_cast<double>(ray.v)) ||
            reach.contains(at.x(), at.y()));
  };
  for (const SurfacePoint& point : surface.points) {
    FaceRay ray;
    if (static_cast<double>(point.position.z()) < floor_height + kAboveFloor) continue;
    if (!add(point.position, point.origin, ray)) continue;
    ray.scan = point.scan;
    const float cosine = 1 / std::sqrt(1 + ray.slope_u * ray.slope_u + ray.slope_v * ray.slope_v);
    ray.look[0] = point.intensity / std::max(cosine, kLeastCosine);
    ray.look[1] = static_cast<float>(point.r) / 255.F;
    ray.look[2] = static_cast<float>(point.g) / 255.F;
    ray.look[3] = static_cast<float>(point.b) / 255.F;
    result.rays.push_back(ray);
  }
  align_scans(result, surface.scans);
  std::vector<double> deviations;
  for (const FaceRay& ray : result.rays)
    if (std::abs(ray.depth) < kAlignReach) deviations.push_back(std::abs(static_cast<double>(ray.depth)));
  result.sigma = deviations.empty() ? 0.01 : 1.4826 * median(deviations);
  for (const auto& [end, origin] : surface.free_ends) {
    FaceRay ray;
    if (!add(end, origin, ray)) continue;
    ray.returned = false;
    result.rays.push_back(ray);
  }
  return result;
}

FaceGrid::FaceGrid(const Face& face)
    : u0(face.u_min - kFaceMargin),
      v0(face.v_min - kFaceMargin),
      width(static_cast<int>((face.u_max - face.u_min + 2 * kFaceMargin) / kFaceCell) + 1),
      height(static_cast<int>((face.v_max - face.v_min + 2 * kFaceMargin) / kFaceCell) + 1) {}

}  // namespace loci
