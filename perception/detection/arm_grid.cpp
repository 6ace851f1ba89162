#include "perception/detection/arm_grid.h"

#include <algorithm>
#include <cmath>

namespace loci::perception {
namespace {

constexpr int kColumns = 320;
constexpr float kMin_z = 0.3F, kMax_z = 1.9F;  ///< of arms; farther away a hand is a few pixels
constexpr double kSurfaceArea = 0.05;          ///< of a horizontal surface, m²
constexpr float kFlat = 0.9F;                  ///< cosine to the vertical of its normals
constexpr float kClearance = 0.06F;            ///< what lies on a surface is lower
constexpr float kPlanCell = 0.05F;             ///< metres
constexpr float kReach = 0.5F;                 ///< of a hand above the surface that it reaches for

/// Whether a colour (BGR) may be that of human skin, of any complexion in nearly white light. That of wood
/// and cardboard may, too.
bool may_be_skin(const cv::Vec3b& bgr) {
  const int blue = bgr[0], green = bgr[1], red = bgr[2];
  const int range = red - std::min(green, blue);
  if (red < 32 || red < std::max(green, blue)) return false;
  if (100 * range < 12 * red || 100 * range > 62 * red) return false;  // saturation
  const double hue_deg = 60.0 * (green - blue) / range;
  return hue_deg > -15 && hue_deg < 33;
}

double step_of_noise(float z) {
  return 0.015 + 0.008 * static_cast<double>(z) * static_cast<double>(z);
}

}  // namespace

ArmGrid::ArmGrid(const PeopleFrame& frame)
    : frame_(frame),
      step_(std::max(1, frame.points.cols / kColumns)),
      rows_(frame.points.rows / step_),
      columns_(frame.points.cols / step_),
      up_((frame.map_from_camera->linear().transpose() * Vector3d::UnitZ()).cast<float>()),
      east_(up_.unitOrthogonal()),
      north_(up_.cross(east_)) {
  const Isometry3d color_from_depth = frame.camera.depth_from_color.inverse();
  const cv::Rect image({}, frame.color.size());
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const cv::Point at(column * step_ + step_ / 2, row * step_ + step_ / 2);
      const Eigen::Vector3f point(frame.points.at<cv::Vec3f>(at).val);
      const bool known = !frame.explained.empty() && frame.explained.at<uint8_t>(at) != 0;
      points_.push_back(point);
      free_.push_back(point.z() > kMin_z && point.z() < kMax_z && !known ? 1 : 0);
    }
  find_surfaces();
  skin_.assign(size(), 0);
  for (size_t cell = 0; cell < size(); ++cell) {
    if (is_free(cell) && is_on_a_surface(points_[cell])) free_[cell] = 0;
    if (!is_free(cell)) continue;
    const Vector3d seen = color_from_depth * points_[cell].cast<double>();
    const Vector2d pixel = frame.camera.color.project(seen);
    const cv::Point at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    if (seen.z() > 0 && image.contains(at)) skin_[cell] = may_be_skin(frame.color.at<cv::Vec3b>(at)) ? 1 : 0;
  }
}

std::vector<ArmGrid::Facet> ArmGrid::facets() const {
  std::vector<Facet> facets;
  const double side = 2 * step_ / frame_.camera.depth.fx;
  for (int row = 2; row + 2 < rows_; row += 2)
    for (int column = 2; column + 2 < columns_; column += 2) {
      const size_t here = cell(row, column);
      const Eigen::Vector3f right = points_[here + 2] - points_[here - 2];
      const Eigen::Vector3f down = points_[cell(row + 2, column)] - points_[cell(row - 2, column)];
      const Eigen::Vector3f normal = down.cross(right).normalized();
      const auto facing = static_cast<double>(-normal.dot(points_[here].normalized()));
      if (facing > 0.1)  // not what is not measured
        facets.push_back({here, normal, std::pow(static_cast<double>(points_[here].z()) * side, 2) / facing});
    }
  return facets;
}

void ArmGrid::find_surfaces() {
  constexpr double kBin = 0.01, kLowest = -4;  // metres
  std::vector<double> areas(800, 0.0);
  for (const Facet& facet : facets())
    if (facet.normal.dot(up_) > kFlat) {
      const double bin = (static_cast<double>(height(points_[facet.cell])) - kLowest) / kBin;
      areas[static_cast<size_t>(std::clamp(bin, 0.0, 799.0))] += facet.area;
    }
  for (size_t bin = 1; bin + 1 < areas.size(); ++bin)
    if (areas[bin - 1] + areas[bin] + areas[bin + 1] > kSurfaceArea)
      surfaces_.push_back(static_cast<float>(kLowest + (static_cast<double>(bin) + 0.5) * kBin));
  for (size_t cell = 0; cell < size(); cell += 3) {  // a plan of this resolution needs no more
    const Eigen::Vector3f& point = points_[cell];
    if (!is_on_a_surface(point)) continue;
    float& highest = plan_.try_emplace(below(point), height(point)).first->second;
    highest = std::max(highest, height(point));
  }
}

std::pair<int, int> ArmGrid::below(const Eigen::Vector3f& point) const {
  return {static_cast<int>(std::floor(point.dot(east_) / kPlanCell)),
          static_cast<int>(std::floor(point.dot(north_) / kPlanCell))};
}

bool ArmGrid::on_one_surface(float a, float b) {
  return std::abs(static_cast<double>(a - b)) < step_of_noise(std::min(a, b));
}

bool ArmGrid::is_on_a_surface(const Eigen::Vector3f& point) const {
  const auto tolerance = static_cast<float>(0.01 + step_of_noise(point.z()) / 2);
  const auto next = std::ranges::lower_bound(surfaces_, height(point) - tolerance);
  return next != surfaces_.end() && *next < height(point) + tolerance;
}

bool ArmGrid::is_in_the_air(float height) const {
  const auto above = std::ranges::upper_bound(surfaces_, height);
  return above == surfaces_.begin() || height - *std::prev(above) > kClearance;
}

bool ArmGrid::is_over_a_surface(const Eigen::Vector3f& point) const {
  const auto [x, y] = below(point);
  const float top = height(point);
  for (int i = x - 2; i <= x + 2; ++i)
    for (int k = y - 2; k <= y + 2; ++k) {
      const auto surface = plan_.find({i, k});
      if (surface != plan_.end() && surface->second < top && surface->second > top - kReach) return true;
    }
  return false;
}

std::vector<int> ArmGrid::pixels_of(const std::vector<size_t>& cells) const {
  cv::Mat depths = cv::Mat::zeros(rows_, columns_, CV_32F);
  for (const size_t cell : cells) depths.ptr<float>()[cell] = points_[cell].z();
  const auto belongs = [&](int v, int u, float z) {
    for (int row = std::max(0, v / step_ - 1); row <= std::min(rows_ - 1, v / step_ + 1); ++row)
      for (int column = std::max(0, u / step_ - 1); column <= std::min(columns_ - 1, u / step_ + 1);
           ++column) {
        const float depth = depths.ptr<float>(row)[column];
        if (depth > 0 && on_one_surface(depth, z)) return true;
      }
    return false;
  };
  std::vector<int> pixels;
  for (int v = 0; v < frame_.points.rows; ++v)
    for (int u = 0; u < frame_.points.cols; ++u)
      if (belongs(v, u, frame_.points.ptr<cv::Vec3f>(v)[u][2])) pixels.push_back(v * frame_.points.cols + u);
  return pixels;
}

}  // namespace loci::perception
