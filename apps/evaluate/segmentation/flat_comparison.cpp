#include "apps/evaluate/segmentation/flat_comparison.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/evaluate/segmentation/scores.h"
#include "apps/evaluate/segmentation/strips.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "mapping/render/render.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/kinect.h"
#include "mapping/simulation/scenario.h"

namespace loci::apps::segmentation_evaluation {
namespace {

/// One image of a flat scene.
struct FlatImage {
  cv::Mat depth;        ///< CV_32F, as the sensor measures it
  cv::Mat color;        ///< CV_8UC3, twice as large
  LabelledImage truth;  ///< of the colour image: which piece
};

/// A workspace of two tables side by side, uneven by some millimetres, before a Kinect that stands still and
/// has a colour image of twice the depth image's size (§4.3). Pieces of a toy train's track, 10 mm high,
/// lie on it.
class FlatWorkspace {
 public:
  /// The camera looks at the tables' middle from `distance` metres; everything else is drawn from `random`.
  FlatWorkspace(double distance, Random random);

  const mapping::RgbdCamera& camera() const { return camera_; }
  /// The ideal plane of the tables in the depth camera's frame: normal · p = offset.
  Vector3d normal() const;
  double offset() const;
  /// CV_8U: depth pixels in which the tables are seen.
  cv::Mat inside() const;

  /// Depth of the empty tables, with noise of its own.
  cv::Mat empty_depth(uint64_t number) const;
  /// Some pieces anew, under light of another strength and tint, with a bright strip somewhere, as an
  /// automatic exposure shows it.
  FlatImage image(uint64_t number) const;

 private:
  cv::Mat measured(const mapping::RenderedView& view, const Random& random) const;

  struct Colors {
    mapping::Rgba left_table, right_table;
    std::array<mapping::Rgba, 3> pieces;
  };
  double surface(double x, double y) const;
  mapping::TriangleMesh tables() const;
  mapping::TriangleMesh piece(Random& draw, const Vector2d& at) const;

