#include "mapping/articulation/face.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "mapping/base/random.h"

namespace loci::mapping {
namespace {

constexpr int kSamples = 400;
constexpr double kReach = 0.02;
constexpr size_t kMinPoints = 30;

size_t count_near(const Face& face, const std::vector<Vector3d>& points) {
  return static_cast<size_t>(std::count_if(
      points.begin(), points.end(), [&](const Vector3d& p) { return std::abs(face.distance(p)) < kReach; }));
}

}  // namespace

Face refined_face(const Face& start, const std::vector<Vector3d>& points, double reach) {
  Face face = start;
  for (int round = 0; round < 5; ++round) {
    Vector3d mean = Vector3d::Zero();
    size_t count = 0;
    for (const Vector3d& p : points)
      if (std::abs(face.distance(p)) < reach) {
        mean += p;
        ++count;
      }
    if (count < 3) return face;
    mean /= static_cast<double>(count);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Vector3d& p : points)
      if (std::abs(face.distance(p)) < reach)
        scatter += (p - mean) * (p - mean).transpose() / static_cast<double>(count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    Vector3d normal = solver.eigenvectors().col(0);
    if (normal.dot(face.normal) < 0) normal = -normal;
    face.normal = normal;
    face.offset = normal.dot(mean);
    face.points = count;
    // Tilt by noise: σ / (spread · √n), for both directions within the plane.
    face.normal_sd = std::sqrt(
        solver.eigenvalues()[0] / static_cast<double>(count) *
        (1 / std::max(solver.eigenvalues()[1], 1e-9) + 1 / std::max(solver.eigenvalues()[2], 1e-9)));
  }
  return face;
}

std::optional<Face> find_face(const std::vector<Vector3d>& points,
                              const std::function<bool(const Vector3d&)>& allowed) {
  if (points.size() < kMinPoints) return std::nullopt;
  Random random(1);
  Face best;
  size_t most = 0;
  const auto draw = [&] { return points[random.index(points.size())]; };
  // Small triangles have noisy normals: few points decide among many planes, all points refine the best.
  std::vector<Vector3d> some;
  for (size_t i = 0; i < 600; ++i) some.push_back(draw());
  for (int sample = 0; sample < kSamples; ++sample) {
    const Vector3d a = draw(), b = draw(), c = draw();
    const Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-3 || !allowed(normal.normalized())) continue;
    const Face face{normal.normalized(), normal.normalized().dot(a), 0, 0};
    const size_t count = count_near(face, some);
    if (count > most) {
      most = count;
      best = face;
    }
  }
  if (most == 0) return std::nullopt;
  best = refined_face(best, points, kReach);
  if (best.points < kMinPoints || !allowed(best.normal)) return std::nullopt;
  return best;
}

std::array<double, 2> outline_of(const std::vector<double>& places) {
  const double cell = 0.01;
  const auto [low, high] = std::minmax_element(places.begin(), places.end());
  const size_t cells = static_cast<size_t>((*high - *low) / cell) + 1;
  std::vector<double> counts(cells, 0);
  for (const double place : places) counts[static_cast<size_t>((place - *low) / cell)] += 1;
  std::vector<double> sorted = counts;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[sorted.size() * 6 / 10], half = 0.5 * usual;
  // Two neighbouring cells must be covered, so that a mixed return does not move an edge.
  size_t first = 0, last = cells - 1;
  while (first + 1 < cells && (counts[first] < half || counts[first + 1] < half)) ++first;
  while (last > first && (counts[last] < half || counts[last - 1] < half)) --last;
  // Within the outermost cells the edge is where their share of points ends.
  const double inner = std::max(usual, 1.0);
  const double before = first > 0 ? std::min(counts[first - 1] / inner, 1.0) : 0;
  const double after = last + 1 < cells ? std::min(counts[last + 1] / inner, 1.0) : 0;
  return {*low + (static_cast<double>(first) - before) * cell,
          *low + (static_cast<double>(last) + 1 + after) * cell};
}

}  // namespace loci::mapping
