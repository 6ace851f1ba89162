#include "perception/annotators/hypotheses/flat_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "mapping/base/quantile.h"
#include "perception/annotators/hypotheses/flat_colors.h"
#include "perception/annotators/hypotheses/support_planes.h"
#include "perception/annotators/hypotheses/thin_objects.h"
#include "perception/annotators/hypotheses/uneven_surface.h"

namespace loci {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Standard deviation of single pixels' heights, from neighbours on the same surface.
double pixel_noise(const cv::Mat& heights) {
  constexpr float kStep = 0.02f;  // What differs by more is an edge.
  double sum = 0;
  int count = 0;
  for (int v = 0; v < heights.rows; v += 2)
    for (int u = 1; u < heights.cols; u += 2) {
      const float d = heights.at<float>(v, u) - heights.at<float>(v, u - 1);
      if (!(std::abs(d) < kStep)) continue;
      sum += static_cast<double>(d * d);
      ++count;
    }
  return count == 0 ? 0 : std::sqrt(sum / count / 2);
}

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

/// What the plane's normal and depth make of one pixel of the colour picture, m².
double pixel_area(const RgbdCamera& camera, const FlatSurface& surface, const cv::Point& pixel) {
  const Vector3d ray = camera.depth_from_color.linear() * camera.color.unproject(pixel.x, pixel.y, 1);
  const double slope = std::abs(surface.normal.dot(ray));
  const Vector3d& eye = camera.depth_from_color.translation();
  const double z = std::abs(surface.offset - surface.normal.dot(eye)) / std::max(1e-6, slope);
  return z * z / (camera.color.fx * camera.color.fy) / std::max(0.05, slope);
}

/// The objects' depth pixels: those that fall into an object's mask in the colour picture.
void assign_depth_pixels(const cv::Mat& depth, const cv::Mat& heights, const RgbdCamera& camera,
                         const cv::Mat& object_of_color, std::vector<FlatObject>& objects) {
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  std::vector<std::vector<float>> over(objects.size());
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const Vector3d p =
          color_from_depth * camera.depth.unproject(u, v, static_cast<double>(depth.at<float>(v, u)));
      if (p.z() <= 0) continue;
      const Vector2d at = camera.color.project(p);
      if (!camera.color.contains(at)) continue;
      const int object = object_of_color.at<int>(static_cast<int>(std::lround(at.y())),
                                                 static_cast<int>(std::lround(at.x())));
      if (object < 0) continue;
      objects[static_cast<size_t>(object)].pixels.push_back(v * depth.cols + u);
      over[static_cast<size_t>(object)].push_back(heights.at<float>(v, u));
    }
  for (size_t i = 0; i < objects.size(); ++i)
    if (!over[i].empty()) objects[i].height = static_cast<double>(median(over[i]));
}

/// Heights of single pixels over the plane, or over the empty surface where that is known.
cv::Mat raw_heights(const cv::Mat& depth, const PinholeCamera& camera, const FlatSurface& surface,
                    const FlatOptions& options) {
  const bool calibrated = !surface.empty_depth.empty();
  cv::Mat heights(depth.size(), CV_32F, cv::Scalar(static_cast<double>(kNone)));
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (!(z > 0) || !surface.inside.at<unsigned char>(v, u)) continue;
      const double slope = surface.normal.dot(camera.unproject(u, v, 1));
      const double ground =
          calibrated ? slope * static_cast<double>(surface.empty_depth.at<float>(v, u)) : surface.offset;
      const double height = slope * static_cast<double>(z) - ground;
      // What is much too high or too low would only spoil its neighbours.
      if (std::abs(height) < 2 * options.max_height_m) heights.at<float>(v, u) = static_cast<float>(height);
    }
  return heights;
}

