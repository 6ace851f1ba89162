#include "mapping/orthophoto/orthophoto.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/orthophoto/face_points.h"
#include "mapping/orthophoto/parameters.h"

namespace loci::mapping {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// How well a camera sees a place of the face: pixels per metre across the view, squared, times the cosine;
/// 0 = not.
double view_quality(const RgbdCamera& camera, const Isometry3d& camera_from_face, const Vector3d& place) {
  const Vector3d at = camera_from_face * place;
  if (at.z() < 0.1 || at.z() > kPhoto.max_range_m || !camera.depth.contains(camera.depth.project(at)))
    return 0;
  const Vector3d in_color = camera.depth_from_color.inverse() * at;
  if (in_color.z() < 0.1 || !camera.color.contains(camera.color.project(in_color))) return 0;
  const double cosine = -(camera_from_face.linear().col(2)).dot(at.normalized());
  if (cosine < kPhoto.min_cosine) return 0;
  return cosine / (at.z() * at.z());
}

/// A frame that may be used, by its pose alone.
struct Candidate {
  size_t number = 0;
  Isometry3d face_from_camera = Isometry3d::Identity();
};

/// Where the plane is for a frame: depth = offset + tilt_u · (u − mean_u) + tilt_v · (v − mean_v), and a
/// shift in the plane.
struct Correction {
  double offset = 0, tilt_u = 0, tilt_v = 0, mean_u = 0, mean_v = 0;
  Vector2d shift = Vector2d::Zero();  ///< the frame shows at (u, v) + shift what is at (u, v)
  double depth(double u, double v) const { return offset + tilt_u * (u - mean_u) + tilt_v * (v - mean_v); }
};

/// The plane through most points of a frame near the face: the median, then least squares within narrowing
/// limits. Unset with too few.
std::optional<Correction> plane_of(const std::vector<FacePoint>& points) {
  if (points.size() < kPhoto.min_fit_points) return std::nullopt;
  Correction plane;
  std::vector<double> depths;
  for (const FacePoint& point : points) depths.push_back(point.depth);
  plane.offset = median(std::move(depths));
  for (const double reach : {1.0, 1.0, 0.7, 0.5, 0.5}) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    const auto near = [&](const FacePoint& point) {
      return std::abs(point.depth - plane.depth(point.u, point.v)) < reach * kPhoto.fit_reach_m;
    };
    std::vector<const FacePoint*> inliers;
    for (const FacePoint& point : points)
      if (near(point)) inliers.push_back(&point), sum += Vector3d(point.u, point.v, point.depth), ++count;
    if (inliers.size() < kPhoto.min_fit_points) return std::nullopt;
    const Vector3d mean = sum / count;
    Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
    Vector2d with_depth = Vector2d::Zero();
    for (const FacePoint* point : inliers) {
      const Vector2d d(point->u - mean.x(), point->v - mean.y());
      products += d * d.transpose();
      with_depth += d * (point->depth - mean.z());
    }
    // An axis along which the frame sees little keeps its direction.
    const Eigen::Matrix2d prior = Eigen::Matrix2d::Identity() * (count * kPhoto.min_spread_m2);
    const Vector2d tilt = (products + prior).ldlt().solve(with_depth);
    plane = {mean.z(),
             std::clamp(tilt.x(), -kPhoto.max_tilt, kPhoto.max_tilt),
             std::clamp(tilt.y(), -kPhoto.max_tilt, kPhoto.max_tilt),
             mean.x(),
             mean.y(),
             Vector2d::Zero()};
  }
  if (std::abs(plane.offset) > kPhoto.max_drift_m) return std::nullopt;
  return plane;
}

/// Mean squared difference of neighbouring pixels: blurred images have little.
double sharpness_of(const cv::Mat& color, const cv::Mat& mask) {
  cv::Mat grey, edges;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  cv::Laplacian(grey, edges, CV_32F);
  return cv::norm(edges, cv::NORM_L1, mask) / std::max(1, cv::countNonZero(mask));
}

