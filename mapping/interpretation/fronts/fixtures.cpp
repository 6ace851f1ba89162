#include "mapping/interpretation/fronts/fixtures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/math/random.h"
#include "mapping/interpretation/fronts/face.h"
#include "mapping/interpretation/fronts/fixture_shape.h"
#include "mapping/interpretation/fronts/parameters.h"
#include "mapping/interpretation/fronts/ribs.h"

namespace loci::mapping {
namespace {

/// A connected piece of the candidates' raster.
struct FixturePatch {
  cv::Rect cells;
  size_t cluster = 0;  ///< which it belongs to: its own number or that of a patch in line with it
};

/// Connected pieces of a raster by label; the first is the background.
std::vector<FixturePatch> patches_of(const cv::Mat& mask, cv::Mat& labels) {
  cv::Mat stats, centroids;
  const int number = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8);
  std::vector<FixturePatch> patches;
  for (int i = 0; i < number; ++i)
    patches.push_back({{stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                        stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)},
                       static_cast<size_t>(i)});
  return patches;
}

/// Joins thin patches in line with each other: parts of a bar may be hidden or missed.
void join_in_line(std::vector<FixturePatch>& patches) {
  const auto in_line = [](const cv::Rect& a, const cv::Rect& b) {
    const auto along = [](int a0, int a1, int b0, int b1, int a_low, int a_size, int b_low, int b_size) {
      // Two knobs may be nearer to each other than the pieces of a bar that a tap hides in part.
      const bool bars = std::max(a1 - a0, b1 - b0) > kFixtures.bar_elongation * std::max(a_size, b_size);
      return std::max(a0, b0) - std::min(a1, b1) <=
                 (bars ? kFixtures.join_bars_cells : kFixtures.join_gap_cells) &&
             a_size <= kFixtures.thin_cells && b_size <= kFixtures.thin_cells &&
             std::abs(2 * a_low + a_size - 2 * b_low - b_size) <= 2 * kFixtures.join_offset_cells;
    };
    return along(a.x, a.x + a.width, b.x, b.x + b.width, a.y, a.height, b.y, b.height) ||
           along(a.y, a.y + a.height, b.y, b.y + b.height, a.x, a.width, b.x, b.width);
  };
  for (size_t i = 1; i < patches.size(); ++i)
    for (size_t k = 1; k < i; ++k) {
      const size_t from = patches[i].cluster;
      const size_t to = patches[k].cluster;
      if (from == to || !in_line(patches[i].cells, patches[k].cells)) continue;
      for (FixturePatch& patch : patches)
        if (patch.cluster == from) patch.cluster = to;
      patches[to].cells |= patches[from].cells;
    }
}

/// Rasters of ray ends: on the face, within reach of a fixture, farther before it, behind it.
struct FixtureLayers {
  cv::Mat face, fixture, farther, behind;
};

FixtureLayers count(const FaceRays& rays, const FaceGrid& grid, const FaceGround& ground, double threshold) {
  const cv::Mat empty = cv::Mat::zeros(grid.height, grid.width, CV_32F);
  FixtureLayers layers{empty.clone(), empty.clone(), empty.clone(), empty.clone()};
  for (const FaceRay& ray : rays.rays) {
    double u = ray.point_u();
    double v = ray.point_v();
    const double depth = static_cast<double>(ray.depth) - ground.at(u, v);
    const bool before = ray.returned && depth > threshold;
    if (!before) u = ray.plane_u(), v = ray.plane_v();
    const int x = grid.column(u);
    const int y = grid.row(v);
    if (!grid.inside(x, y)) continue;
    // A mirror-like front gives no returns; a missing return still shows that no object is before it.
    cv::Mat& layer = before ? (depth < kFaces.fixture_reach_m ? layers.fixture : layers.farther)
                     : ray.returned && depth < -threshold ? layers.behind
                                                          : layers.face;
    layer.at<float>(y, x) += 1;
  }
  for (cv::Mat* layer : {&layers.face, &layers.fixture, &layers.farther, &layers.behind})
    cv::GaussianBlur(*layer, *layer, {}, 1.5, 1.5, cv::BORDER_CONSTANT);
  return layers;
}

