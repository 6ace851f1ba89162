#include "mapping/orthophoto/bars.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/orthophoto/parameters.h"
#include "mapping/orthophoto/patch.h"

namespace loci::mapping {
namespace {

/// A bar as seen in the orthophoto, pixels; level bars lie along columns.
struct SeenBar {
  bool level = true;
  double along0 = 0, along1 = 0;  ///< ends
  double across = 0;              ///< middle line
  double width = 0;
  double length() const { return along1 - along0 + 1; }
  double score = 0;        ///< mean contrast against both sides over its noise
  bool in_relief = false;  ///< seen there, not in colour
  size_t layer = 0;   ///< of the image that shows it: 0 = of the face itself, n = the n-th layer before it
  double beyond = 0;  ///< the same beyond its ends, at the end where it is higher, over `score`
};

/// How much each pixel differs from both flanks in the same sense, for a bar of `width` rows.
cv::Mat contrast(const cv::Mat& image, int width) {
  const int flank = std::max(2, width);
  const int reach = width / 2 + 1 + (flank + 1) / 2;  // From the middle of the bar to that of a flank.
  cv::Mat middle, side, difference[2];
  cv::blur(image, middle, {kBars.smooth_px, width});
  cv::blur(image, side, {kBars.smooth_px, flank});
  for (int i = 0; i < 2; ++i) {
    cv::Mat moved;
    const cv::Mat by = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, i == 0 ? -reach : reach);
    cv::warpAffine(side, moved, by, side.size(), cv::INTER_NEAREST | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    difference[i] = middle - moved;
  }
  cv::Mat result(image.size(), CV_32F);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const auto dot =
          static_cast<float>(difference[0].at<cv::Vec3f>(y, x).dot(difference[1].at<cv::Vec3f>(y, x)));
      result.at<float>(y, x) = std::sqrt(std::max(0.F, dot));
    }
  return result;
}

/// Median of the values where a mask is set; 0 without any.
double masked_median(const cv::Mat& values, const cv::Mat& mask) {
  std::vector<float> chosen;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (mask.at<uint8_t>(y, x) != 0) chosen.push_back(values.at<float>(y, x));
  return chosen.empty() ? 0 : static_cast<double>(median(std::move(chosen)));
}

/// Pixels of the face itself.
cv::Mat face_mask(const Orthophoto& photo) {
  cv::Mat mask(photo.color.size(), CV_8U, cv::Scalar(0));
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      const float relief = photo.relief.at<float>(y, x);
      if (photo.weight.at<float>(y, x) > 0 && std::abs(relief) < static_cast<float>(kBars.face_relief_m))
        mask.at<uint8_t>(y, x) = 255;
    }
  return mask;
}

/// Median of a score along a row, with its neighbours.
double median_ridge(const cv::Mat& scores, int x0, int x1, int y) {
  std::vector<float> values;
  for (int x = std::max(0, x0); x < std::min(scores.cols, x1); ++x) {
    float best = 0;
    for (int row = std::max(0, y - 1); row <= std::min(scores.rows - 1, y + 1); ++row)
      best = std::max(best, scores.at<float>(row, x));
    values.push_back(best);
  }
  return values.empty() ? 0 : static_cast<double>(median(std::move(values)));
}

