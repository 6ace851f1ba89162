#include "perception/annotators/hypotheses/flat_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "perception/annotators/hypotheses/flat_search.h"
#include "perception/annotators/hypotheses/support_planes.h"
#include "perception/annotators/hypotheses/thin_objects.h"
#include "perception/annotators/hypotheses/uneven_surface.h"

namespace loci::perception {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Box filter over what there is.
cv::Mat smoothed(const cv::Mat& heights, int width) {
  if (width <= 1) return heights;
  const cv::Mat known = heights == heights;
  cv::Mat values = heights.clone();
  values.setTo(0, ~known);
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255);
  cv::boxFilter(values, values, CV_32F, {width, width}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(weight, weight, CV_32F, {width, width}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat result = values / weight;
  result.setTo(kNone, ~known);
  return result;
}

int width_against(double noise, const FlatOptions& options) {
  const int width = static_cast<int>(std::ceil(noise / options.noise_m));
  return std::clamp(width | 1, 1, 11);
}

/// Heights of single pixels over the plane, or over the empty surface where that is known.
cv::Mat raw_heights(const cv::Mat& depth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                    const FlatOptions& options) {
  const bool calibrated = !surface.empty_depth.empty();
  cv::Mat heights(depth.size(), CV_32F);
  const double per_column = surface.normal.x() / camera.fx;
  const double most = 2 * options.max_height_m;
  for (int v = 0; v < depth.rows; ++v) {
    const double start = surface.normal.dot(camera.unproject(0, v, 1));
    const auto* z = depth.ptr<float>(v);
    const auto* inside = surface.inside.ptr<unsigned char>(v);
    const auto* empty = calibrated ? surface.empty_depth.ptr<float>(v) : nullptr;
    auto* height_of = heights.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const double slope = start + per_column * u;
      const double ground = calibrated ? slope * static_cast<double>(empty[u]) : surface.offset;
      const double height = slope * static_cast<double>(z[u]) - ground;
      // What is much too high or too low would only spoil its neighbours.
      const bool near = z[u] > 0 && inside[u] != 0 && std::abs(height) < most;
      height_of[u] = near ? static_cast<float>(height) : kNone;
    }
  }
  return heights;
}

/// Heights over the surface as it bends as a whole, and over what it really is like.
struct Leveled {
  cv::Mat bent, uneven;
};

/// Whether most of it lies where the surface is expected.
bool level(const cv::Mat& heights, double tolerance) {
  size_t within = 0;
  size_t all = 0;
  for (int v = 0; v < heights.rows; v += 2)
    for (int u = 0; u < heights.cols; u += 2) {
      const float height = heights.at<float>(v, u);
      if (std::isnan(height)) continue;
      ++all;
      within += std::abs(height) < static_cast<float>(tolerance) ? 1 : 0;
    }
  return 2 * within > all;
}

Leveled leveled(const cv::Mat& smooth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                const FlatOptions& options) {
  if (!surface.empty_depth.empty() || options.background_m == 0) return {smooth, smooth};
  Leveled heights;
  heights.bent = over_bent_surface(smooth, camera, surface.normal, surface.offset);
  // The envelope costs time and takes what is wide for surface.
  heights.uneven = level(heights.bent, 0.5 * options.table_m)
                       ? heights.bent
                       : over_uneven_surface(smooth, camera, surface.normal, surface.offset,
                                             options.background_m, (options.table_m + options.object_m) / 2);
  return heights;
}

/// A step in height that the sensor tells from steps of its disparity, metres: one and a half of them.
double min_step(const cv::Mat& depth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                const std::vector<int>& pixels, const FlatOptions& options) {
  constexpr double kNoises = 3;
  const int middle = pixels[pixels.size() / 2];
  const double slope =
      std::abs(surface.normal.dot(camera.unproject(middle % depth.cols, middle / depth.cols, 1)));
  return std::max(options.step_m,
                  kNoises * slope * depth_noise(static_cast<double>(depth.ptr<float>()[middle])));
}

/// The part of a frame that shows a surface.
struct SurfacePart {
  cv::Rect depth_box, color_box;
  cv::Mat depth, color;
  mapping::RgbdCamera camera;
  FlatSurface surface;

  SurfacePart(const cv::Mat& whole_depth, const cv::Mat& whole_color, const mapping::RgbdCamera& whole_camera,
              const FlatSurface& whole)
      : depth_box(cv::boundingRect(whole.inside)),
        color_box(box_in_color(depth_box, whole_camera, whole.normal, whole.offset)),
        depth(whole_depth(depth_box)),
        color(whole_color(color_box)),
        camera{cropped(whole_camera.depth, depth_box), cropped(whole_camera.color, color_box),
               whole_camera.depth_from_color},
        surface{whole.normal, whole.offset, whole.inside(depth_box),
                whole.empty_depth.empty() ? cv::Mat() : whole.empty_depth(depth_box)} {}