/// Cells in which a large share of the points is within reach of a fixture.
cv::Mat candidates(const FixtureLayers& layers, float share) {
  return (layers.fixture > kFixtures.min_density) & (layers.fixture > share * (layers.fixture + layers.face));
}

class FixtureFinder {
 public:
  FixtureFinder(const FaceRays& rays)
      : rays_(rays),
        grid_(rays.face),
        ground_(rays),
        threshold_(std::clamp(2 * rays.sigma, kFixtures.min_protrusion_m, 0.03)),
        layers_(count(rays, grid_, ground_, threshold_)) {}

  FixtureSearch search(const Random& random) {
    // A handle that is connected to a large object (close below a counter) separates at higher shares.
    cv::Mat rest(grid_.height, grid_.width, CV_8U, cv::Scalar(255));
    for (size_t pass = 0; pass < kFixtures.min_shares.size(); ++pass)
      rest = search(rest & candidates(layers_, kFixtures.min_shares[pass]), random.fork(pass),
                    pass + 1 == kFixtures.min_shares.size());
    drop_ghosts();
    result_.ribs = remove_ribs(result_.fixtures);
    if (!result_.ribs.empty()) {
      const Vector3d& at = result_.ribs.front().centre;
      result_.notes.push_back(
          fmt::format("{} upright bars in a row at ({:.2f}, {:.2f}, {:.2f}) are not handles",
                      result_.ribs.size(), at.x(), at.y(), at.z()));
    }
    return std::move(result_);
  }

 private:
  /// Tries every patch of a raster; returns those without the shape of a fixture for the next pass. Only the
  /// last pass adds notes.
  cv::Mat search(const cv::Mat& mask, const Random& random, bool last) {
    cv::Mat labels;
    std::vector<FixturePatch> patches = patches_of(mask, labels);
    join_in_line(patches);
    const std::vector<std::vector<FixturePoint>> clusters = clusters_of(patches, labels);
    std::vector<bool> failed(patches.size(), false);
    for (size_t i = 1; i < clusters.size(); ++i) {
      if (clusters[i].size() < kFixtures.min_points) continue;
      const cv::Rect& cells = patches[i].cells;
      const FaceRect box{
          grid_.u0 + cells.x * kFaces.cell_m, grid_.u0 + (cells.x + cells.width) * kFaces.cell_m,
          grid_.v0 + cells.y * kFaces.cell_m, grid_.v0 + (cells.y + cells.height) * kFaces.cell_m};
      bool shapeless = false;
      const std::string why = try_cluster(clusters[i], box, random.fork(i), shapeless);
      if (why.empty()) continue;
      failed[i] = shapeless;
      if (shapeless && !last) continue;
      const Vector3d at = rays_.face.at(box.u(), box.v());
      result_.notes.push_back(
          fmt::format("the object before the face at ({:.2f}, {:.2f}, {:.2f}) is no fixture: {}", at.x(),
                      at.y(), at.z(), why));
    }
    cv::Mat rest = cv::Mat::zeros(mask.size(), CV_8U);
    for (int y = 0; y < labels.rows; ++y)
      for (int x = 0; x < labels.cols; ++x)
        if (failed[patches[static_cast<size_t>(labels.at<int>(y, x))].cluster]) rest.at<uint8_t>(y, x) = 255;
    return rest;
  }

  std::vector<std::vector<FixturePoint>> clusters_of(const std::vector<FixturePatch>& patches,
                                                     const cv::Mat& labels) const {
    std::vector<std::vector<FixturePoint>> clusters(patches.size());
    for (const FaceRay& ray : rays_.rays) {
      const double depth = static_cast<double>(ray.depth) - ground_.at(ray.point_u(), ray.point_v());
      if (!ray.returned || depth < threshold_ || depth > kFaces.fixture_reach_m) continue;
      const int x = grid_.column(ray.point_u());
      const int y = grid_.row(ray.point_v());
      if (!grid_.inside(x, y) || labels.at<int>(y, x) == 0) continue;
      const Vector2d slope(static_cast<double>(ray.slope_u), static_cast<double>(ray.slope_v));
      const double norm = std::hypot(1.0, slope.norm());
      clusters[patches[static_cast<size_t>(labels.at<int>(y, x))].cluster].push_back(
          {ray.point_u(), ray.point_v(), depth, slope / norm, 1 / norm, ray.scan});
    }
    return clusters;
  }

