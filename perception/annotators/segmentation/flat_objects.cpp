#include "perception/annotators/segmentation/flat_objects.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/segmentation/flat_surface.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"
#include "perception/recognition/image_features.h"

namespace loci::perception {
namespace {

/// Which pixel of the depth camera shows what a pixel of the colour camera shows, for everything on one plane
/// (normal · p = offset, depth camera's frame): the homography that the plane induces. Flat objects on it
/// move by less than a pixel.
class PlaneRegistration {
 public:
  PlaneRegistration(const mapping::RgbdCamera& camera, const Vector3d& normal, double offset);

  /// An image of the depth camera as the colour camera would see it if it were painted on the plane (nearest
  /// pixel; `outside` where the depth image does not reach).
  cv::Mat seen_by_color(const cv::Mat& image, double outside) const;

 private:
  cv::Mat columns_, rows_;  ///< CV_32F, of the colour image's size
};

Eigen::Matrix3d intrinsics(const mapping::PinholeCamera& camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return k;
}

PlaneRegistration::PlaneRegistration(const mapping::RgbdCamera& camera, const Vector3d& normal, double offset)
    : columns_(camera.color.height, camera.color.width, CV_32F),
      rows_(camera.color.height, camera.color.width, CV_32F) {
  constexpr float kBeside = -10;
  const Vector3d& eye = camera.depth_from_color.translation();
  // A ray r from `eye` meets the plane in the direction of (normal · r) eye + up r.
  const Eigen::Matrix3d ray = camera.depth_from_color.linear() * intrinsics(camera.color).inverse();
  const Eigen::RowVector3d slope = normal.transpose() * ray;
  const Eigen::Matrix3d met = eye * slope + (offset - normal.dot(eye)) * ray;
  const Eigen::Matrix3d pixel = intrinsics(camera.depth) * met;
  for (int v = 0; v < columns_.rows; ++v) {
    const Vector3d start = pixel.col(1) * v + pixel.col(2);
    const double slope_start = slope[1] * v + slope[2];
    auto* column = columns_.ptr<float>(v);
    auto* row = rows_.ptr<float>(v);
    for (int u = 0; u < columns_.cols; ++u) {
      const double w = start.z() + pixel(2, 0) * u;
      const bool before = w * (slope_start + slope[0] * u) > 0;
      const double inverse = 1 / w;
      column[u] = before ? static_cast<float>((start.x() + pixel(0, 0) * u) * inverse) : kBeside;
      row[u] = before ? static_cast<float>((start.y() + pixel(1, 0) * u) * inverse) : kBeside;
    }
  }
}

cv::Mat PlaneRegistration::seen_by_color(const cv::Mat& image, double outside) const {
  cv::Mat result;
  cv::remap(image, result, columns_, rows_, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(outside));
  return result;
}

/// The pixels of the colour image that may show those of `box` of the depth image, some more included;
/// all of it when the box looks beside the plane.
cv::Rect box_in_color(const cv::Rect& box, const mapping::RgbdCamera& camera, const Vector3d& normal,
                      double offset) {
  constexpr int kMore = 20;  // What is higher than the plane is seen beside it.
  const cv::Rect all(0, 0, camera.color.width, camera.color.height);
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  double left = 1e9;
  double right = -1e9;
  double top = 1e9;
  double bottom = -1e9;
  for (const int u : {box.x, box.x + box.width})
    for (const int v : {box.y, box.y + box.height}) {
      const Vector3d ray = camera.depth.unproject(u, v, 1);
      const Vector3d p = color_from_depth * Vector3d(offset / normal.dot(ray) * ray);
      if (offset * normal.dot(ray) <= 0 || p.z() < 0.1) return all;
      const Vector2d at = camera.color.project(p);
      if (at.cwiseAbs().maxCoeff() > 1e5) return all;
      left = std::min(left, at.x());
      right = std::max(right, at.x());
      top = std::min(top, at.y());
      bottom = std::max(bottom, at.y());
    }
  const cv::Point low(static_cast<int>(left) - kMore, static_cast<int>(top) - kMore);
  const cv::Point high(static_cast<int>(right) + kMore, static_cast<int>(bottom) + kMore);
  return cv::Rect(low, high) & all;
}

/// The camera of a part of its image.
mapping::PinholeCamera cropped(const mapping::PinholeCamera& camera, const cv::Rect& box) {
  return {box.width, box.height, camera.fx, camera.fy, camera.cx - box.x, camera.cy - box.y};
}

/// What is certain by its height alone; CV_8U, of the colour image's size.
struct FlatSeeds {
  cv::Mat table;
  cv::Mat object;
};

constexpr float kMaxByColor = 4;
constexpr float kMaxByHeight = 3;

/// Shares of the pixels per bin of saturation (rows) and hue (columns), blurred so that the noise of the
/// colours does not matter.
cv::Mat histogram_of(const cv::Mat& bin_of, const cv::Mat& mask, int bins) {
  cv::Mat histogram = cv::Mat::zeros(bins, bins, CV_32F);
  auto* count = histogram.ptr<float>();
  for (int v = 0; v < bin_of.rows; ++v) {
    const auto* bin = bin_of.ptr<uint16_t>(v);
    const auto* in = mask.ptr<unsigned char>(v);
    for (int u = 0; u < bin_of.cols; ++u)
      if (in[u]) count[bin[u]] += 1;
  }
  // Hue is a circle.
  cv::Mat wrapped;
  cv::copyMakeBorder(histogram, wrapped, 0, 0, 3, 3, cv::BORDER_WRAP);
  cv::GaussianBlur(wrapped, wrapped, {5, 5}, 0.8);
  histogram = wrapped.colRange(3, 3 + bins).clone();
  return histogram / std::max(1.0, cv::sum(histogram)[0]);
}

/// Bin of each pixel of an image (CV_8UC3): saturation · bins + hue; CV_16U.
cv::Mat color_bins(const cv::Mat& color, int bins) {
  cv::Mat hsv;
  cv::GaussianBlur(color, hsv, {3, 3}, 0);
  cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV_FULL);
  cv::Mat bin_of(color.size(), CV_16U);
  for (int v = 0; v < color.rows; ++v) {
    const auto* pixel = hsv.ptr<cv::Vec3b>(v);
    auto* bin = bin_of.ptr<uint16_t>(v);
    for (int u = 0; u < color.cols; ++u)
      bin[u] = static_cast<uint16_t>(pixel[u][1] * bins / 256 * bins + pixel[u][0] * bins / 256);
  }
  return bin_of;
}

/// How much more likely a pixel's hue and saturation are among the object seeds than among the table seeds,
/// as a logarithm (histogram back-projection of both classes); CV_32F, within ±4. `bin_of`: color_bins().
cv::Mat color_log_odds(const cv::Mat& bin_of, const FlatSeeds& seeds, int bins) {
  const cv::Mat table = histogram_of(bin_of, seeds.table, bins);
  const cv::Mat object = histogram_of(bin_of, seeds.object, bins);
  // A colour that neither class has shown says nothing.
  const float unseen = 0.1f / static_cast<float>(bins * bins);
  std::vector<float> odds_of(static_cast<size_t>(bins * bins));
  for (size_t i = 0; i < odds_of.size(); ++i) {
    const float ratio = (object.ptr<float>()[i] + unseen) / (table.ptr<float>()[i] + unseen);
    odds_of[i] = std::clamp(std::log(ratio), -kMaxByColor, kMaxByColor);
  }
  cv::Mat odds(bin_of.size(), CV_32F);
  for (int v = 0; v < odds.rows; ++v)
    for (int u = 0; u < odds.cols; ++u) odds.ptr<float>(v)[u] = odds_of[bin_of.ptr<uint16_t>(v)[u]];
  return odds;
}

/// The same for a height, whose error has the standard deviation `noise` (metres): surfaces are below
/// `table_m`, objects above `object_m`. Within ±3, and 0 where there is none.
cv::Mat height_log_odds(const cv::Mat& heights, double table_m, double object_m, double noise) {
  const auto middle = static_cast<float>((table_m + object_m) / 2);
  // Two normal distributions, as far apart as an object at the limit and the surface itself.
  const auto slope = static_cast<float>(2 * middle / (noise * noise));
  cv::Mat odds(heights.size(), CV_32F);
  for (int v = 0; v < odds.rows; ++v)
    for (int u = 0; u < odds.cols; ++u) {
      const float height = heights.ptr<float>(v)[u];
      odds.ptr<float>(v)[u] =
          std::isnan(height) ? 0 : std::clamp(slope * (height - middle), -kMaxByHeight, kMaxByHeight);
    }
  return odds;
}

/// The two stages of find_flat_objects() over one image, and over what is left of it.
class FlatSearch {
 public:
  FlatSearch(const cv::Mat& depth, const cv::Mat& color, const mapping::RgbdCamera& camera,
             const FlatSurface& surface, const FlatOptions& options);

