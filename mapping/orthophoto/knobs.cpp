#include "mapping/orthophoto/knobs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/orthophoto/parameters.h"
#include "mapping/orthophoto/patch.h"

namespace loci::mapping {
namespace {

constexpr int kSides = 8;

struct SeenKnob {
  cv::Point at;       ///< in its layer
  cv::Point on_face;  ///< where the frames of the layer show the face
  int radius = 0;     ///< pixels
  size_t layer = 0;   ///< index
  float score = 0;
  double relief = 0;  ///< metres, of a knob that no layer shows clearer than the face; else 0
};

/// How much each pixel's disc differs from what is around it in the same sense, in the direction in which it
/// differs least.
cv::Mat spot_contrast(const cv::Mat& image, int radius) {
  cv::Mat middle, side;
  cv::blur(image, middle, {radius, radius});
  cv::blur(image, side, {radius, radius});
  std::array<cv::Mat, kSides> difference;
  cv::Mat mean(image.size(), CV_32FC3, cv::Scalar::all(0));
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * kPi * i / kSides, reach = kKnobs.ring * radius;
    const cv::Mat by = (cv::Mat_<double>(2, 3) << 1, 0, std::round(reach * std::cos(angle)), 0, 1,
                        std::round(reach * std::sin(angle)));
    cv::Mat moved;
    cv::warpAffine(side, moved, by, side.size(), cv::INTER_NEAREST | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    difference[static_cast<size_t>(i)] = middle - moved;
    mean += difference[static_cast<size_t>(i)] / kSides;
  }
  cv::Mat result(image.size(), CV_32F, cv::Scalar(0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec3f& towards = mean.at<cv::Vec3f>(y, x);
      const auto length = static_cast<float>(cv::norm(towards));
      if (length < static_cast<float>(kKnobs.min_noise)) continue;
      float least = length;
      for (const cv::Mat& one : difference)
        least = std::min(least, static_cast<float>(one.at<cv::Vec3f>(y, x).dot(towards)) / length);
      result.at<float>(y, x) = std::max(0.F, least);
    }
  return result;
}

cv::Mat unit_image(const cv::Mat& color) {
  cv::Mat image;
  color.convertTo(image, CV_32FC3, 1.0 / 255);
  return image;
}

class KnobFinder {
 public:
  KnobFinder(const Orthophoto& photo, const std::vector<FaceFixture>& bars) : photo_(photo), bars_(bars) {
    // Knobs that the relief shows, and what it smears of them, are before the face.
    mask_ = (photo.relief > -kBars.face_relief_m) & (photo.weight > 0);
    mask_.convertTo(mask_, CV_32F, 1.0 / 255);
  }

  std::vector<FaceFixture> run() {
    std::vector<SeenKnob> knobs;
    for (const int radius : kKnobs.radii_px) {
      const cv::Mat flat = spot_contrast(unit_image(photo_.layers.front().color), radius) / kKnobs.min_noise;
      cv::Mat around;
      cv::blur(mask_, around, {5 * radius, 5 * radius});
      for (size_t layer = 1; layer < photo_.layers.size(); ++layer)
        if (photo_.layers[layer].depth < kKnobs.max_protrusion_m)
          look(spot_contrast(unit_image(photo_.layers[layer].color), radius) / kKnobs.min_noise, flat, around,
               {{}, {}, radius, layer, 0, 0}, knobs);
    }
    std::stable_sort(knobs.begin(), knobs.end(),
                     [](const SeenKnob& a, const SeenKnob& b) { return a.score > b.score; });
    std::vector<FaceFixture> found;
    for (const SeenKnob& knob : knobs) {
      const FaceFixture one = fixture_of(knob);
      const auto same = [&](const FaceFixture& other) {
        return other.box.grown(kKnobs.min_apart_m).intersects(one.box);
      };
      if (std::none_of(bars_.begin(), bars_.end(), same) && std::none_of(found.begin(), found.end(), same))
        found.push_back(one);
    }
    return found;
  }

 private:
  /// The largest scores of a layer that stand out against the image of the face.
  void look(const cv::Mat& scores, const cv::Mat& flat, const cv::Mat& around, SeenKnob knob,
            std::vector<SeenKnob>& knobs) const {
    cv::Mat highest, on_face;
    const int reach = static_cast<int>(kKnobs.min_apart_m / photo_.pixel_m) | 1;
    cv::dilate(scores, highest, cv::Mat::ones(reach, reach, CV_8U));
    cv::dilate(flat, on_face, cv::Mat::ones(5, 5, CV_8U));
    const double depth = photo_.layers[knob.layer].depth / photo_.pixel_m;
    for (int y = 0; y < scores.rows; ++y)
      for (int x = 0; x < scores.cols; ++x) {
        knob.score = scores.at<float>(y, x);
        if (knob.score < static_cast<float>(kKnobs.min_score) || knob.score < highest.at<float>(y, x) ||
            around.at<float>(y, x) < static_cast<float>(kKnobs.min_beside))
          continue;
        const cv::Vec2f slope = photo_.slope.at<cv::Vec2f>(y, x);
        const cv::Point moved(x - static_cast<int>(std::lround(static_cast<double>(slope[0]) * depth)),
                              y + static_cast<int>(std::lround(static_cast<double>(slope[1]) * depth)));
        if (!shows_face_around(around, {x, y}, depth)) continue;
        const float same = std::max(on_face.at<float>(y, x), on_face.at<float>(moved));
        knob.relief = 0;
        if (knob.score < static_cast<float>(kKnobs.min_layer_gain) * same)
          if (knob.relief = relief_at(moved, knob.radius); knob.relief < kKnobs.min_relief_m) continue;
        if (photo_.layers[knob.layer].agreement.at<float>(y, x) < static_cast<float>(kBars.min_agreement))
          continue;
        knob.at = {x, y};
        knob.on_face = moved;
        if (frames_showing(knob) > kPatches.min_frames) knobs.push_back(knob);
      }
  }

  /// Whether most frames show the face around a place of a layer.
  bool shows_face_around(const cv::Mat& around, const cv::Point& at, double depth_px) const {
    const cv::Vec2f slope = photo_.slope.at<cv::Vec2f>(at), sd = photo_.slope_sd.at<cv::Vec2f>(at);
    for (const float u : {-1.F, 0.F, 1.F})
      for (const float v : {-1.F, 0.F, 1.F}) {
        const auto pixels = [&](int axis, float by) {
          return static_cast<int>(std::lround(static_cast<double>(slope[axis] + by * sd[axis]) * depth_px));
        };
        const cv::Point seen(at.x - pixels(0, u), at.y + pixels(1, v));
        if (!seen.inside(cv::Rect({}, around.size())) ||
            around.at<float>(seen) < static_cast<float>(kKnobs.min_beside))
          return false;
      }
    return true;
  }

  /// Median of the measured relief around a pixel; 0 without.
  double relief_at(const cv::Point& at, int radius) const {
    const cv::Rect disc =
        cv::Rect(at.x - radius / 2, at.y - radius / 2, radius, radius) & cv::Rect({}, photo_.relief.size());
    std::vector<float> values;
    for (int y = disc.y; y < disc.y + disc.height; ++y)
      for (int x = disc.x; x < disc.x + disc.width; ++x)
        if (const float relief = photo_.relief.at<float>(y, x); !std::isnan(relief)) values.push_back(relief);
    return values.empty() ? 0 : static_cast<double>(median(std::move(values)));
  }

  /// A knob and what is on each of its sides, as spot_contrast() compares them.
  static LayerPatch patch_of(const SeenKnob& knob) {
    const auto square = [&](const cv::Point& middle) {
      const int first = -(knob.radius / 2);
      std::vector<cv::Point> places;
      for (int y = first; y < first + knob.radius; ++y)
        for (int x = first; x < first + knob.radius; ++x) places.emplace_back(middle.x + x, middle.y + y);
      return places;
    };
    LayerPatch patch{square(knob.at), {}};
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * kPi * i / kSides, reach = kKnobs.ring * knob.radius;
      patch.sides.push_back(
          square(knob.at + cv::Point(static_cast<int>(std::lround(reach * std::cos(angle))),
                                     static_cast<int>(std::lround(reach * std::sin(angle))))));
    }
    return patch;
  }

  double frames_showing(const SeenKnob& knob) const {
    return share_showing(photo_, photo_.layers[knob.layer], patch_of(knob));
  }

  FaceFixture fixture_of(const SeenKnob& knob) const {
    FaceFixture found;
    const bool by_relief = knob.relief > 0;
    const cv::Point at = by_relief ? knob.on_face : knob.at;
    found.u = photo_.u(at.x);
    found.v = photo_.v(at.y);
    const double radius = knob.radius * photo_.pixel_m;
    const double depth = by_relief ? knob.relief : photo_.layers[knob.layer].depth;
    found.box = {found.u - radius, found.u + radius, found.v - radius, found.v + radius};
    Fixture& fixture = found.fixture;
    fixture.kind = Fixture::Kind::knob;
    fixture.centre =
        by_relief ? photo_.in_map({found.u, found.v}, depth) : photo_.in_layer({found.u, found.v}, depth);
    fixture.axis = photo_.face.normal3();
    fixture.length = 2 * radius;
    fixture.radius = radius;
    fixture.protrusion = depth;
    const auto score = static_cast<double>(knob.score);
    fixture.confidence = score / (score + kKnobs.half_score);
    fixture.evidence = {{"contrast", score},
                        {"relief_m", depth},
                        {"relief_sd_m", kBars.layer_sd_m},
                        {"depth_from", by_relief ? "relief" : "parallax"},
                        {"agreement", photo_.layers[knob.layer].agreement.at<float>(knob.at)},
                        {"frames_showing", frames_showing(knob)}};
    return found;
  }

  const Orthophoto& photo_;
  const std::vector<FaceFixture>& bars_;
  cv::Mat mask_;
};

}  // namespace

std::vector<FaceFixture> find_knobs(const Orthophoto& photo, const std::vector<FaceFixture>& bars) {
  return KnobFinder(photo, bars).run();
}

}  // namespace loci::mapping
