#include "perception/annotators/structure/supports.h"

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "perception/annotators/scene_data.h"

namespace loci::perception {
namespace {

constexpr double kGridCell = 0.02;  ///< of the top-down grid in which area and outline are found, metres

/// So many points, spread over a surface, determine its plane as well as all do.
constexpr size_t kEnough = 10000;

size_t stride_of(size_t count) {
  return std::max<size_t>(1, count / kEnough);
}

struct PlaneSample {
  Vector3d point;
  int pixel;
  double weight;
};

/// Those of some pixels that are near a plane and whose normals agree with it.
std::vector<PlaneSample> samples_near(const cv::Mat& points, const cv::Mat& normals,
                                      const std::vector<int>& pixels, const Vector3d& normal, double offset,
                                      double reach, double cosine) {
  std::vector<PlaneSample> samples;
  samples.reserve(pixels.size());
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* direction = normals.ptr<cv::Vec3f>();
  const cv::Vec3f n(static_cast<float>(normal.x()), static_cast<float>(normal.y()),
                    static_cast<float>(normal.z()));
  const auto along = [&n](const cv::Vec3f& v) {
    return static_cast<double>(n[0] * v[0] + n[1] * v[1] + n[2] * v[2]);
  };
  for (const int i : pixels) {
    const auto z = static_cast<double>(point[i][2]);
    if (!(z > 0) || !(along(direction[i]) > cosine)) continue;
    if (std::abs(along(point[i]) - offset) > reach + depth_noise(z)) continue;
    samples.push_back({to_vector(point[i]), i, 1.0 / (z * z)});
  }
  return samples;
}

/// Fits a plane to what lies within reach of it, by least squares; false when that does not span one.
bool fit_plane(const std::vector<PlaneSample>& samples, double reach, Vector3d& normal, double& offset) {
  double weight = 0;
  Vector3d sum = Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  size_t count = 0;
  const Vector3d origin = samples.empty() ? Vector3d::Zero() : samples.front().point;
  for (size_t i = 0; i < samples.size(); i += stride_of(samples.size())) {
    const PlaneSample& s = samples[i];
    if (std::abs(normal.dot(s.point) - offset) > reach + depth_noise(s.point.z())) continue;
    const Vector3d p = s.point - origin;
    weight += s.weight;
    sum += s.weight * p;
    moments += s.weight * p * p.transpose();
    ++count;
  }
  if (count < 50 || weight <= 0) return false;
  const Vector3d mean = sum / weight;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      Eigen::Matrix3d(moments - weight * mean * mean.transpose()));
  const Vector3d fitted = solver.eigenvectors().col(0);
  normal = fitted.dot(normal) < 0 ? Vector3d(-fitted) : fitted;
  offset = normal.dot(origin + mean);
  return true;
}

Vector6d monomials(double x, double y) {
  Vector6d m;
  m << 1, x, y, x * x, x * y, y * y;
  return m;
}

/// Fits the bend to the inliers and leaves out, step by step, what stands off it. A small piece of surface is
/// flat: there a bend would only follow the noise.
void fit_bend(const std::vector<PlaneSample>& samples, SupportPlane& plane) {
  constexpr double kStiffness =
      0.02;  // Metres to the fourth: a metre of surface bends freely, a foot hardly.
  struct Position {
    Vector3d point;  ///< in the plane's frame
    double weight, noise;
  };
  const Isometry3d plane_from_camera = plane.camera_from_plane.inverse();
  std::vector<Position> positions;
  for (size_t i = 0; i < samples.size(); i += stride_of(samples.size()))
    positions.push_back(
        {plane_from_camera * samples[i].point, samples[i].weight, depth_noise(samples[i].point.z())});
  double reach = 0.02;
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    Vector6d b = Vector6d::Zero();
    for (const Position& position : positions) {
      const Vector3d& p = position.point;
      const Vector6d m = monomials(p.x(), p.y());
      const double bent = Eigen::Map<const Vector6d>(plane.bend.data()).dot(m);
      if (std::abs(p.z() - bent) > reach + position.noise) continue;
      a.noalias() += (position.weight * m) * m.transpose();
      b += (position.weight * p.z()) * m;
    }
    const double weight = a(0, 0);
    for (int i = 3; i < 6; ++i) a(i, i) += kStiffness * weight;
    const Vector6d solved = a.ldlt().solve(b);
    std::copy_n(solved.data(), 6, plane.bend.begin());
    reach = std::max(0.006, reach * 0.6);
  }
}

