#include "mapping/simulation/household_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/render/render.h"
#include "mapping/sensor/kinect.h"
#include "mapping/simulation/household.h"
#include "mapping/simulation/scenario.h"
#include "mapping/simulation/shapes.h"

namespace loci::mapping {
namespace {

/// A table before a camera.
struct Table {
  RenderScene scene;
  Isometry3d map_from_camera = Isometry3d::Identity();
  std::vector<std::string> classes;
};

/// One in eight belongs to no class; what every kitchen has many of is drawn twice as often.
std::string drawn_class(Random& draw) {
  static const std::vector<std::string> frequent = {"box", "can", "bowl", "cup", "mug", "bottle"};
  const std::vector<std::string>& all = household_classes();
  if (draw.uniform() < 0.125) return "other";
  const uint64_t number = draw.index(all.size() + frequent.size());
  return number < all.size() ? all[number] : frequent[number - all.size()];
}

TriangleMesh table_top(Random& draw) {
  ShapeBuilder builder;
  const auto shade = [&] { return static_cast<float>(draw.uniform(0.2, 0.95)); };
  const float red = shade(), green = red * static_cast<float>(draw.uniform(0.75, 1.05));
  builder.box({-0.8, -0.6, -0.04}, {0.8, 0.6, 0},
              Rgba(red, green, green * static_cast<float>(draw.uniform(0.6, 1.1)), 1));
  return builder.take();
}

void put(Table& table, const std::string& name, const HouseholdObject& object, const Vector3d& at,
         double yaw) {
  Isometry3d pose(Eigen::Translation3d{at});
  pose.rotate(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
  table.classes.push_back(name);
  table.scene.add(fmt::format("object_{}", table.classes.size()), object.mesh, pose);
}

/// Circles on a table that hold something.
struct TakenRoom {
  std::vector<std::pair<Vector2d, double>> circles;

  bool take(const Vector2d& at, double radius, double gap) {
    if (std::ranges::any_of(circles, [&](const auto& other) {
          return (other.first - at).norm() < other.second + radius + gap;
        }))
      return false;
    circles.emplace_back(at, radius);
    return true;
  }
};

void add_objects(Table& table, Random& draw) {
  constexpr size_t kObjects = 6;
  constexpr double kGap = 0.012;
  TakenRoom taken;
  for (int attempt = 0; attempt < 40 && taken.circles.size() < kObjects; ++attempt) {
    const std::string name = drawn_class(draw);
    const HouseholdObject object = draw_household_object(name, draw);
    const double x = draw.uniform(-0.38, 0.38);
    const Vector2d at(x, draw.uniform(-0.3, 0.3));
    if (!taken.take(at, object.reach, kGap)) continue;
    put(table, name, object, {at.x(), at.y(), 0}, draw.uniform(0, 2 * kPi));
    if (object.room == 0 || draw.uniform() < 0.5) continue;
    const std::string upper = drawn_class(draw);
    const HouseholdObject on_top = draw_household_object(upper, draw);
    if (on_top.reach < 1.3 * object.room)
      put(table, upper, on_top, {at.x(), at.y(), object.top}, draw.uniform(0, 2 * kPi));
  }
}

/// What a stack is made of: the object, its class and how it stands.
struct Stacked {
  std::string name;
  HouseholdObject object;
  Vector3d at = Vector3d::Zero();
  double yaw = 0;

  double room() const { return std::max(object.room, object.foot); }
};

/// Up to four objects upon each other, each with its middle over the flat top of the one below. Half of them
/// are turned like it.
std::vector<Stacked> drawn_stack(Random& draw) {
  static const std::vector<std::string> classes = {"book",   "bowl", "box", "box",    "can", "can",
                                                   "carton", "cup",  "jar", "sponge", "tin", "tin"};
  constexpr double kMaxHeight = 0.36, kMinRoom = 0.35;
  std::vector<Stacked> stack;
  const size_t most = 1 + draw.index(4);
  for (int attempt = 0; attempt < 20 && stack.size() < most; ++attempt) {
    Stacked next{classes[draw.index(classes.size())], {}, Vector3d::Zero(), draw.uniform(0, 2 * kPi)};
    next.object = draw_household_object(next.name, draw);
    const double turn = draw.uniform(0, 2 * kPi), aside = draw.uniform(0, 0.4);
    const bool aligned = draw.uniform() < 0.5;
    if (!stack.empty()) {
      const Stacked& below = stack.back();
      if (below.room() < kMinRoom * next.object.reach) continue;
      next.at = below.at + Vector3d(aside * below.room() * std::cos(turn),
                                    aside * below.room() * std::sin(turn), below.object.top);
      if (next.at.z() + next.object.top > kMaxHeight) continue;
      if (aligned) next.yaw = below.yaw;
    }
    stack.push_back(std::move(next));
    if (stack.back().room() == 0) break;
  }
  return stack;
}

void add_stacks(Table& table, Random& draw) {
  constexpr size_t kStacks = 5;
  constexpr double kGap = 0.002;
  TakenRoom taken;
  for (int attempt = 0; attempt < 25 && taken.circles.size() < kStacks; ++attempt) {
    const double x = draw.uniform(-0.32, 0.32);
    const Vector2d at(x, draw.uniform(-0.25, 0.25));
    const std::vector<Stacked> stack = drawn_stack(draw);
    double reach = 0;
    for (const Stacked& each : stack) reach = std::max(reach, each.at.head<2>().norm() + each.object.reach);
    if (!taken.take(at, reach, kGap)) continue;
    for (const Stacked& each : stack)
      put(table, each.name, each.object, each.at + Vector3d(at.x(), at.y(), 0), each.yaw);
  }
}

Table drawn_table(Random& draw, Arrangement arrangement) {
  Table table;
  table.scene.add("table", table_top(draw), Isometry3d::Identity());
  if (arrangement == Arrangement::stacked)
    add_stacks(table, draw);
  else
    add_objects(table, draw);
  const double elevation = draw.uniform(15, 70) * kDegree, side = draw.uniform(-0.4, 0.4);
  const Vector3d from(side, -std::cos(elevation), std::sin(elevation));
  double distance = draw.uniform() < 0.6 ? draw.uniform(0.75, 1.3) : draw.uniform(1.3, 2.2);
  // Further below the camera a plane is taken for the floor.
  constexpr double kHighest = 1.15;
  if (arrangement == Arrangement::stacked) distance = std::min(distance, kHighest / std::sin(elevation));
  table.map_from_camera = looking_at(from.normalized() * distance, Vector3d::Zero());
  return table;
}

/// A lamp of drawn colour and direction over even light, seen with drawn exposure.
cv::Mat lit(const RenderedView& view, const Isometry3d& map_from_camera, Random draw) {
  const double tilt = draw.uniform(0, 1.1), turn = draw.uniform(0, 2 * kPi);
  const Vector3d up(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
  const Eigen::Vector3f lamp = (map_from_camera.linear().transpose() * up).cast<float>();
  const auto ambient = static_cast<float>(draw.uniform(0.35, 0.75)),
             gain = static_cast<float>(draw.uniform(0.7, 1.3));
  cv::Vec3f white;
  for (int c = 0; c < 3; ++c) white[c] = gain * static_cast<float>(draw.uniform(0.88, 1.12));
  cv::Mat image(view.color.size(), CV_8UC3, cv::Scalar::all(40));
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      if (view.link.at<int>(v, u) < 0) continue;
      const auto& normal = view.normal.at<cv::Vec3f>(v, u);
      const float facing = std::max(0.0F, normal[0] * lamp.x() + normal[1] * lamp.y() + normal[2] * lamp.z());
      const float light = ambient + (1 - ambient) * facing;
      const auto& color = view.color.at<cv::Vec3b>(v, u);
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(v, u)[c] =
            cv::saturate_cast<uchar>(light * white[c] * static_cast<float>(color[c]));
    }
  cv::GaussianBlur(image, image, {3, 3}, 0);
  return image;
}

}  // namespace

HouseholdScenes::HouseholdScenes(size_t scenes, const Random& random, Arrangement arrangement)
    : random_(random), arrangement_(arrangement) {
  info_.format = "simulated";
  info_.path = "household objects";
  info_.map_frame = "table";
  info_.camera = kinect_camera();
  info_.camera.color = info_.camera.depth;
  info_.camera.depth_from_color = Isometry3d::Identity();
  info_.frames = info_.frames_with_pose = scenes;
  if (scenes > 0) info_.last_time = time_of(scenes - 1);
}

RgbdFrame HouseholdScenes::frame(size_t i) const {
  Random draw = random_.fork(i);
  const Table table = drawn_table(draw, arrangement_);
  classes_ = table.classes;
  RgbdFrame frame;
  frame.camera = info_.camera;
  frame.index = static_cast<int64_t>(i);
  frame.name = fmt::format("scene{}", i);
  frame.time_ns = time_of(i);
  frame.map_from_camera = table.map_from_camera;
  RenderOptions options;
  options.normals = options.colors = true;
  const RenderedView view = table.scene.render(frame.camera.depth, table.map_from_camera, options);
  KinectModel sensor;
  cv::Mat depth = view.depth;
  // Half of the images have the simulation's own noise, which differs from pixel to pixel.
  if (draw.uniform() < 0.5) {
    depth = seen_through_window(depth, frame.camera.depth.fx * sensor.baseline_m, draw.fork(1));
    sensor.disparity_sigma_px = 0;
  }
  frame.depth = measured_by_kinect(depth, view.normal, frame.camera.depth, sensor, draw.fork(0));
  frame.color = lit(view, table.map_from_camera, draw.fork(2));
  add_color_noise(frame.color, sensor, draw.fork(3));
  labels_ = cv::Mat::zeros(frame.depth.size(), CV_16U);
  for (int v = 0; v < frame.depth.rows; ++v)
    for (int u = 0; u < frame.depth.cols; ++u)
      if (const int link = view.link.at<int>(v, u); link >= 0 && !std::isnan(frame.depth.at<float>(v, u)))
        labels_.at<uint16_t>(v, u) = static_cast<uint16_t>(link == 0 ? 1 : 10 + 10 * link);
  return frame;
}

cv::Mat seen_through_window(const cv::Mat& depth, double focal_times_baseline, Random draw) {
  constexpr int kHalf = 4;           // pixels
  constexpr float kSameSurface = 1;  // px of disparity
  constexpr double kSigma = 0.07;    // px, after the window
  cv::Mat disparity = focal_times_baseline / depth, noise(depth.size(), CV_32F), result(depth.size(), CV_32F);
  for (float& value : cv::Mat_<float>(noise))
    value = static_cast<float>(draw.normal(kSigma * (2 * kHalf + 1)));
  cv::blur(noise, noise, {2 * kHalf + 1, 2 * kHalf + 1});
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const float own = disparity.at<float>(v, u);
      float sum = 0, count = 0;
      for (int y = std::max(0, v - kHalf); y <= std::min(depth.rows - 1, v + kHalf); ++y) {
        const float* row = disparity.ptr<float>(y);
        for (int x = std::max(0, u - kHalf); x <= std::min(depth.cols - 1, u + kHalf); ++x)
          if (std::abs(row[x] - own) < kSameSurface) {
            sum += row[x];
            ++count;
          }
      }
      const float seen = sum / count + noise.at<float>(v, u);  // NaN stays NaN.
      result.at<float>(v, u) = static_cast<float>(focal_times_baseline) / seen;
    }
  }
  return result;
}

}  // namespace loci::mapping
