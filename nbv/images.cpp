#include "nbv/images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"

namespace loci::nbv {
namespace {

const cv::Scalar kUnknown(225, 225, 225), kFree(170, 220, 170), kOccupied(60, 60, 200), kBlue(200, 120, 30),
    kGreen(40, 160, 40), kRed(30, 30, 220), kRobot(0, 140, 255);

constexpr double kMargin = 0.4;  ///< metres around what is known: the robot may stand at its edge

/// An image of the floor, some pixels per cell.
class Sheet {
 public:
  explicit Sheet(const mapping::FloorGrid& floor)
      : floor_(floor),
        scale_(std::clamp(900 / std::max({floor.width, floor.height, 1}), 3, 12)),
        margin_(static_cast<int>(std::ceil(kMargin / floor.cell)) * scale_),
        image_(floor.height * scale_ + 2 * margin_, floor.width * scale_ + 2 * margin_, CV_8UC3,
               cv::Scalar::all(255)) {}

  cv::Point at(const Vector2d& point) const {
    const Vector2d cells = (point - floor_.low) / floor_.cell * scale_;
    return {margin_ + static_cast<int>(std::lround(cells.x())),
            image_.rows - 1 - margin_ - static_cast<int>(std::lround(cells.y()))};
  }
  void square(const Vector2d& center, double edge, const cv::Scalar& color) {
    const Vector2d half(edge / 2, edge / 2);
    cv::rectangle(image_, at(center - half), at(center + half), color, cv::FILLED);
  }
  void dot(const Vector2d& point) { cv::circle(image_, at(point), 1, cv::Scalar::all(0), cv::FILLED); }
  void arrow(const mapping::PlanarPose& pose, const cv::Scalar& color, int width) {
    const Vector2d from(pose.x, pose.y);
    const Vector2d to = from + 0.35 * Vector2d(std::cos(pose.yaw), std::sin(pose.yaw));
    cv::arrowedLine(image_, at(from), at(to), color, width, cv::LINE_AA, 0, 0.35);
  }
  void path(const std::vector<mapping::PlanarPose>& corners) {
    for (size_t i = 0; i + 1 < corners.size(); ++i)
      cv::line(image_, at({corners[i].x, corners[i].y}), at({corners[i + 1].x, corners[i + 1].y}), kRobot, 1,
               cv::LINE_AA);
  }
  void robot(const mapping::PlanarPose& pose) {
    cv::circle(image_, at({pose.x, pose.y}), static_cast<int>(0.25 / floor_.cell * scale_), kRobot, 2,
               cv::LINE_AA);
    arrow(pose, kRobot, 2);
  }
  /// Grey values of a cost layer: white = the least, black = the most.
  void costs(const std::vector<float>& values) {
    if (values.empty()) return;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double range = std::max(1e-6, static_cast<double>(*most - *least));
    for (int y = 0; y < floor_.height; ++y)
      for (int x = 0; x < floor_.width; ++x) {
        const double share = static_cast<double>(values[floor_.index(x, y)] - *least) / range;
        if (share > 0) square(floor_.center(x, y), floor_.cell, cv::Scalar::all(255 * (1 - share)));
      }
  }
  /// What stands in the robot's way, as dots: where on the map one is.
  void obstacles() {
    for (int y = 0; y < floor_.height; ++y)
      for (int x = 0; x < floor_.width; ++x)
        if (floor_.obstacle[floor_.index(x, y)] != 0)
          cv::circle(image_, at(floor_.center(x, y)), scale_ > 6 ? 2 : 1, kBlue, cv::FILLED);
  }
  const cv::Mat& image() const { return image_; }

