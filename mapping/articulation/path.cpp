#include "mapping/articulation/path.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/articulation/parameters.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/math/rotation_vector.h"

namespace loci::mapping {
namespace {

using Positions = std::vector<Vector3d>;

double extent_of(const Positions& positions) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : positions) box.extend(p);
  return box.diagonal().norm();
}

/// The circle through three points; false when they are on a line.
bool circle_through(const Vector3d& a, const Vector3d& b, const Vector3d& c, Path& path) {
  const Vector3d u = b - a, v = c - a, normal = u.cross(v);
  const double area = normal.squaredNorm();
  if (area < 1e-12 * u.squaredNorm() * v.squaredNorm() || area == 0) return false;
  const Vector3d from_a =
      (u.squaredNorm() * v.cross(normal) + v.squaredNorm() * normal.cross(u)) / (2 * area);
  path.centre = a + from_a;
  path.radius = from_a.norm();
  path.axis = normal.normalized();
  return true;
}

/// The path through randomly drawn positions.
bool draw_path(Path::Kind kind, const Positions& positions, Random& random, Path& path) {
  path.kind = kind;
  const auto draw = [&] { return positions[random.index(positions.size())]; };
  const Vector3d first = draw();
  if (kind == Path::Kind::point) {
    path.centre = first;
    return true;
  }
  const Vector3d second = draw();
  if ((second - first).norm() == 0) return false;
  if (kind == Path::Kind::line) {
    path.centre = first;
    path.axis = (second - first).normalized();
    return true;
  }
  return circle_through(first, second, draw(), path);
}

/// The drawn path with the smallest median distance: up to half of the positions may be outliers.
Path min_median_path(Path::Kind kind, const Positions& positions) {
  Random random(1);
  Path best;
  best.kind = kind;
  best.centre = positions.front();
  best.radius = kind == Path::Kind::circle ? 1 : 0;
  double min_distance = std::numeric_limits<double>::infinity();
  std::vector<double> distances(positions.size());
  for (int sample = 0; sample < kTracks.samples; ++sample) {
    Path path;
    if (!draw_path(kind, positions, random, path)) continue;
    std::transform(positions.begin(), positions.end(), distances.begin(),
                   [&](const Vector3d& p) { return path.across(p).norm(); });
    const double distance = median(distances);
    if (distance < min_distance) {
      min_distance = distance;
      best = path;
    }
  }
  return best;
}

Eigen::VectorXd residuals(const Path& path, const Positions& positions) {
  const int rows = path.across_dimensions();
  Eigen::VectorXd all(static_cast<Eigen::Index>(positions.size()) * rows);
  for (size_t i = 0; i < positions.size(); ++i)
    all.segment(static_cast<Eigen::Index>(i) * rows, rows) = path.across(positions[i]).head(rows);
  return all;
}

Eigen::MatrixXd jacobian(const Path& path, const Positions& positions) {
  const int n = path.parameters();
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(positions.size()) * path.across_dimensions(), n);
  const double step = 1e-6;
  for (int k = 0; k < n; ++k) {
    const Eigen::VectorXd change = step * Eigen::VectorXd::Unit(n, k);
    columns.col(k) =
        (residuals(perturbed(path, change), positions) - residuals(perturbed(path, -change), positions)) /
        (2 * step);
  }
  return columns;
}

double weighted_square(const Path& path, const Positions& positions, const std::vector<double>& weights) {
  double sum = 0;
  for (size_t i = 0; i < positions.size(); ++i) sum += weights[i] * path.across(positions[i]).squaredNorm();
  return sum;
}

Eigen::VectorXd row_weights(const Path& path, const std::vector<double>& weights) {
  const int rows = path.across_dimensions();
  Eigen::VectorXd all(static_cast<Eigen::Index>(weights.size()) * rows);
  for (size_t i = 0; i < weights.size(); ++i)
    all.segment(static_cast<Eigen::Index>(i) * rows, rows).setConstant(weights[i]);
  return all;
}

