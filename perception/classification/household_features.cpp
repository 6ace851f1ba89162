#include "perception/classification/household_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"

namespace loci::perception {
namespace {

constexpr size_t kMinSurfaceSamples = 30;
constexpr size_t kMaxSurfaceSamples = 1500;

/// A point of the surface: x to the right, y away from the camera, z above the ground.
struct Sample {
  Vector3d at, normal;
};

class Values {
 public:
  /// From `low` to `high`, as 0 to 1; what is not known is 0.
  void add(double value, double low, double high) {
    const double share = std::isfinite(value) ? (value - low) / (high - low) : 0.0;
    values_.push_back(static_cast<float>(std::clamp(share, 0.0, 1.0)));
  }
  void add_share(double value) { add(value, 0, 1); }

  FeatureVector take() {
    const float sum = std::accumulate(values_.begin(), values_.end(), 0.0F);
    values_.push_back(static_cast<float>(values_.size()) - sum);
    return std::move(values_);
  }

 private:
  FeatureVector values_;
};

std::vector<Sample> upright_samples(const SurfacePoints& surface, const Ground& ground) {
  std::vector<size_t> used;
  for (size_t i = 0; i < surface.points.size(); ++i)
    if (surface.points[i].allFinite() && surface.normals[i].allFinite()) used.push_back(i);
  if (used.size() < kMinSurfaceSamples) return {};
  Vector3d middle = Vector3d::Zero();
  for (const size_t i : used) middle += surface.points[i].cast<double>();
  middle /= static_cast<double>(used.size());
  Vector3d away = middle - ground.up * ground.up.dot(middle);
  if (away.norm() < 1e-3) away = ground.up.unitOrthogonal();
  Eigen::Matrix3d turn;
  turn.row(1) = away.normalized();
  turn.row(2) = ground.up;
  turn.row(0) = turn.row(1).cross(turn.row(2));
  const size_t step = std::max<size_t>(1, used.size() / kMaxSurfaceSamples);
  std::vector<Sample> samples;
  for (size_t k = 0; k < used.size(); k += step) {
    const size_t i = used[k];
    Vector3d at = turn * (surface.points[i].cast<double>() - middle);
    at.z() = ground.up.dot(surface.points[i].cast<double>()) - ground.height;
    samples.push_back({at, turn * surface.normals[i].cast<double>()});
  }
  return samples;
}

struct Extent {
  double low = 0, high = 0;
  double length() const { return high - low; }
  double middle() const { return (low + high) / 2; }
};

template <class Get>
Extent extent_of(const std::vector<Sample>& samples, const Get& get) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const Sample& sample : samples) values.push_back(get(sample));
  const auto [low, high] = quantiles(values, 0.02, 0.98);
  return {low, high};
}

/// The vertical axis about which the outside is round, from points and normals: p - r n = centre.
struct Round {
  Vector2d centre = Vector2d::Zero();
  double radius = 0.25;  ///< of what is flat
  double error = 0;      ///< root mean square, m
};

Round round_of(const std::vector<Sample>& samples, const Vector2d& middle) {
  std::vector<std::pair<Vector2d, Vector2d>> outside;
  for (const Sample& sample : samples) {
    const Vector2d flat = sample.normal.head<2>();
    if (flat.norm() < 0.5 || flat.dot(sample.at.head<2>() - middle) <= 0) continue;
    outside.emplace_back(sample.at.head<2>(), flat.normalized());
  }
  Round round;
  round.centre = middle;
  if (outside.size() < 10) return round;
  Vector2d p = Vector2d::Zero(), n = Vector2d::Zero();
  for (const auto& [at, normal] : outside) p += at, n += normal;
  const auto count = static_cast<double>(outside.size());
  p /= count, n /= count;
  double pn = 0, nn = 0;
  for (const auto& [at, normal] : outside) pn += (at - p).dot(normal - n), nn += (normal - n).squaredNorm();
  if (nn / count > 0.01) round.radius = std::clamp(pn / nn, 0.005, 0.25);
  round.centre = p - round.radius * n;
  for (const auto& [at, normal] : outside)
    round.error += (at - round.radius * normal - round.centre).squaredNorm() / count;
  round.error = std::sqrt(round.error);
  return round;
}