std::vector<int> all_pixels(const cv::Mat& points) {
  std::vector<int> pixels(points.total());
  std::iota(pixels.begin(), pixels.end(), 0);
  return pixels;
}

/// A top-down grid of what was seen of a plane.
struct Grid {
  cv::Mat cells;  ///< CV_8U, 255 = seen
  Vector2d origin = Vector2d::Zero();

  Vector2d centre(int row, int col) const { return origin + kGridCell * Vector2d(col + 0.5, row + 0.5); }
};

Grid grid_of(const std::vector<Vector2d>& positions) {
  Grid grid;
  Vector2d low = Vector2d::Constant(1e9);
  Vector2d high = Vector2d::Constant(-1e9);
  for (const Vector2d& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double limit = 20.0;  // Metres; a Kinect sees less.
  high = high.cwiseMin(low + Vector2d::Constant(limit));
  grid.origin = low;
  const int cols = static_cast<int>((high.x() - low.x()) / kGridCell) + 1;
  const int rows = static_cast<int>((high.y() - low.y()) / kGridCell) + 1;
  grid.cells = cv::Mat::zeros(rows, cols, CV_8U);
  for (const Vector2d& p : positions) {
    const int col = static_cast<int>((p.x() - low.x()) / kGridCell);
    const int row = static_cast<int>((p.y() - low.y()) / kGridCell);
    if (col >= 0 && row >= 0 && col < cols && row < rows) grid.cells.at<unsigned char>(row, col) = 255;
  }
  return grid;
}

std::vector<Vector2d> hull_of(const cv::Mat& cells, const Grid& grid) {
  std::vector<cv::Point2f> centres;
  for (int row = 0; row < cells.rows; ++row)
    for (int col = 0; col < cells.cols; ++col)
      if (cells.at<unsigned char>(row, col)) {
        const Vector2d c = grid.centre(row, col);
        centres.emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
      }
  std::vector<cv::Point2f> hull;
  if (centres.size() >= 3) cv::convexHull(centres, hull);
  std::vector<Vector2d> outline;
  double twice_area = 0;
  for (size_t i = 0; i < hull.size(); ++i) {
    const cv::Point2f& a = hull[i];
    const cv::Point2f& b = hull[(i + 1) % hull.size()];
    twice_area += static_cast<double>(a.x * b.y - a.y * b.x);
    outline.emplace_back(static_cast<double>(a.x), static_cast<double>(a.y));
  }
  if (twice_area < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

/// A frame on the plane whose x axis is as far as possible the camera's.
Isometry3d plane_frame(const Vector3d& normal, const Vector3d& origin) {
  Vector3d x = Vector3d::UnitX() - normal * normal.x();
  if (x.norm() < 0.1) x = Vector3d::UnitZ() - normal * normal.z();
  x.normalize();
  Isometry3d frame = Isometry3d::Identity();
  frame.linear().col(0) = x;
  frame.linear().col(1) = normal.cross(x);
  frame.linear().col(2) = normal;
  frame.translation() = origin;
  return frame;
}

/// Where the surface is seen, in the plane's frame. Notes how many pixels these are and how far they are off.
std::vector<Vector2d> bent_inliers(const std::vector<PlaneSample>& samples, SupportPlane& plane) {
  std::vector<Vector2d> inliers;
  inliers.reserve(samples.size());
  double sum = 0;
  for (const PlaneSample& s : samples) {
    const Vector3d position = plane.in_plane(s.point);
    if (std::abs(position.z()) > 0.006 + depth_noise(s.point.z())) continue;
    inliers.push_back(position.head<2>());
    sum += position.z() * position.z();
  }
  plane.inliers = static_cast<int>(inliers.size());
  plane.deviation = inliers.empty() ? 0 : std::sqrt(sum / static_cast<double>(inliers.size()));
  return inliers;
}

void set_area_and_outline(const std::vector<Vector2d>& positions, SupportPlane& plane) {
  const Grid grid = grid_of(positions);
  // Sparse far rows leave gaps between cells; single cells are flying pixels.
  cv::Mat solid;
  cv::morphologyEx(grid.cells, solid, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
  plane.area = kGridCell * kGridCell * cv::countNonZero(solid);
  cv::morphologyEx(solid, solid, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U));
  plane.outline = hull_of(solid, grid);
}

/// Splits one height into supports that are apart: the pixels of each.
std::vector<std::vector<int>> separate(const std::vector<PlaneSample>& samples,
                                       const Isometry3d& plane_from_camera, const SupportOptions& options) {
  std::vector<Vector2d> positions;
  positions.reserve(samples.size());
  for (const PlaneSample& s : samples) positions.push_back((plane_from_camera * s.point).head<2>());
  const Grid grid = grid_of(positions);
  const int reach = std::max(1, static_cast<int>(options.bridge_m / kGridCell / 2));
  cv::Mat bridged;
  cv::dilate(grid.cells, bridged,
             cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1}));
  cv::Mat labels;
  const int count = cv::connectedComponents(bridged, labels);
  std::vector<int> cells(static_cast<size_t>(count), 0);
  for (int row = 0; row < labels.rows; ++row)
    for (int col = 0; col < labels.cols; ++col)
      if (grid.cells.at<unsigned char>(row, col)) ++cells[static_cast<size_t>(labels.at<int>(row, col))];
  std::vector<std::vector<int>> pixels(static_cast<size_t>(count));
  for (size_t i = 0; i < samples.size(); ++i) {
    const int col = static_cast<int>((positions[i].x() - grid.origin.x()) / kGridCell);
    const int row = static_cast<int>((positions[i].y() - grid.origin.y()) / kGridCell);
    if (col < 0 || row < 0 || col >= labels.cols || row >= labels.rows) continue;
    const auto label = static_cast<size_t>(labels.at<int>(row, col));
    if (label == 0 || cells[label] * kGridCell * kGridCell < 0.5 * options.min_area_m2) continue;
    pixels[label].push_back(samples[i].pixel);
  }
  std::erase_if(pixels, [](const std::vector<int>& p) { return p.empty(); });
  return pixels;
}

/// Whether `upper` is the top of an object that stands on `lower` rather than a support of its own right.
bool is_top_of_object(const SupportPlane& upper, const SupportPlane& lower) {
  if (upper.area > 0.3 * lower.area) return false;
  const Vector3d centre = lower.in_plane(upper.camera_from_plane.translation());
  if (centre.z() < 0.01 || centre.z() > 0.35 || upper.outline.empty()) return false;
  const PolygonOutline outline(lower.outline);
  int within = 0;
  for (const Vector2d& corner : upper.outline) {
    const Vector3d p = upper.camera_from_plane * Vector3d(corner.x(), corner.y(), 0);
    within += outline.inside(lower.in_plane(p).head<2>()) > -0.03 ? 1 : 0;
  }
  return within >= 0.7 * static_cast<double>(upper.outline.size());
}

/// What is seen across the ends of a plane in the rows and columns of the image.
struct PlaneEnds {
  int falling = 0;  ///< what is farther, or nothing
  int other = 0;    ///< what rises
  int cut = 0;      ///< the edge of the image
};

/// Looks from an end of a plane, at the pixel `at`, outwards.
void look_beyond(const cv::Mat& points, const SupportPlane& plane, const cv::Point& at, const cv::Point& step,
                 PlaneEnds& ends) {
  constexpr int kNear = 3, kFar = 10;   // pixels: edges are ragged
  constexpr double kSurelyInRange = 4;  // metres; farther nothing is measured, and a floor ends, too
  const cv::Rect image({}, points.size());
  bool falls = to_vector(points.at<cv::Vec3f>(at)).z() < kSurelyInRange;
  for (int far = kNear; far <= kFar; ++far) {
    const cv::Point beyond = at + far * step;
    if (!image.contains(beyond)) {
      ++ends.cut;
      return;
    }
    if (!falls) break;
    const Vector3d p = to_vector(points.at<cv::Vec3f>(beyond));
    if (std::isnan(p.z())) continue;
    falls = plane.normal.dot(p) - plane.offset < -0.03 - depth_noise(p.z());
    break;
  }
  ++(falls ? ends.falling : ends.other);
}

/// Whether a plane ends in view, where nothing rises from it: that of a table does, and that of a floor goes
/// on to walls, furniture and the edges of the image.
bool ends_in_view(const cv::Mat& points, const SupportPlane& plane) {
  const PolygonOutline outline(plane.outline);
  const auto shows_plane = [&](int u, int v) {
    const Vector3d p = to_vector(points.at<cv::Vec3f>(v, u));
    if (!(p.z() > 0)) return false;
    const Vector3d at = plane.in_plane(p);
    return std::abs(at.z()) < 0.006 + depth_noise(p.z()) && outline.inside(at.head<2>()) > -kGridCell;
  };
  PlaneEnds ends;
  constexpr double kMinFalling = 0.25;  // where the image cuts it off, it may go on as either
  constexpr int kEvery = 4;
  const auto look = [&](const cv::Point& start, const cv::Point& step, int length) {
    int first = 0, last = length - 1;
    while (first < length && !shows_plane(start.x + first * step.x, start.y + first * step.y)) ++first;
    if (first == length) return;
    while (!shows_plane(start.x + last * step.x, start.y + last * step.y)) --last;
    look_beyond(points, plane, start + first * step, -step, ends);
    look_beyond(points, plane, start + last * step, step, ends);
  };
  for (int v = 0; v < points.rows; v += kEvery) look({0, v}, {1, 0}, points.cols);
  for (int u = 0; u < points.cols; u += kEvery) look({u, 0}, {0, 1}, points.rows);
  return ends.falling > ends.other && ends.falling > kMinFalling * (ends.falling + ends.other + ends.cut);
}

std::vector<SupportPlane> horizontal_supports(const cv::Mat& points, const cv::Mat& normals,
                                              const mapping::PinholeCamera& camera, const Vector3d& up,
                                              const SupportOptions& options) {
  const double cosine = std::cos(options.normal_deg * kPi / 180);
  // A table under a high camera may lie as deep as this.
  const double deepest = 2 * options.max_below_camera_m;
  std::vector<PlaneSample> all =
      samples_near(points, normals, all_pixels(points), up, -deepest / 2, deepest / 2 + 0.5, cosine);
  constexpr double kBin = 0.01;
  const auto bins = static_cast<size_t>((deepest + 1.0) / kBin) + 1;
  std::vector<int> bin_of(all.size(), -1);
  std::vector<double> area(bins, 0);
  for (size_t i = 0; i < all.size(); ++i) {
    const double bin = (up.dot(all[i].point) + deepest) / kBin;
    if (bin < 0 || bin >= static_cast<double>(bins)) continue;
    bin_of[i] = static_cast<int>(bin);
    const double cos_view = std::max(0.15, -up.dot(all[i].point.normalized()));
    area[static_cast<size_t>(bin_of[i])] +=
        all[i].point.z() * all[i].point.z() / (camera.fx * camera.fy * cos_view);
  }
  std::vector<SupportPlane> found;
  for (int attempt = 0; attempt < 12; ++attempt) {
    size_t peak = 0;
    double best = 0;
    for (size_t i = 1; i + 1 < bins; ++i) {
      const double sum = area[i - 1] + area[i] + area[i + 1];
      if (sum > best) {
        best = sum;
        peak = i;
      }
    }
    if (best < options.min_area_m2 / 2) break;
    std::vector<PlaneSample> layer;
    const int reach = static_cast<int>(options.inlier_m / kBin) + 1;
    for (size_t i = 0; i < all.size(); ++i)
      if (bin_of[i] >= 0 && std::abs(bin_of[i] - static_cast<int>(peak)) <= reach) layer.push_back(all[i]);
    const double height = (static_cast<double>(peak) + 0.5) * kBin - deepest;
    const Isometry3d plane_from_camera = plane_frame(up, up * height).inverse();
    for (const std::vector<int>& pixels : separate(layer, plane_from_camera, options))
      if (auto plane = refine_support(points, normals, pixels, up, height, options)) found.push_back(*plane);
    for (int b = -reach; b <= reach; ++b) {
      const int bin = static_cast<int>(peak) + b;
      if (bin >= 0 && bin < static_cast<int>(bins)) area[static_cast<size_t>(bin)] = 0;
    }
    for (size_t i = 0; i < all.size(); ++i)
      if (std::abs(bin_of[i] - static_cast<int>(peak)) <= reach) bin_of[i] = -1;
  }
  std::erase_if(found, [&](const SupportPlane& plane) {
    const double below = -up.dot(plane.camera_from_plane.translation());
    return below > options.max_below_camera_m && !ends_in_view(points, plane);
  });
  std::vector<SupportPlane> result;
  for (size_t i = 0; i < found.size(); ++i) {
    bool own = true;
    for (size_t k = 0; k < found.size() && own; ++k) own = i == k || !is_top_of_object(found[i], found[k]);
    if (own) result.push_back(found[i]);
  }
  std::sort(result.begin(), result.end(), [&](const SupportPlane& a, const SupportPlane& b) {
    return up.dot(a.camera_from_plane.translation()) < up.dot(b.camera_from_plane.translation());
  });
  return result;
}

/// The direction of the plane that most of what looks upwards in the image agrees with.
std::optional<Vector3d> dominant_plane(const cv::Mat& points, const cv::Mat& normals, double inlier,
                                       double cosine, double& offset) {
  std::vector<PlaneSample> samples;
  std::vector<Vector3d> directions;
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* direction = normals.ptr<cv::Vec3f>();
  for (int i = 0; i < points.rows * points.cols; i += 13) {
    const Vector3d n = to_vector(direction[i]);
    if (!(n.y() < -0.2)) continue;
    samples.push_back({to_vector(point[i]), i, static_cast<double>(point[i][2])});
    directions.push_back(n);
  }
  if (samples.size() < 100) return std::nullopt;
  Random random(1);
  double best = 0;
  std::optional<Vector3d> normal;
  for (int trial = 0; trial < 300; ++trial) {
    const Vector3d& a = samples[random.index(samples.size())].point;
    const Vector3d& b = samples[random.index(samples.size())].point;
    const Vector3d& c = samples[random.index(samples.size())].point;
    Vector3d n = (b - a).cross(c - a);
    if (n.norm() < 1e-3) continue;
    n.normalize();
    if (n.y() > 0) n = -n;
    if (n.y() > -0.2) continue;
    double score = 0;
    for (size_t i = 0; i < samples.size(); ++i)
      if (std::abs(n.dot(samples[i].point - a)) < inlier / 2 && n.dot(directions[i]) > cosine)
        score += samples[i].weight * samples[i].weight;
    if (score > best) {
      best = score;
      normal = n;
      offset = n.dot(a);
    }
  }
  return normal;
}

}  // namespace

