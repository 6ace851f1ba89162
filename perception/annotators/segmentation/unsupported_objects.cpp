#include "perception/annotators/segmentation/unsupported_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/moments.h"
#include "mapping/base/text/text.h"
#include "perception/annotators/frame_outcome.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/segmentation/superpixels.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

using Eigen::Vector3f;
using Pixels = std::vector<int>;

/// Two regions of one part that its colours tell apart, or nothing when they do not.
class ColorDivision {
 public:
  ColorDivision(const cv::Mat& lab, const Pixels& part)
      : lab_(lab), part_(part), box_(box_of(part, lab.size())) {}

  std::optional<std::array<Pixels, 2>> regions() {
    if (!divide()) return std::nullopt;
    // Single pixels follow their surroundings: prints and noise make no region.
    constexpr int kAround = 11;
    cv::Mat side = cv::Mat::zeros(box_.size(), CV_8U), inside = side.clone(), mean, all;
    for (size_t i = 0; i < part_.size(); ++i) {
      side.at<uint8_t>(at(part_[i])) = second_[i] ? 255 : 0;
      inside.at<uint8_t>(at(part_[i])) = 255;
    }
    cv::boxFilter(side, mean, CV_32F, {kAround, kAround});
    cv::boxFilter(inside, all, CV_32F, {kAround, kAround});
    std::array<Pixels, 2> regions;
    size_t agreeing = 0;
    for (size_t i = 0; i < part_.size(); ++i) {
      const bool second = mean.at<float>(at(part_[i])) > 0.5F * all.at<float>(at(part_[i]));
      regions[second ? 1 : 0].push_back(part_[i]);
      agreeing += second == second_[i] ? 1 : 0;
    }
    constexpr double kMinAgreeing = 0.92, kMinShare = 0.15;
    const auto count = static_cast<double>(part_.size());
    const bool coherent = static_cast<double>(agreeing) > kMinAgreeing * count;
    const auto smaller = static_cast<double>(std::min(regions[0].size(), regions[1].size()));
    if (!coherent || smaller < kMinShare * count) return std::nullopt;
    return regions;
  }

 private:
  cv::Point at(int pixel) const { return cv::Point(pixel % lab_.cols, pixel / lab_.cols) - box_.tl(); }
  /// Lightness counts less: shadows change it.
  Vector3f color(int pixel) const {
    const cv::Vec3f& lab = lab_.ptr<cv::Vec3f>()[pixel];
    return {0.4F * lab[0], lab[1], lab[2]};
  }

  /// Two means of the colours; false unless they are further apart than the colours of one surface.
  bool divide() {
    constexpr double kMinApart = 15;     // of CIE Lab
    constexpr double kMinSpreads = 3.5;  // standard deviations of the colours around their mean
    constexpr int kRounds = 10;
    Vector3f sum = Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
    for (const int pixel : part_) {
      const Vector3f c = color(pixel);
      if (!c.allFinite()) return false;
      sum += c;
      squares += c * c.transpose();
    }
    const auto count = static_cast<float>(part_.size());
    const Vector3f mean = sum / count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(
        Eigen::Matrix3f(squares / count - mean * mean.transpose()));
    const Vector3f axis = solver.eigenvectors().col(2);
    const float spread = std::sqrt(std::max(0.0F, solver.eigenvalues()[2]));
    std::array<Vector3f, 2> means = {mean - spread * axis, mean + spread * axis};
    second_.assign(part_.size(), false);
    double squared = 0;
    for (int round = 0; round < kRounds; ++round) {
      std::array<Vector3f, 2> sums = {Vector3f::Zero(), Vector3f::Zero()};
      std::array<float, 2> counts = {0, 0};
      squared = 0;
      for (size_t i = 0; i < part_.size(); ++i) {
        const Vector3f c = color(part_[i]);
        const float first = (c - means[0]).squaredNorm(), other = (c - means[1]).squaredNorm();
        second_[i] = other < first;
        const size_t side = second_[i] ? 1 : 0;
        sums[side] += c;
        counts[side] += 1;
        squared += static_cast<double>(std::min(first, other));
      }
      if (counts[0] == 0 || counts[1] == 0) return false;
      for (const size_t side : {size_t{0}, size_t{1}}) means[side] = sums[side] / counts[side];
    }
    const auto apart = static_cast<double>((means[1] - means[0]).norm());
    return apart > kMinApart && apart > kMinSpreads * std::sqrt(squared / static_cast<double>(count) / 3);
  }

  const cv::Mat& lab_;
  const Pixels& part_;
  cv::Rect box_;
  std::vector<bool> second_;  ///< of each pixel of the part
};

