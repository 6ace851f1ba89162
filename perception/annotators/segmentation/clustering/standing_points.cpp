#include "perception/annotators/segmentation/clustering/standing_points.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"
#include "perception/conversions/opencv.h"
#include "perception/recognition/image_features.h"

namespace loci::perception {
namespace {

using Eigen::Vector3f;

constexpr int kNoSupport = -1;  ///< below a point
constexpr int kOnSupport = -2;  ///< it is the support itself

/// The highest support below a point, or one of the two above, and the point in its frame.
int support_below(const Vector3f& p, int label, const std::vector<SupportGround>& grounds,
                  const ClusterOptions& options, Vector3d& position) {
  // Beyond the outline by this much objects are still looked at, to tell what merely reaches over the
  // support.
  constexpr double kAround = 0.15;
  int best = kNoSupport;
  for (size_t s = 0; s < grounds.size(); ++s) {
    const SupportPlane& support = grounds[s].plane;
    if (support.region != label) continue;
    const Vector3d at = support.in_plane(p.cast<double>());
    if (at.z() > options.max_height_m || at.z() < -0.03) continue;
    const double floor = options.floor_m + (grounds[s].color ? 0 : support.uncertainty) +
                         1.5 * height_noise(support, p.cast<double>());
    if (at.z() < -floor || (best >= 0 && at.z() > floor && at.z() >= position.z())) continue;
    const double inside = grounds[s].outline.inside(at.head<2>());
    if (inside < -kAround) continue;
    if (std::abs(at.z()) <= floor) return kOnSupport;
    if (at.z() <= floor) continue;
    best = static_cast<int>(s);
    position = at;
  }
  return best;
}

}  // namespace

std::vector<Standing> stand_on_supports(const ClusterImages& images, const mapping::PinholeCamera& camera,
                                        const std::vector<SupportGround>& grounds,
                                        const ClusterOptions& options, int threads, cv::Mat& shows) {
  const cv::Mat& points = images.points;
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* normal = images.normals.ptr<cv::Vec3f>();
  const auto* label_of = images.region.empty() ? nullptr : images.region.ptr<uint16_t>();
  const auto focal_squared = static_cast<float>(camera.fx * camera.fy);
  shows = cv::Mat::zeros(points.size(), CV_8U);
  constexpr int kRows = 16;
  const auto blocks = static_cast<size_t>((points.rows + kRows - 1) / kRows);
  std::vector<std::vector<Standing>> of_block(blocks, std::vector<Standing>(grounds.size()));
  parallel_each(blocks, threads, [&](size_t block) {
    const int end = std::min(points.rows, static_cast<int>(block + 1) * kRows) * points.cols;
    for (int i = static_cast<int>(block) * kRows * points.cols; i < end; ++i) {
      if (std::isnan(point[i][2])) continue;
      const Vector3f p = to_vector3f(point[i]);
      Vector3d position;
      const int best = label_of && label_of[i] == 0
                           ? kNoSupport
                           : support_below(p, label_of ? label_of[i] : 0, grounds, options, position);
      shows.ptr<uint8_t>()[i] = static_cast<uint8_t>(best >= 0            ? Shows::candidate
                                                     : best == kOnSupport ? Shows::support
                                                                          : Shows::surroundings);
      if (best < 0) continue;
      const auto s = static_cast<size_t>(best);
      Standing& target = of_block[block][s];
      target.pixels.push_back(i);
      target.points.push_back(p);
      target.normals.push_back(to_vector3f(normal[i]));
      target.in_plane.push_back(position.cast<float>());
      target.normals_in_plane.push_back(grounds[s].plane_from_camera * target.normals.back());
      target.areas.push_back(p.z() * p.z() / focal_squared);
    }
  });
  std::vector<Standing> standing(grounds.size());
  for (size_t s = 0; s < standing.size(); ++s) {
    size_t count = 0;
    for (const auto& part : of_block) count += part[s].pixels.size();
    standing[s].reserve(count);
    for (const auto& part : of_block)
      for (size_t i = 0; i < part[s].pixels.size(); ++i) standing[s].add(part[s], i);
  }
  return standing;
}

Standing subset(const Standing& all, const std::vector<size_t>& members) {
  Standing part;
  part.reserve(members.size());
  for (const size_t i : members) part.add(all, i);
  return part;
}

void drop_specks(Standing& standing, const SupportPlane& support, const ClusterOptions& options,
                 cv::Mat& shows) {
  constexpr double kSigmas = 4, kMinShare = 0.3;
  constexpr int kReach = 2;  // pixels of the box filter, on either side
  if (standing.pixels.empty()) return;
  const cv::Rect box = box_of(standing.pixels, shows.size());
  const cv::Rect around =
      cv::Rect(box.tl() - cv::Point(kReach, kReach), box.br() + cv::Point(kReach, kReach)) &
      cv::Rect({}, shows.size());
  cv::Mat share;
  cv::boxFilter(shows(around) == static_cast<uint8_t>(Shows::candidate), share, CV_32F,
                {2 * kReach + 1, 2 * kReach + 1});
  std::vector<size_t> kept;
  for (size_t i = 0; i < standing.pixels.size(); ++i) {
    const double reach = options.floor_m + support.uncertainty +
                         kSigmas * height_noise(support, standing.points[i].cast<double>());
    const int pixel = standing.pixels[i];
    if (static_cast<double>(standing.in_plane[i].z()) > reach ||
        static_cast<double>(share.at<float>(pixel / shows.cols - around.y, pixel % shows.cols - around.x)) >
            kMinShare * 255)
      kept.push_back(i);
    else
      shows.ptr<uint8_t>()[pixel] = static_cast<uint8_t>(Shows::support);
  }
  if (kept.size() < standing.pixels.size()) standing = subset(standing, kept);
}

std::vector<cv::Vec3b> lab_colors(const std::vector<Vector3f>& points, const ClusterImages& images) {
  if (images.color.empty() || points.empty()) return {};
  const Eigen::Isometry3f color_from_depth = images.color_from_depth.cast<float>();
  cv::Mat colors(1, static_cast<int>(points.size()), CV_8UC3, cv::Scalar::all(0));
  const auto fx = static_cast<float>(images.color_camera.fx), fy = static_cast<float>(images.color_camera.fy);
  const auto cx = static_cast<float>(images.color_camera.cx), cy = static_cast<float>(images.color_camera.cy);
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector3f p = color_from_depth * points[i];
    const float u = fx * p.x() / p.z() + cx + 0.5f, v = fy * p.y() / p.z() + cy + 0.5f;
    if (!(p.z() > 0 && u >= 0 && v >= 0) || u >= static_cast<float>(images.color.cols) ||
        v >= static_cast<float>(images.color.rows))
      continue;
    colors.ptr<cv::Vec3b>()[i] = images.color.ptr<cv::Vec3b>(static_cast<int>(v))[static_cast<int>(u)];
  }
  constexpr int kBlock = 1 << 15;  // OpenCV starts threads for more, which costs more than the conversion
  for (int begin = 0; begin < colors.cols; begin += kBlock) {
    cv::Mat block = colors.colRange(begin, std::min(colors.cols, begin + kBlock));
    lab_of(block).copyTo(block);
  }
  return {colors.begin<cv::Vec3b>(), colors.end<cv::Vec3b>()};
}