void SupportOptions::declare(OptionTable& table) {
  table.number("inlier_m", inlier_m, "m", "Maximum distance of an inlier from the plane (2 to 5 cm).", 0.002,
               0.1);
  table.number("normal_deg", normal_deg, "deg",
               "Maximum angle between the normals of an inlier and of the plane.", 1, 80);
  table.number("min_area_m2", min_area_m2, "m2", "Minimum visible area of a support (without a map).", 0.001,
               10);
  table.number(
      "max_below_camera_m", max_below_camera_m, "m",
      "Maximum depth of a support below the camera; lower planes are floor (without a map), unless they "
      "end in view less than twice as low.",
      0.1, 10);
  table.number("bridge_m", bridge_m, "m",
               "Parts of a plane closer than this belong to one support (without a map).", 0, 2);
}

PolygonOutline::PolygonOutline(const std::vector<Vector2d>& corners) {
  std::vector<Vector2d> distinct;
  for (const Vector2d& corner : corners)
    if (distinct.empty() || (corner - distinct.back()).norm() > 1e-9) distinct.push_back(corner);
  while (distinct.size() > 1 && (distinct.front() - distinct.back()).norm() <= 1e-9) distinct.pop_back();
  if (distinct.size() < 3) return;
  for (size_t i = 0; i < distinct.size(); ++i) {
    const Vector2d &start = distinct[i], &end = distinct[(i + 1) % distinct.size()];
    const double length = (end - start).norm();
    const Vector2d along = (end - start) / length;
    edges_.push_back({start.x(), start.y(), along.x(), along.y(), length, end.y()});
  }
}