void add_sizes(const std::vector<Sample>& samples, Values& values) {
  const Extent x = extent_of(samples, [](const Sample&s) { return s.at.x(); }),
               y = extent_of(samples, [](const Sample&s) { return s.at.y(); }),
               z = extent_of(samples, [](const Sample&s) { return s.at.z(); });
  values.add(z.high, 0, 0.4);
  values.add(z.low, 0, 0.2);
  values.add(x.length(), 0, 0.5);
  values.add(y.length(), 0, 0.5);
  values.add(std::log(std::max(z.high, 0.002) / std::max(x.length(), 0.005)), -4, 3);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (const Sample& sample : samples) mean += sample.at / static_cast<double>(samples.size());
  for (const Sample& sample : samples)
    moments += (sample.at - mean) * (sample.at - mean).transpose() / static_cast<double>(samples.size());
  const Vector3d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments, Eigen::EigenvaluesOnly)
                              .eigenvalues()
                              .cwiseMax(0)
                              .cwiseSqrt();
  for (int i = 0; i < 3; ++i) values.add(spread[i], 0, 0.12);
  values.add_share(spread[1] / std::max(spread[2], 1e-6));
  values.add_share(spread[0] / std::max(spread[2], 1e-6));

  // How wide it is by height: necks, rims, feet.
  constexpr size_t kSlices = 6;
  std::array<std::vector<double>, kSlices> slices;
  const double low = std::min(z.low, 0.3 * z.high);
  for (const Sample& sample : samples) {
    const double share = (sample.at.z() - low) / std::max(z.high - low, 1e-3);
    slices[std::clamp<size_t>(static_cast<size_t>(std::max(0.0, share) * kSlices), 0, kSlices - 1)].push_back(
        sample.at.x());
  }
  for (std::vector<double>& slice : slices) {
    double width = 0;
    if (slice.size() > 5) {
      const auto [left, right] = quantiles(slice, 0.03, 0.97);
      width = right - left;
    }
    values.add(width / std::max(x.length(), 0.005), 0, 1.2);
  }
}

void add_directions(const std::vector<Sample>& samples, double top, Values& values) {
  const double share = 1 / static_cast<double>(samples.size());
  double up = 0, side = 0, slanted = 0, down = 0, low_up = 0;
  std::vector<double> height_of_up = {0};
  Vector2d twofold = Vector2d::Zero(), fourfold = Vector2d::Zero();
  double aside = 0;
  constexpr size_t kBins = 24;
  std::array<double, kBins> azimuth{};
  for (const auto& [at, normal] : samples) {
    const double z = normal.z();
    (z > 0.9 ? up : z > 0.35 ? slanted : z > -0.35 ? side : down) += share;
    if (z > 0.9) {
      height_of_up.push_back(at.z());
      low_up += at.z() < 0.7 * top ? share : 0;
    }
    if (std::abs(z) > 0.5) continue;
    const double angle = std::atan2(normal.y(), normal.x());
    ++aside;
    twofold += Vector2d(std::cos(2 * angle), std::sin(2 * angle));
    fourfold += Vector2d(std::cos(4 * angle), std::sin(4 * angle));
    ++azimuth[std::min(kBins - 1, static_cast<size_t>((angle + kPi) / (2 * kPi) * kBins))];
  }
  for (const double each : {up, slanted, side, down, low_up}) values.add_share(each);
  values.add(quantile(height_of_up, 0.5) / std::max(top, 0.005), 0, 1);
  values.add_share(twofold.norm() / std::max(aside, 1.0));
  values.add_share(fourfold.norm() / std::max(aside, 1.0));
  double most = 0;
  int filled = 0;
  for (size_t i = 0; i < kBins; ++i) {
    most = std::max(most, azimuth[i] + azimuth[(i + 1) % kBins]);
    filled += azimuth[i] > 0.02 * aside && aside > 0 ? 1 : 0;
  }
  values.add_share(most / std::max(aside, 1.0));
  values.add(filled, 0, kBins);
}

/// Round outside, wall inside, what stands out of it.
void add_roundness(const std::vector<Sample>& samples, double top, Values& values) {
  const Extent x = extent_of(samples, [](const Sample&s) { return s.at.x(); }),
               y = extent_of(samples, [](const Sample&s) { return s.at.y(); });
  const Round first = round_of(samples, {x.middle(), std::max(y.middle(), y.low + x.length() / 2)});
  const bool plausible = first.radius < 0.7 * x.length() + 0.01;
  const Round round = plausible ? round_of(samples, first.centre) : first;
  values.add(round.radius, 0, 0.25);
  values.add(round.radius / std::max(x.length(), 0.005), 0, 1.5);
  values.add(round.error, 0, 0.03);
  values.add(round.error / std::max(round.radius, 0.005), 0, 0.5);
  const double radius = std::min(round.radius, 0.6 * x.length());
  const Vector2d centre = plausible ? round.centre : Vector2d(x.middle(), y.middle());
  double inside = 0, out = 0, slope = 0, all = static_cast<double>(samples.size());
  std::vector<double> middle, beyond = {0};
  for (const auto& [at, normal] : samples) {
    const Vector2d from = at.head<2>() - centre;
    if (normal.head<2>().norm() > 0.25 &&
        normal.head<2>().dot(from) < -0.5 * normal.head<2>().norm() * from.norm()) {
      ++inside;
      slope += normal.z();
    }
    if (from.norm() < 0.45 * radius) middle.push_back(at.z());
    out += from.norm() > 1.12 * radius + 0.004 ? 1 : 0;
    beyond.push_back(from.norm());
  }
  values.add_share(inside / all);
  values.add(inside > 5 ? slope / inside : -0.2, -0.2, 1);
  values.add(middle.size() > 5 ? quantile(middle, 0.5) / std::max(top, 0.005) : -0.1, -0.1, 1.1);
  values.add(middle.size() > 5 ? quantile(middle, 0.1) / std::max(top, 0.005) : -0.1, -0.1, 1.1);
  values.add_share(out / all);
  values.add(quantile(beyond, 0.99) / std::max(radius, 0.005), 0.8, 3);
}