  /// Objects of which at least a quarter is higher than `object_m`, with the pixels of both images.
  /// `heights`: over the surface, CV_32F, metres, of the depth image.
  std::vector<FlatObject> find(const cv::Mat& heights, double object_m) const;
  /// What was found, and what is next to it, is not looked at again.
  void leave_out(const std::vector<FlatObject>& objects);
  /// Depth pixels that are looked at, CV_8U.
  const cv::Mat& open_ground() const { return open_; }
  /// The same in the colour image.
  cv::Mat ground_in_color() const { return registration_.seen_by_color(open_, 0); }

 private:
  double pixel_area(const cv::Point& pixel) const;
  cv::Mat near(const cv::Mat& seeds) const;
  void assign_depth_pixels(const cv::Mat& heights, const cv::Mat& object_of_color,
                           std::vector<FlatObject>& objects) const;

  const cv::Mat& depth_;
  const mapping::RgbdCamera& camera_;
  const FlatSurface& surface_;
  const FlatOptions& options_;
  PlaneRegistration registration_;
  cv::Mat bin_of_color_;
  cv::Mat open_;
};

FlatSearch::FlatSearch(const cv::Mat& depth, const cv::Mat& color, const mapping::RgbdCamera& camera,
                       const FlatSurface& surface, const FlatOptions& options)
    : depth_(depth),
      camera_(camera),
      surface_(surface),
      options_(options),
      registration_(camera, surface.normal, surface.offset),
      bin_of_color_(color_bins(color, options.bins)),
      open_(surface.inside.clone()) {}

/// What the plane's normal and depth make of one pixel of the colour image, m².
double FlatSearch::pixel_area(const cv::Point& pixel) const {
  const Vector3d ray = camera_.depth_from_color.linear() * camera_.color.unproject(pixel.x, pixel.y, 1);
  const double slope = std::abs(surface_.normal.dot(ray));
  const Vector3d& eye = camera_.depth_from_color.translation();
  const double z = std::abs(surface_.offset - surface_.normal.dot(eye)) / std::max(1e-6, slope);
  return z * z / (camera_.color.fx * camera_.color.fy) / std::max(0.05, slope);
}

/// Where colour may carry an object on.
cv::Mat FlatSearch::near(const cv::Mat& seeds) const {
  const cv::Moments moments = cv::moments(seeds, true);
  const cv::Point centre(static_cast<int>(moments.m10 / moments.m00),
                         static_cast<int>(moments.m01 / moments.m00));
  const int width = 2 * static_cast<int>(options_.reach_m / std::sqrt(pixel_area(centre))) + 1;
  cv::Mat reached;
  cv::dilate(seeds, reached, cv::getStructuringElement(cv::MORPH_RECT, {width, width}));
  return reached;
}

void FlatSearch::leave_out(const std::vector<FlatObject>& objects) {
  if (objects.empty()) return;
  cv::Mat taken = cv::Mat::zeros(open_.size(), CV_8U);
  for (const FlatObject& object : objects)
    for (const int pixel : object.pixels) taken.ptr<unsigned char>()[pixel] = 255;
  cv::dilate(taken, taken, cv::Mat::ones(7, 7, CV_8U));
  open_.setTo(0, taken);
}

std::vector<FlatObject> FlatSearch::find(const cv::Mat& over_depth, double object_m) const {
  const cv::Mat heights = registration_.seen_by_color(over_depth, std::numeric_limits<double>::quiet_NaN());
  const cv::Mat inside = registration_.seen_by_color(open_, 0);
  const cv::Mat low = heights < options_.table_m;
  const cv::Mat high = heights > object_m;
  const cv::Mat too_high = heights > options_.max_height_m;
  const FlatSeeds seeds = {low & inside, high & inside & ~too_high};
  if (cv::countNonZero(seeds.object) < 20) return {};
  const double noise = std::max(0.0015, 2 * std::min(options_.noise_m, pixel_noise(over_depth)));
  cv::Mat odds = color_log_odds(bin_of_color_, seeds, options_.bins) +
                 height_log_odds(heights, options_.table_m, object_m, noise);
  cv::boxFilter(odds, odds, CV_32F, {3, 3});
  cv::Mat mask = (odds > 0) & near(seeds.object) & inside & ~too_high;
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
    const int pixels = boxes.at<int>(label, cv::CC_STAT_AREA);
    const double scale = pixel_area((box.tl() + box.br()) / 2);
    if (pixels * scale < options_.min_area_m2) continue;
    if (std::max(box.width, box.height) * std::sqrt(scale) > options_.max_extent_m) continue;
    // Colour may carry an object on, but most of it has to be there.
    const cv::Mat own = labels(box) == label;
    if (4 * cv::countNonZero(own & seeds.object(box)) < pixels) continue;
    object_of(box).setTo(static_cast<double>(objects.size()), own);
    objects.push_back({box, own, {}, 0});
  }
  assign_depth_pixels(over_depth, object_of, objects);
  return objects;
}

