#include "mapping/interpretation/wall_evidence.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "mapping/base/parallel.h"

namespace loci::mapping {
namespace {

constexpr double kCell = 0.1;         // m
constexpr double kOn = 0.05;          // m; a ray that ends this near ends on the plane
constexpr double kBehind = 0.12;      // m; or this far behind has crossed it
constexpr double kAbove = 0.05;       // m above the top; nearer may still be the plane
constexpr double kHighest = 0.8;      // m above the top; higher crossings say nothing about the plane
constexpr int kMinRays = 2;           // that make a cell crossed; one may be noise
constexpr size_t kMaxRays = 3000000;  // more are thinned evenly

/// Cells of a plane and of what is above it.
class PlaneCells {
 public:
  explicit PlaneCells(const VerticalPlane& plane)
      : plane_(plane),
        normal_(plane.normal.cast<float>()),
        direction_(plane.direction().cast<float>()),
        offset_(static_cast<float>(plane.offset)),
        columns_(static_cast<size_t>(plane.length() / kCell) + 1),
        rows_(static_cast<size_t>((plane.top - plane.bottom) / kCell) + 1),
        hits_(columns_ * rows_, 0),
        passes_(columns_ * rows_, 0),
        looked_(columns_, 0),
        over_(columns_, 0) {}

  void add(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool returned) {
    const float start = normal_.dot(from.head<2>()) - offset_;
    const float end = normal_.dot(to.head<2>()) - offset_;
    if (start < static_cast<float>(kOn) || end > static_cast<float>(kOn)) return;
    const bool on = end > -static_cast<float>(kOn);
    if (on && !returned) return;
    if (!on && end > -static_cast<float>(kBehind)) return;
    const Eigen::Vector3f at = on ? to : Eigen::Vector3f(from + (to - from) * (start / (start - end)));
    const double along = static_cast<double>(direction_.dot(at.head<2>())) - plane_.along_min;
    if (along < 0 || along > plane_.length()) return;
    const auto column = static_cast<size_t>(along / kCell);
    const double z = static_cast<double>(at.z());
    if (z >= plane_.bottom && z <= plane_.top) {
      const size_t cell = static_cast<size_t>((z - plane_.bottom) / kCell) * columns_ + column;
      ++(on ? hits_ : passes_)[cell];
    } else if (z > plane_.top + kAbove && z < plane_.top + kHighest) {
      ++looked_[column];
      if (!on && returned) ++over_[column];
    }
  }

  RayEvidence evidence() const {
    const auto fraction = [](const std::vector<int>& counts) {
      const auto many = std::count_if(counts.begin(), counts.end(), [](int n) { return n >= kMinRays; });
      return static_cast<double>(many) / static_cast<double>(counts.size());
    };
    double crossed = 0;
    double seen = 0;
    for (size_t cell = 0; cell < hits_.size(); ++cell) {
      const bool through = passes_[cell] >= kMinRays && passes_[cell] > hits_[cell];
      crossed += through;
      seen += through || hits_[cell] > 0;
    }
    return {fraction(looked_), fraction(over_), seen > 0 ? crossed / seen : 0};
  }

 private:
  const VerticalPlane& plane_;
  Eigen::Vector2f normal_, direction_;
  float offset_;
  size_t columns_, rows_;
  std::vector<int> hits_, passes_;  ///< by cell
  std::vector<int> looked_, over_;  ///< by column
};

}  // namespace

std::vector<RayEvidence> ray_evidence(const Surface& surface, const std::vector<VerticalPlane>& planes,
                                      int threads) {
  std::vector<RayEvidence> result(planes.size());
  const size_t step = (surface.points.size() + surface.free_ends.size()) / kMaxRays + 1;
  parallel_for(planes.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      PlaneCells cells(planes[i]);
      for (size_t k = 0; k < surface.points.size(); k += step) {
        const SurfacePoint& point = surface.points[k];
        cells.add(surface.origins[point.origin], point.position, true);
      }
      for (size_t k = 0; k < surface.free_ends.size(); k += step)
        cells.add(surface.origins[surface.free_ends[k].second], surface.free_ends[k].first, false);
      result[i] = cells.evidence();
    }
  });
  return result;
}

void polish(VerticalPlane& plane, const Surface& surface) {
  constexpr double kFromEnds = 0.06;  // m
  constexpr float kFacing = 0.9F;     // cosine
  constexpr size_t kMin = 200;
  for (const double tolerance : {0.03, 0.025, 0.02}) {
    const double inset = std::min(kFromEnds, plane.length() / 4);
    const Vector2d centre = plane.at((plane.along_min + plane.along_max) / 2);
    Vector2d sum = Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    size_t count = 0;
    for (const SurfacePoint& point : surface.points) {
      const Vector2d at = point.position.head<2>().cast<double>();
      if (std::abs(plane.normal.dot(at) - plane.offset) > tolerance) continue;
      if (point.normal.head<2>().dot(plane.normal.cast<float>()) < kFacing) continue;
      const double along = plane.direction().dot(at);
      const double z = static_cast<double>(point.position.z());
      if (along < plane.along_min + inset || along > plane.along_max - inset) continue;
      if (z < plane.bottom + inset || z > plane.top - inset) continue;
      sum += at - centre;
      squares += (at - centre) * (at - centre).transpose();
      ++count;
    }
    if (count < kMin) return;
    const Vector2d mean = sum / static_cast<double>(count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(squares / static_cast<double>(count) -
                                                                mean * mean.transpose());
    Vector2d normal = solver.eigenvectors().col(0);
    if (normal.dot(plane.normal) < 0) normal = -normal;
    if (normal.dot(plane.normal) < 0.999) return;
    const Vector2d start = plane.at(plane.along_min);
    const Vector2d end = plane.at(plane.along_max);
    plane.normal = normal;
    plane.offset = normal.dot(centre + mean);
    plane.along_min = plane.direction().dot(start);
    plane.along_max = plane.direction().dot(end);
  }
}

bool has_fixtures(const Surface& surface, const VerticalPlane& plane) {
  constexpr double kNearest = 0.02;  // m before the plane
  constexpr double kFarthest = 0.08;
  constexpr double kInset = 0.03;   // m; a neighbour's side is no fixture
  constexpr double kReachHigh = 2;  // m; nobody reaches higher
  constexpr size_t kMin = 40;
  size_t count = 0;
  for (const SurfacePoint& point : surface.points) {
    const Vector3d position = point.position.cast<double>();
    const double before = plane.normal.dot(position.head<2>()) - plane.offset;
    if (before < kNearest || before > kFarthest) continue;
    const double along = plane.direction().dot(position.head<2>());
    if (along < plane.along_min + kInset || along > plane.along_max - kInset) continue;
    if (position.z() < plane.bottom + kInset || position.z() > std::min(plane.top - kInset, kReachHigh))
      continue;
    ++count;
  }
  return count >= kMin;
}

}  // namespace loci::mapping
