#include "memory/recorder/observation_pixels.h"

#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"

namespace loci::memory {

belief::AxisBox robust_box(const std::vector<Vector3d>& points) {
  if (points.empty()) return {};
  Vector3d low, high;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    low[axis] = quantile(values, 0.01);
    high[axis] = quantile(values, 0.99);
  }
  return {(low + high) / 2, high - low};
}

std::string encoded_image(const cv::Mat& image, const std::string& ending) {
  const std::vector<unsigned char> bytes = mapping::encode_image(image, ending);
  return {bytes.begin(), bytes.end()};
}

void set_pixels(std::span<const int32_t> pixels, SceneRecord& record, ObservationRecord& observation) {
  const cv::Mat& depth = record.view.depth;
  const auto label = static_cast<int>(record.observations.size());
  std::vector<Vector3d> points;
  cv::Rect roi;
  for (const int32_t pixel : pixels) {
    const int v = pixel / depth.cols, u = pixel % depth.cols;
    record.view.labels.at<int>(v, u) = label;
    roi = roi.empty() ? cv::Rect(u, v, 1, 1) : (roi | cv::Rect(u, v, 1, 1));
    const float z = depth.at<float>(v, u);
    if (std::isfinite(z))
      points.push_back(record.view.map_from_camera * record.view.camera.unproject(u, v, z));
  }
  observation.evidence.points = static_cast<int>(points.size());
  observation.row.points = static_cast<int64_t>(points.size());
  observation.evidence.box = robust_box(points);
  observation.evidence.range = (record.view.map_from_camera.inverse() * observation.evidence.box.centre).z();
  if (roi.empty()) return;
  observation.row.roi = {roi.x, roi.y, roi.width, roi.height};
  cv::Mat mask = cv::Mat::zeros(roi.size(), CV_8U);
  for (const int32_t pixel : pixels)
    mask.at<uint8_t>(pixel / depth.cols - roi.y, pixel % depth.cols - roi.x) = 255;
  observation.mask = {encoded_image(mask, ".png"), "image/png"};
}

}  // namespace loci::memory