std::optional<SupportPlane> refine_support(const cv::Mat& points, const cv::Mat& normals,
                                           const std::vector<int>& pixels, const Vector3d& normal,
                                           double offset, const SupportOptions& options) {
  const double cosine = std::cos(options.normal_deg * kPi / 180);
  SupportPlane plane;
  plane.normal = normal;
  plane.offset = offset;
  const std::vector<PlaneSample> around =
      samples_near(points, normals, pixels, normal, offset, 2 * options.inlier_m, cosine);
  for (const double reach : {1.0, 0.75, 0.5, 0.5})
    if (!fit_plane(around, reach * options.inlier_m, plane.normal, plane.offset)) return std::nullopt;
  const std::vector<PlaneSample> samples =
      samples_near(points, normals, pixels, plane.normal, plane.offset, options.inlier_m, cosine);
  if (samples.empty()) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (const PlaneSample& s : samples) mean += s.point;
  mean /= static_cast<double>(samples.size());
  mean -= plane.normal * (plane.normal.dot(mean) - plane.offset);
  plane.camera_from_plane = plane_frame(plane.normal, mean);
  fit_bend(samples, plane);
  const std::vector<Vector2d> inliers = bent_inliers(samples, plane);
  if (inliers.size() < 50) return std::nullopt;
  set_area_and_outline(inliers, plane);
  if (plane.area < options.min_area_m2 || plane.outline.size() < 3) return std::nullopt;
  return plane;
}