 private:
  const mapping::FloorGrid& floor_;
  int scale_;
  int margin_;  ///< pixels
  cv::Mat image_;
};

std::vector<float> summed(const CostmapStack& stack) {
  std::vector<float> sum(stack.layers.front().size(), 0.F);
  for (const auto& layer : stack.layers)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += layer[i];
  return sum;
}

/// Calls task(center) for every voxel of a kind.
template <class Task>
void for_voxels(const ViewPlan& plan, ViewVoxel kind, const Task& task) {
  const mapping::Voxels& voxels = plan.voxels;
  for (int z = 0; z < voxels.size.z(); ++z)
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x)
        if (plan.frontier.states[voxels.index({x, y, z})] == kind) task(voxels.center({x, y, z}));
}

cv::Mat frontier_image(const ViewPlan& plan, const mapping::PlanarPose& robot) {
  Sheet sheet(plan.floor);
  const double edge = plan.voxels.resolution;
  sheet.square(plan.floor.center(plan.floor.width / 2, plan.floor.height / 2), 1e3, kUnknown);
  for_voxels(plan, ViewVoxel::free, [&](const Vector3d& p) { sheet.square(p.head<2>(), edge, kFree); });
  for_voxels(plan, ViewVoxel::frontier,
             [&](const Vector3d& p) { sheet.square(p.head<2>(), edge, kOccupied); });
  sheet.robot(robot);
  return sheet.image();
}

/// Surfaces from above, dark = low.
cv::Mat occupied_image(const ViewPlan& plan, const mapping::PlanarPose& robot) {
  Sheet sheet(plan.floor);
  for_voxels(plan, ViewVoxel::occupied, [&](const Vector3d& p) {
    const double share = std::clamp(p.z() / 2.2, 0.0, 1.0);
    if (p.z() < 2.2)
      sheet.square(p.head<2>(), plan.voxels.resolution,
                   {60 + 40 * share, 60 + 140 * share, 120 + 130 * share});
  });
  sheet.robot(robot);
  return sheet.image();
}

cv::Mat cost_image(const ViewPlan& plan, const std::vector<float>& costs, const mapping::PlanarPose& robot) {
  Sheet sheet(plan.floor);
  sheet.costs(costs);
  sheet.obstacles();
  sheet.robot(robot);
  return sheet.image();
}

/// Fig. 7.4: a sample per place, in its best orientation.
cv::Mat samples_image(const ViewPlan& plan, const mapping::PlanarPose& robot) {
  Sheet sheet(plan.floor);
  sheet.costs(summed(plan.costs));
  sheet.obstacles();
  for_voxels(plan, ViewVoxel::frontier, [&](const Vector3d& p) { sheet.dot(p.head<2>()); });
  const size_t layers = plan.costs.layers.size();
  const ViewSample* most = nullptr;
  for (size_t i = 0; i + layers <= plan.samples.size(); i += layers) {
    const auto first = plan.samples.begin() + static_cast<std::ptrdiff_t>(i);
    const auto best =
        std::max_element(first, first + static_cast<std::ptrdiff_t>(layers),
                         [](const ViewSample& a, const ViewSample& b) { return a.score < b.score; });
    if (best->score > 0) sheet.arrow(best->pose, kBlue, 1);
    for (auto sample = first; sample != first + static_cast<std::ptrdiff_t>(layers); ++sample)
      if (most == nullptr || sample->counts.frontier > most->counts.frontier) most = &*sample;
  }
  if (most != nullptr) sheet.arrow(most->pose, kGreen, 3);
  sheet.path(plan.view.path);
  if (plan.view.pose) sheet.arrow(*plan.view.pose, kRed, 3);
  sheet.robot(robot);
  return sheet.image();
}

}  // namespace

std::vector<ViewImage> view_images(const ViewPlan& plan, const mapping::PlanarPose& robot) {
  std::vector<ViewImage> images;
  if (plan.voxels.states.empty() || plan.costs.layers.empty()) return images;
  images.push_back(
      {"frontier", "Free space (green) and frontier (red) from above", frontier_image(plan, robot)});
  images.push_back({"occupied", "Surfaces by height", occupied_image(plan, robot)});
  images.push_back({"costs_frontier", "C_F, all orientations: dark = many; obstacles in blue",
                    cost_image(plan, summed(plan.frontier_costs), robot)});
  images.push_back({"costs_occupied", "C_O, all orientations: dark = many; obstacles in blue",
                    cost_image(plan, summed(plan.occupied_costs), robot)});
  for (size_t layer = 0; layer < plan.costs.layers.size(); ++layer) {
    const int degrees = static_cast<int>(std::lround(plan.costs.yaw(layer) / kDegree));
    images.push_back({fmt::format("costs_{:03}", degrees),
                      fmt::format("C for poses that look along {}°", degrees),
                      cost_image(plan, plan.costs.layers[layer], robot)});
  }
  images.push_back({"samples", "C, frontier, samples and the choice (red)", samples_image(plan, robot)});
  return images;
}

std::vector<std::filesystem::path> write_view_images(const ViewPlan& plan, const mapping::PlanarPose& robot,
                                                     const std::filesystem::path& folder) {
  make_folder(folder);
  std::vector<std::filesystem::path> files;
  for (const ViewImage& image : view_images(plan, robot)) {
    files.push_back(folder / (image.name + ".png"));
    mapping::write_image(files.back(), image.image);
  }
  return files;
}

}  // namespace loci::nbv