/// The straight bar among the ridge pixels of a component: its strongest row and what lies along it. Unset
/// when too little does.
std::optional<SeenBar> bar_in(const cv::Rect& box, const std::function<bool(int, int)>& is_ridge,
                              const cv::Mat& scores, const cv::Mat& widths) {
  std::vector<cv::Point> pixels;
  std::vector<double> rows(static_cast<size_t>(box.height), 0);
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = box.x; x < box.x + box.width; ++x)
      if (is_ridge(x, y)) {
        pixels.emplace_back(x, y);
        rows[static_cast<size_t>(y - box.y)] += static_cast<double>(scores.at<float>(y, x));
      }
  const int middle = box.y + static_cast<int>(std::max_element(rows.begin(), rows.end()) - rows.begin());
  std::erase_if(pixels,
                [&](const cv::Point& pixel) { return std::abs(pixel.y - middle) > kBars.max_wander_px; });
  std::vector<float> all;
  for (const cv::Point& pixel : pixels) all.push_back(scores.at<float>(pixel));
  // Smoothing along the bar prolongs it to where half of its contrast is left.
  const float half = median(std::move(all)) / 2;
  std::erase_if(pixels, [&](const cv::Point& pixel) { return scores.at<float>(pixel) < half; });
  std::vector<int> columns;
  std::vector<float> chosen, width;
  for (const cv::Point& pixel : pixels) {
    columns.push_back(pixel.x);
    chosen.push_back(scores.at<float>(pixel));
    width.push_back(static_cast<float>(widths.at<int>(pixel)));
  }
  SeenBar bar;
  bar.along0 = *std::min_element(columns.begin(), columns.end());
  bar.along1 = *std::max_element(columns.begin(), columns.end());
  bar.across = middle;
  bar.width = static_cast<double>(median(std::move(width)));
  bar.score = static_cast<double>(median(std::move(chosen)));
  if (static_cast<double>(pixels.size()) < kBars.min_filled * bar.length()) return std::nullopt;
  return bar;
}

/// Level bars of an image (upright ones of its transpose); `strongest`: the score of each pixel.
std::vector<SeenBar> seen_bars(const cv::Mat& image, const cv::Mat& mask, double pixel_m,
                               cv::Mat& strongest) {
  strongest = cv::Mat(image.size(), CV_32F, cv::Scalar(0));
  cv::Mat widths(image.size(), CV_32S, cv::Scalar(0));
  for (const int width : kBars.widths_px) {
    cv::Mat score = contrast(image, width);
    const double noise = std::max(1.4826 * masked_median(score, mask), kBars.min_noise);
    score *= 1 / noise;
    for (int y = 0; y < score.rows; ++y)
      for (int x = 0; x < score.cols; ++x)
        if (score.at<float>(y, x) > strongest.at<float>(y, x)) {
          strongest.at<float>(y, x) = score.at<float>(y, x);
          widths.at<int>(y, x) = width;
        }
  }
  // Ridges: a bar's middle line is stronger than what is above and below.
  cv::Mat around, ridge(image.size(), CV_8U, cv::Scalar(0));
  cv::dilate(strongest, around, cv::Mat::ones(5, 1, CV_8U));
  for (int y = 0; y < ridge.rows; ++y)
    for (int x = 0; x < ridge.cols; ++x)
      if (strongest.at<float>(y, x) > static_cast<float>(kBars.min_score) &&
          strongest.at<float>(y, x) >= around.at<float>(y, x))
        ridge.at<uint8_t>(y, x) = 255;
  const int gap = static_cast<int>(kBars.max_gap_m / pixel_m);
  cv::Mat joined, labels, stats, centres;
  cv::morphologyEx(ridge, joined, cv::MORPH_CLOSE, cv::Mat::ones(1, gap | 1, CV_8U));
  const int count = cv::connectedComponentsWithStats(joined, labels, stats, centres);
  std::vector<SeenBar> bars;
  for (int i = 1; i < count; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_WIDTH) * pixel_m < kBars.min_length_m) continue;
    const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                       stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    std::optional<SeenBar> bar = bar_in(
        box, [&](int x, int y) { return labels.at<int>(y, x) == i && ridge.at<uint8_t>(y, x) != 0; },
        strongest, widths);
    if (!bar || bar->length() * pixel_m < kBars.min_length_m || bar->length() * pixel_m > kFixtures.max_bar_m)
      continue;
    for (const bool at_end : {false, true}) {
      const int reach = static_cast<int>(kBars.beyond_m / pixel_m), blur = kBars.smooth_px;
      const int x0 =
          at_end ? static_cast<int>(bar->along1) + blur : static_cast<int>(bar->along0) - blur - reach;
      bar->beyond = std::max(
          bar->beyond, median_ridge(strongest, x0, x0 + reach, static_cast<int>(bar->across)) / bar->score);
    }
    bars.push_back(*bar);
  }
  return bars;
}