std::vector<SupportPlane> find_supports(const cv::Mat& points, const cv::Mat& normals,
                                        const mapping::PinholeCamera& camera,
                                        const std::optional<Vector3d>& up, const SupportOptions& options) {
  if (up) return horizontal_supports(points, normals, camera, *up, options);
  double offset = 0;
  const double cosine = std::cos(options.normal_deg * kPi / 180);
  const auto normal = dominant_plane(points, normals, options.inlier_m, cosine, offset);
  if (!normal) return {};
  if (auto plane = refine_support(points, normals, all_pixels(points), *normal, offset, options))
    return {*plane};
  return {};
}

std::pair<Vector3d, double> plane_in_camera(const types::PlanarSupport& support, const Isometry3d& pose) {
  const auto normal = types::from<Vector3d>(support.normal.get());
  return {pose.linear().transpose() * normal, support.offset.get() - normal.dot(pose.translation())};
}

namespace {

/// What of a convex polygon lies at least `near` before the camera.
std::vector<Vector3d> part_before(const std::vector<Vector3d>& corners, double near) {
  std::vector<Vector3d> part;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector3d& p = corners[i];
    const Vector3d& next = corners[(i + 1) % corners.size()];
    if (p.z() >= near) part.push_back(p);
    if ((p.z() >= near) != (next.z() >= near))
      part.push_back(p + (near - p.z()) / (next.z() - p.z()) * (next - p));
  }
  return part;
}

}  // namespace