std::optional<Vector3f> color_of_support(const SupportGround& ground, const ClusterImages& images,
                                         const mapping::PinholeCamera& camera) {
  constexpr double kMinStep = 0.02, kMaxSteps = 500, kReach = 0.03;
  constexpr size_t kMinSamples = 100;
  if (images.color.empty()) return std::nullopt;
  Eigen::AlignedBox2d extent;
  for (const Vector2d& corner : ground.plane.outline) extent.extend(corner);
  const double step = std::max(kMinStep, extent.sizes().maxCoeff() / kMaxSteps);
  std::vector<Vector3f> seen;
  for (double x = extent.min().x(); x < extent.max().x(); x += step)
    for (double y = extent.min().y(); y < extent.max().y(); y += step) {
      const Vector3d p = ground.plane.camera_from_plane * Vector3d(x, y, 0);
      if (ground.outline.inside({x, y}) < kMinStep || p.z() < 0.1) continue;
      const Vector2d pixel = camera.project(p);
      if (!camera.contains(pixel)) continue;
      const float z = images.points.at<cv::Vec3f>(static_cast<int>(std::lround(pixel.y())),
                                                  static_cast<int>(std::lround(pixel.x())))[2];
      if (!(std::abs(static_cast<double>(z) - p.z()) > kReach)) seen.push_back(p.cast<float>());
    }
  if (seen.size() < kMinSamples) return std::nullopt;
  const std::vector<cv::Vec3b> lab = lab_colors(seen, images);
  Vector3f color;
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<uint8_t> values;
    for (const cv::Vec3b& each : lab) values.push_back(each[channel]);
    color[channel] = median(std::move(values));
  }
  return color;
}

void drop_like_support(Standing& standing, const SupportGround& ground, const ClusterOptions& options,
                       const ClusterImages& images, cv::Mat& shows) {
  const std::vector<cv::Vec3b> lab = lab_colors(standing.points, images);
  std::vector<size_t> kept;
  for (size_t i = 0; i < standing.pixels.size(); ++i) {
    const double floor = options.floor_m + ground.plane.uncertainty +
                         1.5 * height_noise(ground.plane, standing.points[i].cast<double>());
    if (static_cast<double>(standing.in_plane[i].z()) > floor ||
        is_other_color(lab_vector(lab[i]), *ground.color))
      kept.push_back(i);
    else
      shows.ptr<uint8_t>()[standing.pixels[i]] = static_cast<uint8_t>(Shows::support);
  }
  if (kept.size() < standing.pixels.size()) standing = subset(standing, kept);
}

}  // namespace loci::perception