  /// What was found in the part, in the whole frame.
  void to_whole(FlatObject& object, int whole_columns) const {
    object.box += color_box.tl();
    for (int& pixel : object.pixels)
      pixel = (pixel / depth.cols + depth_box.y) * whole_columns + pixel % depth.cols + depth_box.x;
  }
};

}  // namespace

void FlatOptions::declare(OptionTable& table) {
  table.number("table_m", table_m, "m", "What is lower certainly is the surface.", 0, 0.05);
  table.number("object_m", object_m, "m", "What is higher certainly is an object.", 0.001, 0.05);
  table.number("thin_m", thin_m, "m", "Thinner things are part of the surface; 0 = only what is certain.", 0,
               0.05);
  table.number("step_m", step_m, "m", "What is thin rises by so much over what is next to it.", 0.0005, 0.05);
  table.number("max_height_m", max_height_m, "m", "Higher things are not flat.", 0.005, 0.2);
  table.number("noise_m", noise_m, "m", "Heights are smoothed until their noise is below this.", 0.0001,
               0.01);
  table.number(
      "background_m", background_m, "m",
      "Without calibration what rises over its surroundings within this length is an object; 0 = over "
      "the plane.",
      0, 1);
  table.number("reach_m", reach_m, "m", "How far colour may carry an object beyond what is certain.", 0, 0.2);
  table.number("min_area_m2", min_area_m2, "m2", "Smaller things are left out.", 0, 0.1);
  table.number("max_extent_m", max_extent_m, "m", "Longer things are left out.", 0.01, 5);
  table.integer("bins", bins, "", "Bins of hue and of saturation.", 2, 180);
}

void SurfaceCalibration::add(const cv::Mat& depth) {
  if (frames_++ == 0) {
    sum_ = cv::Mat::zeros(depth.size(), CV_64F);
    count_ = cv::Mat::zeros(depth.size(), CV_32S);
  }
  if (depth.size() != sum_.size()) throw Error("images of different sizes cannot be averaged");
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (!(z > 0)) continue;
      sum_.at<double>(v, u) += 1 / static_cast<double>(z);
      ++count_.at<int>(v, u);
    }
}

cv::Mat SurfaceCalibration::mean() const {
  cv::Mat mean(sum_.size(), CV_32F, cv::Scalar(static_cast<double>(kNone)));
  for (int v = 0; v < mean.rows; ++v)
    for (int u = 0; u < mean.cols; ++u)
      if (const int count = count_.at<int>(v, u); 2 * count >= frames_ && count > 0)
        mean.at<float>(v, u) = static_cast<float>(count / sum_.at<double>(v, u));
  return mean;
}

cv::Mat heights_over_surface(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                             const FlatSurface& surface, const FlatOptions& options) {
  const cv::Mat heights = raw_heights(depth, camera, surface, options);
  return leveled(smoothed(heights, width_against(pixel_noise(heights), options)), camera, surface, options)
      .uneven;
}

cv::Mat seen_by_color(const cv::Mat& image, const mapping::RgbdCamera& camera, const FlatSurface& surface,
                      double outside) {
  return PlaneRegistration(camera, surface.normal, surface.offset).seen_by_color(image, outside);
}

std::vector<FlatObject> find_flat_objects(const cv::Mat& depth, const cv::Mat& color,
                                          const mapping::RgbdCamera& camera, const FlatSurface& surface,
                                          const FlatOptions& options) {
  const SurfacePart part(depth, color, camera, surface);
  if (part.depth_box.empty() || part.color_box.empty()) return {};
  const cv::Mat raw = raw_heights(part.depth, part.camera.depth, part.surface, options);
  const cv::Mat smooth = smoothed(raw, width_against(pixel_noise(raw), options));
  FlatSearch search(part.depth, part.color, part.camera, part.surface, options);
  const Leveled heights = leveled(smooth, part.camera.depth, part.surface, options);
  std::vector<FlatObject> objects = search.find(heights.uneven, options.object_m);
  if (options.thin_m > 0) {
    search.leave_out(objects);
    for (FlatObject& thin : search.find(heights.bent, options.thin_m))
      if (!thin.pixels.empty() &&
          rises_all_around(raw, thin.pixels, search.open_ground(),
                           min_step(part.depth, part.camera.depth, surface, thin.pixels, options)))
        objects.push_back(std::move(thin));
  }
  for (FlatObject& object : objects) part.to_whole(object, depth.cols);
  return objects;
}

}  // namespace loci::perception