  Random random_;
  mapping::RgbdCamera camera_;
  Isometry3d map_from_camera_ = Isometry3d::Identity();
  Colors colors_;
  std::array<double, 8> waves_;
  double seam_ = 0;
  double step_ = 0;
  mapping::RenderScene empty_;
  mapping::RenderedView empty_view_;
};

constexpr double kHalfLength = 0.5;  ///< of the tables, metres
constexpr double kHalfWidth = 0.35;
constexpr double kThickness = 0.010;

/// Painted, laminated and wooden tops; the last are hardly another colour than the pieces.
const std::array<std::pair<mapping::Rgba, mapping::Rgba>, 4> kTables = {
    {{{0.55f, 0.57f, 0.58f, 1}, {0.60f, 0.60f, 0.62f, 1}},
     {{0.25f, 0.38f, 0.30f, 1}, {0.28f, 0.36f, 0.32f, 1}},
     {{0.42f, 0.26f, 0.16f, 1}, {0.38f, 0.25f, 0.17f, 1}},
     {{0.78f, 0.66f, 0.50f, 1}, {0.74f, 0.64f, 0.50f, 1}}}};
const std::array<mapping::Rgba, 3> kPieces = {
    {{0.80f, 0.62f, 0.38f, 1}, {0.76f, 0.55f, 0.33f, 1}, {0.72f, 0.20f, 0.15f, 1}}};

void add_triangle(mapping::TriangleMesh& mesh, uint32_t a, uint32_t b, uint32_t c,
                  const mapping::Rgba& color) {
  mesh.triangles.push_back({a, b, c});
  mesh.colors.push_back(color);
}

/// The same colour, a little lighter or darker.
mapping::Rgba varied(const mapping::Rgba& color, Random& draw, double most) {
  const auto gain = static_cast<float>(1 + draw.uniform(-most, most));
  return {color[0] * gain, color[1] * gain, color[2] * gain, 1};
}

/// What the light makes of the materials' colours.
cv::Mat lit(const cv::Mat& colors, Random& draw) {
  const double tint[3] = {draw.uniform(0.9, 1.1), 1.0, draw.uniform(0.9, 1.1)};
  const double direction = draw.uniform(0, kPi);
  const double along = draw.uniform(0.3, 0.7);
  const double half = draw.uniform(0.05, 0.15);
  const double strength = draw.uniform(0.3, 0.9);
  cv::Mat light(colors.size(), CV_32F);
  for (int v = 0; v < light.rows; ++v)
    for (int u = 0; u < light.cols; ++u) {
      const double x = static_cast<double>(u) / light.cols;
      const double y = static_cast<double>(v) / light.rows;
      const double across =
          std::abs((x - along) * std::cos(direction) + (y - along) * std::sin(direction)) - half;
      const double in_strip = std::clamp(0.5 - across / 0.03, 0.0, 1.0);
      const double corner = (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5);
      light.at<float>(v, u) = static_cast<float>((1 - 0.3 * corner) * (1 + strength * in_strip));
    }
  cv::Mat image;
  colors.convertTo(image, CV_32FC3);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3f>(v, u)[c] *= light.at<float>(v, u) * static_cast<float>(tint[c]);
  // The camera aims at a mean brightness and clips what is brighter than it can show.
  cv::Mat nothing;
  cv::inRange(colors, cv::Scalar::all(0), cv::Scalar::all(0), nothing);
  const cv::Scalar mean = cv::mean(image, ~nothing);
  image *= draw.uniform(100, 150) / std::max(1.0, (mean[0] + mean[1] + mean[2]) / 3);
  image.convertTo(image, CV_8UC3);
  cv::GaussianBlur(image, image, {3, 3}, 0);
  return image;
}

FlatWorkspace::FlatWorkspace(double distance, Random random) : random_(random) {
  camera_ = mapping::kinect_camera();
  camera_.color = {1280, 960, 1056, 1056, 640.5, 480.5};
  Random draw = random_.fork(0);
  const double elevation = draw.uniform(45, 60) * kPi / 180;
  const double side = draw.uniform(-0.3, 0.3);
  const Vector3d from(side * distance, -std::cos(elevation) * distance, std::sin(elevation) * distance);
  map_from_camera_ = mapping::looking_at(from.normalized() * distance, Vector3d::Zero());
  const auto& tables = kTables[draw.index(kTables.size())];
  colors_ = {tables.first, tables.second, {kPieces[0], kPieces[1], kPieces[2]}};
  for (double& wave : waves_) wave = draw.uniform();
  seam_ = draw.uniform(-0.2, 0.2);
  step_ = draw.uniform(-0.002, 0.002);
  empty_.add("tables", this->tables(), Isometry3d::Identity());
  mapping::RenderOptions options;
  options.normals = true;
  empty_view_ = empty_.render(camera_.depth, map_from_camera_, options);
}

Vector3d FlatWorkspace::normal() const {
  return map_from_camera_.linear().transpose() * Vector3d::UnitZ();
}

double FlatWorkspace::offset() const {
  return -map_from_camera_.translation().z();
}

cv::Mat FlatWorkspace::inside() const {
  return empty_view_.depth == empty_view_.depth;
}

double FlatWorkspace::surface(double x, double y) const {
  const auto wave = [&](size_t i, double amplitude, double least, double most) {
    const double length = least + (most - least) * waves_[i];
    const double direction = 2 * kPi * waves_[i + 1];
    return amplitude * std::sin(2 * kPi * (x * std::cos(direction) + y * std::sin(direction)) / length +
                                6 * waves_[i + 2]);
  };
  const double other_table = x < seam_ ? 0 : step_ + 0.004 * (waves_[6] - 0.5) * (x - seam_) / kHalfLength;
  return wave(0, 0.002, 0.5, 1.0) + wave(3, 0.0015, 0.3, 0.6) + other_table;
}

mapping::TriangleMesh FlatWorkspace::tables() const {
  constexpr double kCell = 0.01;
  const int columns = static_cast<int>(2 * kHalfLength / kCell);
  const int rows = static_cast<int>(2 * kHalfWidth / kCell);
  mapping::TriangleMesh mesh;
  Random draw = random_.fork(1);
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column) {
      const double x = -kHalfLength + column * kCell;
      const double y = -kHalfWidth + row * kCell;
      mesh.vertices.emplace_back(Vector3d(x, y, surface(x, y)).cast<float>());
    }
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto a = static_cast<uint32_t>(row * (columns + 1) + column);
      const auto above = a + static_cast<uint32_t>(columns) + 1;
      const mapping::Rgba& base =
          -kHalfLength + column * kCell < seam_ ? colors_.left_table : colors_.right_table;
      const mapping::Rgba color = varied(base, draw, 0.04);
      add_triangle(mesh, a, a + 1, above + 1, color);
      add_triangle(mesh, a, above + 1, above, color);
    }
  return mesh;
}