/// How normals turn along short distances: all pairs, those one above the other, those side by side.
void add_curvature(const std::vector<Sample>& samples, Values& values) {
  std::vector<double> all = {0}, upright = {0}, level = {0};
  Random draw(samples.size());
  for (int pair = 0; pair < 4000; ++pair) {
    const Sample &a = samples[draw.index(samples.size())], &b = samples[draw.index(samples.size())];
    const Vector3d between = b.at - a.at;
    const double length = between.norm();
    if (length < 0.008 || length > 0.03) continue;
    const double turn = (b.normal - a.normal).dot(between) / (length * length);
    all.push_back(turn);
    const double steep = std::abs(between.z()) / length;
    if (steep > 0.8) upright.push_back(turn);
    if (steep < 0.3) level.push_back(turn);
  }
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) values.add(quantile(all, share), -40, 60);
  values.add(quantile(upright, 0.5), -40, 60);
  values.add(quantile(level, 0.5), -40, 60);
}

/// The largest planes: their share of the surface, how steep, and how large.
void add_planes(const std::vector<Sample>& samples, Values& values) {
  std::vector<bool> taken(samples.size(), false);
  for (int plane = 0; plane < 2; ++plane) {
    size_t best = 0;
    int most = 0;
    const size_t step = std::max<size_t>(1, samples.size() / 40);
    const auto on = [&](size_t i, size_t j) {
      return !taken[j] && samples[i].normal.dot(samples[j].normal) > 0.92 &&
             std::abs(samples[i].normal.dot(samples[j].at - samples[i].at)) < 0.005;
    };
    for (size_t i = step / 2; i < samples.size(); i += step) {
      if (taken[i]) continue;
      int count = 0;
      for (size_t j = 0; j < samples.size(); j += 3) count += on(i, j) ? 1 : 0;
      if (count > most) most = count, best = i;
    }
    double share = 0;
    for (size_t j = 0; j < samples.size(); ++j)
      if (most > 0 && on(best, j)) {
        if (j != best) taken[j] = true;
        share += 1 / static_cast<double>(samples.size());
      }
    if (most > 0) taken[best] = true;
    values.add_share(share);
    values.add(most > 0 ? samples[best].normal.z() : 0, -0.2, 1);
  }
}

/// The footprint as a bar: how wide along it, how bent. The broader end comes last.
void add_footprint(const std::vector<Sample>& samples, Values& values) {
  std::vector<cv::Point2f> points;
  for (const Sample& sample : samples)
    points.emplace_back(static_cast<float>(sample.at.x()), static_cast<float>(sample.at.y()));
  const cv::RotatedRect box = cv::minAreaRect(points);
  const double longer = static_cast<double>(std::max(box.size.width, box.size.height)),
               shorter = static_cast<double>(std::min(box.size.width, box.size.height));
  values.add(longer, 0, 0.5);
  values.add(shorter, 0, 0.4);
  values.add_share(shorter / std::max(longer, 1e-3));
  double yaw = static_cast<double>(box.angle) * kPi / 180;
  if (box.size.height > box.size.width) yaw += kPi / 2;
  const Vector2d along(std::cos(yaw), std::sin(yaw)), across(-along.y(), along.x());
  const Vector2d centre(static_cast<double>(box.center.x), static_cast<double>(box.center.y));
  constexpr size_t kParts = 6;
  std::array<std::vector<double>, kParts> parts;
  for (const Sample& sample : samples) {
    const Vector2d from = sample.at.head<2>() - centre;
    const double share = along.dot(from) / std::max(longer, 1e-3) + 0.5;
    parts[std::clamp<size_t>(static_cast<size_t>(std::max(0.0, share) * kParts), 0, kParts - 1)].push_back(
        across.dot(from));
  }
  std::array<double, kParts> width{}, middle{};
  for (size_t i = 0; i < kParts; ++i) {
    if (parts[i].size() < 3) continue;
    const auto [low, high] = quantiles(parts[i], 0.03, 0.97);
    width[i] = high - low;
    middle[i] = (low + high) / 2;
  }
  if (width[0] + width[1] + width[2] > width[3] + width[4] + width[5]) std::ranges::reverse(width);
  for (const double each : width) values.add(each / std::max(shorter, 1e-3), 0, 1.1);
  const double bend = (middle[2] + middle[3] - middle[0] - middle[5]) / 2;
  values.add(std::abs(bend) / std::max(longer, 1e-3), 0, 0.3);
}

