#include "perception/recognition/image_features.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/math/math.h"
#include "mapping/image/root_sift.h"

namespace loci::perception {
namespace {

// Half of Lowe's threshold: packages show soft shades, and matching sorts out what is noise.
constexpr double kContrast = 0.02;
constexpr double kEdge = 12;

Descriptor in_bytes(const float* rooted) {
  Descriptor descriptor;
  std::transform(rooted, rooted + descriptor.size(), descriptor.begin(),
                 [](float value) { return cv::saturate_cast<uint8_t>(512 * value); });
  return descriptor;
}

cv::Mat grey_of_side(const cv::Mat& image, int side, double& scale) {
  cv::Mat grey = image, scaled;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  scale = static_cast<double>(side) / std::max(image.cols, image.rows);
  cv::resize(grey, scaled, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  return scaled;
}

constexpr int kHashSide = 32, kFrequencies = 8, kColorCells = 4;

constexpr double kMaxTurn = 35 * kPi / 180;  // between a key point's own turn and the map's
constexpr double kMaxZoomRatio = 1.8;        // likewise, of the scale
constexpr double kCoarse = 2;  // Similarities of single key points are less precise than the fitted map.
constexpr double kMaxStretch = 2.5;  // of an affine map: a package seen from 66 degrees aside
constexpr size_t kMax = 250;         // correspondences, the weightiest: the time grows with their square

cv::Matx23d similarity(const Keypoint& from, const Keypoint& to) {
  const double scale = static_cast<double>(to.size) / static_cast<double>(from.size);
  const auto turn = static_cast<double>(to.angle - from.angle);
  const double c = scale * std::cos(turn), s = scale * std::sin(turn);
  const auto fx = static_cast<double>(from.x), fy = static_cast<double>(from.y);
  return {c, -s, static_cast<double>(to.x) - c * fx + s * fy,  //
          s, c,  static_cast<double>(to.y) - s * fx - c * fy};
}

struct Shape {
  double scale = 0, turn = 0;
};

Shape shape_of(const cv::Matx23d& map) {
  return {std::sqrt(std::abs(map(0, 0) * map(1, 1) - map(0, 1) * map(1, 0))),
          std::atan2(map(1, 0) - map(0, 1), map(0, 0) + map(1, 1))};
}

bool agrees(const Correspondence& pair, const cv::Matx23d& map, const Shape& shape, double tolerance) {
  const cv::Vec2d mapped =
      map * cv::Vec3d(static_cast<double>(pair.from.x), static_cast<double>(pair.from.y), 1);
  const double dx = mapped[0] - static_cast<double>(pair.to.x),
               dy = mapped[1] - static_cast<double>(pair.to.y);
  if (dx * dx + dy * dy > tolerance * tolerance) return false;
  const double zoom = static_cast<double>(pair.to.size) / (static_cast<double>(pair.from.size) * shape.scale);
  const auto turn = static_cast<double>(pair.to.angle - pair.from.angle);
  return std::abs(std::log(zoom)) < std::log(kMaxZoomRatio) &&
         std::abs(std::remainder(turn - shape.turn, 2 * kPi)) < kMaxTurn;
}

/// Those that agree; of several with the same key point (of either image) the weightiest. `order` by weight.
ImageFit agreeing(const std::vector<Correspondence>& pairs, const std::vector<size_t>& order,
                  const cv::Matx23d& map, double tolerance) {
  ImageFit fit;
  fit.to_from_from = map;
  const Shape shape = shape_of(map);
  std::set<std::pair<float, float>> from,
      to;  // The place, not the number: SIFT gives several turns at one place.
  for (const size_t i : order) {
    const Correspondence& pair = pairs[i];
    if (!agrees(pair, map, shape, tolerance) || from.contains({pair.from.x, pair.from.y}) ||
        to.contains({pair.to.x, pair.to.y}))
      continue;
    from.insert({pair.from.x, pair.from.y});
    to.insert({pair.to.x, pair.to.y});
    fit.inliers.push_back(i);
    fit.weight += pair.weight;
  }
  return fit;
}

/// Weighted least squares; false when the points do not hold it.
bool affine_of(const std::vector<Correspondence>& pairs, const std::vector<size_t>& inliers,
               cv::Matx23d& map) {
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Matx<double, 3, 2> right = cv::Matx<double, 3, 2>::zeros();
  for (const size_t i : inliers) {
    const cv::Vec3d p(static_cast<double>(pairs[i].from.x), static_cast<double>(pairs[i].from.y), 1);
    const cv::Vec2d q(static_cast<double>(pairs[i].to.x), static_cast<double>(pairs[i].to.y));
    normal += pairs[i].weight * p * p.t();
    right += pairs[i].weight * p * q.t();
  }
  bool solved = false;
  const cv::Matx33d inverse = normal.inv(cv::DECOMP_CHOLESKY, &solved);
  if (!solved) return false;
  const cv::Matx23d found = (inverse * right).t();
  cv::Matx22d linear(found(0, 0), found(0, 1), found(1, 0), found(1, 1));
  if (cv::determinant(linear) <= 0) return false;
  cv::Vec2d stretch;
  cv::SVD::compute(linear, stretch);
  if (stretch[0] > kMaxStretch * stretch[1]) return false;
  map = found;
  return true;
}

constexpr int kWhite = 245;
constexpr double kSigma = 25;  // of Lab: another light shifts colours, another flavour changes them
constexpr int kFewCells = 30;
constexpr double kUnknown = 0.5;

}  // namespace

ImageFeatures image_features(const cv::Mat& image, int side, int most) {
  double scale = 1;
  const cv::Mat grey = grey_of_side(image, side, scale);
  std::vector<cv::KeyPoint> found;
  cv::Mat values;
  cv::SIFT::create(most, 3, kContrast, kEdge)->detectAndCompute(grey, cv::noArray(), found, values);
  values = mapping::root_sift(values);
  ImageFeatures features;
  features.width = image.cols;
  features.height = image.rows;
  const auto to_given = static_cast<float>(1 / scale);
  for (size_t i = 0; i < found.size(); ++i) {
    features.keypoints.push_back({found[i].pt.x * to_given, found[i].pt.y * to_given,
                                  found[i].size * to_given,
                                  found[i].angle * std::numbers::pi_v<float> / 180});
    features.descriptors.push_back(in_bytes(values.ptr<float>(static_cast<int>(i))));
  }
  return features;
}

uint64_t perceptual_hash(const cv::Mat& image) {
  if (image.empty()) return 0;
  cv::Mat grey = image, small, spectrum;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::resize(grey, small, {kHashSide, kHashSide}, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::dct(small, spectrum);
  // Without the first row and column, which say how bright it is, and from where light comes.
  std::array<float, kFrequencies * kFrequencies> values{};
  for (int v = 0; v < kFrequencies; ++v)
    for (int u = 0; u < kFrequencies; ++u)
      values[static_cast<size_t>(v * kFrequencies + u)] = spectrum.at<float>(v + 1, u + 1);
  std::array<float, kFrequencies* kFrequencies> sorted = values;
  const auto middle = sorted.begin() + sorted.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  uint64_t hash = 0;
  for (size_t i = 0; i < values.size(); ++i)
    if (values[i] >= *middle) hash |= uint64_t{1} << i;
  return hash;
}

cv::Mat lab_of(const cv::Mat& image) {
  const auto convert = [](const cv::Mat& bgr) {
    cv::Mat lab;
    cv::cvtColor(bgr, lab, cv::COLOR_BGR2Lab);
    return lab;
  };
  // OpenCV 4.6 fills its tables at the first conversion, without a lock.
  [[maybe_unused]] static const cv::Mat first = convert(cv::Mat::zeros(1, 1, CV_8UC3));
  return convert(image);
}

cv::Mat cell_colors(const cv::Mat& image) {
  cv::Mat small;
  cv::resize(image, small, {kColorCells, kColorCells}, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F, 1.0 / 255);
  return lab_of(small);
}

int hash_distance(uint64_t a, uint64_t b) {
  return std::popcount(a ^ b);
}

ImageFit fit_images(const std::vector<Correspondence>& pairs, double tolerance) {
  std::vector<size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return pairs[a].weight > pairs[b].weight; });
  ImageFit best;
  double most = 0;
  if (order.size() > kMax) order.resize(kMax);
  for (const size_t seed : order) {
    const cv::Matx23d map = similarity(pairs[seed].from, pairs[seed].to);
    const Shape shape = shape_of(map);
    double weight = 0;
    for (const size_t i : order)
      if (agrees(pairs[i], map, shape, kCoarse * tolerance)) weight += pairs[i].weight;
    if (weight <= most) continue;
    most = weight;
    best.to_from_from = map;
  }
  best = agreeing(pairs, order, best.to_from_from, kCoarse * tolerance);
  for (int round = 0; round < 3 && best.inliers.size() >= 4; ++round) {
    cv::Matx23d map;
    if (!affine_of(pairs, best.inliers, map)) break;
    ImageFit refined = agreeing(pairs, order, map, tolerance);
    if (refined.inliers.size() < 3) break;
    best = std::move(refined);
  }
  if (best.inliers.size() < 3) return {};
  std::sort(best.inliers.begin(), best.inliers.end());
  return best;
}

double log_false_alarms(const std::vector<Correspondence>& pairs, const ImageFit& fit, double tolerance,
                        const cv::Size& to, size_t images) {
  constexpr double kScales = 16;  // between the smallest and the largest key points of an image
  const double place = kPi * tolerance * tolerance / std::max(1, to.area());
  const double turn = kMaxTurn / kPi;
  const double zoom = 2 * std::log(kMaxZoomRatio) / std::log(kScales);
  const double p = std::min(0.5, place * turn * zoom);
  std::set<std::pair<int, int>> places;
  for (const size_t i : fit.inliers)
    places.insert({static_cast<int>(static_cast<double>(pairs[i].to.x) / (2 * tolerance)),
                   static_cast<int>(static_cast<double>(pairs[i].to.y) / (2 * tolerance))});
  const auto tried = static_cast<double>(std::min(pairs.size(), kMax));
  const double tests = static_cast<double>(images) * tried;
  const double k = static_cast<double>(places.size()) - 3, n = tried - 3;
  if (k <= 0 || n < k) return std::log10(std::max(1.0, tests));
  // The first term of the tail, far above the mean nearly all of it.
  const double chance = std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) + k * std::log(p) +
                        (n - k) * std::log1p(-p);
  return (std::log(tests) + std::min(0.0, chance)) / std::numbers::ln10;
}