mapping::TriangleMesh FlatWorkspace::piece(Random& draw, const Vector2d& at) const {
  // A strip along an arc; a straight piece is one of a very large circle.
  constexpr double kHalfPiece = 0.02;
  const double length = draw.uniform(0.08, 0.16);
  const double radius = draw.uniform() < 0.5 ? 0.18 : 100;
  const double turn = draw.uniform(0, 2 * kPi);
  const mapping::Rgba color = colors_.pieces[draw.index(3)];
  const Vector2d slope((surface(at.x() + 0.02, at.y()) - surface(at.x() - 0.02, at.y())) / 0.04,
                       (surface(at.x(), at.y() + 0.02) - surface(at.x(), at.y() - 0.02)) / 0.04);
  constexpr int kSteps = 12;
  mapping::TriangleMesh mesh;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = (static_cast<double>(i) / kSteps - 0.5) * length / radius;
    for (const double side : {-kHalfPiece, kHalfPiece}) {
      const Vector2d local((radius + side) * std::sin(angle), (radius + side) * std::cos(angle) - radius);
      const Vector2d p = at + Eigen::Rotation2Dd(turn) * local;
      const double ground = surface(at.x(), at.y()) + slope.dot(p - at);
      for (const double height : {0.0, kThickness})
        mesh.vertices.emplace_back(Vector3d(p.x(), p.y(), ground + height).cast<float>());
    }
  }
  // Per step: inner foot, inner top, outer foot, outer top.
  for (uint32_t i = 0; i < kSteps; ++i) {
    const uint32_t a = 4 * i;
    const uint32_t b = a + 4;
    const auto quad = [&](uint32_t p, uint32_t q, uint32_t r, uint32_t s) {
      add_triangle(mesh, p, q, r, color);
      add_triangle(mesh, p, r, s, color);
    };
    quad(a + 1, b + 1, b + 3, a + 3);
    quad(a, b, b + 1, a + 1);
    quad(a + 3, b + 3, b + 2, a + 2);
  }
  for (const uint32_t end : {0u, 4u * kSteps}) {
    add_triangle(mesh, end, end + 1, end + 3, color);
    add_triangle(mesh, end, end + 3, end + 2, color);
  }
  return mesh;
}

cv::Mat FlatWorkspace::measured(const mapping::RenderedView& view, const Random& random) const {
  return measured_by_kinect(view.depth, view.normal, camera_.depth, mapping::KinectModel(), random);
}

cv::Mat FlatWorkspace::empty_depth(uint64_t number) const {
  return measured(empty_view_, random_.fork(2).fork(number));
}