/// One step of Levenberg and Marquardt on the weighted squares; false when converged.
bool improve(Path& path, const Positions& positions, const std::vector<double>& weights) {
  const Eigen::MatrixXd j = jacobian(path, positions);
  const Eigen::VectorXd w = row_weights(path, weights);
  const Eigen::MatrixXd normal = j.transpose() * w.asDiagonal() * j;
  const Eigen::VectorXd gradient = j.transpose() * w.cwiseProduct(residuals(path, positions));
  const double before = weighted_square(path, positions, weights);
  for (double damping = 1e-9; damping < 1e6; damping *= 30) {
    Eigen::MatrixXd damped = normal;
    damped.diagonal().array() += damping * (normal.diagonal().array() + 1e-9 * normal.trace()) + 1e-15;
    const Eigen::VectorXd change = -damped.ldlt().solve(gradient);
    if (!change.allFinite()) continue;
    const Path candidate = perturbed(path, change);
    const double after = weighted_square(candidate, positions, weights);
    if (after >= before) continue;
    path = candidate;
    return before - after > 1e-9 * before;
  }
  return false;
}

double log_normal_density(double square, double sigma, int dimensions) {
  return -0.5 * square / (sigma * sigma) - dimensions * (std::log(sigma) + 0.5 * std::log(2 * kPi));
}

/// Length of the path over inliers; 0 for a point.
double travel_of(const Path& path, const std::vector<double>& along, const std::vector<double>& weights) {
  if (path.kind == Path::Kind::point) return 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (size_t i = 0; i < along.size(); ++i)
    if (weights[i] > 0.5) {
      low = std::min(low, along[i]);
      high = std::max(high, along[i]);
    }
  return high < low ? 0 : (high - low) * (path.kind == Path::Kind::circle ? path.radius : 1);
}

/// 1 / span is the density of poses along the path: the geometric mean density of a normal distribution with
/// their spread, which also holds for pauses at the ends.
double span_of(const PathFit& fit) {
  double sum = 0, mean = 0, square = 0;
  for (size_t i = 0; i < fit.along.size(); ++i) {
    sum += fit.weights[i];
    mean += fit.weights[i] * fit.along[i];
    square += fit.weights[i] * fit.along[i] * fit.along[i];
  }
  if (sum < 1e-9) return 0;
  const double variance = std::max(square / sum - (mean / sum) * (mean / sum), 0.0);
  return std::sqrt(2 * kPi * std::exp(1.0) * variance) *
         (fit.path.kind == Path::Kind::circle ? fit.path.radius : 1);
}

/// Whether most neighbouring poses are outliers, too: then the path is wrong there and not the poses.
std::vector<bool> in_a_run(const std::vector<double>& weights) {
  const size_t count = weights.size(), half = std::clamp<size_t>(count / 8, 1, 5);
  std::vector<bool> all(count);
  for (size_t i = 0; i < count; ++i) {
    const size_t from = i < half ? 0 : i - half, to = std::min(count, i + half + 1);
    size_t outliers = 0;
    for (size_t j = from; j < to; ++j) outliers += weights[j] < 0.5;
    all[i] = 4 * outliers > 3 * (to - from);
  }
  return all;
}

/// Expectation: weights given path, sigma and outlier share; and the likelihood of all poses.
void weigh(PathFit& fit, const Positions& positions, double extent, const PathOptions& options) {
  const int dimensions = fit.path.across_dimensions();
  fit.along = fit.path.along(positions, fit.weights);
  fit.travel = travel_of(fit.path, fit.along, fit.weights);
  // The span of an arc is about that of its chord; a ring through noise is longer and less likely.
  fit.span =
      options.span > 0 ? std::max(options.span, 0.85 * span_of(fit)) : std::max(span_of(fit), fit.sigma);
  const double log_along = dimensions == 3 ? 0 : -std::log(fit.span);
  const double log_outlier = std::log(fit.outlier_share) - 3 * std::log(extent + 10 * fit.sigma);
  std::vector<double> log_inlier(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    log_inlier[i] = std::log(1 - fit.outlier_share) + log_along +
                    log_normal_density(fit.path.across(positions[i]).squaredNorm(), fit.sigma, dimensions);
    fit.weights[i] = 1 / (1 + std::exp(std::min(log_outlier - log_inlier[i], 500.0)));
  }
  const std::vector<bool> run = in_a_run(fit.weights);
  fit.log_likelihood = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    if (run[i]) fit.weights[i] = 1;
    fit.log_likelihood += run[i] ? log_inlier[i]
                                 : std::max(log_inlier[i], log_outlier) +
                                       std::log1p(std::exp(-std::abs(log_inlier[i] - log_outlier)));
  }
}

