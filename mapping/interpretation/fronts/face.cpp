#include "mapping/interpretation/fronts/face.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/math.h"
#include "mapping/interpretation/fronts/parameters.h"
#include "mapping/interpretation/surfaces/vertical_planes.h"

namespace loci::mapping {
namespace {

/// A small piece of vertical surface.
struct Piece {
  Vector2d position = Vector2d::Zero();
  Vector2d normal = Vector2d::Zero();
  double height = 0;
  bool taken = false;
};

std::vector<Piece> pieces_of(const Surface& surface, double floor_height) {
  struct Sum {
    Vector3d position = Vector3d::Zero(), normal = Vector3d::Zero();
    double count = 0;
  };
  CellIndex index(surface.points.size() / 8);
  std::vector<Sum> sums;
  for (const SurfacePoint& point : surface.points) {
    if (std::abs(point.normal.z()) > 0.35F || point.normal.isZero()) continue;
    if (static_cast<double>(point.position.z()) < floor_height + kFaces.min_height_m) continue;
    const uint32_t number = index.insert(cell_of(point.position, kFaces.piece_m));
    if (number == sums.size()) sums.emplace_back();
    Sum& sum = sums[number];
    sum.position += point.position.cast<double>();
    sum.normal += point.normal.cast<double>();
    ++sum.count;
  }
  std::vector<Piece> pieces;
  for (const Sum& sum : sums) {
    if (sum.count < kFaces.min_piece_points || sum.normal.norm() < 0.6 * sum.count) continue;
    const Vector3d normal = sum.normal.normalized();
    if (std::abs(normal.z()) > 0.25) continue;
    const Vector3d position = sum.position / sum.count;
    pieces.push_back({position.head<2>(), normal.head<2>().normalized(), position.z(), false});
  }
  return pieces;
}

LineVotes votes_of(const std::vector<Piece>& pieces) {
  double reach = 0;
  for (const Piece& piece : pieces) reach = std::max(reach, piece.position.norm());
  LineVotes votes(reach, {kFaces.angle_bins, kFaces.angle_spread_bins, kFaces.offset_bin_m});
  for (const Piece& piece : pieces) votes.vote(piece.position, piece.normal, 1);
  return votes;
}

std::vector<size_t> inliers_of(const std::vector<Piece>& pieces, const Vector2d& normal, double offset,
                               double width) {
  std::vector<size_t> inliers;
  for (size_t i = 0; i < pieces.size(); ++i)
    if (!pieces[i].taken && std::abs(normal.dot(pieces[i].position) - offset) < width &&
        normal.dot(pieces[i].normal) > kFaces.min_facing_cosine)
      inliers.push_back(i);
  return inliers;
}

/// Fits the plane to its inliers repeatedly within narrowing limits. Near pieces weigh more, so that the
/// larger of two layers (panels, carcass) wins and not their mean.
void refine(const std::vector<Piece>& pieces, Vector2d& normal, double& offset) {
  for (const double width : {0.03, 0.022, 0.018, 0.015, 0.015, 0.015}) {
    const std::vector<size_t> inliers = inliers_of(pieces, normal, offset, width);
    if (inliers.size() < 8) break;
    const auto weight = [&](size_t i) {
      const double off = (normal.dot(pieces[i].position) - offset) / width;
      return (1 - off * off) * (1 - off * off);
    };
    double sum = 0;
    Vector2d mean = Vector2d::Zero();
    for (const size_t i : inliers) {
      sum += weight(i);
      mean += weight(i) * pieces[i].position;
    }
    mean /= sum;
    double xx = 0;
    double xy = 0;
    double yy = 0;
    for (const size_t i : inliers) {
      const Vector2d d = pieces[i].position - mean;
      xx += weight(i) * d.x() * d.x();
      xy += weight(i) * d.x() * d.y();
      yy += weight(i) * d.y() * d.y();
    }
    const double along = 0.5 * std::atan2(2 * xy, xx - yy);
    const Vector2d fitted(-std::sin(along), std::cos(along));
    const Vector2d turned = fitted.dot(normal) < 0 ? Vector2d(-fitted) : fitted;
    if (turned.dot(normal) > 0.99) normal = turned;  // a short plane keeps its direction
    offset = normal.dot(mean);
  }
}

/// Splits a plane at wide gaps.
std::vector<FurnitureFace> faces_of(const std::vector<Piece>& pieces, std::vector<size_t> inliers,
                                    const Vector2d& normal, double offset) {
  FurnitureFace plane;
  plane.normal = normal;
  plane.offset = offset;
  const auto along = [&](size_t i) { return plane.right().dot(pieces[i].position); };
  std::stable_sort(inliers.begin(), inliers.end(), [&](size_t a, size_t b) { return along(a) < along(b); });
  std::vector<FurnitureFace> faces;
  double last = -1e9;
  for (const size_t i : inliers) {
    const double u = along(i);
    if (u - last > kFaces.max_gap_m) {
      faces.push_back(plane);
      faces.back().u_min = u;
      faces.back().v_min = faces.back().v_max = pieces[i].height;
    }
    last = u;
    FurnitureFace& face = faces.back();
    face.u_max = u;
    face.v_min = std::min(face.v_min, pieces[i].height);
    face.v_max = std::max(face.v_max, pieces[i].height);
    face.area += kFaces.piece_m * kFaces.piece_m;
  }
  std::erase_if(faces, [](const FurnitureFace& face) { return face.area < kFaces.min_area_m2; });
  return faces;
}

/// A plane that was found before, with its observed cells.
class StrongerPlane {
 public:
  StrongerPlane(std::vector<FurnitureFace> faces, const std::vector<Piece>& pieces,
                const std::vector<size_t>& inliers)
      : faces_(std::move(faces)) {
    for (const size_t i : inliers) seen_.insert(cell(pieces[i]));
  }