class BarFinder {
 public:
  explicit BarFinder(const Orthophoto& photo) : photo_(photo), mask_(face_mask(photo)) {}

  std::vector<FaceFixture> run() {
    std::vector<SeenBar> bars;
    const auto look = [&](const cv::Mat& image, size_t layer, bool in_relief) {
      for (const bool level : {true, false}) {
        cv::Mat scores;
        for (SeenBar bar : seen_bars(level ? image : cv::Mat(image.t()), level ? mask_ : cv::Mat(mask_.t()),
                                     photo_.pixel_m, scores)) {
          bar.level = level;
          bar.layer = layer;
          bar.in_relief = in_relief;
          bars.push_back(bar);
        }
        if (layer == 1) flat_scores_[level ? 1 : 0] = scores;
      }
    };
    for (size_t layer = 0; layer <= photo_.layers.size(); ++layer) {
      cv::Mat image;
      (layer == 0 ? photo_.color : photo_.layers[layer - 1].color).convertTo(image, CV_32FC3, 1.0 / 255);
      look(image, layer, false);
    }
    // Thin bars seen from very different places vanish in the median of the colours.
    look(relief_image(), 0, true);
    std::stable_sort(bars.begin(), bars.end(),
                     [](const SeenBar& a, const SeenBar& b) { return a.score > b.score; });
    for (const bool standing : {true, false})
      for (const SeenBar& bar : bars)
        if (stands(bar) == standing) consider(bar);
    return std::move(bars_);
  }

 private:
  /// The relief as an image like the colours: 1 is the farthest that handles reach.
  cv::Mat relief_image() const {
    cv::Mat relief = cv::max(cv::min(photo_.relief, kFaces.fixture_reach_m), 0) / kFaces.fixture_reach_m;
    cv::patchNaNs(relief, 0);
    cv::Mat image;
    const std::array<cv::Mat, 3> parts = {relief, relief, relief};
    cv::merge(parts.data(), 3, image);
    return image;
  }

  cv::Rect rect_of(const SeenBar& bar, double margin_m) const {
    const double margin = margin_m / photo_.pixel_m;
    const double half = bar.width / 2 + margin;
    const auto at = [](double value) { return static_cast<int>(std::lround(value)); };
    const int a0 = at(bar.along0 - margin), a1 = at(bar.along1 + margin) + 1;
    const int c0 = at(bar.across - half), c1 = at(bar.across + half) + 1;
    return bar.level ? cv::Rect(a0, c0, a1 - a0, c1 - c0) : cv::Rect(c0, a0, c1 - c0, a1 - a0);
  }

  /// Share of a rectangle's pixels that are face.
  double face_share(const cv::Rect& rect) const {
    const cv::Rect inside = rect & cv::Rect({}, mask_.size());
    if (inside.area() < rect.area() * 2 / 3) return 0;
    return static_cast<double>(cv::countNonZero(mask_(inside))) / inside.area();
  }

  /// The face shows on both sides and beyond both ends.
  double surroundings(const SeenBar& bar) const {
    const double reach = kBars.surroundings_m / photo_.pixel_m;
    SeenBar side = bar;
    double share = 1;
    side.width = reach;
    for (const double sign : {-1.0, 1.0}) {
      side.across = bar.across + sign * (bar.width / 2 + reach / 2 + 1);
      share = std::min(share, face_share(rect_of(side, 0)));
    }
    return share;
  }

  double depth_of(const SeenBar& bar) const {
    return bar.layer == 0 ? 0 : photo_.layers[bar.layer - 1].depth;
  }

