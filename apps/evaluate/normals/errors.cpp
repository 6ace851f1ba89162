#include "apps/evaluate/normals/errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mapping/base/math/math.h"

namespace loci::apps::normals_evaluation {
namespace {

constexpr double kDegrees = 180 / kPi;

/// From the chord, which is exact for small angles where the cosine is not.
double angle_deg(const cv::Vec3f& a, const cv::Vec3f& b) {
  const cv::Vec3f apart = a.dot(b) < 0 ? a + b : a - b;
  return 2 * std::asin(std::min(1.0, cv::norm(apart) / 2)) * kDegrees;
}

double inclination_deg(const cv::Vec3f& n) {
  return std::acos(std::min(1.0, static_cast<double>(std::abs(n[2])))) * kDegrees;
}

bool is_normal(const cv::Vec3f& n) {
  return std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
}

}  // namespace

void ErrorHistogram::add(double degrees) {
  const int bin = std::clamp(static_cast<int>(degrees / kBinDeg), 0, kBins - 1);
  ++bins_[static_cast<size_t>(bin)];
  ++count_;
}

double ErrorHistogram::within(double degrees) const {
  const auto end = std::clamp<std::ptrdiff_t>(std::lround(degrees / kBinDeg), 0, kBins);
  const size_t below = std::accumulate(bins_.begin(), bins_.begin() + end, size_t{0});
  return count_ == 0 ? 0 : static_cast<double>(below) / static_cast<double>(count_);
}

double ErrorHistogram::median() const {
  size_t below = 0;
  for (size_t bin = 0; bin < bins_.size(); ++bin) {
    if (2 * (below + bins_[bin]) >= count_ && bins_[bin] > 0)
      return kBinDeg *
             (static_cast<double>(bin) + (0.5 * static_cast<double>(count_) - static_cast<double>(below)) /
                                             static_cast<double>(bins_[bin]));
    below += bins_[bin];
  }
  return 0;
}

void InclinationHistogram::add(double inclination, double deviation_deg) {
  if (std::abs(deviation_deg) >= kReachDeg) return;
  const auto row = static_cast<size_t>(std::clamp(inclination / kRowDeg, 0.0, kRows - 1.0));
  ++counts_[row][static_cast<size_t>((deviation_deg + kReachDeg) / kColumnDeg)];
}

std::array<double, InclinationHistogram::kColumns> InclinationHistogram::row(int index) const {
  const auto& counts = counts_[static_cast<size_t>(index)];
  const auto most = static_cast<double>(std::max<size_t>(1, *std::max_element(counts.begin(), counts.end())));
  std::array<double, kColumns> shares = {};
  for (size_t i = 0; i < shares.size(); ++i) shares[i] = static_cast<double>(counts[i]) / most;
  return shares;
}

double InclinationHistogram::median(int index) const {
  const auto& counts = counts_[static_cast<size_t>(index)];
  const size_t all = std::accumulate(counts.begin(), counts.end(), size_t{0});
  size_t below = 0;
  for (size_t i = 0; i < counts.size() && all > 0; ++i) {
    below += counts[i];
    if (2 * below >= all) return (static_cast<double>(i) + 0.5) * kColumnDeg - kReachDeg;
  }
  return 0;
}

void MethodErrors::add(const cv::Mat& found, const cv::Mat& truth, const cv::Mat& reference) {
  for (int v = 0; v < truth.rows; ++v)
    for (int u = 0; u < truth.cols; ++u) {
      const cv::Vec3f& n = found.at<cv::Vec3f>(v, u);
      const cv::Vec3f& t = truth.at<cv::Vec3f>(v, u);
      const bool has_normal = is_normal(n);
      if (has_normal && !reference.empty() && is_normal(reference.at<cv::Vec3f>(v, u)))
        to_reference.add(angle_deg(n, reference.at<cv::Vec3f>(v, u)));
      if (!is_normal(t)) continue;
      ++pixels;
      if (!has_normal) continue;
      ++normals;
      to_truth.add(angle_deg(n, t));
      const double surface = inclination_deg(t);
      by_inclination.add(surface, inclination_deg(n) - surface);
    }
}

double MethodErrors::density() const {
  return pixels == 0 ? 0 : static_cast<double>(normals) / static_cast<double>(pixels);
}

double MethodErrors::quantile_ms(double share) const {
  if (seconds.empty()) return 0;
  std::vector<double> sorted(seconds);
  std::sort(sorted.begin(), sorted.end());
  const auto last = static_cast<double>(sorted.size() - 1);
  return 1e3 * sorted[static_cast<size_t>(share * last)];
}

double MethodErrors::median_ms() const {
  return quantile_ms(0.5);
}

}  // namespace loci::apps::normals_evaluation
