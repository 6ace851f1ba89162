#include "mapping/interpretation/fixtures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/math.h"
#include "mapping/base/quantile.h"
#include "mapping/interpretation/face_ground.h"
#include "mapping/interpretation/fixture_shapes.h"

namespace loci::mapping {
namespace {

constexpr double kMinProtrusion = 0.015;  // m
constexpr double kLongestBar = 1.3;       // m; of a fridge
constexpr double kShortestBar = 0.045;    // m
constexpr double kThickestBar = 0.045;    // m
constexpr double kMaxKnob = 0.065;        // m
constexpr double kMinKnob = 0.008;        // m
constexpr double kElongated = 2.2;        // length over width that makes a bar
constexpr double kMaxTurned = 0.35;       // rad; handles are level or upright
/// Of the points in a cell that stand before the face, for the cell to belong to a fixture; look by look.
constexpr std::array<float, 3> kShares = {0.3F, 0.45F, 0.65F};
constexpr double kMinShownAtEnds = 0.25;
constexpr double kAsDeep = 0.6;  // of its distance from the face; nearer to the face a ray passed by it
constexpr double kCore = 0.38;   // of length and width to each side that rays certainly meet
constexpr size_t kMinPoints = 10;
constexpr size_t kManyPoints = 40;       // are not all in mid-air
constexpr double kMinBeside = 6;         // cells beside a fixture that rays met
constexpr double kSurroundings = 0.035;  // m beside a fixture in which its front shows
constexpr double kMinShown = 0.4;        // of these must be face
constexpr float kMin = 0.07F;            // points per cell after smoothing: one within 6 mm
constexpr double kHalfRound =
    0.785;  // mean distance of the visible half of a cylinder from its axis / radius

/// Rasters of what the rays met: the face, something shortly or farther before it, something behind it.
struct Layers {
  cv::Mat face, fixture, farther, behind;
};

Layers count(const FaceRays& rays, const FaceGrid& grid, const FaceGround& ground, double threshold) {
  const cv::Mat empty = cv::Mat::zeros(grid.height, grid.width, CV_32F);
  Layers layers{empty.clone(), empty.clone(), empty.clone(), empty.clone()};
  for (const FaceRay& ray : rays.rays) {
    double u = ray.point_u();
    double v = ray.point_v();
    const double depth = static_cast<double>(ray.depth) - ground.at(u, v);
    const bool before = ray.returned && depth > threshold;
    if (!before) u = static_cast<double>(ray.u), v = static_cast<double>(ray.v);
    const int x = grid.column(u);
    const int y = grid.row(v);
    if (!grid.inside(x, y)) continue;
    // A mirror-like front gives no returns: that nothing came back says that nothing stands before it.
    cv::Mat& layer = before ? (depth < kFixtureReach ? layers.fixture : layers.farther)
                     : ray.returned && depth < -threshold ? layers.behind
                                                          : layers.face;
    layer.at<float>(y, x) += 1;
  }
  for (cv::Mat* layer : {&layers.face, &layers.fixture, &layers.farther, &layers.behind})
    cv::GaussianBlur(*layer, *layer, {}, 1.5, 1.5, cv::BORDER_CONSTANT);
  return layers;
}

/// Cells in which a good part of the points stands shortly before the face.
cv::Mat candidates(const Layers& layers, float share) {
  return (layers.fixture > kMin) & (layers.fixture > share * (layers.fixture + layers.face));
}

class FixtureFinder {
 public:
  FixtureFinder(const FaceRays& rays)
      : rays_(rays),
        grid_(rays.face),
        ground_(rays),
        threshold_(std::clamp(2 * rays.sigma, kMinProtrusion, 0.03)),
        layers_(count(rays, grid_, ground_, threshold_)) {}

  FixtureSearch search(const Random& random) {
    // What hangs together with something large, a handle close below a counter, is looked at more closely.
    cv::Mat rest(grid_.height, grid_.width, CV_8U, cv::Scalar(255));
    for (size_t look = 0; look < kShares.size(); ++look)
      rest = search(rest & candidates(layers_, kShares[look]), random.fork(look), look + 1 == kShares.size());
    drop_ghosts();
    return std::move(result_);
  }

