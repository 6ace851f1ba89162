#include "perception/detection/lift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/base/math/math.h"

namespace loci::perception {
namespace {

/// Tuned on simulated recordings with Kinect noise.
struct LiftParameters {
  double bin_m = 0.01;        ///< of the histogram of depths: some standard deviations at 1 to 2 m
  double min_share = 0.03;    ///< of the peak; fewer pixels in a bin end the object
  int gap_bins = 2;           ///< empty ones in a row end it, too: 3 cm lie between two objects
  double min_reach_m = 0.05;  ///< that depth may differ from the mode, at least
  size_t min_pixels = 25;     ///< of an object
  double slab_m = 0.008;      ///< height of what a box shows of the surface below the object, beside noise
  double slab_share = 0.05;   ///< of the pixels, for that surface to be there
  double explained_m = 0.01;  ///< tolerance of a map, beside noise
};
constexpr LiftParameters kLift;

/// Standard deviations of a Kinect's depth, threefold.
double noise_at(double z) {
  return 0.004 * z * z;
}

Vector3d to_vector(const cv::Vec3f& point) {
  return {static_cast<double>(point[0]), static_cast<double>(point[1]), static_cast<double>(point[2])};
}

/// The region in the pixels of the colour camera.
struct ScaledRegion {
  const ImageRegion& region;
  double scale_x = 1, scale_y = 1;  ///< region from colour image