  bool is_parallel(const Vector2d& normal) const {
    return faces_.front().normal.dot(normal) > kFaces.parallel_cosine;
  }

  /// Whether a piece of a weaker parallel plane is noise, a mixed return or a panel a little behind this
  /// plane.
  bool has_layer(const Piece& piece) const {
    const double u = faces_.front().right().dot(piece.position);
    return std::abs(before(piece)) < kFaces.same_face_m &&
           std::any_of(faces_.begin(), faces_.end(), [&](const FurnitureFace& face) {
             return u > face.u_min - kFaces.max_gap_m / 4 && u < face.u_max + kFaces.max_gap_m / 4;
           });
  }

  /// Whether a piece belongs to a narrow object before the plane, which is visible on both sides: a row of
  /// equal handles would be a plane of its own.
  bool has_fixture(const Piece& piece) const {
    if (const double depth = before(piece); depth < 0 || depth > kFaces.fixture_reach_m) return false;
    const Eigen::Vector3i at = cell(piece);
    const auto seen_towards = [&](int du, int dv) {
      for (int step = 1; step <= kFaces.fixture_gap_cells; ++step)
        if (seen_.find(at + step * Eigen::Vector3i(du, dv, 0)) != CellIndex::kNone) return true;
      return false;
    };
    return (seen_towards(1, 0) && seen_towards(-1, 0)) || (seen_towards(0, 1) && seen_towards(0, -1));
  }

 private:
  double before(const Piece& piece) const {
    return faces_.front().normal.dot(piece.position) - faces_.front().offset;
  }
  Eigen::Vector3i cell(const Piece& piece) const {
    return cell_of(Vector3d(faces_.front().right().dot(piece.position), piece.height, 0), kFaces.piece_m);
  }