FlatImage FlatWorkspace::image(uint64_t number) const {
  Random draw = random_.fork(3).fork(number);
  mapping::RenderScene scene;
  scene.add("tables", tables(), Isometry3d::Identity());
  std::vector<Vector2d> places;
  for (int attempt = 0; attempt < 60 && places.size() < 7; ++attempt) {
    const Vector2d at(draw.uniform(-0.36, 0.36), draw.uniform(-0.24, 0.24));
    const bool free = std::all_of(places.begin(), places.end(),
                                  [&](const Vector2d& other) { return (at - other).norm() > 0.18; });
    if (!free) continue;
    places.push_back(at);
    scene.add("piece_" + std::to_string(places.size()), piece(draw, at), Isometry3d::Identity());
  }
  mapping::RenderOptions options;
  options.normals = true;
  FlatImage image;
  image.depth = measured(scene.render(camera_.depth, map_from_camera_, options), draw.fork(0));
  options.colors = true;
  const mapping::RenderedView view =
      scene.render(camera_.color, map_from_camera_ * camera_.depth_from_color, options);
  image.color = lit(view.color, draw);
  add_color_noise(image.color, mapping::KinectModel(), draw.fork(1));
  // Links: the tables are 0, the pieces follow.
  image.truth.object = cv::Mat(view.link.size(), CV_16U);
  for (int v = 0; v < view.link.rows; ++v)
    for (int u = 0; u < view.link.cols; ++u)
      image.truth.object.at<uint16_t>(v, u) = static_cast<uint16_t>(std::max(0, view.link.at<int>(v, u)));
  image.truth.judged = view.link >= 0;
  return image;
}

/// What two stages find, as segments of the colour image.
cv::Mat two_stages(const FlatImage& image, const mapping::RgbdCamera& camera,
                   const perception::FlatSurface& surface, const perception::FlatOptions& options) {
  cv::Mat segments = cv::Mat::zeros(image.color.size(), CV_16U);
  int number = 0;
  for (const perception::FlatObject& object :
       find_flat_objects(image.depth, image.color, camera, surface, options))
    segments(object.box).setTo(++number, object.mask);
  return segments;
}

/// Connected pixels that are higher than the middle between table and object.
cv::Mat threshold(const FlatImage& image, const mapping::RgbdCamera& camera,
                  const perception::FlatSurface& surface, const perception::FlatOptions& options) {
  const cv::Mat heights = measure_heights(image.depth, camera.depth, surface, options).uneven;
  const cv::Mat in_color = seen_by_color(heights, camera, surface, std::numeric_limits<double>::quiet_NaN());
  const double middle = (options.table_m + options.object_m) / 2;
  cv::Mat mask = in_color > middle;
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(5, 5, CV_8U));
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8);
  cv::Mat segments = cv::Mat::zeros(mask.size(), CV_16U);
  constexpr int kMinPixels = 200;
  for (int label = 1, number = 0; label < count; ++label)
    if (stats.at<int>(label, cv::CC_STAT_AREA) >= kMinPixels) segments.setTo(++number, labels == label);
  return segments;
}

}  // namespace

void FlatComparisonOptions::declare(OptionTable& table) {
  table.integer("flat_workspaces", workspaces, "", "Simulated workspaces, from near to far.", 1, 1000);
  table.integer("flat_images", images, "", "Images of each, under changing light.", 1, 1000);
  table.integer("flat_empty", empty_images, "", "Images of the empty tables for the calibration.", 1, 10000);
  table.number("flat_nearest_m", nearest_m, "m", "Distance of the nearest camera.", 0.5, 4);
  table.number("flat_farthest_m", farthest_m, "m", "Distance of the farthest camera.", 0.5, 4);
  table.integer("flat_seed", seed, "", "Seed of the simulated workspaces.", 0, 1 << 30);
}