  ScaledRegion(const ImageRegion& given, const mapping::PinholeCamera& color) : region(given) {
    if (given.image.empty()) return;
    scale_x = static_cast<double>(given.image.width) / color.width;
    scale_y = static_cast<double>(given.image.height) / color.height;
    constexpr double kMaxUneven = 0.02;                                 // sizes are whole numbers of pixels
    const bool of_fractions = given.image.width == given.image.height;  // of an image of any shape
    if (!of_fractions && std::abs(scale_x - scale_y) > kMaxUneven * std::max(scale_x, scale_y))
      throw Error(
          fmt::format("the detections are in an image of {} x {} pixels, that of the recording has {} x {}",
                      given.image.width, given.image.height, color.width, color.height),
          {}, "give detections in the images of the recording; they may be scaled evenly");
  }
  bool contains(double x, double y) const { return region.contains(x * scale_x, y * scale_y); }
  /// In the inner half of the box, where a box shows the object rather than what lies around.
  bool is_central(double x, double y) const {
    const cv::Rect2d& box = region.box;
    return std::abs(x * scale_x - box.x - box.width / 2) < box.width / 4 &&
           std::abs(y * scale_y - box.y - box.height / 2) < box.height / 4;
  }
  cv::Rect2d box() const {
    const cv::Rect2d& box = region.box;
    return {box.x / scale_x, box.y / scale_y, box.width / scale_x, box.height / scale_y};
  }
};

float depth_at(const LiftFrame& frame, int pixel) {
  return frame.points.ptr<cv::Vec3f>()[pixel][2];
}

/// The depths of an object: from the mode outwards, as long as there are enough pixels and it is not deeper
/// than it is large.
std::pair<double, double> depth_band(const std::vector<float>& central, const std::vector<float>& all,
                                     double reach_per_m) {
  const auto [nearest, farthest] = std::ranges::minmax(all);
  const auto low = static_cast<double>(nearest);
  const auto bins = static_cast<size_t>((static_cast<double>(farthest) - low) / kLift.bin_m) + 1;
  const auto bin_of = [&](float z) {
    return std::min(bins - 1, static_cast<size_t>((static_cast<double>(z) - low) / kLift.bin_m));
  };
  std::vector<int> mode_counts(bins, 0), counts(bins, 0);
  for (const float z : central) ++mode_counts[bin_of(z)];
  for (const float z : all) ++counts[bin_of(z)];
  // Over three bins, so that a surface on the border of two counts once. Farther surfaces have fewer pixels.
  size_t mode = 0;
  double best = -1;
  for (size_t i = 0; i < bins; ++i) {
    const int sum =
        mode_counts[i] + (i > 0 ? mode_counts[i - 1] : 0) + (i + 1 < bins ? mode_counts[i + 1] : 0);
    if (static_cast<double>(sum) > best) {
      best = sum;
      mode = i;
    }
  }
  const double z = low + (static_cast<double>(mode) + 0.5) * kLift.bin_m;
  const double reach = std::max(kLift.min_reach_m, reach_per_m * z);
  const auto few = std::max(1.0, kLift.min_share * best / 3);
  const auto end_of = [&](int step) {
    auto last = static_cast<std::ptrdiff_t>(mode);
    int empty = 0;
    for (auto i = last + step; i >= 0 && i < static_cast<std::ptrdiff_t>(bins); i += step) {
      if (static_cast<double>(std::abs(i - static_cast<std::ptrdiff_t>(mode))) * kLift.bin_m > reach) break;
      if (counts[static_cast<size_t>(i)] < few) {
        if (++empty >= kLift.gap_bins) break;
        continue;
      }
      empty = 0;
      last = i;
    }
    return last;
  };
  return {low + static_cast<double>(end_of(-1)) * kLift.bin_m,
          low + static_cast<double>(end_of(1) + 1) * kLift.bin_m};
}

/// Leaves out the surface below the object: the lowest of what a box shows.
void leave_out_ground(const LiftFrame& frame, std::vector<int>& pixels) {
  std::vector<double> heights;
  for (const int pixel : pixels)
    heights.push_back(frame.up->dot(to_vector(frame.points.ptr<cv::Vec3f>()[pixel])));
  const double ground = quantile(heights, 0.02);
  const double slab = kLift.slab_m + noise_at(static_cast<double>(depth_at(frame, pixels.front())));
  std::vector<int> above;
  for (size_t i = 0; i < pixels.size(); ++i)
    if (heights[i] > ground + slab) above.push_back(pixels[i]);
  const auto left_out = static_cast<double>(pixels.size() - above.size());
  const bool is_there = left_out > kLift.slab_share * static_cast<double>(pixels.size());
  if (is_there && above.size() >= kLift.min_pixels) pixels = std::move(above);
}

/// The position of the pixel next to a key point, of those of the object.
std::optional<Vector3d> position_of(const KeyPoint2D& point, const ScaledRegion& region,
                                    const LiftFrame& frame, const std::vector<int>& pixels) {
  constexpr double kMaxPixels = 4;
  const Vector2d at(point.x / region.scale_x, point.y / region.scale_y);
  double best = kMaxPixels * kMaxPixels;
  std::optional<Vector3d> position;
  for (const int pixel : pixels) {
    const cv::Vec2f& there = frame.in_color.ptr<cv::Vec2f>()[pixel];
    const double distance =
        (Vector2d(static_cast<double>(there[0]), static_cast<double>(there[1])) - at).squaredNorm();
    if (distance >= best) continue;
    best = distance;
    position = to_vector(frame.points.ptr<cv::Vec3f>()[pixel]);
  }
  return position;
}

}  // namespace

cv::Mat points_of(const cv::Mat& depth, const mapping::PinholeCamera& camera) {
  cv::Mat points(depth.size(), CV_32FC3);
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      const Vector3d p = camera.unproject(u, v, static_cast<double>(z));
      points.at<cv::Vec3f>(v, u) = z > 0 ? cv::Vec3f(static_cast<float>(p.x()), static_cast<float>(p.y()), z)
                                         : cv::Vec3f(nan, nan, nan);
    }
  return points;
}

LiftFrame lift_frame(const cv::Mat& depth, const mapping::RgbdCamera& camera, const cv::Mat& explained,
                     const std::optional<Vector3d>& up) {
  return lift_frame_of_points(points_of(depth, camera.depth), camera, explained, up);
}