class Photographer {
 public:
  Photographer(const Recording& recording, const std::vector<std::optional<Isometry3d>>& map_from_camera,
               const FurnitureFace& face, int threads)
      : recording_(recording), map_from_camera_(map_from_camera), threads_(threads) {
    photo_.face = face;
    photo_.pixel_m = kPhoto.pixel_m;
    photo_.u0 = face.u_min - kPhoto.margin_m;
    photo_.v0 = std::max(face.v_min - kPhoto.margin_m, 0.0);
    size_ = {static_cast<int>(std::ceil((face.u_max + kPhoto.margin_m - photo_.u0) / kPhoto.pixel_m)),
             static_cast<int>(std::ceil((face.v_max + kPhoto.margin_m - photo_.v0) / kPhoto.pixel_m))};
    photo_.color = cv::Mat::zeros(size_, CV_8UC3);
  }

  Orthophoto run() {
    choose_frames();
    views_.resize(candidates_.size());
    parallel_each(candidates_.size(), threads_, [&](size_t i) { read(i, views_[i]); });
    std::erase_if(views_, [](const PhotoView& view) { return view.quality.empty(); });
    equalise();
    fuse();
    for (int round = 0; round < kPhoto.align_rounds; ++round) {
      align();
      fuse();
    }
    for (const PhotoView& view : views_) photo_.frames.push_back(view.frame);
    for (const double depth : kPhoto.layers_m) photo_.layers.push_back(layer(depth));
    for (PhotoView& view : views_) view.relief.release();
    photo_.views = std::move(views_);
    straighten();
    return std::move(photo_);
  }

 private:
  /// Numbers of the frames that show each place of the face best.
  std::vector<std::vector<size_t>> best_views(const std::vector<Candidate>& all) const {
    const FurnitureFace& face = photo_.face;
    std::vector<std::vector<size_t>> best;
    for (double u = face.u_min; u <= face.u_max; u += kPhoto.probe_m)
      for (double v = face.v_min; v <= face.v_max; v += kPhoto.probe_m) {
        std::vector<std::pair<double, size_t>> views;
        for (size_t i = 0; i < all.size(); ++i) {
          const double quality =
              view_quality(recording_.info().camera, all[i].face_from_camera.inverse(), {u, v, 0});
          if (quality > 0) views.emplace_back(-quality, i);
        }
        std::sort(views.begin(), views.end());
        views.resize(std::min(kPhoto.frames_per_probe, views.size()));
        best.emplace_back();
        for (const auto& [quality, i] : views) best.back().push_back(i);
      }
    return best;
  }