cv::Mat pixels_over(const types::PlanarSupport& support, const Isometry3d& camera_from_map,
                    const mapping::PinholeCamera& camera) {
  constexpr double kNear = 0.1, kMaxPixel = 1e6;
  std::vector<Vector3d> outline;
  for (const Vector3d& corner : types::points_from_values(support.outline.get()))
    outline.push_back(camera_from_map * corner);
  std::vector<cv::Point> corners;
  for (const Vector3d& p : part_before(outline, kNear)) {
    const Vector2d at = camera.project(p).cwiseMax(-kMaxPixel).cwiseMin(kMaxPixel);
    corners.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  }
  cv::Mat inside(camera.height, camera.width, CV_8U, cv::Scalar(0));
  if (corners.size() < 3) return inside;
  std::vector<cv::Point> hull;
  cv::convexHull(corners, hull);
  cv::fillConvexPoly(inside, hull, cv::Scalar(255));
  return inside;
}

void leave_out_what_the_map_shows(const cv::Mat& map_depth, const cv::Mat& bare, const Vector3d& normal,
                                  double offset, const mapping::PinholeCamera& camera, cv::Mat& inside) {
  constexpr double kOver_m = 0.01;    // a surface is not over itself
  constexpr double kBeside_m = 0.01;  // poses and maps are not exact
  cv::Mat other = (bare == 0) & inside;
  std::vector<float> depths;
  const cv::Rect box = cv::boundingRect(inside);
  for (int v = box.y; v < box.br().y; ++v) {
    const auto* depth = map_depth.ptr<float>(v);
    const auto* within = inside.ptr<unsigned char>(v);
    auto* shown = other.ptr<unsigned char>(v);
    for (int u = box.x; u < box.br().x; ++u) {
      if (within[u] == 0 || std::isnan(depth[u])) continue;
      depths.push_back(depth[u]);
      if (normal.dot(camera.unproject(u, v, static_cast<double>(depth[u]))) - offset > kOver_m)
        shown[u] = 255;
    }
  }
  if (depths.empty()) return;
  const int beside =
      static_cast<int>(std::ceil(kBeside_m * camera.fx / static_cast<double>(median(std::move(depths)))));
  cv::dilate(other, other, cv::Mat::ones(2 * beside + 1, 2 * beside + 1, CV_8U));
  inside.setTo(0, other);
}

cv::Mat pixels_of_clusters(const types::SceneCas& scene, const cv::Size& size, int margin) {
  cv::Mat taken = cv::Mat::zeros(size, CV_8U);
  for (const types::Cluster& cluster : scene.clusters())
    for (const int32_t index : cluster_indices(cluster)) taken.ptr<unsigned char>()[index] = 255;
  if (margin > 0) cv::dilate(taken, taken, cv::Mat::ones(2 * margin + 1, 2 * margin + 1, CV_8U));
  return taken;
}

}  // namespace loci::perception