/// The objects' depth pixels: those that fall into an object's mask in the colour image.
void FlatSearch::assign_depth_pixels(const cv::Mat& heights, const cv::Mat& object_of_color,
                                     std::vector<FlatObject>& objects) const {
  if (objects.empty()) return;
  const Isometry3d color_from_depth = camera_.depth_from_color.inverse();
  std::vector<std::vector<float>> over(objects.size());
  for (int v = 0; v < depth_.rows; ++v)
    for (int u = 0; u < depth_.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const Vector3d p =
          color_from_depth * camera_.depth.unproject(u, v, static_cast<double>(depth_.at<float>(v, u)));
      if (p.z() <= 0) continue;
      const Vector2d at = camera_.color.project(p);
      if (!camera_.color.contains(at)) continue;
      const int object =
          object_of_color.at<int>(static_cast<int>(at.y() + 0.5), static_cast<int>(at.x() + 0.5));
      if (object < 0) continue;
      objects[static_cast<size_t>(object)].pixels.push_back(v * depth_.cols + u);
      over[static_cast<size_t>(object)].push_back(heights.at<float>(v, u));
    }
  for (size_t i = 0; i < objects.size(); ++i)
    if (!over[i].empty()) objects[i].height = static_cast<double>(median(over[i]));
}

/// Noise of the height over a surface that one pixel measures, metres.
double height_noise(const cv::Mat& depth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                    const cv::Point& pixel) {
  const double slope = std::abs(surface.normal.dot(camera.unproject(pixel.x, pixel.y, 1)));
  return slope * depth_noise(static_cast<double>(depth.at<float>(pixel)));
}