  /// Where the frames show on the face what a bar's layer shows at its place, in mean, and how far they
  /// scatter, pixels across the bar.
  std::pair<double, double> displacement(const SeenBar& bar, double depth) const {
    const int along = static_cast<int>((bar.along0 + bar.along1) / 2), across = static_cast<int>(bar.across);
    const cv::Point at = bar.level ? cv::Point(along, across) : cv::Point(across, along);
    if (!at.inside(cv::Rect({}, mask_.size()))) return {0, 0};
    const int axis = bar.level ? 1 : 0;
    const double pixels = depth / photo_.pixel_m;
    // Rows count downwards.
    const auto slope = static_cast<double>(photo_.slope.at<cv::Vec2f>(at)[axis]) * (bar.level ? 1 : -1);
    return {slope * pixels, static_cast<double>(photo_.slope_sd.at<cv::Vec2f>(at)[axis]) * pixels};
  }

  /// How far from its place single frames may show a bar that stands before the face, metres.
  double smear_at(const SeenBar& bar, double depth) const {
    SeenBar turned = bar;  // Its cross section at the same place.
    turned.level = !bar.level;
    turned.along0 = turned.along1 = bar.across;
    turned.across = (bar.along0 + bar.along1) / 2;
    return kBars.smear_sigmas * photo_.pixel_m *
           std::max(displacement(bar, depth).second, displacement(turned, depth).second);
  }

  /// Mean share of the frames that show one colour in a part of a layer.
  double agreement(const cv::Rect& box, size_t layer) const {
    return cv::mean(photo_.layers[layer - 1].agreement(box & cv::Rect({}, mask_.size())))[0];
  }

  /// A bar and its two flanks, as contrast() compares them.
  LayerPatch patch_of(const SeenBar& bar) const {
    const double flank = std::max(2.0, bar.width), reach = bar.width / 2 + 1 + (flank + 1) / 2;
    const auto strip = [&](double offset, double width) {
      SeenBar part = bar;
      part.across += offset;
      part.width = width - 1;
      const cv::Rect rect = rect_of(part, 0);
      std::vector<cv::Point> places;
      for (int y = rect.y; y < rect.y + rect.height; ++y)
        for (int x = rect.x; x < rect.x + rect.width; ++x) places.emplace_back(x, y);
      return places;
    };
    return {strip(0, bar.width), {strip(-reach, flank), strip(reach, flank)}};
  }

  double frames_showing(const SeenBar& bar) const {
    return share_showing(photo_, photo_.layers[bar.layer - 1], patch_of(bar));
  }

  /// Whether a layer shows the bar clearer than the face does, at its place or where its frames show the
  /// face: what is on the face is sharp there.
  bool stands(const SeenBar& bar) const {
    if (depth_of(bar) == 0 || bar.score < kBars.min_standing_score) return false;
    const double moved = displacement(bar, depth_of(bar)).first;
    const cv::Mat& flat = flat_scores_[bar.level ? 1 : 0];
    double on_face = 0;
    const int first = static_cast<int>(std::floor(std::min(0.0, moved))) - kBars.max_wander_px + 1;
    const int last = static_cast<int>(std::ceil(std::max(0.0, moved))) + kBars.max_wander_px - 1;
    for (int by = first; by <= last; ++by)
      on_face =
          std::max(on_face, median_ridge(flat, static_cast<int>(bar.along0), static_cast<int>(bar.along1) + 1,
                                         static_cast<int>(std::lround(bar.across)) + by));
    return bar.score > kBars.min_layer_gain * on_face;
  }

  /// Whether the frames see the bar's place from so different directions that a bar before the face would be
  /// clearer in a layer.
  bool would_stand(const SeenBar& bar) const {
    return displacement(bar, kBars.usual_protrusion_m).second > bar.width;
  }