  std::string try_cluster(const std::vector<FixturePoint>& points, const FaceRect& box, const Random& random,
                          bool& shapeless) {
    shapeless = true;
    if (std::min(box.width(), box.height()) > 3 * kFixtures.max_bar_width_m) return "it is large";
    FixtureShape shape = line_through(points, random);
    if (shape.inliers.size() < kFixtures.min_points) return "few points";
    measure_shape(points, shape);
    if (shape.width < kFixtures.max_bar_width_m) extend(points, shape);
    // The line through a knob may run askew.
    const bool bar = !is_round(points) && shape.length > kFixtures.bar_elongation * shape.width &&
                     shape.length > kFixtures.min_bar_m &&
                     (!is_askew(shape) || std::hypot(box.width(), box.height()) > 1.5 * kFixtures.max_knob_m);
    if (const std::optional<double> gap = bar ? gap_of(points, shape) : std::nullopt) {
      std::array<std::vector<FixturePoint>, 2> halves;
      for (const FixturePoint& point : points)
        halves[shape.axis.dot(Vector2d(point.u, point.v) - shape.centre) < *gap ? 0 : 1].push_back(point);
      if (std::min(halves[0].size(), halves[1].size()) >= kFixtures.min_points)
        return try_halves(halves, box, random, shapeless);
    }
    if (!bar) {
      shape.inliers.resize(points.size());
      for (size_t i = 0; i < points.size(); ++i) shape.inliers[i] = i;
      measure_shape(points, shape);
    }
    std::string why = bar ? why_no_bar(shape, points.size()) : why_no_knob(shape);
    if (!why.empty()) return why;
    shapeless = false;
    return add(points, shape, bar);
  }

  /// Calls `visit` for each ray that ends on a fixture, or passes where it is, `protrusion` before the face
  /// and within `half_width` of its middle line: with the place along it from its middle, and whether it
  /// ended.
  template <class Visit>
  void for_rays_at(const FixtureShape& shape, double protrusion, double half_width, Visit&& visit) const {
    const Vector2d across(-shape.axis.y(), shape.axis.x());
    for (const FaceRay& ray : rays_.rays) {
      if (!ray.returned) continue;
      const double depth = static_cast<double>(ray.depth) - ground_.at(ray.plane_u(), ray.plane_v());
      const bool before = depth > kFixtures.min_hit_depth * protrusion;
      if (before && depth > kFaces.fixture_reach_m) continue;
      const Vector2d d = ray.at_depth(before ? depth : protrusion) - shape.centre;
      if (std::abs(across.dot(d)) < half_width) visit(shape.axis.dot(d), before);
    }
  }

  /// Of what looks like one bar: where rays pass through its line over such a length that there are two, as
  /// on neighbouring fronts; in metres from the middle. What hides a part of a bar stops the rays.
  std::optional<double> gap_of(const std::vector<FixturePoint>& points, const FixtureShape& shape) const {
    std::vector<double> depths;
    for (const size_t i : shape.inliers) depths.push_back(points[i].depth);
    std::vector<size_t> through(static_cast<size_t>(shape.length / kFixtures.gap_step_m) + 1);
    std::vector<size_t> on(through.size());
    for_rays_at(shape, median(depths), kFixtures.core * std::max(shape.width, kFixtures.gap_step_m),
                [&](double along, bool ended) {
                  const double step = std::floor((along + shape.length / 2) / kFixtures.gap_step_m);
                  if (step >= 0 && step < static_cast<double>(on.size()))
                    ++(ended ? on : through)[static_cast<size_t>(step)];
                });
    const auto [first, count] = widest_gap(through, on);
    const double middle =
        (static_cast<double>(first) + static_cast<double>(count) / 2) * kFixtures.gap_step_m -
        shape.length / 2;
    const bool wide = static_cast<double>(count) * kFixtures.gap_step_m >= kFixtures.min_gap_m;
    const bool inside = std::abs(middle) < shape.length / 2 - kFixtures.min_bar_m;
    return wide && inside ? std::optional(middle) : std::nullopt;
  }

