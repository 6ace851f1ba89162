#include "mapping/orthophoto/patch.h"

#include <optional>

#include "mapping/orthophoto/parameters.h"

namespace loci::mapping {
namespace {

/// Mean colour of the places that an image shows; unset when it shows too few.
template <typename ColorAt>
std::optional<cv::Vec3d> mean_color(const std::vector<cv::Point>& places, const ColorAt& color_at) {
  cv::Vec3d sum(0, 0, 0);
  double count = 0;
  for (const cv::Point& place : places)
    if (const cv::Vec3b* color = color_at(place)) sum += cv::Vec3d(*color), ++count;
  if (count < kPatches.min_seen * static_cast<double>(places.size()) || count == 0) return std::nullopt;
  return sum / count;
}

/// The difference of a patch from each of its sides.
template <typename ColorAt>
std::optional<std::vector<cv::Vec3d>> differences(const LayerPatch& patch, const ColorAt& color_at) {
  const auto own = mean_color(patch.own, color_at);
  if (!own) return std::nullopt;
  std::vector<cv::Vec3d> result;
  for (const auto& side : patch.sides) {
    const auto beside = mean_color(side, color_at);
    if (!beside) return std::nullopt;
    result.push_back(*own - *beside);
  }
  return result;
}

/// Whether differences are those of the layer, in sense and in part of their size.
bool are_alike(const std::vector<cv::Vec3d>& own, const std::vector<cv::Vec3d>& layer) {
  for (size_t i = 0; i < own.size(); ++i)
    if (own[i].dot(layer[i]) < kPatches.min_contrast * layer[i].dot(layer[i])) return false;
  return true;
}

}  // namespace

double share_showing(const Orthophoto& photo, const PhotoLayer& layer, const LayerPatch& patch) {
  const cv::Rect all({}, photo.color.size());
  const auto in_layer = differences(
      patch, [&](const cv::Point& at) { return at.inside(all) ? &layer.color.at<cv::Vec3b>(at) : nullptr; });
  if (!in_layer) return 0;
  double seen = 0, shown = 0;
  for (const PhotoView& view : photo.views) {
    const LayerScaling scaling = photo.scaling(view, layer.depth);
    bool sees = false, shows = false;
    // The layer's distance is not quite that of the patch.
    for (int dy = -kPatches.reach_px; dy <= kPatches.reach_px && !shows; ++dy)
      for (int dx = -kPatches.reach_px; dx <= kPatches.reach_px && !shows; ++dx) {
        const auto in_view = differences(patch, [&](const cv::Point& at) -> const cv::Vec3b* {
          const cv::Point from = scaling.on_face(at.x + dx, at.y + dy);
          return from.inside(all) && view.quality.at<float>(from) > 0 ? &view.color.at<cv::Vec3b>(from)
                                                                      : nullptr;
        });
        sees = sees || in_view;
        shows = in_view && are_alike(*in_view, *in_layer);
      }
    seen += sees ? 1 : 0;
    shown += shows ? 1 : 0;
  }
  return seen > 0 ? shown / seen : 0;
}

}  // namespace loci::mapping