/// What lies across the outline of a part, as shares of it without the side that looks down, where anything
/// may stand before it.
struct Outline {
  double before = 0;   ///< what is seen there falls off behind the part's surface
  double behind = 0;   ///< it rises before it
  double contact = 0;  ///< its surface goes on there
  double cut = 0;      ///< the image ends
};

class Candidates {
 public:
  Candidates(const cv::Mat& points, const cv::Mat& normals, const Vector3d& up)
      : points_(points), normals_(normals), label_(points.size(), CV_32S) {
    const Vector2d down(-up.x(), -up.y());
    down_ = down.norm() > 0.1 ? down.normalized() : Vector2d(0, 1);
  }

  Outline outline(const Pixels& part) {
    label_ = 0;
    for (const int pixel : part) label_.ptr<int>()[pixel] = 1;
    Outline found;
    double all = 0;
    for (const int pixel : part)
      for (const cv::Point& step : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)})
        if (step.x * down_.x() + step.y * down_.y() < 0.7) all += look(pixel, step, found);
    for (double* share : {&found.before, &found.behind, &found.contact, &found.cut})
      *share /= std::max(1.0, all);
    return found;
  }

 private:
  /// Looks from a pixel over the outline; 0 where that is inside, or a hole of the part.
  double look(int pixel, const cv::Point& step, Outline& found) const {
    constexpr int kFar = 10;         // Edges are ragged, and beside them nothing is measured.
    constexpr int kImageBorder = 4;  // Depth cameras leave the outermost columns empty.
    constexpr int kAside = 4;
    constexpr double kLevel = 0.003;  // m
    const cv::Point from(pixel % points_.cols, pixel / points_.cols);
    const cv::Rect image(kImageBorder, kImageBorder, points_.cols - 2 * kImageBorder,
                         points_.rows - 2 * kImageBorder);
    const cv::Rect whole({}, points_.size());
    for (int far = 1; far <= kFar; ++far) {
      const cv::Point to = from + far * step;
      if (!image.contains(to)) {
        found.cut += 1;
        return 1;
      }
      if (label_.at<int>(to) == 1) return 0;
      const cv::Vec3f& other = points_.at<cv::Vec3f>(to);
      if (std::isnan(other[2])) continue;
      // Smoothing rounds edges: the surface a little inside of them says where it would go on.
      cv::Point inner = from;
      for (int aside = 0; aside < kAside && whole.contains(inner - step) && label_.at<int>(inner - step) == 1;
           ++aside)
        inner -= step;
      const cv::Vec3f& own = points_.at<cv::Vec3f>(inner);
      const float height = normals_.at<cv::Vec3f>(inner).dot(other - own);
      const auto level = static_cast<float>(kLevel + 2 * depth_noise(static_cast<double>(own[2])));
      (height < -level ? found.before : height > level ? found.behind : found.contact) += 1;
      return 1;
    }
    return 1;
  }

  const cv::Mat& points_;
  const cv::Mat& normals_;
  cv::Mat label_;
  Vector2d down_;
};

/// Area (m²) and largest extent (m) of pixels.
std::pair<double, double> size_of(const Pixels& part, const cv::Mat& points, double focal_squared) {
  double area = 0;
  Moments<3> moments;
  for (const int pixel : part) {
    const Vector3d p = to_vector(points.ptr<cv::Vec3f>()[pixel]);
    area += p.z() * p.z() / focal_squared;
    moments.add(p);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance());
  const Vector3d axis = solver.eigenvectors().col(2);
  std::vector<float> along;
  for (const int pixel : part)
    along.push_back(static_cast<float>(axis.dot(to_vector(points.ptr<cv::Vec3f>()[pixel]))));
  const auto [low, high] = quantiles(along, 0.02, 0.98);
  return {area, static_cast<double>(high - low)};
}

}  // namespace

void UnsupportedOptions::declare(OptionTable& table) {
  table.number("nearest_m", nearest_m, "m", "What is nearer is the robot's own arm.", 0, 2);
  table.number(
      "farthest_m", farthest_m, "m",
      "Farther away objects are not looked for without a support; half of what is measured has to be "
      "nearer.",
      0.1, 5);
  table.number("tolerance_m", tolerance_m, "m", "Maximum gap inside one object.", 0.001, 1);
  table.number("min_area_m2", min_area_m2, "m2", "Minimum area of an object, as it is seen.", 0, 1);
  table.number("max_extent_m", max_extent_m, "m", "Maximum extent of an object; larger parts are walls.",
               0.05, 10);
  parts.declare(table);
}