LiftFrame lift_frame_of_points(const cv::Mat& points, const mapping::RgbdCamera& camera,
                               const cv::Mat& explained, const std::optional<Vector3d>& up) {
  LiftFrame frame{camera, points, explained, up, cv::Mat(points.size(), CV_32FC2)};
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < static_cast<int>(points.total()); ++i) {
    const Vector3d in_color = color_from_depth * to_vector(points.ptr<cv::Vec3f>()[i]);
    cv::Vec2f& at = frame.in_color.ptr<cv::Vec2f>()[i];
    at = {nan, nan};
    if (!(in_color.z() > 0)) continue;
    // Pixel centres are at integers here and at halves in detections.
    const Vector2d pixel = camera.color.project(in_color) + Vector2d(0.5, 0.5);
    at = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  }
  return frame;
}

cv::Mat explained_by(const cv::Mat& depth, const cv::Mat& map_depth) {
  cv::Mat explained = cv::Mat::zeros(depth.size(), CV_8U);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const auto z = static_cast<double>(depth.at<float>(v, u));
      const auto map = static_cast<double>(map_depth.at<float>(v, u));
      if (z >= map - kLift.explained_m - noise_at(map)) explained.at<unsigned char>(v, u) = 255;
    }
  return explained;
}

std::vector<int> pixels_in(const LiftFrame& frame, const ImageRegion& region) {
  const ScaledRegion scaled(region, frame.camera.color);
  std::vector<int> pixels;
  for (int i = 0; i < static_cast<int>(frame.in_color.total()); ++i) {
    const cv::Vec2f& at = frame.in_color.ptr<cv::Vec2f>()[i];
    if (scaled.contains(static_cast<double>(at[0]), static_cast<double>(at[1]))) pixels.push_back(i);
  }
  return pixels;
}

LiftResult lift_region(const LiftFrame& frame, const ImageRegion& region,
                       const std::vector<KeyPoint2D>& key_points) {
  const ScaledRegion scaled(region, frame.camera.color);
  const cv::Rect2d image(0, 0, frame.camera.color.width, frame.camera.color.height), box = scaled.box();
  if ((box & image).empty()) return {std::nullopt, Reason::outside_image};
  std::vector<int> pixels = pixels_in(frame, region);
  const size_t inside = pixels.size();
  if (!frame.explained.empty())
    std::erase_if(pixels, [&](int pixel) { return frame.explained.data[pixel] != 0; });
  const Reason reason = pixels.size() < inside ? Reason::map_explained : Reason::no_depth_inside;
  if (pixels.size() < kLift.min_pixels) return {std::nullopt, reason};

  std::vector<float> all, central;
  for (const int pixel : pixels) {
    all.push_back(depth_at(frame, pixel));
    const cv::Vec2f& at = frame.in_color.ptr<cv::Vec2f>()[pixel];
    if (!region.mask.empty() || scaled.is_central(static_cast<double>(at[0]), static_cast<double>(at[1])))
      central.push_back(all.back());
  }
  // An object is hardly deeper than the diagonal of its image is long.
  const double reach_per_m =
      std::hypot(box.width / frame.camera.color.fx, box.height / frame.camera.color.fy);
  const auto band = depth_band(central.empty() ? all : central, all, reach_per_m);
  std::erase_if(pixels, [&](int pixel) {
    const auto z = static_cast<double>(depth_at(frame, pixel));
    return z < band.first || z > band.second;
  });
  if (region.mask.empty() && frame.up) leave_out_ground(frame, pixels);
  if (pixels.size() < kLift.min_pixels) return {std::nullopt, reason};
  LiftedRegion lifted{pixels, {}, false};
  lifted.at_image_border =
      box.x < 1 || box.y < 1 || box.br().x > image.width - 1 || box.br().y > image.height - 1;
  for (const KeyPoint2D& point : key_points)
    if (const auto position = position_of(point, scaled, frame, pixels))
      lifted.key_points.push_back({point.name, *position});
  return {lifted, {}};
}

}  // namespace loci::perception
