#include "perception/annotators/hypotheses/thin_objects.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "mapping/base/quantile.h"

namespace loci::perception {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Where on the plane a pixel looks.
class Terms {
 public:
  /// A row of the image: both coordinates are quotients of what grows evenly along it.
  struct Row {
    float x_start, x_step, y_start, y_step, slope_start, slope_step;

    std::pair<float, float> at(int u) const {
      const auto column = static_cast<float>(u);
      const float inverse = 1 / (slope_start + slope_step * column);
      return {(x_start + x_step * column) * inverse, (y_start + y_step * column) * inverse};
    }
  };

  Terms(const mapping::PinholeCamera& camera, const Vector3d& normal, double offset)
      : camera_(camera),
        normal_(normal),
        x_(offset * normal.unitOrthogonal()),
        y_(offset * normal.cross(normal.unitOrthogonal())) {}

  Row row(int v) const {
    const Vector3d ray = camera_.unproject(0, v, 1);
    const auto part = [&](const Vector3d& axis) {
      return std::pair(static_cast<float>(axis.dot(ray)), static_cast<float>(axis.x() / camera_.fx));
    };
    const auto [x_start, x_step] = part(x_);
    const auto [y_start, y_step] = part(y_);
    const auto [slope_start, slope_step] = part(normal_);
    return {x_start, x_step, y_start, y_step, slope_start, slope_step};
  }
  /// The polynomial's terms at a pixel.
  Vector6f at(int u, int v) const {
    const auto [x, y] = row(v).at(u);
    Vector6f terms;
    terms << 1, x, y, x * x, x * y, y * y;
    return terms;
  }

 private:
  const mapping::PinholeCamera& camera_;
  Vector3d normal_;
  Vector3d x_, y_;  ///< axes of the plane, times its offset
};

struct Sample {
  Vector6f terms;
  float height;
};

Vector6f fitted(const std::vector<Sample>& samples) {
  constexpr int kRounds = 4;
  constexpr double kStiffness = 0.02;  // m⁴: a metre of surface bends freely, a foot hardly.
  Vector6f bend = Vector6f::Zero();
  float reach = 0.01f;
  for (int round = 0; round < kRounds; ++round) {
    Matrix6d a = Matrix6d::Identity() * 1e-6;
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    for (const Sample& sample : samples) {
      if (std::abs(sample.height - bend.dot(sample.terms)) > reach) continue;
      const Eigen::Matrix<double, 6, 1> terms = sample.terms.cast<double>();
      a.noalias() += terms * terms.transpose();
      b += static_cast<double>(sample.height) * terms;
    }
    const double weight = a(0, 0);
    for (int i = 3; i < 6; ++i) a(i, i) += kStiffness * weight;
    bend = a.ldlt().solve(b).cast<float>();
    reach = std::max(0.003f, reach * 0.6f);
  }
  return bend;
}

/// A short piece of a thing's border.
struct BorderPiece {
  int border = 0;  ///< pixels of the border
  std::optional<float>
      step;  ///< how much higher the thing is than what is beside it, metres; nothing = not seen
};

/// `beyond`, `within` (CV_32F): distances of what is outside to the thing, and of its pixels to its border.
BorderPiece border_piece(const cv::Mat& heights, const cv::Mat& ground, const cv::Mat& beyond,
                         const cv::Mat& within) {
  constexpr float kGap = 3;  // Pixels at an edge show a bit of both.
  constexpr float kNear = 10;
  constexpr int kMin = 8;  // Fewer pixels have no mean to speak of.
  BorderPiece piece;
  float inner = 0;
  float outer = 0;
  int inner_count = 0;
  int outer_count = 0;
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const float inwards = within.at<float>(v, u);
      const float outwards = beyond.at<float>(v, u);
      piece.border += inwards > 0 && inwards < 1.2f ? 1 : 0;
      const float height = heights.at<float>(v, u);
      if (std::isnan(height)) continue;
      if (inwards > 1.2f && inwards <= kNear) {
        inner += height;
        ++inner_count;
      } else if (outwards > kGap && outwards <= kNear && ground.at<unsigned char>(v, u)) {
        outer += height;
        ++outer_count;
      }
    }
  if (inner_count >= kMin && outer_count >= kMin)
    piece.step = inner / static_cast<float>(inner_count) - outer / static_cast<float>(outer_count);
  return piece;
}

}  // namespace

cv::Mat over_bent_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                          const Vector3d& normal, double offset) {
  constexpr int kStep = 4;
  const Terms terms(camera, normal, offset);
  std::vector<Sample> samples;
  for (int v = 0; v < heights.rows; v += kStep)
    for (int u = 0; u < heights.cols; u += kStep)
      if (const float height = heights.at<float>(v, u); !std::isnan(height))
        samples.push_back({terms.at(u, v), height});
  const Vector6f bend = fitted(samples);
  cv::Mat result(heights.size(), CV_32F);
  for (int v = 0; v < heights.rows; ++v) {
    const auto* height = heights.ptr<float>(v);
    auto* over = result.ptr<float>(v);
    const Terms::Row row = terms.row(v);
    for (int u = 0; u < heights.cols; ++u) {
      const auto [x, y] = row.at(u);
      over[u] =
          height[u] - (bend[0] + (bend[1] + bend[3] * x + bend[4] * y) * x + (bend[2] + bend[5] * y) * y);
    }
  }
  return result;
}

bool rises_all_around(const cv::Mat& heights, const std::vector<int>& pixels, const cv::Mat& ground,
                      double step_m) {
  constexpr int kNear = 10;
  constexpr int kCell = 16;        // Pieces of the border, pixels.
  constexpr size_t kCells = 6;     // Fewer may be noise that lies together.
  constexpr double kBorder = 0.6;  // The rest may lie at something else.
  cv::Mat own = cv::Mat::zeros(heights.size(), CV_8U);
  std::vector<cv::Point> places;
  for (const int pixel : pixels) {
    own.ptr<unsigned char>()[pixel] = 255;
    places.emplace_back(pixel % heights.cols, pixel / heights.cols);
  }
  if (places.empty()) return false;
  const cv::Rect box = cv::boundingRect(places);
  const cv::Rect around =
      cv::Rect(box.x - kNear, box.y - kNear, box.width + 2 * kNear, box.height + 2 * kNear) &
      cv::Rect({0, 0}, heights.size());
  cv::Mat beyond;
  cv::Mat within;
  cv::distanceTransform(~own(around), beyond, cv::DIST_L2, 3);
  cv::distanceTransform(own(around), within, cv::DIST_L2, 3);
  std::vector<float> steps;
  int border = 0;
  int compared = 0;
  for (int top = 0; top < around.height; top += kCell)
    for (int left = 0; left < around.width; left += kCell) {
      const cv::Rect cell = cv::Rect(left, top, kCell, kCell) & cv::Rect({0, 0}, around.size());
      const BorderPiece piece =
          border_piece(heights(around)(cell), ground(around)(cell), beyond(cell), within(cell));
      border += piece.border;
      if (!piece.step) continue;
      compared += piece.border;
      steps.push_back(*piece.step);
    }
  if (steps.size() < kCells || compared < kBorder * border) return false;
  const auto step = static_cast<float>(step_m);
  return median(steps) >= step && quantile(steps, 0.2) >= step / 3;
}

}  // namespace loci::perception