/// A step in height that the sensor tells from steps of its disparity, metres: one and a half of them.
double min_step(const cv::Mat& depth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                const std::vector<int>& pixels, const FlatOptions& options) {
  constexpr double kNoises = 3;
  const int middle = pixels[pixels.size() / 2];
  return std::max(options.step_m,
                  kNoises * height_noise(depth, camera, surface, {middle % depth.cols, middle / depth.cols}));
}

/// What is certainly above a surface, metres: noise lifts few pixels so high.
double certain_height(const cv::Mat& depth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                      const FlatOptions& options) {
  constexpr double kNoises = 2.5;
  std::vector<double> noises;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      if (surface.inside.at<unsigned char>(v, u) != 0 && !std::isnan(depth.at<float>(v, u)))
        noises.push_back(height_noise(depth, camera, surface, {u, v}));
  return noises.empty() ? options.object_m : std::max(options.object_m, kNoises * median(noises));
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

constexpr int kClusterMargin = 5;  ///< pixels beside a cluster show a bit of both

void add_cluster(const FlatObject& object, const types::PlanarSupport& support, const types::SceneCas& scene,
                 const Isometry3d& pose) {
  const auto cluster = types::Cluster::create(scene.cas());
  set_points(cluster, FlatObjectExtractor::kName, object.pixels, scene, pose);
  add_image(cluster, FlatObjectExtractor::kName, {object.box, object.mask}, scene);
  const cv::Size image = cloud_points(scene).size();
  cluster.at_image_border.set(is_at_image_border(box_of(object.pixels, image), image));
  cluster.at_support_border.set(false);
  cluster.partly_hidden.set(false);
  cluster.support.set(support);
  scene.add_cluster(cluster);
}

/// Clusters as a flat object sees its neighbours.
class Neighbours {
 public:
  Neighbours(const std::vector<std::vector<int>>& clusters, const cv::Mat& depth, const cv::Mat& color,
             const mapping::RgbdCamera& camera)
      : depth_(depth),
        color_(color),
        camera_(camera),
        clusters_(clusters),
        cluster_of_(depth.size(), CV_32S, cv::Scalar(-1)) {
    for (size_t cluster = 0; cluster < clusters.size(); ++cluster)
      for (const int pixel : clusters[cluster]) cluster_of_.ptr<int>()[pixel] = static_cast<int>(cluster);
  }

  bool is_part_of_one(const FlatObject& object) const {
    constexpr double kMinShare = 0.3;
    const auto [cluster, share] = longest_contact(object.pixels);
    return share > kMinShare && same_color(object.pixels, clusters_[cluster]);
  }

 private:
  /// The cluster along which most of an outline runs, and that share of it.
  std::pair<size_t, double> longest_contact(const std::vector<int>& object) const {
    constexpr int kReach = 2 * kClusterMargin;
    cv::Mat own = cv::Mat::zeros(depth_.size(), CV_8U);
    for (const int pixel : object) own.ptr<unsigned char>()[pixel] = 1;
    std::vector<int> contact(clusters_.size());
    int outline = 0;
    const cv::Rect image({}, depth_.size());
    for (const int pixel : object) {
      const cv::Point here(pixel % depth_.cols, pixel / depth_.cols);
      for (const cv::Point& step : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)}) {
        if (!image.contains(here + step) || own.at<unsigned char>(here + step)) continue;
        ++outline;
        for (int far = 1; far <= kReach && image.contains(here + far * step); ++far) {
          const int cluster = cluster_of_.at<int>(here + far * step);
          if (cluster < 0) continue;
          ++contact[static_cast<size_t>(cluster)];
          break;
        }
      }
    }
    const auto most = std::ranges::max_element(contact);
    if (most == contact.end() || outline == 0) return {};
    return {static_cast<size_t>(most - contact.begin()), static_cast<double>(*most) / outline};
  }

  bool same_color(const std::vector<int>& a, const std::vector<int>& b) const {
    constexpr double kMaxChroma = 15;
    constexpr double kMaxLightness = 50;  // surfaces that face another way are brighter or darker
    const cv::Vec3d apart = mean_lab(a) - mean_lab(b);
    return std::hypot(apart[1], apart[2]) < kMaxChroma && std::abs(apart[0]) < kMaxLightness;
  }

  /// Mean colour of pixels of the depth image, CIELAB as OpenCV has it in 8 bits.
  cv::Vec3d mean_lab(const std::vector<int>& pixels) const {
    const Isometry3d color_from_depth = camera_.depth_from_color.inverse();
    cv::Mat seen(0, 1, CV_8UC3);
    for (const int pixel : pixels) {
      const auto z = static_cast<double>(depth_.ptr<float>()[pixel]);
      if (std::isnan(z)) continue;
      const Vector3d p =
          color_from_depth * camera_.depth.unproject(pixel % depth_.cols, pixel / depth_.cols, z);
      if (p.z() <= 0) continue;
      const Vector2d at = camera_.color.project(p);
      if (camera_.color.contains(at))
        seen.push_back(color_.at<cv::Vec3b>(static_cast<int>(at.y() + 0.5), static_cast<int>(at.x() + 0.5)));
    }
    if (seen.empty()) return {};
    const cv::Scalar mean = cv::mean(lab_of(seen));
    return {mean[0], mean[1], mean[2]};
  }

  const cv::Mat& depth_;
  const cv::Mat& color_;
  const mapping::RgbdCamera& camera_;
  const std::vector<std::vector<int>>& clusters_;
  cv::Mat cluster_of_;  ///< CV_32S, index by pixel of the depth image, -1 = none
};

}  // namespace