  void consider(const SeenBar& bar) {
    const cv::Rect box = rect_of(bar, 0);
    const FaceRect rect = {photo_.u(box.x - 0.5), photo_.u(box.x + box.width - 0.5),
                           photo_.v(box.y + box.height - 0.5), photo_.v(box.y - 0.5)};
    if (bar.beyond > kBars.max_continuation || surroundings(bar) < kBars.min_beside) return;
    if (stands(bar)) {
      SeenBar behind = bar;  // What the frames show beside it is the face there.
      behind.across += displacement(bar, depth_of(bar)).first;
      if (surroundings(behind) < kBars.min_beside) return;
      if (agreement(box, bar.layer) > kBars.min_agreement && frames_showing(bar) > kPatches.min_frames)
        add(bar, rect, depth_of(bar), kBars.layer_sd_m);
      return;
    }
    if (bar.layer > 0) return;
    if (!bar.in_relief && !would_stand(bar) && (divides_surfaces(bar) || ends_at_edges(bar))) return;
    const MeasuredRelief relief = relief_of(bar);
    if ((bar.in_relief || would_stand(bar)) &&
        (relief.over_nearer < kBars.min_relief_m || relief.beside > kBars.min_relief_m))
      return;
    if (relief.mean < -kBars.max_recess_sigmas * relief.sd || relief.over_nearer < -kBars.min_relief_m)
      return;
    add(bar, rect, relief.mean, relief.sd);
  }

  /// Mean colour of a part of the image; NaN outside.
  cv::Vec3d color_of(const cv::Rect& rect) const {
    const cv::Rect inside = rect & cv::Rect({}, mask_.size());
    if (inside.area() < rect.area() / 2) return cv::Vec3d::all(std::nan(""));
    const cv::Scalar mean = cv::mean(photo_.color(inside), photo_.weight(inside) > 0);
    return {mean[0], mean[1], mean[2]};
  }

  /// Whether the surfaces on both sides of a bar differ, as at the gap between a front and the slab above it.
  bool divides_surfaces(const SeenBar& bar) const {
    const double reach = kBars.surroundings_m / photo_.pixel_m;
    SeenBar side = bar;
    side.width = reach / 2;
    std::array<cv::Vec3d, 2> colors;
    for (size_t i = 0; i < 2; ++i) {
      // The shadow of a handle is nearer.
      side.across = bar.across + (i == 0 ? -1 : 1) * (bar.width / 2 + 0.75 * reach);
      colors[i] = color_of(rect_of(side, 0));
    }
    const cv::Vec3d own = color_of(rect_of(bar, 0));
    const double contrast = std::min(cv::norm(own - colors[0]), cv::norm(own - colors[1]));
    return cv::norm(colors[0] - colors[1]) > kBars.max_side_change * contrast;
  }

  /// Whether other surfaces begin where the bar ends, as at the ends of a seam: the face beyond a handle
  /// looks like the face beside it.
  bool ends_at_edges(const SeenBar& bar) const {
    const double reach = kBars.surroundings_m / photo_.pixel_m, gap = kBars.smooth_px / 2.0;
    SeenBar side = bar;
    side.width = reach / 2;
    const auto beside = [&](double sign, double from, double to) {
      side.across = bar.across + sign * (bar.width / 2 + 2 + reach / 4);
      side.along0 = from;
      side.along1 = to;
      return color_of(rect_of(side, 0));
    };
    const cv::Vec3d own = color_of(rect_of(bar, 0));
    int edges = 0;
    for (const bool at_end : {false, true}) {
      const double end = at_end ? bar.along1 : bar.along0, out = at_end ? 1 : -1;
      double change = 1e9;  // Stays where nothing is known.
      // A handle may be in the corner of its front: one side is enough.
      for (const double sign : {-1.0, 1.0}) {
        const auto strip = [&](double from, double to) {
          const double a = end + out * from, b = end + out * to;
          return beside(sign, std::min(a, b), std::max(a, b));
        };
        const cv::Vec3d inner = strip(-gap - reach, -gap), outer = strip(gap, gap + reach);
        const double ratio = cv::norm(outer - inner) / cv::norm(own - inner);
        if (!std::isnan(ratio)) change = std::min(change, ratio);
      }
      if (change > kBars.max_end_change && change < 1e9) ++edges;
    }
    return edges == 2;
  }

  struct MeasuredRelief {
    double mean = 0;         ///< against both flanks
    double over_nearer = 0;  ///< against the nearer one: at the edge of a slab only the other is lower
    double beside = 0;  ///< of the flank farther from the face: the top of a slab seen beyond its edge rises
    double sd = 0;      ///< of the mean
  };