  std::vector<FurnitureFace> faces_;  ///< pieces of the one plane; never empty
  CellIndex seen_;
};

/// Decided piece by piece: a plane that is rotated by less than a degree may run along a row of fronts and
/// still have surface of its own elsewhere.
bool is_explained(const Piece& piece, const Vector2d& normal, const std::vector<StrongerPlane>& stronger) {
  return std::any_of(stronger.begin(), stronger.end(), [&](const StrongerPlane& plane) {
    return plane.is_parallel(normal) && (plane.has_layer(piece) || plane.has_fixture(piece));
  });
}

}  // namespace

std::vector<FurnitureFace> find_faces(const Surface& surface, double floor_height) {
  std::vector<Piece> pieces = pieces_of(surface, floor_height);
  std::vector<FurnitureFace> faces;
  std::vector<StrongerPlane> stronger;
  if (pieces.empty()) return faces;
  LineVotes votes = votes_of(pieces);
  const int min_votes = static_cast<int>(0.4 * kFaces.min_area_m2 / (kFaces.piece_m * kFaces.piece_m));
  for (size_t round = 0; round < 4 * kFaces.max_faces && faces.size() < kFaces.max_faces; ++round) {
    const LineVotes::Peak peak = votes.strongest();
    if (peak.votes < min_votes) break;
    Vector2d normal = peak.normal;
    double offset = peak.offset;
    refine(pieces, normal, offset);
    // What lies near the plane belongs to it, panels that stand out from it or back, too.
    std::vector<size_t> inliers = inliers_of(pieces, normal, offset, kFaces.explained_m);
    if (faces_of(pieces, inliers, normal, offset).empty()) {
      votes.forget(peak);
      continue;
    }
    for (const size_t i : inliers) {
      pieces[i].taken = true;
      votes.vote(pieces[i].position, pieces[i].normal, -1);
    }
    std::erase_if(inliers, [&](size_t i) { return is_explained(pieces[i], normal, stronger); });
    const std::vector<FurnitureFace> found = faces_of(pieces, inliers, normal, offset);
    faces.insert(faces.end(), found.begin(), found.end());
    if (!found.empty()) stronger.emplace_back(found, pieces, inliers);
  }
  return faces;
}

namespace {

/// Sets the crossing of a ray with the face, from `origin` to `end` (face coordinates); false when the ray
/// does not concern the face.
bool cross(const Vector3d& origin, const Vector3d& end, bool known_origin, FaceRay& ray) {
  ray.depth = static_cast<float>(end.z());
  ray.u = static_cast<float>(end.x());
  ray.v = static_cast<float>(end.y());
  if (!known_origin) return std::abs(end.z()) < kFaces.before_m;
  if (origin.z() < 0.05 || end.z() > kFaces.before_m) return false;  // from behind, or ended before the face
  const Vector3d path = end - origin;
  if (path.z() > -1e-6) return false;
  ray.slope_u = static_cast<float>(path.x() / path.z());
  ray.slope_v = static_cast<float>(path.y() / path.z());
  ray.u -= ray.slope_u * ray.depth;
  ray.v -= ray.slope_v * ray.depth;
  return true;
}

/// Offset and rotation of a scan against a face: depth = offset + slope · (u − middle).
struct Misfit {
  double offset = 0, slope = 0, middle = 0;
  double at(double u) const { return offset + slope * (u - middle); }
};

struct DepthAt {
  double u, depth;
};

/// Robust fit: the median, and the slope of depths near it.
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
      if (std::abs(one.depth - misfit.at(one.u)) > kFaces.align_reach_m / 2) continue;
      uu += u * u;
      ud += u * (one.depth - misfit.offset);
    }
    if (uu / static_cast<double>(depths.size()) > kFaces.min_slope_m2)
      misfit.slope = std::clamp(ud / uu, -kFaces.max_slope, kFaces.max_slope);
  }
  return misfit;
}

/// Subtracts the misfit of each scan, where set.
void subtract(std::vector<FaceRay>& rays, const std::vector<std::optional<Misfit>>& misfits) {
  for (FaceRay& ray : rays)
    if (ray.returned && misfits[ray.scan])
      ray.depth -= static_cast<float>(misfits[ray.scan]->at(ray.plane_u()));
}

/// The depth that a scan measured in a cell of the face.
struct CellDepth {
  size_t cell, scan;
  double u, depth, count;
};