bool is_part_of_cluster(const FlatObject& object, const std::vector<std::vector<int>>& clusters,
                        const cv::Mat& depth, const cv::Mat& color, const mapping::RgbdCamera& camera) {
  return Neighbours(clusters, depth, color, camera).is_part_of_one(object);
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
  const SurfaceHeights heights = measure_heights(part.depth, part.camera.depth, part.surface, options);
  FlatSearch search(part.depth, part.color, part.camera, part.surface, options);
  std::vector<FlatObject> objects =
      search.find(heights.uneven, certain_height(part.depth, part.camera.depth, part.surface, options));
  search.leave_out(objects);
  const auto rises = [&](const FlatObject& object) {
    return !object.pixels.empty() &&
           rises_all_around(heights.raw, object.pixels, search.open_ground(),
                            min_step(part.depth, part.camera.depth, surface, object.pixels, options));
  };
  // Neighbouring pixels share the noise of their depth: what is as high as an object for a few centimetres
  // may be nothing else, unless it looks different, too.
  const cv::Mat ground = search.ground_in_color();
  std::erase_if(objects, [&](const FlatObject& object) {
    return color_contrast(part.color, object.box, object.mask, ground) < options.min_contrast &&
           !rises(object);
  });
  if (options.thin_m > 0)
    for (FlatObject& thin : search.find(heights.bent, options.thin_m))
      if (rises(thin)) objects.push_back(std::move(thin));
  for (FlatObject& object : objects) part.to_whole(object, depth.cols);
  return objects;
}