std::vector<std::vector<int>> find_unsupported_objects(const cv::Mat& points, const cv::Mat& normals,
                                                       const cv::Mat& lab,
                                                       const mapping::PinholeCamera& camera,
                                                       const Vector3d& up, const UnsupportedOptions& options,
                                                       int threads) {
  Pixels pixels;
  std::vector<Vector3f> near_points, near_normals;
  for (int i = 0; i < static_cast<int>(points.total()); ++i) {
    const cv::Vec3f &p = points.ptr<cv::Vec3f>()[i], &n = normals.ptr<cv::Vec3f>()[i];
    const auto z = static_cast<double>(p[2]);
    if (!(z > options.nearest_m && z < options.farthest_m) || std::isnan(n[2])) continue;
    pixels.push_back(i);
    near_points.push_back(to_vector3f(p));
    near_normals.push_back(to_vector3f(n));
  }
  int groups = 0;
  const std::vector<int> group_of =
      euclidean_groups(near_points, static_cast<float>(options.tolerance_m), groups);
  const ConvexParts parts =
      split_groups(near_points, near_normals, {}, members_of(group_of, groups), options.parts, threads);
  std::vector<Pixels> candidates;
  for (const std::vector<size_t>& members : members_of(parts.part_of_point, parts.count)) {
    Pixels part;
    for (const size_t i : members) part.push_back(pixels[i]);
    candidates.push_back(std::move(part));
  }
  std::vector<Pixels> objects;
  Candidates judge(points, normals, up);
  while (!candidates.empty()) {
    Pixels part = std::move(candidates.back());
    candidates.pop_back();
    const auto [area, extent] = size_of(part, points, camera.fx * camera.fy);
    if (area < options.min_area_m2) continue;
    if (!lab.empty())
      if (auto regions = ColorDivision(lab, part).regions()) {
        for (Pixels& region : *regions) candidates.push_back(std::move(region));
        continue;
      }
    if (extent > options.max_extent_m) continue;
    constexpr double kMaxCut = 0.15, kMaxContact = 0.8, kMinBefore = 0.07, kMinRatio = 1.4;
    const Outline outline = judge.outline(part);
    if (outline.cut > kMaxCut || outline.contact > kMaxContact) continue;
    if (outline.before < kMinBefore || outline.before < kMinRatio * outline.behind) continue;
    objects.push_back(std::move(part));
  }
  std::ranges::sort(objects, {}, [](const Pixels& part) { return part.front(); });
  return objects;
}

AnnotatorDescriptor UnsupportedObjectExtractor::descriptor() const {
  return {kName,
          "Finds objects in bins and on shelves, close by, where no surface shows what they stand on.",
          {"Scene", "CameraInfo", "view:cloud", "view:normals"},
          {"Cluster", "ReferenceClusterPoints", "StandaloneImageROI"},
          {"view:color", "view:map_depth", "PlanarSupport"},
          {}};
}

void UnsupportedObjectExtractor::process(cas::Cas& cas, Context& context) {
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.scene();
  if (!scene.map_from_camera.is_set() || !facade.supports().empty() || facade.has(kMapDepthView)) return;
  const cv::Mat points = cloud_points(facade), normals = cloud_normals(facade);
  cv::Mat depth;
  cv::extractChannel(points, depth, 2);
  const cv::Mat close = (depth > options_.nearest_m) & (depth < options_.farthest_m);
  const int measured = cv::countNonZero(depth > options_.nearest_m);
  if (measured == 0 || cv::countNonZero(close) < measured / 2) return;
  const Isometry3d pose = map_from_camera(scene);
  std::optional<Vector3d> up;
  if (has_measured_pose(scene)) up = pose.linear().transpose() * Vector3d::UnitZ();
  if (no_support_because(depth, points, normals, types::cameras(facade).depth, up) != Reason::no_plane)
    return;
  const mapping::RgbdCamera cameras = types::cameras(facade);
  cv::Mat color, lab;
  if (facade.has(types::SceneCas::kColor)) {
    color = types::view_image(facade, types::SceneCas::kColor);
    lab = lab_of_points(points, color, cameras);
  }
  const std::vector<Pixels> objects = find_unsupported_objects(
      points, normals, lab, cameras.depth, up.value_or(-Vector3d::UnitY()), options_, context.threads);
  for (const Pixels& pixels : objects) {
    const auto cluster = types::Cluster::create(cas);
    set_points(cluster, kName, pixels, facade, pose);
    cluster.at_image_border.set(is_at_image_border(box_of(pixels, points.size()), points.size()));
    if (!color.empty())
      add_image(cluster, kName, color_region(points, pixels, cameras, color.size()), facade);
    facade.add_cluster(cluster);
  }
  facade.log(kName, "info", fmt::format("{} without a support", counted(objects.size(), "object")));
}

}  // namespace loci::perception