cv::Mat leveled(const cv::Mat& smooth, const PinholeCamera& camera, const FlatSurface& surface,
                const FlatOptions& options) {
  if (!surface.empty_depth.empty() || options.background_m == 0) return smooth;
  return over_uneven_surface(smooth, camera, surface.normal, surface.offset, options.background_m,
                             (options.table_m + options.object_m) / 2);
}

/// A step in height that the sensor tells from steps of its disparity, metres: one and a half of them.
double least_step(const cv::Mat& depth, const PinholeCamera& camera, const FlatSurface& surface,
                  const std::vector<int>& pixels, const FlatOptions& options) {
  constexpr double kNoises = 3;
  const int middle = pixels[pixels.size() / 2];
  const double slope =
      std::abs(surface.normal.dot(camera.unproject(middle % depth.cols, middle / depth.cols, 1)));
  return std::max(options.step_m,
                  kNoises * slope * depth_noise(static_cast<double>(depth.ptr<float>()[middle])));
}

/// Two stages over one picture and what of it is left.
class Search {
 public:
  Search(const cv::Mat& depth, const cv::Mat& color, const RgbdCamera& camera, const FlatSurface& surface,
         const FlatOptions& options)
      : depth_(depth),
        color_(color),
        camera_(camera),
        surface_(surface),
        options_(options),
        open_(surface.inside.clone()) {}

  /// Things of which at least a quarter is higher than `object_m`, with the pixels of both pictures.
  std::vector<FlatObject> find(const cv::Mat& over_depth, double object_m) const;
  /// What was found, and what is next to it, is not looked at again.
  void leave_out(const std::vector<FlatObject>& objects);
  /// Depth pixels that are looked at.
  const cv::Mat& open_ground() const { return open_; }

 private:
  const cv::Mat& depth_;
  const cv::Mat& color_;
  const RgbdCamera& camera_;
  const FlatSurface& surface_;
  const FlatOptions& options_;
  cv::Mat open_;
};

void Search::leave_out(const std::vector<FlatObject>& objects) {
  if (objects.empty()) return;
  cv::Mat taken = cv::Mat::zeros(open_.size(), CV_8U);
  for (const FlatObject& object : objects)
    for (const int pixel : object.pixels) taken.ptr<unsigned char>()[pixel] = 255;
  cv::dilate(taken, taken, cv::Mat::ones(7, 7, CV_8U));
  open_.setTo(0, taken);
}

std::vector<FlatObject> Search::find(const cv::Mat& over_depth, double object_m) const {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const cv::Mat heights = seen_by_color(over_depth, camera_, surface_, nothing);
  const cv::Mat inside = seen_by_color(open_, camera_, surface_, 0);
  const cv::Mat low = heights < options_.table_m;
  const cv::Mat high = heights > object_m;
  const cv::Mat too_high = heights > options_.max_height_m;
  const FlatSeeds seeds = {low & inside, high & inside & ~too_high};
  if (cv::countNonZero(seeds.object) < 20) return {};
  const double noise = std::max(0.0015, 2 * std::min(options_.noise_m, pixel_noise(over_depth)));
  cv::Mat odds = color_log_odds(color_, seeds, options_.bins) +
                 height_log_odds(heights, options_.table_m, object_m, noise);
  cv::boxFilter(odds, odds, CV_32F, {3, 3});
  const cv::Moments moments = cv::moments(seeds.object, true);
  const cv::Point centre(static_cast<int>(moments.m10 / moments.m00),
                         static_cast<int>(moments.m01 / moments.m00));
  const double area = pixel_area(camera_, surface_, centre);
  const int reach = static_cast<int>(options_.reach_m / std::sqrt(area));
  cv::Mat near;
  cv::dilate(seeds.object, near,
             cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1}));
  cv::Mat mask = (odds > 0) & near & inside & ~too_high;
  const cv::Mat round = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, round);
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, round);

  cv::Mat labels;
  cv::Mat boxes;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, boxes, centres, 8);
  std::vector<FlatObject> objects;
  cv::Mat object_of(labels.size(), CV_32S, cv::Scalar(-1));
  for (int label = 1; label < count; ++label) {
    const cv::Rect box(boxes.at<int>(label, cv::CC_STAT_LEFT), boxes.at<int>(label, cv::CC_STAT_TOP),
                       boxes.at<int>(label, cv::CC_STAT_WIDTH), boxes.at<int>(label, cv::CC_STAT_HEIGHT));
    const cv::Mat own = labels(box) == label;
    const int pixels = boxes.at<int>(label, cv::CC_STAT_AREA);
    // Colour may carry an object on, but most of it has to be there.
    if (4 * cv::countNonZero(own & seeds.object(box)) < pixels) continue;
    const double scale = pixel_area(camera_, surface_, (box.tl() + box.br()) / 2);
    if (pixels * scale < options_.min_area_m2) continue;
    if (std::max(box.width, box.height) * std::sqrt(scale) > options_.max_extent_m) continue;
    object_of(box).setTo(static_cast<double>(objects.size()), own);
    objects.push_back({box, own, {}, 0});
  }
  assign_depth_pixels(depth_, over_depth, camera_, object_of, objects);
  return objects;
}

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
  if (depth.size() != sum_.size()) throw Error("pictures of different sizes cannot be averaged");
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