AnnotatorDescriptor FlatObjectExtractor::descriptor() const {
  return {FlatObjectExtractor::kName,
          "Finds flat objects on supports by height and colour.",
          {"Scene", "CameraInfo", "view:depth", "view:color", "view:cloud", "PlanarSupport"},
          {"Cluster", "ReferenceClusterPoints", "StandaloneImageROI"},
          {"Cluster"}};
}

void FlatObjectExtractor::declare(OptionTable& table) {
  options_.declare(table);
  table.text("calibration", calibration_,
             "Image of the empty surface for a static camera, written by `loci-perceive surface`.");
}

void FlatObjectExtractor::start(Context& /*context*/) {
  if (!calibration_.empty()) empty_depth_ = read_surface(calibration_);
}

void FlatObjectExtractor::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  if (!scene.scene().map_from_camera.is_set() || !scene.has(types::SceneCas::kColor)) {
    scene.log(FlatObjectExtractor::kName, "info", "flat objects need a pose and a colour image");
    return;
  }
  const Isometry3d pose = map_from_camera(scene.scene());
  const mapping::RgbdCamera camera = types::cameras(scene);
  const cv::Mat depth = types::view_image(scene, types::SceneCas::kDepth);
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor);
  if (!empty_depth_.empty() && empty_depth_.size() != depth.size())
    throw Error("the empty surface is not as large as the depth image", {calibration_, 0, {}},
                "make it from a recording of the same camera");
  cv::Mat taken = pixels_of_clusters(scene, depth.size(), kClusterMargin);
  std::vector<std::vector<int>> clusters;
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto indices = cluster_indices(cluster);
    clusters.emplace_back(indices.begin(), indices.end());
  }
  const cv::Mat points = cloud_points(scene);
  const cv::Mat map_depth = scene.has(kMapDepthView) ? types::view_image(scene, kMapDepthView) : cv::Mat();
  const cv::Mat bare = scene.has(kBareView) ? types::view_image(scene, kBareView) : cv::Mat();
  size_t found = 0;
  for (const types::PlanarSupport& support : scene.supports()) {
    FlatSurface surface;
    std::tie(surface.normal, surface.offset) = plane_in_camera(support, pose);
    surface.inside = pixels_over(support, pose.inverse(), camera.depth) & ~taken;
    if (!map_depth.empty() && !bare.empty())
      leave_out_what_the_map_shows(map_depth, bare, surface.normal, surface.offset, camera.depth,
                                   surface.inside);
    surface.empty_depth = empty_depth_;
    for (FlatObject& object : find_flat_objects(depth, color, camera, surface, options_)) {
      // The points of people and robots were taken out of the cloud, most often not to the last pixel.
      const size_t measured = object.pixels.size();
      std::erase_if(object.pixels, [&](int pixel) { return std::isnan(points.ptr<cv::Vec3f>()[pixel][2]); });
      if (2 * object.pixels.size() < measured) continue;
      if (object.pixels.empty() || is_part_of_cluster(object, clusters, depth, color, camera)) continue;
      add_cluster(object, support, scene, pose);
      // Of two supports that overlap in the image one has it.
      for (const int pixel : object.pixels) taken.ptr<unsigned char>()[pixel] = 255;
      ++found;
    }
  }
  scene.log(FlatObjectExtractor::kName, "info", fmt::format("{} flat objects", found));
}

}  // namespace loci::perception
