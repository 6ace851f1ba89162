#include "mapping/orthophoto/lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/orthophoto/parameters.h"

namespace loci::mapping {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Mean of the known pixels in a window; NaN where less than half is known.
cv::Mat masked_mean(const cv::Mat& values, const cv::Mat& known, const cv::Size& window) {
  cv::Mat sum, share;
  cv::boxFilter(values.mul(known), sum, CV_32F, window, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::boxFilter(known, share, CV_32F, window, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::Mat mean = sum / share;
  mean.setTo(cv::Scalar(static_cast<double>(kUnknown)), share < 0.5);
  return mean;
}

/// The image moved to the right; what comes in is unknown.
cv::Mat moved(const cv::Mat& image, int columns) {
  cv::Mat result(image.size(), CV_32F, cv::Scalar(static_cast<double>(kUnknown)));
  const int width = image.cols - std::abs(columns);
  if (width <= 0) return result;
  const int from = std::max(0, -columns), to = std::max(0, columns);
  image(cv::Rect(from, 0, width, image.rows)).copyTo(result(cv::Rect(to, 0, width, image.rows)));
  return result;
}

/// Differences as standard scores: over their robust spread on the face, at least `min_sd`.
cv::Mat standardised(const cv::Mat& difference, const cv::Mat& face, double min_sd) {
  std::vector<float> values;
  for (int y = 0; y < face.rows; y += 2)
    for (int x = 0; x < face.cols; x += 2)
      if (face.at<uint8_t>(y, x) != 0 && !std::isnan(difference.at<float>(y, x)))
        values.push_back(std::abs(difference.at<float>(y, x)));
  const double sd =
      values.empty() ? min_sd : std::max(min_sd, 1.4826 * static_cast<double>(median(std::move(values))));
  return difference / sd;
}

}  // namespace

PhotoLines::Direction PhotoLines::direction_of(const cv::Mat& color, const cv::Mat& known,
                                               const cv::Mat& face) {
  Direction result;
  std::array<cv::Mat, 3> parts;
  cv::split(color, parts.data());
  const cv::Size flank(kLines.flank_px, kLines.chunk_px);
  const cv::Mat grey = (parts[0] + parts[1] + parts[2]) / 3;
  const cv::Mat side = masked_mean(grey, known, flank);
  const int reach = kLines.core_px / 2 + 1 + kLines.flank_px / 2;
  const cv::Mat before = moved(side, reach), after = moved(side, -reach);
  const cv::Mat middle = masked_mean(grey, known, {kLines.core_px, kLines.chunk_px});
  // cv::min and cv::max drop NaN; adding it times zero keeps it. Seams are dark, or light where they show a
  // lit body.
  const cv::Mat darker = cv::min(before, after) - middle, lighter = middle - cv::max(before, after);
  const cv::Mat seam =
      standardised(cv::max(darker, lighter) + 0 * (before + after + middle), face, kLines.min_sd);
  // A line that leans or is drawn by several fronts wanders by a pixel.
  result.scores[kSeam] = cv::max(seam, cv::max(moved(seam, 1), moved(seam, -1))) + 0 * seam;
  const int gap = kLines.flank_px / 2 + 1;
  for (size_t c = 0; c < 3; ++c) {
    const cv::Mat mean = masked_mean(parts[c], known, flank);
    result.scores[c + 1] = standardised(moved(mean, -gap) - moved(mean, gap), face, kLines.min_sd);
  }
  return result;
}

PhotoLines::PhotoLines(const Orthophoto& photo, const cv::Mat& hidden) {
  cv::Mat color, known;
  photo.color.convertTo(color, CV_32FC3, 1.0 / 255);
  cv::Mat(photo.weight > 0).convertTo(known, CV_32F, 1.0 / 255);
  const cv::Mat face = cv::abs(photo.relief) < kBars.face_relief_m;
  if (!hidden.empty()) known.setTo(0, hidden);
  upright_ = direction_of(color, known, face);
  level_ = direction_of(color.t(), known.t(), face.t());
}

PhotoLine PhotoLines::line_in(size_t channel, bool upright, int position, int from, int to) const {
  const cv::Mat& scores = (upright ? upright_ : level_).scores[channel];
  PhotoLine result;
  result.position = position;
  if (position < 0 || position >= scores.cols) return result;
  const int chunks = std::max(1, (to - from) / kLines.chunk_px);
  std::vector<float> values;
  double sum = 0;
  for (int i = 0; i < chunks; ++i) {
    const int at = from + (2 * i + 1) * (to - from) / (2 * chunks);
    if (at < 0 || at >= scores.rows || std::isnan(scores.at<float>(at, position))) continue;
    result.strength += static_cast<double>(scores.at<float>(at, position));
    values.push_back(std::clamp(scores.at<float>(at, position), -kLines.max_z, kLines.max_z));
    sum += static_cast<double>(values.back());
  }
  result.strength = std::abs(result.strength);
  const auto known = static_cast<double>(values.size());
  if (known < std::max(1.0, kLines.min_known * chunks) || (channel == kSeam && sum < 0)) return result;
  const float sign = sum < 0 ? -1 : 1;
  const auto shown =
      std::count_if(values.begin(), values.end(), [&](float z) { return sign * z > kLines.shown_z; });
  result.z = std::abs(sum) / std::sqrt(known);
  result.share = static_cast<double>(shown) / known;
  result.kind = channel == kSeam ? PhotoLine::Kind::seam : PhotoLine::Kind::step;
  return result;
}

PhotoLine PhotoLines::line(bool upright, int position, int from, int to) const {
  PhotoLine best;
  for (size_t channel = 0; channel < kChannels; ++channel)
    if (const PhotoLine one = line_in(channel, upright, position, from, to); one.z > best.z) best = one;
  return best;
}

PhotoLine PhotoLines::strongest(bool upright, int first, int last, int from, int to) const {
  const auto cuts = [](const PhotoLine& one) { return one.z > kLines.min_z && one.share > kLines.min_share; };
  PhotoLine best;
  for (int position = first; position <= last; ++position) {
    const PhotoLine one = line(upright, position, from, to);
    if (one.z > best.z && cuts(one)) best = one;
  }
  if (best.kind == PhotoLine::Kind::none) return best;
  // Strong scores are limited, so that neighbouring positions are equal. The flanks of a seam are steps, too.
  const int reach = kLines.core_px + kLines.flank_px;
  PhotoLine seam, step;
  for (int position = std::max(first, best.position - reach);
       position <= std::min(last, best.position + reach); ++position)
    for (size_t channel = 0; channel < kChannels; ++channel) {
      const PhotoLine one = line_in(channel, upright, position, from, to);
      PhotoLine& strongest = channel == kSeam ? seam : step;
      if (one.strength > strongest.strength && cuts(one)) strongest = one;
    }
  return seam.kind != PhotoLine::Kind::none ? seam : step;
}

}  // namespace loci::mapping