  /// One by one the frames that show most places best. Places count less the more frames are chosen of them:
  /// in a video, where many show the same, none is left without.
  void choose_frames() {
    std::vector<Candidate> all;
    for (size_t i = 0; i < map_from_camera_.size(); ++i)
      if (const auto& pose = map_from_camera_[i]) all.push_back({i, face_from_camera(photo_.face, *pose)});
    const std::vector<std::vector<size_t>> best = best_views(all);
    std::vector<double> shown(best.size(), 0);
    std::vector<bool> is_chosen(all.size(), false);
    while (candidates_.size() < kPhoto.max_frames) {
      std::vector<double> gains(all.size(), 0);
      for (size_t place = 0; place < best.size(); ++place)
        for (const size_t i : best[place])
          if (!is_chosen[i]) gains[i] += 1 / (1 + shown[place]);
      const auto most = std::max_element(gains.begin(), gains.end());
      if (most == gains.end() || *most == 0) break;
      const auto next = static_cast<size_t>(most - gains.begin());
      is_chosen[next] = true;
      candidates_.push_back(all[next]);
      for (size_t place = 0; place < best.size(); ++place)
        shown[place] += static_cast<double>(std::count(best[place].begin(), best[place].end(), next));
    }
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.number < b.number; });
  }

  void read(size_t i, PhotoView& view) const {
    const RgbdFrame frame = recording_.frame(candidates_[i].number);
    if (frame.color.empty() || frame.depth.empty()) return;
    const Isometry3d& pose = candidates_[i].face_from_camera;
    const std::optional<Correction> plane = plane_of(points_near(frame, pose, photo_.face));
    if (!plane) return;
    view = project(frame, pose, *plane);
    view.frame = candidates_[i].number;
    view.ground = {plane->depth(0, 0), plane->tilt_u, plane->tilt_v};
  }

  /// The frame as seen through the plane.
  PhotoView project(const RgbdFrame& frame, const Isometry3d& face_from_camera,
                    const Correction& plane) const {
    PhotoView result;
    result.camera = face_from_camera * frame.camera.depth_from_color.translation();
    const double distance = face_from_camera.translation().z();
    result.relief = cv::Mat(size_, CV_32F, cv::Scalar(kNaN));
    result.quality = cv::Mat::zeros(size_, CV_32F);
    cv::Mat map(size_, CV_32FC2, cv::Scalar(-10, -10));
    const Isometry3d camera_from_face = face_from_camera.inverse();
    const Isometry3d color_from_depth = frame.camera.depth_from_color.inverse();
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) {
        const double u = photo_.u0 + (x + 0.5) * photo_.pixel_m;
        const double v = photo_.v0 + (size_.height - y - 0.5) * photo_.pixel_m;
        const Vector3d place(u, v, plane.depth(u, v));
        const double quality = view_quality(frame.camera, camera_from_face, place);
        if (quality <= 0) continue;
        const Vector3d at = camera_from_face * place;
        const Vector2d pixel = frame.camera.depth.project(at);
        const auto z = static_cast<double>(
            frame.depth.at<float>(static_cast<int>(pixel.y() + 0.5), static_cast<int>(pixel.x() + 0.5)));
        double weight = kPhoto.unmeasured_weight;
        if (z > 0) {
          // Along the ray by the factor z / at.z(): the distance from the camera's to the plane shrinks
          // alike.
          const double relief = (distance - place.z()) * (1 - z / at.z());
          if (relief > kPhoto.before_m) continue;
          result.relief.at<float>(y, x) = static_cast<float>(relief);
          if (relief < -kPhoto.behind_m) continue;
          weight = 1;
        }
        result.quality.at<float>(y, x) = static_cast<float>(weight * quality);
        const Vector2d color = frame.camera.color.project(color_from_depth * at);
        map.at<cv::Vec2f>(y, x) = {static_cast<float>(color.x()), static_cast<float>(color.y())};
      }
    cv::remap(frame.color, result.color, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    const cv::Mat seen = result.quality > 0;
    result.quality *= sharpness_of(result.color, seen);
    return result;
  }

  /// Removes differences of exposure and white balance: a gain per frame and channel.
  void equalise() {
    fuse();
    for (PhotoView& view : views_) {
      cv::Scalar gain(1, 1, 1);
      for (int channel = 0; channel < 3; ++channel) {
        std::vector<float> ratios;
        for (int y = 0; y < size_.height; y += 3)
          for (int x = 0; x < size_.width; x += 3) {
            const float own = view.color.at<cv::Vec3b>(y, x)[channel];
            const float all = photo_.color.at<cv::Vec3b>(y, x)[channel];
            if (view.quality.at<float>(y, x) > 0 && own > 5 && own < 250 && all > 5 && all < 250)
              ratios.push_back(all / own);
          }
        if (ratios.size() > kPhoto.min_fit_points)
          gain[channel] = static_cast<double>(median(std::move(ratios)));
      }
      cv::multiply(view.color, gain, view.color);
    }
  }

  static cv::Mat gradients(const cv::Mat& color) {
    cv::Mat grey, dx, dy, strength;
    cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
    cv::resize(grey, grey, {}, 1.0 / kPhoto.align_step_px, 1.0 / kPhoto.align_step_px, cv::INTER_AREA);
    grey.convertTo(grey, CV_32F);
    cv::Sobel(grey, dx, CV_32F, 1, 0);
    cv::Sobel(grey, dy, CV_32F, 0, 1);
    std::vector<cv::Mat> parts = {dx, dy};
    cv::merge(parts, strength);
    return strength;
  }

  /// Correlation of two gradient images where both are seen, the second shifted.
  static double correlation(const cv::Mat& a, const cv::Mat& seen_a, const cv::Mat& b, const cv::Mat& seen_b,
                            int dx, int dy, int& overlap) {
    double ab = 0, aa = 0, bb = 0;
    overlap = 0;
    for (int y = std::max(0, -dy); y < std::min(a.rows, a.rows - dy); ++y) {
      const auto* ra = a.ptr<cv::Vec2f>(y);
      const auto* rb = b.ptr<cv::Vec2f>(y + dy);
      const auto* sa = seen_a.ptr<uint8_t>(y);
      const auto* sb = seen_b.ptr<uint8_t>(y + dy);
      for (int x = std::max(0, -dx); x < std::min(a.cols, a.cols - dx); ++x) {
        if (sa[x] == 0 || sb[x + dx] == 0) continue;
        const cv::Vec2f& p = ra[x];
        const cv::Vec2f& q = rb[x + dx];
        ab += static_cast<double>(p.dot(q));
        aa += static_cast<double>(p.dot(p));
        bb += static_cast<double>(q.dot(q));
        ++overlap;
      }
    }
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
  }

  static cv::Mat seen_mask(const cv::Mat& weight) {
    cv::Mat seen = weight > 0;
    cv::erode(seen, seen, cv::Mat::ones(5, 5, CV_8U));
    cv::resize(seen, seen, {}, 1.0 / kPhoto.align_step_px, 1.0 / kPhoto.align_step_px, cv::INTER_NEAREST);
    return seen;
  }

  /// Shifts each frame in the plane to where its edges fit those of all.
  void align() {
    const cv::Mat all = gradients(photo_.color);
    const cv::Mat seen_all = seen_mask(photo_.weight);
    const double step = photo_.pixel_m * kPhoto.align_step_px;
    const int reach = static_cast<int>(kPhoto.max_shift_m / step);
    const auto min_overlap = static_cast<int>(kPhoto.min_overlap_m2 / (step * step));
    parallel_each(views_.size(), threads_, [&](size_t i) {
      PhotoView& view = views_[i];
      const cv::Mat own = gradients(view.color);
      const cv::Mat seen = seen_mask(view.quality);
      cv::Mat scores(2 * reach + 1, 2 * reach + 1, CV_64F, cv::Scalar(0));
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          int overlap = 0;
          const double score = correlation(all, seen_all, own, seen, dx, dy, overlap);
          if (overlap > min_overlap) scores.at<double>(dy + reach, dx + reach) = score;
        }
      double best = 0;
      cv::Point at;
      cv::minMaxLoc(scores, nullptr, &best, nullptr, &at);
      if (best < kPhoto.min_correlation || at.x == 0 || at.y == 0 || at.x == 2 * reach || at.y == 2 * reach)
        return;
      const auto vertex = [&](double low, double high) {
        const double curvature = 2 * best - low - high;
        return curvature > 1e-9 ? std::clamp(0.5 * (high - low) / curvature, -0.5, 0.5) : 0.0;
      };
      const double dx =
          at.x - reach + vertex(scores.at<double>(at.y, at.x - 1), scores.at<double>(at.y, at.x + 1));
      const double dy =
          at.y - reach + vertex(scores.at<double>(at.y - 1, at.x), scores.at<double>(at.y + 1, at.x));
      shift(view, dx * kPhoto.align_step_px, dy * kPhoto.align_step_px);
    });
  }

  void shift(PhotoView& view, double dx, double dy) const {
    view.camera.x() -= dx * photo_.pixel_m;
    view.camera.y() += dy * photo_.pixel_m;
    const cv::Mat by = (cv::Mat_<double>(2, 3) << 1, 0, dx, 0, 1, dy);
    const auto warp = [&](cv::Mat& image, int interpolation, const cv::Scalar& border) {
      cv::Mat moved;
      cv::warpAffine(image, moved, by, image.size(), interpolation | cv::WARP_INVERSE_MAP,
                     cv::BORDER_CONSTANT, border);
      image = moved;
    };
    warp(view.color, cv::INTER_LINEAR, {});
    warp(view.quality, cv::INTER_NEAREST, {});
    warp(view.relief, cv::INTER_NEAREST, cv::Scalar(kNaN));
  }

  void fuse() {
    photo_.weight = cv::Mat::zeros(size_, CV_32F);
    photo_.ground = cv::Mat::zeros(size_, CV_32F);
    photo_.relief = cv::Mat(size_, CV_32F, cv::Scalar(kNaN));
    photo_.relief_sd = cv::Mat(size_, CV_32F, cv::Scalar(kNaN));
    photo_.slope = cv::Mat::zeros(size_, CV_32FC2);
    photo_.slope_sd = cv::Mat::zeros(size_, CV_32FC2);
    parallel_for(static_cast<size_t>(size_.height), threads_, [&](size_t begin, size_t end) {
      std::vector<std::pair<float, float>> samples;  // Value and weight.
      for (size_t y = begin; y < end; ++y)
        for (int x = 0; x < size_.width; ++x) fuse_pixel(static_cast<int>(y), x, samples);
    });
  }

  /// Level and upright edges of the face, summed along lines that lean by an angle: sharp for the angle at
  /// which most lines lean.
  double straightness(const cv::Mat& edges, double angle) const {
    cv::Mat turned, sums;
    cv::warpAffine(edges, turned, turn(edges.size(), angle), edges.size());
    std::array<cv::Mat, 2> parts;
    cv::split(turned, parts.data());
    cv::reduce(parts[0], sums, 0, cv::REDUCE_SUM);
    double score = sums.dot(sums);
    cv::reduce(parts[1], sums, 1, cv::REDUCE_SUM);
    return score + sums.dot(sums);
  }

  static cv::Mat turn(const cv::Size& size, double angle) {
    const cv::Point2f middle(static_cast<float>(size.width - 1) / 2, static_cast<float>(size.height - 1) / 2);
    return cv::getRotationMatrix2D(middle, angle / kDegree, 1);
  }

  void straighten() {
    cv::Mat edges = gradients(photo_.color);
    cv::Mat face = cv::abs(photo_.relief) < kPhoto.behind_m;
    cv::erode(face, face, cv::Mat::ones(5, 5, CV_8U));
    cv::resize(face, face, edges.size(), 0, 0, cv::INTER_NEAREST);
    edges.setTo(cv::Scalar::all(0), face == 0);
    double best = kPhoto.min_roll_gain * straightness(edges, 0);
    for (int step = -kPhoto.roll_steps; step <= kPhoto.roll_steps; ++step) {
      const double angle = step * kPhoto.roll_step;
      if (const double score = straightness(edges, angle); score > best) best = score, photo_.roll = angle;
    }
    if (photo_.roll == 0) return;
    const cv::Mat by = turn(size_, photo_.roll);
    const auto warp = [&](cv::Mat& image, int interpolation, const cv::Scalar& border) {
      cv::Mat turned;
      cv::warpAffine(image, turned, by, image.size(), interpolation, cv::BORDER_CONSTANT, border);
      image = turned;
    };
    warp(photo_.color, cv::INTER_LINEAR, {});
    warp(photo_.weight, cv::INTER_NEAREST, {});
    warp(photo_.ground, cv::INTER_NEAREST, {});
    warp(photo_.relief, cv::INTER_NEAREST, cv::Scalar(kNaN));
    warp(photo_.relief_sd, cv::INTER_NEAREST, cv::Scalar(kNaN));
    warp(photo_.slope, cv::INTER_NEAREST, {});
    warp(photo_.slope_sd, cv::INTER_NEAREST, {});
    for (PhotoLayer& layer : photo_.layers)
      warp(layer.color, cv::INTER_LINEAR, {}), warp(layer.agreement, cv::INTER_NEAREST, {});
    for (PhotoView& view : photo_.views) {
      warp(view.color, cv::INTER_LINEAR, {});
      warp(view.quality, cv::INTER_NEAREST, {});
      view.camera.head<2>() = photo_.turned(view.camera.head<2>());
    }
  }

  static float weighted_median(std::vector<std::pair<float, float>>& samples) {
    std::sort(samples.begin(), samples.end());
    float total = 0;
    for (const auto& [value, weight] : samples) total += weight;
    float sum = 0;
    for (const auto& [value, weight] : samples)
      if ((sum += weight) >= total / 2) return value;
    return kNaN;
  }

  void fuse_pixel(int y, int x, std::vector<std::pair<float, float>>& samples) {
    float total = 0;
    cv::Vec2f slope(0, 0), squares(0, 0);
    for (const PhotoView& view : views_) {
      const float weight = view.quality.at<float>(y, x);
      if (weight <= 0) continue;
      total += weight;
      const Vector3d& camera = view.camera;
      const cv::Vec2f own(static_cast<float>((camera.x() - photo_.u(x)) / camera.z()),
                          static_cast<float>((camera.y() - photo_.v(y)) / camera.z()));
      slope += weight * own;
      squares += weight * own.mul(own);
    }
    photo_.weight.at<float>(y, x) = total;
    cv::Vec3b& color = photo_.color.at<cv::Vec3b>(y, x);
    color = {};
    if (total > 0) {
      fuse_ground(y, x, samples);
      slope /= total;
      photo_.slope.at<cv::Vec2f>(y, x) = slope;
      for (int i = 0; i < 2; ++i)
        photo_.slope_sd.at<cv::Vec2f>(y, x)[i] =
            std::sqrt(std::max(0.F, squares[i] / total - slope[i] * slope[i]));
      for (int channel = 0; channel < 3; ++channel) {
        samples.clear();
        for (const PhotoView& view : views_)
          if (const float weight = view.quality.at<float>(y, x); weight > 0)
            samples.emplace_back(view.color.at<cv::Vec3b>(y, x)[channel], weight);
        color[channel] = cv::saturate_cast<uint8_t>(weighted_median(samples));
      }
    }
    fuse_relief(y, x, samples);
  }

  /// The frames projected onto a plane before the face instead: their median. What a frame shows of that
  /// plane, it shows of the face where its ray ends: scaled about the foot of the camera.
  PhotoLayer layer(double depth) const {
    std::vector<LayerScaling> scalings;
    for (const PhotoView& view : views_) scalings.push_back(photo_.scaling(view, depth));
    PhotoLayer layer{depth, cv::Mat::zeros(size_, CV_8UC3), cv::Mat::zeros(size_, CV_32F)};
    parallel_for(static_cast<size_t>(size_.height), threads_, [&](size_t begin, size_t end) {
      std::array<std::vector<uint8_t>, 3> samples;
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < size_.width; ++x) {
          for (auto& channel : samples) channel.clear();
          for (size_t i = 0; i < views_.size(); ++i) {
            const cv::Point from = scalings[i].on_face(x, y);
            if (!from.inside(cv::Rect({}, size_)) || views_[i].quality.at<float>(from) <= 0) continue;
            const cv::Vec3b& pixel = views_[i].color.at<cv::Vec3b>(from);
            for (size_t channel = 0; channel < 3; ++channel)
              samples[channel].push_back(pixel[static_cast<int>(channel)]);
          }
          if (samples[0].empty()) continue;
          cv::Vec3b& color = layer.color.at<cv::Vec3b>(y, x);
          for (int channel = 0; channel < 3; ++channel)
            color[channel] = median(samples[static_cast<size_t>(channel)]);
          int same = 0;
          for (size_t i = 0; i < samples[0].size(); ++i)
            same += std::abs(samples[0][i] - color[0]) < kPhoto.same_color &&
                            std::abs(samples[1][i] - color[1]) < kPhoto.same_color &&
                            std::abs(samples[2][i] - color[2]) < kPhoto.same_color
                        ? 1
                        : 0;
          layer.agreement.at<float>(y, x) = static_cast<float>(same) / static_cast<float>(samples[0].size());
        }
    });
    return layer;
  }

  /// Where the frames have the surface: their drift along the normal is not a step of it, so the median.
  void fuse_ground(int y, int x, std::vector<std::pair<float, float>>& samples) {
    samples.clear();
    const Vector3d at(1, photo_.u(x), photo_.v(y));
    for (const PhotoView& view : views_)
      if (const float weight = view.quality.at<float>(y, x); weight > 0)
        samples.emplace_back(static_cast<float>(view.ground.dot(at)), weight);
    photo_.ground.at<float>(y, x) = weighted_median(samples);
  }

  /// Median over the frames, each weighted by its depth's precision.
  void fuse_relief(int y, int x, std::vector<std::pair<float, float>>& samples) {
    samples.clear();
    for (const PhotoView& view : views_) {
      const float relief = view.relief.at<float>(y, x);
      const auto distance = static_cast<float>(view.camera.z());
      if (!std::isnan(relief)) samples.emplace_back(relief, 1 / (distance * distance));
    }
    if (samples.empty()) return;
    const float middle = weighted_median(samples);
    float spread = 0;
    for (const auto& [relief, weight] : samples) spread += std::min(std::abs(relief - middle), 0.03F);
    const auto count = static_cast<float>(samples.size());
    photo_.relief.at<float>(y, x) = middle;
    photo_.relief_sd.at<float>(y, x) = std::max(1.25F * spread / count, 0.003F) / std::sqrt(count);
  }

  const Recording& recording_;
  const std::vector<std::optional<Isometry3d>>& map_from_camera_;
  int threads_;
  cv::Size size_;
  std::vector<Candidate> candidates_;
  std::vector<PhotoView> views_;
  Orthophoto photo_;
};

}  // namespace