cv::Mat heights_over_surface(const cv::Mat& depth, const PinholeCamera& camera, const FlatSurface& surface,
                             const FlatOptions& options) {
  const cv::Mat heights = raw_heights(depth, camera, surface, options);
  return leveled(smoothed(heights, width_against(pixel_noise(heights), options)), camera, surface, options);
}

cv::Mat seen_by_color(const cv::Mat& picture, const RgbdCamera& camera, const FlatSurface& surface,
                      double outside) {
  cv::Mat columns(camera.color.height, camera.color.width, CV_32F);
  cv::Mat rows(columns.size(), CV_32F);
  const Vector3d& eye = camera.depth_from_color.translation();
  const double up = surface.offset - surface.normal.dot(eye);
  for (int v = 0; v < columns.rows; ++v)
    for (int u = 0; u < columns.cols; ++u) {
      const Vector3d ray = camera.depth_from_color.linear() * camera.color.unproject(u, v, 1);
      const Vector3d p = eye + up / surface.normal.dot(ray) * ray;
      const Vector2d at = p.z() > 0 ? camera.depth.project(p) : Vector2d(-10, -10);
      columns.at<float>(v, u) = static_cast<float>(at.x());
      rows.at<float>(v, u) = static_cast<float>(at.y());
    }
  cv::Mat result;
  cv::remap(picture, result, columns, rows, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(outside));
  return result;
}

std::vector<FlatObject> find_flat_objects(const cv::Mat& depth, const cv::Mat& color,
                                          const RgbdCamera& camera, const FlatSurface& surface,
                                          const FlatOptions& options) {
  const cv::Mat raw = raw_heights(depth, camera.depth, surface, options);
  const double noise = pixel_noise(raw);
  const cv::Mat smooth = smoothed(raw, width_against(noise, options));
  Search search{depth, color, camera, surface, options};
  std::vector<FlatObject> objects =
      search.find(leveled(smooth, camera.depth, surface, options), options.object_m);
  if (options.thin_m == 0) return objects;
  search.leave_out(objects);
  const bool calibrated = !surface.empty_depth.empty();
  const cv::Mat bent =
      calibrated ? smooth : over_bent_surface(smooth, camera.depth, surface.normal, surface.offset);
  for (FlatObject& thin : search.find(bent, options.thin_m))
    if (!thin.pixels.empty() &&
        rises_all_around(raw, thin.pixels, search.open_ground(),
                         least_step(depth, camera.depth, surface, thin.pixels, options)))
      objects.push_back(std::move(thin));
  return objects;
}

}  // namespace loci
