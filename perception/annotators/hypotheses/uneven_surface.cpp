#include "perception/annotators/hypotheses/uneven_surface.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/quantile.h"

namespace loci::perception {
namespace {

constexpr double kCell = 0.005;  ///< of the top view, metres
constexpr int kMaxCells = 2000;

/// Where each pixel of the image falls in the top view of a plane.
struct TopView {
  cv::Mat cell;  ///< CV_32SC2 per pixel, (-1, -1) = outside
  cv::Size size;
};

TopView top_view(const cv::Mat& heights, const mapping::PinholeCamera& camera, const Vector3d& normal,
                 double offset) {
  const Vector3d x = normal.unitOrthogonal();
  const Vector3d y = normal.cross(x);
  cv::Mat positions(heights.size(), CV_64FC2);
  Eigen::AlignedBox2d extent;
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const Vector3d ray = camera.unproject(u, v, 1);
      const Vector3d p = offset / normal.dot(ray) * ray;
      const Vector2d at(x.dot(p), y.dot(p));
      positions.at<cv::Vec2d>(v, u) = {at.x(), at.y()};
      extent.extend(at);
    }
  TopView view{cv::Mat(heights.size(), CV_32SC2, cv::Scalar(-1, -1)), {}};
  if (extent.isEmpty()) return view;
  const auto cells = [&](int axis) {
    return std::min(kMaxCells, static_cast<int>(extent.sizes()[axis] / kCell) + 1);
  };
  view.size = {cells(0), cells(1)};
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const cv::Vec2d& at = positions.at<cv::Vec2d>(v, u);
      const cv::Vec2i cell(static_cast<int>((at[0] - extent.min().x()) / kCell),
                           static_cast<int>((at[1] - extent.min().y()) / kCell));
      if (cell[0] < view.size.width && cell[1] < view.size.height) view.cell.at<cv::Vec2i>(v, u) = cell;
    }
  return view;
}

/// Weighted mean of the surroundings; NaN where there is nothing near.
cv::Mat blurred(const cv::Mat& values, const cv::Mat& weights, double sigma_cells) {
  cv::Mat sum;
  cv::Mat weight;
  cv::GaussianBlur(values.mul(weights), sum, {}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
  cv::GaussianBlur(weights, weight, {}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
  cv::Mat result = sum / weight;
  result.setTo(std::numeric_limits<float>::quiet_NaN(), weight < 1e-4);
  return result;
}

/// The lower envelope of a top view: what narrow things leave of it, level with the surface on the whole.
cv::Mat envelope(const cv::Mat& cells, const cv::Mat& known, double window_m) {
  const int width = static_cast<int>(window_m / kCell) | 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {width, width});
  cv::Mat filled;
  cv::medianBlur(cells, filled, 3);
  filled.setTo(1, ~known);  // Gaps are no low ground,
  cv::Mat opened;
  cv::erode(filled, opened, disc);
  opened.setTo(-1, opened > 0.5);  // nor high ground.
  cv::dilate(opened, opened, disc);
  std::vector<float> above;
  for (int v = 0; v < cells.rows; v += 2)
    for (int u = 0; u < cells.cols; u += 2)
      if (known.at<unsigned char>(v, u)) above.push_back(cells.at<float>(v, u) - opened.at<float>(v, u));
  if (above.empty()) return opened;
  // A minimum lies below the mean by the noise; most of what is seen is surface.
  return opened + static_cast<double>(quantile(above, 0.4));
}

}  // namespace

cv::Mat over_uneven_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                            const Vector3d& normal, double offset, double window_m, double object_m) {
  const TopView view = top_view(heights, camera, normal, offset);
  if (view.size.empty()) return heights;
  cv::Mat sum = cv::Mat::zeros(view.size, CV_32F);
  cv::Mat count = cv::Mat::zeros(view.size, CV_32F);
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const cv::Vec2i& cell = view.cell.at<cv::Vec2i>(v, u);
      if (cell[0] < 0) continue;
      sum.at<float>(cell[1], cell[0]) += heights.at<float>(v, u);
      count.at<float>(cell[1], cell[0]) += 1;
    }
  cv::Mat known = count > 0;
  cv::Mat cells = sum / cv::max(count, 1.0f);
  // Rows that are far apart leave gaps between cells.
  const cv::Mat near = blurred(cells, cv::min(count, 1.0f), 1.0);
  near.copyTo(cells, ~known & (near == near));
  known |= near == near;
  cells.setTo(0, ~known);
  const cv::Mat first = envelope(cells, known, window_m);
  cv::Mat surface_weight;
  const cv::Mat level = cv::abs(cells - first) < object_m;
  cv::Mat(known & level).convertTo(surface_weight, CV_32F, 1.0 / 255);
  const cv::Mat ground = blurred(cells, surface_weight, 0.15 * window_m / kCell);
  cv::Mat result(heights.size(), CV_32F, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const cv::Vec2i& cell = view.cell.at<cv::Vec2i>(v, u);
      if (cell[0] < 0) continue;
      const float own = ground.at<float>(cell[1], cell[0]);
      result.at<float>(v, u) =
          heights.at<float>(v, u) - (std::isnan(own) ? first.at<float>(cell[1], cell[0]) : own);
    }
  return result;
}

}  // namespace loci::perception