/// Maximisation of sigma and outlier share (whose prior weighs as much as ten poses).
void measure_noise(PathFit& fit, const Positions& positions, const PathOptions& options) {
  double sum = 0;
  for (const double w : fit.weights) sum += w;
  const double square = weighted_square(fit.path, positions, fit.weights);
  const double freedom = std::max(fit.path.across_dimensions() * sum - fit.path.parameters(), 1.0);
  fit.rms = std::sqrt(square / std::max(sum, 1e-9));
  fit.sigma = options.sigma > 0 ? options.sigma : std::max(std::sqrt(square / freedom), kTracks.min_sigma_m);
  const double count = static_cast<double>(positions.size());
  fit.outlier_share = std::clamp((10 * options.outlier_probability + count - sum) / (10 + count), 1e-4, 0.5);
}

}  // namespace

std::array<Vector3d, 2> normals_of(const Vector3d& axis) {
  const Vector3d first = axis.unitOrthogonal();
  return {first, axis.cross(first)};
}

Vector3d Path::across(const Vector3d& position) const {
  Vector3d off = position - centre;
  if (kind == Kind::point) return off;
  const double along_axis = off.dot(axis);
  if (kind == Kind::circle) return {(off - along_axis * axis).norm() - radius, along_axis, 0};
  const auto [u, v] = normals_of(axis);
  return {off.dot(u), off.dot(v), 0};
}

int Path::parameters() const {
  switch (kind) {
    case Kind::point:
      return 3;
    case Kind::line:
      return 4;
    case Kind::circle:
      return 6;
  }
  return 0;
}

std::vector<double> Path::along(const std::vector<Vector3d>& positions,
                                const std::vector<double>& weights) const {
  std::vector<double> all(positions.size(), 0);
  if (kind == Kind::point) return all;
  const auto [u, v] = normals_of(axis);
  const double* last = nullptr;
  double first = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vector3d off = positions[i] - centre;
    all[i] = kind == Kind::line ? off.dot(axis) : std::atan2(off.dot(v), off.dot(u));
    if (kind == Kind::circle && last) all[i] -= 2 * kPi * std::round((all[i] - *last) / (2 * kPi));
    if (weights[i] < 0.5) continue;
    if (!last) first = all[i];
    last = &all[i];
  }
  for (double& value : all) value -= first;
  return all;
}

Path perturbed(const Path& path, const Eigen::VectorXd& change) {
  Path moved = path;
  if (path.kind == Path::Kind::point) {
    moved.centre += change.head<3>();
    return moved;
  }
  const auto [u, v] = normals_of(path.axis);
  moved.centre += change[0] * u + change[1] * v;
  if (path.kind == Path::Kind::line) {
    moved.axis = (path.axis + change[2] * u + change[3] * v).normalized();
    return moved;
  }
  moved.centre += change[2] * path.axis;
  moved.axis = (path.axis + change[3] * u + change[4] * v).normalized();
  moved.radius += change[5];
  return moved;
}

size_t PathFit::outliers() const {
  return static_cast<size_t>(std::count_if(weights.begin(), weights.end(), [](double w) { return w < 0.5; }));
}

namespace {

/// Of a symmetric matrix without negative eigenvalues; directions that it does not determine map to 0.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  const Eigen::VectorXd& values = solver.eigenvalues();
  const double smallest =
      values.maxCoeff() * static_cast<double>(values.size()) * std::numeric_limits<double>::epsilon();
  const Eigen::VectorXd inverse = (values.array() > smallest).select(values.cwiseInverse(), 0.0);
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

/// Circle of least algebraic error (Kåsa) in the plane of least squares through all positions.
Path algebraic_circle(const Positions& positions) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : positions) mean += p / static_cast<double>(positions.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : positions) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Vector3d u = solver.eigenvectors().col(2), v = solver.eigenvectors().col(1);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Vector3d& p : positions) {
    const Vector3d row(2 * (p - mean).dot(u), 2 * (p - mean).dot(v), 1);
    normal += row * row.transpose();
    right += row * (p - mean).squaredNorm();
  }
  const Vector3d solution = pseudo_inverse(normal) * right;
  Path path;
  path.kind = Path::Kind::circle;
  path.centre = mean + solution[0] * u + solution[1] * v;
  path.axis = solver.eigenvectors().col(0);
  path.radius = std::sqrt(std::max(solution[2] + solution.head<2>().squaredNorm(), 1e-12));
  return path;
}