void Orthophoto::drop_evidence() {
  views.clear();
  layers.clear();
  for (cv::Mat* image : {&weight, &relief_sd, &slope_sd}) image->release();
}

LayerScaling Orthophoto::scaling(const PhotoView& view, double depth) const {
  const double scale = view.camera.z() / (view.camera.z() - depth);
  return {scale, (1 - scale) * column(view.camera.x()), (1 - scale) * row(view.camera.y())};
}

cv::Point Orthophoto::pixel_at(const Vector2d& at) const {
  return {std::clamp(static_cast<int>(std::lround(column(at.x()))), 0, width() - 1),
          std::clamp(static_cast<int>(std::lround(row(at.y()))), 0, height() - 1)};
}

Vector2d Orthophoto::slope_at(const Vector2d& at) const {
  const cv::Vec2f& leaning = slope.at<cv::Vec2f>(pixel_at(at));
  return {static_cast<double>(leaning[0]), static_cast<double>(leaning[1])};
}

Vector2d Orthophoto::turned(const Vector2d& at) const {
  return middle() + Eigen::Rotation2Dd(roll) * (at - middle());
}

Vector3d Orthophoto::in_map(const Vector2d& at, double depth) const {
  const Vector2d on_face = middle() + Eigen::Rotation2Dd(-roll) * (at - middle()) + depth * slope_at(at);
  return face.at(on_face.x(), on_face.y(), static_cast<double>(ground.at<float>(pixel_at(at))) + depth);
}

Vector3d Orthophoto::in_layer(const Vector2d& at, double depth) const {
  const Vector2d on_face = middle() + Eigen::Rotation2Dd(-roll) * (at - middle());
  return face.at(on_face.x(), on_face.y(), static_cast<double>(ground.at<float>(pixel_at(at))) + depth);
}

Vector2d Orthophoto::seen_at(const Vector3d& point) const {
  const Vector2d stands = stands_at(point);
  const double depth = face.coordinates(point).z() - static_cast<double>(ground.at<float>(pixel_at(stands)));
  return turned(face.coordinates(point).head<2>() - depth * slope_at(stands));
}

Vector2d Orthophoto::stands_at(const Vector3d& point) const {
  return turned(face.coordinates(point).head<2>());
}

Orthophoto make_orthophoto(const Recording& recording,
                           const std::vector<std::optional<Isometry3d>>& map_from_camera,
                           const FurnitureFace& face, int threads) {
  return Photographer(recording, map_from_camera, face, threads).run();
}

}  // namespace loci::mapping