cv::Mat chroma_of(const cv::Mat& image, int side) {
  cv::Mat small;
  const double scale = std::min(1.0, static_cast<double>(side) / std::max(image.cols, image.rows));
  cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  const cv::Mat lab = lab_of(small);
  cv::Mat chroma(small.size(), CV_8UC3);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x) {
      const auto& color = small.at<cv::Vec3b>(y, x);
      const auto& cell = lab.at<cv::Vec3b>(y, x);
      const bool coloured = std::min({color[0], color[1], color[2]}) < kWhite;
      chroma.at<cv::Vec3b>(y, x) = {cell[1], cell[2], static_cast<uint8_t>(coloured ? 255 : 0)};
    }
  return chroma;
}

double color_agreement(const cv::Mat& from, const cv::Size& from_size, const cv::Mat& to,
                       const cv::Size& to_size, const cv::Matx23d& to_from_from) {
  const double from_scale = static_cast<double>(from_size.width) / from.cols;
  const double to_scale = static_cast<double>(to.cols) / to_size.width;
  double sum = 0;
  int count = 0;
  for (int y = 0; y < from.rows; ++y)
    for (int x = 0; x < from.cols; ++x) {
      const auto& ours = from.at<cv::Vec3b>(y, x);
      if (ours[2] == 0) continue;
      const cv::Vec2d pixel = to_from_from * cv::Vec3d((x + 0.5) * from_scale, (y + 0.5) * from_scale, 1);
      const int u = static_cast<int>(std::floor(pixel[0] * to_scale)),
                v = static_cast<int>(std::floor(pixel[1] * to_scale));
      if (u < 0 || v < 0 || u >= to.cols || v >= to.rows) continue;
      const auto& theirs = to.at<cv::Vec3b>(v, u);
      const double da = ours[0] - theirs[0], db = ours[1] - theirs[1];
      sum += std::exp(-(da * da + db * db) / (2 * kSigma * kSigma));
      ++count;
    }
  return count < kFewCells ? kUnknown : sum / count;
}

}  // namespace loci::perception