std::vector<CellDepth> cell_depths(const std::vector<FaceRay>& rays, size_t& cells) {
  CellIndex cell_index, index;
  std::vector<CellDepth> result;
  std::vector<std::vector<float>> depths;
  for (const FaceRay& ray : rays) {
    if (!ray.returned || std::abs(ray.depth) >= kFaces.align_reach_m) continue;
    const Eigen::Vector3i at = cell_of(Eigen::Vector3f(ray.u, ray.v, 0), kFaces.agree_cell_m);
    const uint32_t number = index.insert({at.x(), at.y(), static_cast<int>(ray.scan)});
    if (number == result.size()) {
      result.push_back({cell_index.insert(at), ray.scan, (at.x() + 0.5) * kFaces.agree_cell_m, 0, 0});
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

/// Aligns scans where several saw the same part of the face; otherwise the border of what one scan saw would
/// look like an edge. Panels may lie in different planes. Returns how many scans saw the face.
size_t align_scans(std::vector<FaceRay>& rays, size_t scans) {
  size_t cells = 0;
  std::vector<CellDepth> depths = cell_depths(rays, cells);
  std::vector<double> points(scans, 0);
  for (const CellDepth& one : depths) points[one.scan] += one.count;
  for (int round = 0; round < kFaces.agree_rounds; ++round) {
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
      if (off[scan].size() >= kFaces.min_agree_cells) misfits[scan] = misfit_of(off[scan]);
    for (CellDepth& one : depths)
      if (misfits[one.scan]) one.depth -= misfits[one.scan]->at(one.u);
    subtract(rays, misfits);
  }
  return static_cast<size_t>(
      std::count_if(points.begin(), points.end(), [](double n) { return n >= kFaces.min_scan_points; }));
}

}  // namespace

FaceRays gather_rays(const Surface& surface, const FurnitureFace& face, double floor_height) {
  FaceRays result;
  result.face = face;
  std::vector<Vector3d> origins;
  for (const Eigen::Vector3f& origin : surface.origins)
    origins.push_back(face.coordinates(origin.cast<double>()));
  FaceRect reach = FaceRect{face.u_min, face.u_max, face.v_min, face.v_max}.grown(kFaces.margin_m);
  reach.v0 = std::max(reach.v0, floor_height + kFaces.floor_gap_m);
  const auto add = [&](const Eigen::Vector3f& end, uint32_t origin, FaceRay& ray) {
    const Vector3d at = face.coordinates(end.cast<double>());
    if (at.z() > kFaces.before_m) return false;
    // A board that protrudes from the face is met by rays that would cross the plane beside it.
    return cross(surface.free_space ? origins[origin] : Vector3d::Zero(), at, surface.free_space, ray) &&
           (reach.contains(ray) || reach.contains(at.x(), at.y()));
  };
  for (const SurfacePoint& point : surface.points) {
    FaceRay ray;
    if (static_cast<double>(point.position.z()) < floor_height + kFaces.floor_gap_m) continue;
    if (!add(point.position, point.origin, ray)) continue;
    ray.scan = point.scan;
    ray.appearance = {point.intensity / std::max(ray.cosine(), kFaces.min_cosine),
                      static_cast<float>(point.r) / 255.F, static_cast<float>(point.g) / 255.F,
                      static_cast<float>(point.b) / 255.F};
    result.rays.push_back(ray);
  }
  result.scans = align_scans(result.rays, surface.scans);
  std::vector<double> deviations;
  for (const FaceRay& ray : result.rays)
    if (std::abs(ray.depth) < kFaces.align_reach_m)
      deviations.push_back(std::abs(static_cast<double>(ray.depth)));
  result.sigma = deviations.empty() ? 0.01 : 1.4826 * median(deviations);
  for (const auto& [end, origin] : surface.free_ends) {
    FaceRay ray;
    if (!add(end, origin, ray)) continue;
    ray.returned = false;
    result.rays.push_back(ray);
  }
  return result;
}

FaceGrid::FaceGrid(const FurnitureFace& face)
    : u0(face.u_min - kFaces.margin_m),
      v0(face.v_min - kFaces.margin_m),
      width(static_cast<int>((face.u_max - face.u_min + 2 * kFaces.margin_m) / kFaces.cell_m) + 1),
      height(static_cast<int>((face.v_max - face.v_min + 2 * kFaces.margin_m) / kFaces.cell_m) + 1) {}

FaceGround::FaceGround(const FaceRays& rays)
    : grid_(rays.face),
      width_(grid_.width / kFaces.ground_cells + 1),
      height_(grid_.height / kFaces.ground_cells + 1) {
  std::vector<std::vector<float>> patches(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  depth_.assign(patches.size(), 0);
  for (const FaceRay& ray : rays.rays) {
    const int x = grid_.column(ray.plane_u());
    const int y = grid_.row(ray.plane_v());
    if (ray.is_on_face() && grid_.inside(x, y))
      patches[static_cast<size_t>(y / kFaces.ground_cells * width_ + x / kFaces.ground_cells)].push_back(
          ray.depth);
  }
  std::vector<float> around;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      around.clear();
      for (int ny = std::max(0, y - 1); ny <= std::min(height_ - 1, y + 1); ++ny)
        for (int nx = std::max(0, x - 1); nx <= std::min(width_ - 1, x + 1); ++nx) {
          const std::vector<float>& patch = patches[static_cast<size_t>(ny * width_ + nx)];
          around.insert(around.end(), patch.begin(), patch.end());
        }
      if (around.size() < kFaces.ground_min_points) continue;
      const auto rank = around.begin() +
                        static_cast<std::ptrdiff_t>(kFaces.ground_rank * static_cast<double>(around.size()));
      std::nth_element(around.begin(), rank, around.end());
      depth_[static_cast<size_t>(y * width_ + x)] =
          *rank - static_cast<float>(kFaces.ground_rank_sigmas * std::min(rays.sigma, kFaces.max_sigma_m));
    }
}

double FaceGround::at(double u, double v) const {
  const int x = grid_.column(u);
  const int y = grid_.row(v);
  if (!grid_.inside(x, y)) return 0;
  return static_cast<double>(
      depth_[static_cast<size_t>(y / kFaces.ground_cells * width_ + x / kFaces.ground_cells)]);
}

}  // namespace loci::mapping
