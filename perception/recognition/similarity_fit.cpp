#include "perception/recognition/similarity_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "mapping/base/math.h"

namespace loci::perception {
namespace {

constexpr double kMaxTurn = 35 * kPi / 180;  // between a key point's own turn and the map's
constexpr double kMaxZoom = 1.8;             // likewise, of the scale
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
  return std::abs(std::log(zoom)) < std::log(kMaxZoom) &&
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

}  // namespace

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
  const double zoom = 2 * std::log(kMaxZoom) / std::log(kScales);
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

}  // namespace loci::perception