  /// The longest run of steps through each of which more rays pass than end, and through all of them nearly
  /// all: its first and their number.
  static std::pair<size_t, size_t> widest_gap(const std::vector<size_t>& through,
                                              const std::vector<size_t>& on) {
    std::pair<size_t, size_t> widest{0, 0};
    for (size_t first = 0; first < on.size(); ++first)
      for (size_t last = first, passed = 0, met = 0; last < on.size() && through[last] > on[last]; ++last) {
        passed += through[last];
        met += on[last];
        const bool clear = passed >= kFixtures.min_gap_rays && met * kFixtures.min_gap_rays <= passed;
        if (clear && last - first + 1 > widest.second) widest = {first, last - first + 1};
      }
    return widest;
  }

  std::string try_halves(const std::array<std::vector<FixturePoint>, 2>& halves, const FaceRect& box,
                         const Random& random, bool& shapeless) {
    shapeless = true;
    std::string why;
    for (size_t i = 0; i < halves.size(); ++i) {
      bool without_shape = true;
      why = try_cluster(halves[i], box, random.fork(i), without_shape);
      shapeless = shapeless && without_shape;
    }
    return shapeless ? why : "";
  }

  /// Extends a bar as long as consecutive points before the face lie along it: higher shares shorten it.
  void extend(const std::vector<FixturePoint>& points, FixtureShape& shape) const {
    const Vector2d across(-shape.axis.y(), shape.axis.x());
    std::vector<double> depths;
    for (const size_t i : shape.inliers) depths.push_back(points[i].depth);
    const double min_depth = std::max(1.3 * threshold_, kFixtures.extend_depth * median(depths));
    std::vector<double> along;
    for (const FaceRay& ray : rays_.rays) {
      if (!ray.returned || ray.depth > static_cast<float>(2 * kFaces.fixture_reach_m)) continue;
      const Vector2d d = Vector2d(ray.point_u(), ray.point_v()) - shape.centre;
      const double depth = static_cast<double>(ray.depth) - ground_.at(ray.point_u(), ray.point_v());
      if (std::abs(across.dot(d)) < 0.4 * shape.width && depth > min_depth &&
          depth < kFaces.fixture_reach_m &&
          std::abs(shape.axis.dot(d)) < shape.length / 2 + kFixtures.extend_reach_m)
        along.push_back(shape.axis.dot(d));
    }
    std::sort(along.begin(), along.end());
    double low = -shape.length / 2;
    double high = shape.length / 2;
    for (const double a : along)
      if (a > high && a - high < kFixtures.extend_step_m) high = a;
    for (size_t i = along.size(); i-- > 0;)
      if (along[i] < low && low - along[i] < kFixtures.extend_step_m) low = along[i];
    shape.centre += (low + high) / 2 * shape.axis;
    shape.length = high - low;
  }

  /// Whether all of a cluster is about as wide as tall, and no larger than a knob: a line through some of its
  /// points is a strip of it.
  static bool is_round(const std::vector<FixturePoint>& points) {
    FixtureShape whole;
    whole.inliers.resize(points.size());
    std::iota(whole.inliers.begin(), whole.inliers.end(), size_t{0});
    measure_shape(points, whole);
    return whole.length < kFixtures.max_knob_m && whole.length < kFixtures.bar_elongation * whole.width;
  }

  static std::string why_no_bar(const FixtureShape& shape, size_t points) {
    if (shape.length > kFixtures.max_bar_m) return fmt::format("{:.2f} m long", shape.length);
    if (shape.width > kFixtures.max_bar_width_m) return fmt::format("{:.3f} m thick", shape.width);
    if (static_cast<double>(shape.inliers.size()) < 0.7 * static_cast<double>(points))
      return "no line explains it";
    if (is_askew(shape)) return "it is neither level nor upright";
    return {};
  }
  /// Handles are level or upright; how far a line may seem tilted follows from what may lie beside it.
  static bool is_askew(const FixtureShape& shape) {
    const double turned = std::atan2(std::abs(shape.axis.y()), std::abs(shape.axis.x()));
    const double max_tilt = std::min(kFixtures.max_tilt, 2 * kFixtures.line_tolerance_m / shape.length);
    return turned > max_tilt && turned < kPi / 2 - max_tilt;
  }
  static std::string why_no_knob(const FixtureShape& shape) {
    if (shape.length > kFixtures.max_knob_m)
      return fmt::format("{:.3f} m by {:.3f} m", shape.length, shape.width);
    if (shape.length < kFixtures.min_knob_m) return "it is tiny";
    return {};
  }