PathFit fit_from(const Path& start, const Positions& positions, const PathOptions& options) {
  const double extent = extent_of(positions);
  PathFit fit;
  fit.path = start;
  fit.weights.assign(positions.size(), 1.0);
  fit.outlier_share = std::clamp(options.outlier_probability, 1e-4, 0.5);
  std::vector<double> distances;
  for (const Vector3d& p : positions) distances.push_back(fit.path.across(p).norm());
  fit.sigma = options.sigma > 0 ? options.sigma : std::max(median(distances), kTracks.min_sigma_m);
  for (int round = 0; round < kTracks.em_rounds; ++round) {
    weigh(fit, positions, extent, options);
    for (int step = 0; step < kTracks.lm_steps && improve(fit.path, positions, fit.weights); ++step) {
    }
    const double sigma = fit.sigma;
    measure_noise(fit, positions, options);
    if (std::abs(fit.sigma - sigma) < 1e-4 * sigma) break;
  }
  weigh(fit, positions, extent, options);
  measure_noise(fit, positions, options);
  return fit;
}

}  // namespace

PathFit fit_path(Path::Kind kind, const std::vector<Vector3d>& positions, const PathOptions& options) {
  PathFit fit = fit_from(min_median_path(kind, positions), positions, options);
  if (kind == Path::Kind::circle) {
    // On a short arc, all poses determine the circle better than three, if there are few outliers.
    PathFit other = fit_from(algebraic_circle(positions), positions, options);
    if (other.log_likelihood > fit.log_likelihood) fit = std::move(other);
  }
  const Eigen::MatrixXd j = jacobian(fit.path, positions);
  const Eigen::MatrixXd normal = j.transpose() * row_weights(fit.path, fit.weights).asDiagonal() * j;
  fit.covariance = fit.sigma * fit.sigma * pseudo_inverse(normal);
  return fit;
}

double effective_count(const std::vector<Vector3d>& residuals) {
  double variance = 0, sum = 1;
  for (const Vector3d& r : residuals) variance += r.squaredNorm();
  for (size_t lag = 1; lag < residuals.size() / 2; ++lag) {
    double product = 0;
    for (size_t i = lag; i < residuals.size(); ++i) product += residuals[i].dot(residuals[i - lag]);
    const double correlation = variance > 0 ? product / variance : 0;
    if (correlation < 0.05) break;
    sum += 2 * correlation;
  }
  const double count = static_cast<double>(residuals.size());
  return std::clamp(count / sum, std::min(4.0, count), count);
}

OrientationFit fit_orientations(const std::vector<Eigen::Quaterniond>& orientations, const Vector3d& axis,
                                const std::vector<double>& joint_positions,
                                const std::vector<double>& weights) {
  std::vector<Eigen::Quaterniond> starts;
  for (size_t i = 0; i < orientations.size(); ++i)
    if (weights[i] > 0.5)
      starts.push_back(Eigen::Quaterniond(Eigen::AngleAxisd(-joint_positions[i], axis)) * orientations[i]);
  OrientationFit fit;
  if (starts.empty()) return fit;

  // Weiszfeld's algorithm: the rotation with the smallest sum of angles, robust to flips.
  fit.start = starts[starts.size() / 2];
  std::vector<Vector3d> errors(starts.size());
  for (int round = 0; round < 20; ++round) {
    Vector3d step = Vector3d::Zero();
    double total = 0;
    for (size_t i = 0; i < starts.size(); ++i) {
      errors[i] = vector_from_rotation(starts[i] * fit.start.conjugate());
      const double weight = 1 / (errors[i].norm() + 1e-3);
      step += weight * errors[i];
      total += weight;
    }
    step /= total;
    if (step.norm() < 1e-9) break;
    fit.start = Eigen::Quaterniond(rotation_from_vector(step)) * fit.start;
  }
  for (const Vector3d& error : errors) fit.angles.push_back(error.norm());
  fit.sigma = median(fit.angles) / 1.538;  // 1.538: median length of a normal vector in space

  fit.effective_poses = effective_count(errors);
  return fit;
}

double OrientationFit::log_likelihood(double noise, double poses) const {
  const double log_outlier = std::log(kTracks.orientation_outliers) - std::log(8 * kPi * kPi);
  const double log_peak =
      std::log(1 - kTracks.orientation_outliers) - 3 * (std::log(noise) + 0.5 * std::log(2 * kPi));
  double sum = 0;
  for (const double angle : angles) {
    const double log_inlier = log_peak - 0.5 * angle * angle / (noise * noise);
    const double largest = std::max(log_inlier, log_outlier);
    sum += largest + std::log(std::exp(log_inlier - largest) + std::exp(log_outlier - largest));
  }
  return angles.empty() ? 0 : sum * poses / static_cast<double>(angles.size());
}

}  // namespace loci::mapping