cv::Mat filled(const ObjectView& view) {
  return view.mask.empty() ? cv::Mat(view.image.size(), CV_8U, cv::Scalar(255)) : view.mask;
}

void add_outline(const ObjectView& view, Values& values) {
  double solidity = 0, fill = 0, round = 0, holes = 0, aspect = 0;
  if (!view.image.empty()) {
    cv::Mat mask;
    cv::morphologyEx(filled(view), mask, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    const auto largest = std::ranges::max_element(contours, {}, [](const auto& c) { return c.size(); });
    if (largest != contours.end() && largest->size() > 8) {
      const double area = cv::contourArea(*largest), length = cv::arcLength(*largest, true);
      std::vector<cv::Point> hull;
      cv::convexHull(*largest, hull);
      const cv::RotatedRect box = cv::minAreaRect(*largest);
      const auto width = static_cast<double>(box.size.width), height = static_cast<double>(box.size.height);
      solidity = area / std::max(1.0, cv::contourArea(hull));
      fill = area / std::max(1.0, width * height);
      round = 4 * kPi * area / std::max(1.0, length * length);
      aspect = std::min(width, height) / std::max(1.0, std::max(width, height));
      cv::Mat whole = cv::Mat::zeros(mask.size(), CV_8U);
      cv::drawContours(whole, contours, static_cast<int>(largest - contours.begin()), 255, cv::FILLED);
      holes = 1 - static_cast<double>(cv::countNonZero(mask & whole)) / std::max(1.0, area);
    }
  }
  values.add(solidity, 0.5, 1);
  values.add(fill, 0.3, 1);
  values.add_share(round);
  values.add(holes, 0, 0.3);
  values.add_share(aspect);
}

void add_colors(const ObjectView& view, Values& values) {
  constexpr size_t kHues = 8;
  std::array<double, kHues + 3> shares{};  // then white, grey, black
  double saturation = 0, value = 0, value_square = 0, count = 0;
  if (view.image.type() == CV_8UC3 && !view.image.empty()) {
    cv::Mat hsv;
    cv::cvtColor(view.image, hsv, cv::COLOR_BGR2HSV);
    const cv::Mat mask = filled(view);
    const int step = std::max(1, hsv.rows / 60);
    for (int v = 0; v < hsv.rows; v += step)
      for (int u = 0; u < hsv.cols; u += step) {
        if (mask.at<uchar>(v, u) == 0) continue;
        const cv::Vec3b pixel = hsv.at<cv::Vec3b>(v, u);
        const double s = pixel[1] / 255.0, b = pixel[2] / 255.0;
        ++count;
        saturation += s;
        value += b;
        value_square += b * b;
        if (s * b > 0.15 && s > 0.25)
          ++shares[std::min(kHues - 1, static_cast<size_t>(pixel[0] / 180.0 * kHues))];
        else
          ++shares[kHues + (b > 0.65 ? 0u : b > 0.25 ? 1u : 2u)];
      }
  }
  const double all = std::max(count, 1.0);
  for (const double share : shares) values.add_share(share / all);
  values.add_share(saturation / all);
  values.add_share(value / all);
  values.add(std::sqrt(std::max(0.0, value_square / all - std::pow(value / all, 2))), 0, 0.4);
  values.add_share(*std::ranges::max_element(shares) / all);
}

}  // namespace

FeatureVector household_features(const ObjectView& view) {
  if (!view.ground) return {};
  const std::vector<Sample> samples = upright_samples(view.surface, *view.ground);
  if (samples.size() < kMinSurfaceSamples) return {};
  const double top = extent_of(samples, [](const Sample& s) { return s.at.z(); }).high;
  Values values;
  add_sizes(samples, values);
  add_directions(samples, top, values);
  add_roundness(samples, top, values);
  add_curvature(samples, values);
  add_planes(samples, values);
  add_footprint(samples, values);
  add_outline(view, values);
  add_colors(view, values);
  return values.take();
}

}  // namespace loci::perception