  /// Removes duplicates: beams that meet both a bar and its front yield a second, weak bar, and a bar in
  /// pieces is found several times.
  void drop_ghosts() {
    const auto points = [](const FaceFixture& fixture) {
      return fixture.fixture.evidence.at("inliers").get<double>();
    };
    std::stable_sort(result_.fixtures.begin(), result_.fixtures.end(),
                     [&](const FaceFixture& a, const FaceFixture& b) { return points(a) > points(b); });
    std::vector<FaceFixture> kept;
    for (const FaceFixture& weak : result_.fixtures) {
      const auto strong = std::find_if(kept.begin(), kept.end(), [&](const FaceFixture& other) {
        if (weak.box.intersects(other.box.grown(kFixtures.same_bar_m))) return true;
        return points(weak) < kFixtures.ghost_points * points(other) &&
               other.box.grown(kFixtures.ghost_reach_m).contains(weak.u, weak.v) &&
               std::abs(weak.fixture.axis.dot(other.fixture.axis)) > 0.9;
      });
      if (strong == kept.end())
        kept.push_back(weak);
      else if (weak.box.intersects(strong->box.grown(kFixtures.same_bar_m)) &&
               weak.fixture.kind == Fixture::Kind::handle)
        unite(*strong, weak);
    }
    result_.fixtures = std::move(kept);
  }

  /// Extends a bar over a piece of it in the same line.
  void unite(FaceFixture& bar, const FaceFixture& piece) const {
    const bool level = bar.box.width() > bar.box.height();
    if (level != (piece.box.width() > piece.box.height())) return;
    if (std::abs(level ? bar.v - piece.v : bar.u - piece.u) > kFixtures.unite_offset_m) return;
    double& low = level ? bar.box.u0 : bar.box.v0;
    double& high = level ? bar.box.u1 : bar.box.v1;
    low = std::min(low, level ? piece.box.u0 : piece.box.v0);
    high = std::max(high, level ? piece.box.u1 : piece.box.v1);
    const Vector3d depth =
        (bar.fixture.centre - rays_.face.at(bar.u, bar.v)).dot(rays_.face.normal3()) * rays_.face.normal3();
    (level ? bar.u : bar.v) = (low + high) / 2;
    bar.fixture.centre = rays_.face.at(bar.u, bar.v) + depth;
    bar.fixture.length = high - low;
  }

  /// Share of a band beside the fixture in which rays met the face: the minimum over its thirds, as at the
  /// end of a face (the edge of a counter) another object may be behind a part of it.
  double shown(const FixtureShape& shape, double side, bool along) const {
    const Vector2d axis = along ? shape.axis : Vector2d(-shape.axis.y(), shape.axis.x());
    const Vector2d across(-axis.y(), axis.x());
    const double length = along ? shape.length : shape.width;
    const double half_width = (along ? shape.width : shape.length) / 2;
    std::array<double, 3> face{};
    std::array<double, 3> cells{};
    for (double s = -length / 2; s <= length / 2 + 1e-9; s += kFaces.cell_m) {
      size_t strip = 0;
      for (double t = half_width + 0.008; t < half_width + kFixtures.surroundings_m; t += kFaces.cell_m) {
        const Vector2d at = shape.centre + s * axis + side * t * across;
        const int x = grid_.column(at.x());
        const int y = grid_.row(at.y());
        const auto third = static_cast<size_t>(std::clamp(3 * (s / length + 0.5), 0.0, 2.0));
        if (!grid_.inside(x, y)) continue;
        const float on = layers_.face.at<float>(y, x);
        const float off = layers_.fixture.at<float>(y, x) + layers_.farther.at<float>(y, x) +
                          layers_.behind.at<float>(y, x);
        if (on + off < kFixtures.min_density) continue;  // occluded
        // Beyond a strip of face begins the bar of the next door.
        if (on < layers_.fixture.at<float>(y, x) && strip >= kFixtures.min_strip_cells) break;
        strip += on > off ? 1 : 0;
        cells[third] += 1;
        face[third] += on > off ? 1 : 0;
      }
    }
    double min_share = 1;
    if (cells[0] + cells[1] + cells[2] < kFixtures.min_cells_beside) return 0;
    for (size_t i = 0; i < 3; ++i)
      if (cells[i] > 0) min_share = std::min(min_share, face[i] / cells[i]);
    return min_share;
  }