  MeasuredRelief relief_of(const SeenBar& bar) const {
    bool measured = true;
    const auto mean = [&](double offset, double width, double& variance) {
      SeenBar part = bar;
      part.across += offset;
      part.width = width;
      const cv::Rect rect = rect_of(part, 0) & cv::Rect({}, mask_.size());
      double sum = 0, weight = 0;
      for (int y = rect.y; y < rect.y + rect.height; ++y)
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
          const auto value = static_cast<double>(photo_.relief.at<float>(y, x));
          const auto own = static_cast<double>(photo_.relief_sd.at<float>(y, x));
          if (std::isnan(value)) continue;
          sum += value / (own * own);
          weight += 1 / (own * own);
        }
      // Pixels of the depth camera are larger than those of the orthophoto: about ten share a measurement.
      variance += weight > 0 ? 10 / weight : 1;
      measured = measured && weight > 0;
      return weight > 0 ? sum / weight : 0;
    };
    double variance = 0;
    const double reach = kBars.surroundings_m / photo_.pixel_m / 2;
    std::array<double, 2> flanks{};
    for (size_t i = 0; i < 2; ++i)
      flanks[i] = mean((i == 0 ? -1 : 1) * (bar.width / 2 + 2 + reach / 2), reach, variance);
    variance /= 4;
    const double own = mean(0, bar.width + 2, variance);
    // Beyond the edge of a slab nothing is measured, and nothing is known to be lower.
    const double over_nearer = measured ? own - std::max(flanks[0], flanks[1]) : 0;
    return {own - (flanks[0] + flanks[1]) / 2, over_nearer,
            std::max(std::abs(flanks[0]), std::abs(flanks[1])), std::sqrt(variance)};
  }

  void add(const SeenBar& bar, const FaceRect& seen, double relief, double relief_sd) {
    const double protrusion =
        bar.layer > 0 ? relief : std::clamp(relief, kBars.usual_protrusion_m, kBars.max_protrusion_m);
    FaceFixture found;
    found.box = seen;
    // What no layer shows is displaced by the directions of the frames that show it.
    const double smear = bar.layer > 0 ? 0 : smear_at(bar, protrusion);
    for (const FaceFixture& other : bars_)
      if (other.box.grown(kBars.same_bar_m + smear).intersects(found.box)) return;
    found.u = found.box.u();
    found.v = found.box.v();
    Fixture& fixture = found.fixture;
    fixture.kind = Fixture::Kind::handle;
    fixture.centre = bar.layer > 0 ? photo_.in_layer({found.u, found.v}, protrusion)
                                   : photo_.in_map({found.u, found.v}, protrusion);
    fixture.axis = bar.level ? photo_.face.right3() : Vector3d::UnitZ();
    fixture.length = bar.length() * photo_.pixel_m;
    fixture.radius = std::clamp(bar.width * photo_.pixel_m / 2, 0.003, 0.03);
    fixture.protrusion = protrusion;
    fixture.confidence = bar.score / (bar.score + kBars.half_score);
    fixture.evidence = {{"contrast", bar.score}, {"relief_m", relief}, {"relief_sd_m", relief_sd}};
    if (bar.layer > 0) {
      fixture.evidence["depth_from"] = "parallax";
      fixture.evidence["agreement"] = agreement(rect_of(bar, 0), bar.layer);
      fixture.evidence["frames_showing"] = frames_showing(bar);
    } else {
      fixture.evidence["position_sd_m"] = smear / kBars.smear_sigmas;
    }
    bars_.push_back(std::move(found));
  }

  const Orthophoto& photo_;
  cv::Mat mask_;
  std::array<cv::Mat, 2> flat_scores_;  ///< of upright (transposed) and level bars in the image of the face
  std::vector<FaceFixture> bars_;
};

}  // namespace

std::vector<FaceFixture> find_bars(const Orthophoto& photo) {
  return BarFinder(photo).run();
}

}  // namespace loci::mapping
