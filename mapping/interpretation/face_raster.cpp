#include "mapping/interpretation/face_raster.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/base/cell_index.h"
#include "mapping/base/quantile.h"

namespace loci::mapping {
namespace {

constexpr double kAlignReach = 0.03;  // m; points used to compare scans
constexpr double kAboveFloor = 0.03;  // m; what is lower is floor
constexpr double kMinPoints = 100;    // of a scan that saw the face
constexpr double kMinSpread = 0.04;   // m²; over less of the face no slope is told
constexpr double kMaxTurned = 0.01;   // rad
constexpr double kAgreeCell = 0.03;   // m; cells in which scans are compared
constexpr size_t kMinToAgree = 30;    // cells
constexpr int kAgreeRounds = 8;
constexpr float kMinCosine = 0.15F;  // of incidence; intensity over less is noise

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

/// How far and how much turned a scan lies off a face: depth = offset + slope · (u − middle).
struct Misfit {
  double offset = 0, slope = 0, middle = 0;
  double at(double u) const { return offset + slope * (u - middle); }
};

struct DepthAt {
  double u, depth;
};

/// The median, and the slope of what is near it.
Misfit misfit_of(const std::vector<DepthAt>& depths) {
  Misfit misfit;
  for (const DepthAt& one : depths) misfit.middle += one.u / static_cast<double>(depths.size());
  for (int round = 0; round < 2; ++round) {
    std::vector<double> level;
    for (const DepthAt& one : depths) level.push_back(one.depth - misfit.slope * (one.u - misfit.middle));
    misfit.offset = median(std::move(level));
    double uu = 0;
    double ud = 0;
    for (const DepthAt& one : depths) {
      const double u = one.u - misfit.middle;
      if (std::abs(one.depth - misfit.at(one.u)) > kAlignReach / 2) continue;
      uu += u * u;
      ud += u * (one.depth - misfit.offset);
    }
    if (uu / static_cast<double>(depths.size()) > kMinSpread)
      misfit.slope = std::clamp(ud / uu, -kMaxTurned, kMaxTurned);
  }
  return misfit;
}

/// Takes a misfit per scan out of the rays; unset ones are left alone.
void take_out(std::vector<FaceRay>& rays, const std::vector<std::optional<Misfit>>& misfits) {
  for (FaceRay& ray : rays)
    if (ray.returned && misfits[ray.scan])
      ray.depth -= static_cast<float>(misfits[ray.scan]->at(static_cast<double>(ray.u)));
}

/// What a scan says of a cell of the face.
struct CellDepth {
  size_t cell, scan;
  double u, depth, count;
};

std::vector<CellDepth> cell_depths(const std::vector<FaceRay>& rays, size_t& cells) {
  CellIndex cell_index, index;
  std::vector<CellDepth> result;
  std::vector<std::vector<float>> depths;
  for (const FaceRay& ray : rays) {
    if (!ray.returned || std::abs(ray.depth) >= kAlignReach) continue;
    const Eigen::Vector3i at = cell_of(Eigen::Vector3f(ray.u, ray.v, 0), kAgreeCell);
    const uint32_t number = index.insert({at.x(), at.y(), static_cast<int>(ray.scan)});
    if (number == result.size()) {
      result.push_back({cell_index.insert(at), ray.scan, (at.x() + 0.5) * kAgreeCell, 0, 0});
      depths.emplace_back();
    }
    depths[number].push_back(ray.depth);
  }
  for (size_t i = 0; i < result.size(); ++i) {
    result[i].count = static_cast<double>(depths[i].size());
    result[i].depth = static_cast<double>(median(std::move(depths[i])));
  }
  cells = cell_index.size();
  return result;
}

/// Scans see different parts of a face, whose panels do not all lie in one plane: where several saw the same
/// part, they shall say the same. Otherwise the border of what one of them saw looks like an edge. Returns
/// how many scans saw the face.
size_t make_scans_agree(std::vector<FaceRay>& rays, size_t scans) {
  size_t cells = 0;
  std::vector<CellDepth> depths = cell_depths(rays, cells);
  std::vector<double> points(scans, 0);
  for (const CellDepth& one : depths) points[one.scan] += one.count;
  for (int round = 0; round < kAgreeRounds; ++round) {
    struct Mean {
      double sum = 0, count = 0;
      size_t scans = 0;
    };
    std::vector<Mean> means(cells);
    for (const CellDepth& one : depths) {
      Mean& mean = means[one.cell];
      mean.sum += one.count * one.depth;
      mean.count += one.count;
      ++mean.scans;
    }
    std::vector<std::vector<DepthAt>> off(scans);
    for (const CellDepth& one : depths)
      if (const Mean& mean = means[one.cell]; mean.scans > 1)
        off[one.scan].push_back({one.u, one.depth - mean.sum / mean.count});
    std::vector<std::optional<Misfit>> misfits(scans);
    for (size_t scan = 0; scan < scans; ++scan)
      if (off[scan].size() >= kMinToAgree) misfits[scan] = misfit_of(off[scan]);
    for (CellDepth& one : depths)
      if (misfits[one.scan]) one.depth -= misfits[one.scan]->at(one.u);
    take_out(rays, misfits);
  }
  return static_cast<size_t>(
      std::count_if(points.begin(), points.end(), [](double n) { return n >= kMinPoints; }));
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
    ray.look[0] = point.intensity / std::max(cosine, kMinCosine);
    ray.look[1] = static_cast<float>(point.r) / 255.F;
    ray.look[2] = static_cast<float>(point.g) / 255.F;
    ray.look[3] = static_cast<float>(point.b) / 255.F;
    result.rays.push_back(ray);
  }
  result.scans = make_scans_agree(result.rays, surface.scans);
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

}  // namespace loci::mapping