  /// Points farther before the face over the fixture, per point of it: the edge of an object there yields
  /// both.
  double farther(const FixtureShape& shape, size_t points) const {
    double sum = 0;
    for (double s = -shape.length / 2; s <= shape.length / 2 + 1e-9; s += kFaces.cell_m)
      for (double t = -0.012; t <= 0.012; t += kFaces.cell_m) {
        const Vector2d at = shape.centre + s * shape.axis + t * Vector2d(-shape.axis.y(), shape.axis.x());
        const int x = grid_.column(at.x());
        const int y = grid_.row(at.y());
        if (grid_.inside(x, y)) sum += static_cast<double>(layers_.farther.at<float>(y, x));
      }
    return sum / static_cast<double>(points);
  }

  /// Whether more rays pass a fixture's position, `protrusion` before the face, than end there: then its
  /// points are mixed returns of beams that met two surfaces.
  bool is_seen_through(const FixtureShape& shape, double protrusion) const {
    size_t through = 0, on = 0;
    for_rays_at(shape, protrusion, kFixtures.core * shape.width, [&](double along, bool ended) {
      if (std::abs(along) < kFixtures.core * shape.length) ++(ended ? on : through);
    });
    return through >= on;
  }

  /// Adds a handle or knob; returns why not, or nothing.
  std::string add(const std::vector<FixturePoint>& points, FixtureShape& shape, bool bar) {
    const double beside = std::min(shown(shape, 1, true), shown(shape, -1, true));
    if (beside < kFixtures.min_shown)
      return fmt::format("the face shows beside {:.0f} % of it", 100 * beside);
    const double ends = std::min(shown(shape, 1, false), shown(shape, -1, false));
    // A bar may be as long as its front: then its sides decide.
    const bool whole = bar && shape.length > kFixtures.long_bar_m && beside > kFixtures.min_shown_beside_long;
    if (!whole && ends < (bar ? kFixtures.min_shown_at_ends : kFixtures.min_shown))
      return fmt::format("the face shows beyond its ends in {:.0f} %", 100 * ends);
    if (farther(shape, shape.inliers.size()) > 0.5) return "more points are farther before the face there";
    std::set<int> scans;
    std::vector<double> depths;
    for (const size_t i : shape.inliers) {
      scans.insert(points[i].scan);
      depths.push_back(points[i].depth);
    }
    const double depth = median(depths);
    if (shape.inliers.size() < kFixtures.many_points && is_seen_through(shape, depth))
      return "rays pass through it";
    const double ground = ground_.at(shape.centre.x(), shape.centre.y());
    const double surface = mixture_depth(depths_on(shape, bar, ground), depth, std::max(rays_.sigma, 0.003));
    if (surface < 0.9 * kFixtures.min_protrusion_m)
      return fmt::format("it protrudes by {:.3f} m only", surface);
    FaceFixture found = placed(points, shape, bar, ground, surface);
    if (bar && found.fixture.protrusion - found.fixture.radius <
                   (shape.length > kFixtures.long_bar_m ? kFixtures.min_long_grip_m : kFixtures.min_grip_m))
      return "there is no room for fingers behind it";
    const FurnitureFace& face = rays_.face;
    if (!FaceRect{face.u_min, face.u_max, face.v_min, face.v_max}.contains(found.u, found.v))
      return "it is beside the face";
    const double many = static_cast<double>(shape.inliers.size());
    const bool seen_by_others = scans.size() < 2 && scans_beside(shape) > 1;
    found.fixture.confidence = beside * many / (many + 15) * (seen_by_others ? 0.6 : 1);
    found.fixture.evidence = {{"inliers", shape.inliers.size()},
                              {"scans", std::vector<int>(scans.begin(), scans.end())},
                              {"model", bar ? "line" : "circle"}};
    result_.fixtures.push_back(std::move(found));
    return {};
  }