 private:
  /// Tries every patch of a raster; returns those without the shape of a fixture, to be looked at again. Only
  /// the last look says why.
  cv::Mat search(const cv::Mat& mask, const Random& random, bool last) {
    cv::Mat labels;
    std::vector<FixturePatch> patches = patches_of(mask, labels);
    join_in_line(patches);
    const std::vector<std::vector<FixturePoint>> clusters = clusters_of(patches, labels);
    std::vector<bool> failed(patches.size(), false);
    for (size_t i = 1; i < clusters.size(); ++i) {
      if (clusters[i].size() < kMinPoints) continue;
      const cv::Rect& cells = patches[i].cells;
      const FaceRect box{grid_.u0 + cells.x * kFaceCell, grid_.u0 + (cells.x + cells.width) * kFaceCell,
                         grid_.v0 + cells.y * kFaceCell, grid_.v0 + (cells.y + cells.height) * kFaceCell};
      bool shapeless = false;
      const std::string why = try_cluster(clusters[i], box, random.fork(i), shapeless);
      if (why.empty()) continue;
      failed[i] = shapeless;
      if (shapeless && !last) continue;
      const Vector3d at = rays_.face.at(box.u(), box.v());
      result_.notes.push_back(
          fmt::format("what stands before the face at ({:.2f}, {:.2f}, {:.2f}) is no fixture: {}", at.x(),
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
      if (!ray.returned || depth < threshold_ || depth > kFixtureReach) continue;
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
    if (std::min(box.width(), box.height()) > 3 * kThickestBar) return "it is large";
    FixtureShape shape = line_through(points, random);
    if (shape.inliers.size() < kMinPoints) return "few points";
    measure(points, shape);
    if (shape.width < kThickestBar) extend(points, shape);
    const bool bar = shape.length > kElongated * shape.width && shape.length > kShortestBar;
    if (!bar) {
      shape.inliers.resize(points.size());
      for (size_t i = 0; i < points.size(); ++i) shape.inliers[i] = i;
      measure(points, shape);
    }
    const std::string why = bar ? why_no_bar(shape, points.size()) : why_no_knob(shape);
    if (!why.empty()) return why;
    shapeless = false;
    return add(points, shape, bar);
  }

  /// A closer look sees less: the bar goes on as long as points before the face follow each other along it.
  void extend(const std::vector<FixturePoint>& points, FixtureShape& shape) const {
    constexpr double kReach = 0.12;  // m beyond each end
    constexpr double kStep = 0.022;  // m between points that follow each other
    constexpr double kAsFar = 0.6;   // of the bar's distance from the face
    const Vector2d across(-shape.axis.y(), shape.axis.x());
    std::vector<double> depths;
    for (const size_t i : shape.inliers) depths.push_back(points[i].depth);
    const double least = std::max(1.3 * threshold_, kAsFar * median(depths));
    std::vector<double> along;
    for (const FaceRay& ray : rays_.rays) {
      if (!ray.returned || ray.depth > static_cast<float>(2 * kFixtureReach)) continue;
      const Vector2d d = Vector2d(ray.point_u(), ray.point_v()) - shape.centre;
      const double depth = static_cast<double>(ray.depth) - ground_.at(ray.point_u(), ray.point_v());
      if (std::abs(across.dot(d)) < 0.4 * shape.width && depth > least && depth < kFixtureReach &&
          std::abs(shape.axis.dot(d)) < shape.length / 2 + kReach)
        along.push_back(shape.axis.dot(d));
    }
    std::sort(along.begin(), along.end());
    double low = -shape.length / 2;
    double high = shape.length / 2;
    for (const double a : along)
      if (a > high && a - high < kStep) high = a;
    for (size_t i = along.size(); i-- > 0;)
      if (along[i] < low && low - along[i] < kStep) low = along[i];
    shape.centre += (low + high) / 2 * shape.axis;
    shape.length = high - low;
  }

  static std::string why_no_bar(const FixtureShape& shape, size_t points) {
    if (shape.length > kLongestBar) return fmt::format("{:.2f} m long", shape.length);
    if (shape.width > kThickestBar) return fmt::format("{:.3f} m thick", shape.width);
    if (static_cast<double>(shape.inliers.size()) < 0.7 * static_cast<double>(points))
      return "no line explains it";
    const double turned = std::atan2(std::abs(shape.axis.y()), std::abs(shape.axis.x()));
    if (turned > kMaxTurned && turned < kPi / 2 - kMaxTurned) return "it is neither level nor upright";
    return {};
  }
  static std::string why_no_knob(const FixtureShape& shape) {
    if (shape.length > kMaxKnob) return fmt::format("{:.3f} m by {:.3f} m", shape.length, shape.width);
    if (shape.length < kMinKnob) return "it is tiny";
    return {};
  }

  /// Beams that meet a bar and the front beside it give a second, weak bar near it; a bar in pieces is found
  /// several times.
  void drop_ghosts() {
    constexpr double kNear = 0.1;       // m
    constexpr double kSameBar = 0.008;  // m
    constexpr double kWeak = 0.35;      // of the bar's points
    const auto points = [](const FaceFixture& fixture) {
      return fixture.fixture.evidence.at("inliers").get<double>();
    };
    std::stable_sort(result_.fixtures.begin(), result_.fixtures.end(),
                     [&](const FaceFixture& a, const FaceFixture& b) { return points(a) > points(b); });
    std::vector<FaceFixture> kept;
    for (const FaceFixture& weak : result_.fixtures) {
      const auto strong = std::find_if(kept.begin(), kept.end(), [&](const FaceFixture& other) {
        if (meet(weak.box, other.box.grown(kSameBar))) return true;
        return points(weak) < kWeak * points(other) && other.box.grown(kNear).contains(weak.u, weak.v) &&
               std::abs(weak.fixture.axis.dot(other.fixture.axis)) > 0.9;
      });
      if (strong == kept.end())
        kept.push_back(weak);
      else if (meet(weak.box, strong->box.grown(kSameBar)) && weak.fixture.kind == Fixture::Kind::handle)
        unite(*strong, weak);
    }
    result_.fixtures = std::move(kept);
  }

  static bool meet(const FaceRect& a, const FaceRect& b) {
    return a.u0 < b.u1 && b.u0 < a.u1 && a.v0 < b.v1 && b.v0 < a.v1;
  }

  /// Makes a bar as long as it and a piece of it in the same line are together.
  void unite(FaceFixture& bar, const FaceFixture& piece) const {
    constexpr double kAside = 0.015;  // m
    const bool level = bar.box.width() > bar.box.height();
    if (level != (piece.box.width() > piece.box.height())) return;
    if (std::abs(level ? bar.v - piece.v : bar.u - piece.u) > kAside) return;
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

  /// Share of a band beside the fixture in which the face itself was met: the least of its thirds, for what
  /// ends the face (the edge of a counter) may have something else behind a part of it.
  double shown(const FixtureShape& shape, double side, bool along) const {
    const Vector2d axis = along ? shape.axis : Vector2d(-shape.axis.y(), shape.axis.x());
    const Vector2d across(-axis.y(), axis.x());
    const double length = along ? shape.length : shape.width;
    const double half_width = (along ? shape.width : shape.length) / 2;
    std::array<double, 3> face{};
    std::array<double, 3> cells{};
    for (double s = -length / 2; s <= length / 2 + 1e-9; s += kFaceCell)
      for (double t = half_width + 0.008; t < half_width + kSurroundings; t += kFaceCell) {
        const Vector2d at = shape.centre + s * axis + side * t * across;
        const int x = grid_.column(at.x());
        const int y = grid_.row(at.y());
        const auto third = static_cast<size_t>(std::clamp(3 * (s / length + 0.5), 0.0, 2.0));
        if (!grid_.inside(x, y)) continue;
        const float on = layers_.face.at<float>(y, x);
        const float off = layers_.fixture.at<float>(y, x) + layers_.farther.at<float>(y, x) +
                          layers_.behind.at<float>(y, x);
        if (on + off < kMin) continue;  // in the shadow
        cells[third] += 1;
        face[third] += on > off ? 1 : 0;
      }
    double least = 1;
    if (cells[0] + cells[1] + cells[2] < kMinBeside) return 0;
    for (size_t i = 0; i < 3; ++i)
      if (cells[i] > 0) least = std::min(least, face[i] / cells[i]);
    return least;
  }

  /// Points farther before the face over the fixture, per point of it: the edge of something that stands
  /// there gives both.
  double farther(const FixtureShape& shape, size_t points) const {
    double sum = 0;
    for (double s = -shape.length / 2; s <= shape.length / 2 + 1e-9; s += kFaceCell)
      for (double t = -0.012; t <= 0.012; t += kFaceCell) {
        const Vector2d at = shape.centre + s * shape.axis + t * Vector2d(-shape.axis.y(), shape.axis.x());
        const int x = grid_.column(at.x());
        const int y = grid_.row(at.y());
        if (grid_.inside(x, y)) sum += static_cast<double>(layers_.farther.at<float>(y, x));
      }
    return sum / static_cast<double>(points);
  }

  /// Whether more rays pass through the place of a fixture that stands `protrusion` before the face, to end
  /// at or behind the face, than end there: beams that met two things left points in mid-air.
  bool is_seen_through(const FixtureShape& shape, double protrusion) const {
    const Vector2d across(-shape.axis.y(), shape.axis.x());
    size_t through = 0;
    size_t on = 0;
    for (const FaceRay& ray : rays_.rays) {
      if (!ray.returned) continue;
      const double depth =
          static_cast<double>(ray.depth) - ground_.at(static_cast<double>(ray.u), static_cast<double>(ray.v));
      const bool before = depth > kAsDeep * protrusion;
      if (before && depth > kFixtureReach) continue;
      const double at = before ? depth : protrusion;
      const Vector2d d = Vector2d(static_cast<double>(ray.u) + static_cast<double>(ray.slope_u) * at,
                                  static_cast<double>(ray.v) + static_cast<double>(ray.slope_v) * at) -
                         shape.centre;
      if (std::abs(shape.axis.dot(d)) < kCore * shape.length && std::abs(across.dot(d)) < kCore * shape.width)
        ++(before ? on : through);
    }
    return through >= on;
  }

  std::string add(const std::vector<FixturePoint>& points, FixtureShape& shape, bool bar) {
    const double above = std::min(shown(shape, 1, true), shown(shape, -1, true));
    if (above < kMinShown) return fmt::format("the face shows beside {:.0f} % of it", 100 * above);
    const double ends = std::min(shown(shape, 1, false), shown(shape, -1, false));
    if (ends < (bar ? kMinShownAtEnds : kMinShown))
      return fmt::format("the face shows beyond its ends in {:.0f} %", 100 * ends);
    const double before = farther(shape, shape.inliers.size());
    if (before > 0.5) return "more stands farther before the face there";
    std::set<int> scans;
    std::vector<double> first_depths;
    for (const size_t i : shape.inliers) {
      scans.insert(points[i].scan);
      first_depths.push_back(points[i].depth);
    }
    if (shape.inliers.size() < kManyPoints && is_seen_through(shape, median(first_depths)))
      return "rays pass through it";
    FaceFixture found;
    Fixture& fixture = found.fixture;
    fixture.kind = bar ? Fixture::Kind::handle : Fixture::Kind::knob;
    fixture.radius =
        std::clamp(bar ? (shape.width - 0.004) / 2 : (shape.length + shape.width) / 4, 0.003, 0.03);
    fixture.length = bar ? shape.length : 2 * fixture.radius;
    const double ground = ground_.at(shape.centre.x(), shape.centre.y());
    std::vector<double> depths;
    const Vector2d across(-shape.axis.y(), shape.axis.x());
    const double reach_along = bar ? 0.4 * shape.length : 0.3 * shape.width;
    for (const FaceRay& ray : rays_.rays) {
      const double depth = static_cast<double>(ray.depth) - ground;
      if (!ray.returned || depth > kFixtureReach || depth < -kFaceRelief) continue;
      const Vector2d d = Vector2d(ray.point_u(), ray.point_v()) - shape.centre;
      if (std::abs(shape.axis.dot(d)) < reach_along && std::abs(across.dot(d)) < 0.35 * shape.width)
        depths.push_back(depth);
    }
    const double surface = mixture_depth(depths, median(first_depths), std::max(rays_.sigma, 0.003));
    if (surface < 0.9 * kMinProtrusion) return fmt::format("it stands out by {:.3f} m only", surface);
    // The sensor sees one half of a bar: its axis lies behind.
    Vector2d toward = Vector2d::Zero();
    double lean = 0;
    for (const size_t i : shape.inliers) {
      toward += points[i].toward / static_cast<double>(shape.inliers.size());
      lean += points[i].lean / static_cast<double>(shape.inliers.size());
    }
    if (bar) toward -= toward.dot(shape.axis) * shape.axis;
    const double behind = bar ? kHalfRound * fixture.radius : 0;
    const Vector2d centre = shape.centre - behind * toward;
    fixture.protrusion = surface - behind * lean;
    found.u = centre.x();
    found.v = centre.y();
    const Face& face = rays_.face;
    fixture.centre = face.at(found.u, found.v, ground + fixture.protrusion);
    if (!FaceRect{face.u_min, face.u_max, face.v_min, face.v_max}.contains(found.u, found.v))
      return "it is beside the face";
    fixture.axis =
        bar ? Vector3d(shape.axis.x() * face.right3() + shape.axis.y() * Vector3d::UnitZ()) : face.normal3();
    const double half_u =
        bar ? std::abs(shape.axis.x()) * shape.length / 2 + std::abs(shape.axis.y()) * fixture.radius
            : fixture.radius;
    const double half_v =
        bar ? std::abs(shape.axis.y()) * shape.length / 2 + std::abs(shape.axis.x()) * fixture.radius
            : fixture.radius;
    found.box = {found.u - half_u, found.u + half_u, found.v - half_v, found.v + half_v};
    const double many = static_cast<double>(shape.inliers.size());
    fixture.confidence = above * many / (many + 15) * (scans.size() > 1 || rays_.scans < 2 ? 1 : 0.6);
    fixture.evidence = {{"inliers", shape.inliers.size()},
                        {"scans", std::vector<int>(scans.begin(), scans.end())},
                        {"model", bar ? "line" : "circle"}};
    result_.fixtures.push_back(std::move(found));
    return {};
  }

  const FaceRays& rays_;
  FaceGrid grid_;
  FaceGround ground_;
  double threshold_;
  Layers layers_;
  FixtureSearch result_;
};

}  // namespace

FixtureSearch find_fixtures(const FaceRays& rays, const Random& random) {
  return FixtureFinder(rays).search(random);
}

}  // namespace loci::mapping