FlatComparison compare_flat(const FlatComparisonOptions& options, const perception::FlatOptions& flat,
                            const std::filesystem::path& images, Progress& progress) {
  FlatComparison comparison;
  comparison.workspaces = options.workspaces;
  comparison.methods = {{"two stages, calibrated", {}, {}},
                        {"height > 5 mm, calibrated", {}, {}},
                        {"two stages, not calibrated", {}, {}},
                        {"height > 5 mm, not calibrated", {}, {}},
                        {"height > 5 mm over the plane", {}, {}}};
  perception::FlatOptions over_plane = flat;
  over_plane.background_m = 0;
  const Random random(static_cast<uint64_t>(options.seed));
  if (!images.empty()) make_folder(images);
  for (int w = 0; w < options.workspaces; ++w) {
    const double part = options.workspaces == 1 ? 0.5 : static_cast<double>(w) / (options.workspaces - 1);
    const double distance = options.nearest_m + part * (options.farthest_m - options.nearest_m);
    const FlatWorkspace workspace(distance, random.fork(static_cast<uint64_t>(w)));
    perception::SurfaceCalibration calibration;
    for (int i = 0; i < options.empty_images; ++i) {
      progress.check((w + 0.5 * i / options.empty_images) / options.workspaces, "empty tables");
      calibration.add(workspace.empty_depth(static_cast<uint64_t>(i)));
    }
    const perception::FlatSurface plain{workspace.normal(), workspace.offset(), workspace.inside(), {}};
    perception::FlatSurface calibrated = plain;
    calibrated.empty_depth = calibration.mean();
    for (FlatMethod& method : comparison.methods) method.by_distance.emplace_back(distance, Scores());
    for (int i = 0; i < options.images; ++i) {
      progress.check((w + 0.5 + 0.5 * i / options.images) / options.workspaces, "images");
      const FlatImage image = workspace.image(static_cast<uint64_t>(i));
      const mapping::RgbdCamera& camera = workspace.camera();
      const std::vector<cv::Mat> found = {
          two_stages(image, camera, calibrated, flat), threshold(image, camera, calibrated, flat),
          two_stages(image, camera, plain, flat), threshold(image, camera, plain, flat),
          threshold(image, camera, plain, over_plane)};
      for (size_t m = 0; m < found.size(); ++m) {
        comparison.methods[m].all.add(image.truth, found[m]);
        comparison.methods[m].by_distance.back().second.add(image.truth, found[m]);
      }
      ++comparison.images;
      if (i + 1 == options.images && !images.empty())
        mapping::write_image(images / fmt::format("flat_{}.png", w + 1),
                             strip(image.color, image.truth.object, found, 0.25));
    }
  }
  return comparison;
}

std::string FlatComparison::text() const {
  std::string text = fmt::format(
      "{} workspaces, {} images, {} pieces of 10 mm\n  {:<30}{:>9}{:>9}{:>9}{:>9}   IoU by distance\n",
      workspaces, images, methods.front().all.objects(), "", "IoU", "F1", "prec.", "recall");
  for (const FlatMethod& method : methods) {
    text += fmt::format("  {:<30}{:>9.3f}{:>7.1f} %{:>7.1f} %{:>7.1f} %  ", method.name,
                        method.all.mean_overlap(), 100 * method.all.f1(), 100 * method.all.precision(),
                        100 * method.all.recall());
    for (const auto& [distance, scores] : method.by_distance)
      text += fmt::format(" {:.1f} m {:.2f}", distance, scores.mean_overlap());
    text += "\n";
  }
  return text;
}

Json FlatComparison::to_json() const {
  Json json = {{"workspaces", workspaces}, {"images", images}, {"methods", Json::array()}};
  for (const FlatMethod& method : methods) {
    Json each = method.all.to_json();
    each["method"] = method.name;
    each["distances"] = Json::array();
    for (const auto& [distance, scores] : method.by_distance) {
      Json at = scores.to_json();
      at["distance_m"] = distance;
      each["distances"].push_back(std::move(at));
    }
    json["methods"].push_back(std::move(each));
  }
  return json;
}

}  // namespace loci::apps::segmentation_evaluation