  /// How many scans met the face beside a fixture, and should have seen it.
  size_t scans_beside(const FixtureShape& shape) const {
    std::vector<size_t> points(1);
    for (const FaceRay& ray : rays_.rays) {
      if (!ray.is_on_face()) continue;
      const Vector2d d = Vector2d(ray.plane_u(), ray.plane_v()) - shape.centre;
      if (d.cwiseAbs().maxCoeff() > shape.length / 2 + kFixtures.surroundings_m) continue;
      points.resize(std::max<size_t>(points.size(), ray.scan + size_t{1}));
      ++points[ray.scan];
    }
    return static_cast<size_t>(
        std::count_if(points.begin(), points.end(), [](size_t n) { return n >= kFixtures.min_points; }));
  }

  /// Depths of the points on the middle of a fixture, and of the face behind it.
  std::vector<double> depths_on(const FixtureShape& shape, bool bar, double ground) const {
    std::vector<double> depths;
    const Vector2d across(-shape.axis.y(), shape.axis.x());
    const double reach_along = bar ? 0.4 * shape.length : 0.3 * shape.width;
    for (const FaceRay& ray : rays_.rays) {
      const double depth = static_cast<double>(ray.depth) - ground;
      if (!ray.returned || depth > kFaces.fixture_reach_m || depth < -kFaces.relief_m) continue;
      const Vector2d d = Vector2d(ray.point_u(), ray.point_v()) - shape.centre;
      if (std::abs(shape.axis.dot(d)) < reach_along && std::abs(across.dot(d)) < 0.35 * shape.width)
        depths.push_back(depth);
    }
    return depths;
  }

  /// The fixture in the map. The sensor sees one half of a bar, so that its axis is behind the surface.
  FaceFixture placed(const std::vector<FixturePoint>& points, const FixtureShape& shape, bool bar,
                     double ground, double surface) const {
    FaceFixture found;
    Fixture& fixture = found.fixture;
    fixture.kind = bar ? Fixture::Kind::handle : Fixture::Kind::knob;
    fixture.radius =
        std::clamp(bar ? (shape.width - 0.004) / 2 : (shape.length + shape.width) / 4, 0.003, 0.03);
    fixture.length = bar ? shape.length : 2 * fixture.radius;
    Vector2d toward = Vector2d::Zero();
    double lean = 0;
    for (const size_t i : shape.inliers) {
      toward += points[i].toward / static_cast<double>(shape.inliers.size());
      lean += points[i].lean / static_cast<double>(shape.inliers.size());
    }
    if (bar) toward -= toward.dot(shape.axis) * shape.axis;
    const double behind = bar ? kFixtures.half_round * fixture.radius : 0;
    const Vector2d centre = shape.centre - behind * toward;
    fixture.protrusion = surface - behind * lean;
    found.u = centre.x();
    found.v = centre.y();
    const FurnitureFace& face = rays_.face;
    fixture.centre = face.at(found.u, found.v, ground + fixture.protrusion);
    fixture.axis =
        bar ? Vector3d(shape.axis.x() * face.right3() + shape.axis.y() * Vector3d::UnitZ()) : face.normal3();
    Vector2d half(fixture.radius, fixture.radius);
    if (bar)
      half = {std::abs(shape.axis.x()) * shape.length / 2 + std::abs(shape.axis.y()) * fixture.radius,
              std::abs(shape.axis.y()) * shape.length / 2 + std::abs(shape.axis.x()) * fixture.radius};
    found.box = {found.u - half.x(), found.u + half.x(), found.v - half.y(), found.v + half.y()};
    return found;
  }

  const FaceRays& rays_;
  FaceGrid grid_;
  FaceGround ground_;
  double threshold_;
  FixtureLayers layers_;
  FixtureSearch result_;
};

}  // namespace

FixtureSearch find_fixtures(const FaceRays& rays, const Random& random) {
  return FixtureFinder(rays).search(random);
}

}  // namespace loci::mapping
