#include "perception/annotators/description/texture_annotator.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/image/root_sift.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr double kContrast = 0.03;
constexpr double kMaxZoom = 2;  // Beyond, the image shows nothing more.
constexpr int kReach = 2;       // pixels from a key point to a measured point

/// The part of the colour image that shows an object.
struct ObjectImage {
  cv::Mat grey, mask;  ///< CV_8U
  cv::Mat point;       ///< CV_32S: index of the object's point that a pixel shows, -1 = none
  double range = 0;    ///< median depth from the colour camera, m
  double focal = 1;    ///< pixels
};

ObjectImage object_image(const types::SceneCas& scene, const types::StandaloneImageROI& roi,
                         const std::vector<Vector3d>& points) {
  ObjectImage object;
  cv::cvtColor(types::from<cv::Mat>(roi.image.get()), object.grey, cv::COLOR_BGR2GRAY);
  object.mask = types::from<cv::Mat>(roi.mask.get());
  object.point = cv::Mat(object.grey.size(), CV_32S, cv::Scalar(-1));
  const cv::Rect region = types::from<cv::Rect>(roi.roi.get());
  const mapping::RgbdCamera camera = types::cameras(scene);
  const Isometry3d color_from_map = (map_from_camera(scene.scene()) * camera.depth_from_color).inverse();
  object.focal = camera.color.fx;
  std::vector<double> depths;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector3d in_color = color_from_map * points[i];
    if (!(in_color.z() > 0)) continue;
    depths.push_back(in_color.z());
    const Vector2d at = camera.color.project(in_color);
    const cv::Point pixel(static_cast<int>(std::lround(at.x())) - region.x,
                          static_cast<int>(std::lround(at.y())) - region.y);
    if (cv::Rect({}, object.point.size()).contains(pixel)) object.point.at<int>(pixel) = static_cast<int>(i);
  }
  if (!depths.empty()) object.range = median(std::move(depths));
  return object;
}

/// The point that the image shows at or next to a pixel.
std::optional<size_t> point_at(const cv::Mat& point, const cv::Point2f& pixel) {
  std::optional<size_t> best;
  float nearest = kReach * kReach + 0.5F;
  const int u = cvRound(pixel.x), v = cvRound(pixel.y);
  for (int y = std::max(0, v - kReach); y <= std::min(point.rows - 1, v + kReach); ++y)
    for (int x = std::max(0, u - kReach); x <= std::min(point.cols - 1, u + kReach); ++x) {
      const float dx = static_cast<float>(x) - pixel.x, dy = static_cast<float>(y) - pixel.y;
      if (point.at<int>(y, x) < 0 || dx * dx + dy * dy >= nearest) continue;
      nearest = dx * dx + dy * dy;
      best = static_cast<size_t>(point.at<int>(y, x));
    }
  return best;
}

/// In four bits per value. `descriptor`: RootSIFT, one row.
void append_packed(const cv::Mat& descriptor, std::vector<uint8_t>& bytes) {
  constexpr float kUnit = 32, kMax = 15;  // Few values are above half of the descriptor's length.
  for (int i = 0; i < descriptor.cols; ++i) {
    const auto level =
        static_cast<unsigned>(std::min(kMax, std::floor(kUnit * descriptor.at<float>(i) + 0.5F)));
    if (i % 2 == 0)
      bytes.push_back(static_cast<uint8_t>(level));
    else
      bytes.back() = static_cast<uint8_t>(bytes.back() | level << 4U);
  }
}

}  // namespace

AnnotatorDescriptor TextureAnnotator::descriptor() const {
  return {"Texture",
          "Finds key points on each object's print, by which views of it are recognised and registered.",
          {"Scene", "CameraInfo", "view:cloud", "Cluster", "ReferenceClusterPoints", "StandaloneImageROI"},
          {"TextureAnnotation"}};
}

void TextureAnnotator::declare(OptionTable& table) {
  table.integer("keypoints", keypoints_, "", "Maximum number of key points per object.", 10, 2000);
  table.number("pixel_m", pixel_m_, "m",
               "Size of a pixel on the object to which its image is scaled; images are at most doubled.",
               1e-4, 0.1);
}

void TextureAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const auto sift = cv::SIFT::create(keypoints_, 3, kContrast);
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi || !roi.mask.is_set()) continue;
    const std::vector<Vector3d> points = cluster_points(scene, cluster);
    const ObjectImage object = object_image(scene, roi, points);
    if (object.range <= 0 || object.mask.size() != object.grey.size()) continue;
    const double scale = std::min(kMaxZoom, object.range / object.focal / pixel_m_);
    cv::Mat grey, mask, descriptors;
    cv::resize(object.grey, grey, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
    cv::erode(object.mask, mask, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
    cv::resize(mask, mask, grey.size(), 0, 0, cv::INTER_NEAREST);
    std::vector<cv::KeyPoint> found;
    sift->detectAndCompute(grey, mask, found, descriptors);
    const cv::Mat rooted = mapping::root_sift(descriptors);
    std::vector<float> positions, diameters;
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < found.size(); ++i) {
      const auto point = point_at(object.point, found[i].pt * static_cast<float>(1 / scale));
      if (!point) continue;
      for (const double value : points[*point]) positions.push_back(static_cast<float>(value));
      diameters.push_back(found[i].size * static_cast<float>(object.range / object.focal / scale));
      append_packed(rooted.row(static_cast<int>(i)), bytes);
    }
    if (diameters.empty()) continue;
    const auto annotation = types::TextureAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.positions.set(positions);
    annotation.diameters.set(diameters);
    annotation.descriptors.set(bytes);
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci::perception
