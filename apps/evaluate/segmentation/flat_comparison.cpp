#include "apps/evaluate/segmentation/flat_comparison.h"

#include <fmt/format.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "apps/evaluate/segmentation/flat_scenes.h"
#include "apps/evaluate/segmentation/strips.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "mapping/image/image_io.h"

namespace loci::apps::segmentation_evaluation {
namespace {

/// What two stages find, as segments of the colour image.
cv::Mat two_stages(const FlatImage& image, const mapping::RgbdCamera& camera,
                   const perception::FlatSurface& surface, const perception::FlatOptions& options) {
  cv::Mat segments = cv::Mat::zeros(image.color.size(), CV_16U);
  int number = 0;
  for (const perception::FlatObject& object :
       find_flat_objects(image.depth, image.color, camera, surface, options))
    segments(object.box).setTo(++number, object.mask);
  return segments;
}

/// Connected pixels that are higher than the middle between table and object.
cv::Mat threshold(const FlatImage& image, const mapping::RgbdCamera& camera,
                  const perception::FlatSurface& surface, const perception::FlatOptions& options) {
  const cv::Mat heights = heights_over_surface(image.depth, camera.depth, surface, options);
  const cv::Mat in_color = seen_by_color(heights, camera, surface, std::numeric_limits<double>::quiet_NaN());
  const double middle = (options.table_m + options.object_m) / 2;
  cv::Mat mask = in_color > middle;
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(5, 5, CV_8U));
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8);
  cv::Mat segments = cv::Mat::zeros(mask.size(), CV_16U);
  constexpr int kMinPixels = 200;
  for (int label = 1, number = 0; label < count; ++label)
    if (stats.at<int>(label, cv::CC_STAT_AREA) >= kMinPixels) segments.setTo(++number, labels == label);
  return segments;
}

}  // namespace

void FlatComparisonOptions::declare(OptionTable& table) {
  table.integer("flat_workspaces", workspaces, "", "Simulated workspaces, from near to far.", 1, 1000);
  table.integer("flat_images", images, "", "Images of each, under changing light.", 1, 1000);
  table.integer("flat_empty", empty_images, "", "Images of the empty tables for the calibration.", 1, 10000);
  table.number("flat_nearest_m", nearest_m, "m", "Distance of the nearest camera.", 0.5, 4);
  table.number("flat_farthest_m", farthest_m, "m", "Distance of the farthest camera.", 0.5, 4);
  table.integer("flat_seed", seed, "", "Seed of the simulated workspaces.", 0, 1 << 30);
}

FlatComparison compare_flat(const FlatComparisonOptions& options, const perception::FlatOptions& flat,
                            const std::filesystem::path& images, Progress& progress) {
  FlatComparison comparison;
  comparison.workspaces = options.workspaces;
  comparison.methods = {{"two stages, calibrated", {}, {}},
                        {"height > 5 mm, calibrated", {}, {}},
                        {"two stages, not calibrated", {}, {}},
                        {"height > 5 mm, not calibrated", {}, {}},
                        {"height > 5 mm over the plane", {}, {}}};
  perception::FlatOptions over_plane = flat;
  over_plane.background_m = 0;
  const Random random(static_cast<uint64_t>(options.seed));
  if (!images.empty()) make_folder(images);
  for (int w = 0; w < options.workspaces; ++w) {
    const double part = options.workspaces == 1 ? 0.5 : static_cast<double>(w) / (options.workspaces - 1);
    const double distance = options.nearest_m + part * (options.farthest_m - options.nearest_m);
    const FlatWorkspace workspace(distance, random.fork(static_cast<uint64_t>(w)));
    perception::SurfaceCalibration calibration;
    for (int i = 0; i < options.empty_images; ++i) {
      progress.check((w + 0.5 * i / options.empty_images) / options.workspaces, "empty tables");
      calibration.add(workspace.empty_depth(static_cast<uint64_t>(i)));
    }
    const perception::FlatSurface plain{workspace.normal(), workspace.offset(), workspace.inside(), {}};
    perception::FlatSurface calibrated = plain;
    calibrated.empty_depth = calibration.mean();
    for (FlatMethod& method : comparison.methods) method.by_distance.emplace_back(distance, Scores());
    for (int i = 0; i < options.images; ++i) {
      progress.check((w + 0.5 + 0.5 * i / options.images) / options.workspaces, "images");
      const FlatImage image = workspace.image(static_cast<uint64_t>(i));
      const mapping::RgbdCamera& camera = workspace.camera();
      const std::vector<cv::Mat> found = {
          two_stages(image, camera, calibrated, flat), threshold(image, camera, calibrated, flat),
          two_stages(image, camera, plain, flat), threshold(image, camera, plain, flat),
          threshold(image, camera, plain, over_plane)};
      for (size_t m = 0; m < found.size(); ++m) {
        comparison.methods[m].all.add(image.truth, found[m]);
        comparison.methods[m].by_distance.back().second.add(image.truth, found[m]);
      }
      ++comparison.images;
      if (i + 1 == options.images && !images.empty())
        mapping::write_image(images / fmt::format("flat_{}.png", w + 1),
                             strip(image.color, image.truth.object, found, 0.25));
    }
  }
  return comparison;
}

std::string FlatComparison::text() const {
  std::string text = fmt::format(
      "{} workspaces, {} images, {} pieces of 10 mm\n  {:<30}{:>9}{:>9}{:>9}{:>9}   IoU by distance\n",
      workspaces, images, methods.front().all.objects(), "", "IoU", "F1", "prec.", "recall");
  for (const FlatMethod& method : methods) {
    text += fmt::format("  {:<30}{:>9.3f}{:>7.1f} %{:>7.1f} %{:>7.1f} %  ", method.name,
                        method.all.mean_overlap(), 100 * method.all.f1(), 100 * method.all.precision(),
                        100 * method.all.recall());
    for (const auto& [distance, scores] : method.by_distance)
      text += fmt::format(" {:.1f} m {:.2f}", distance, scores.mean_overlap());
    text += "\n";
  }
  return text;
}

Json FlatComparison::to_json() const {
  Json json = {{"workspaces", workspaces}, {"images", images}, {"methods", Json::array()}};
  for (const FlatMethod& method : methods) {
    Json each = method.all.to_json();
    each["method"] = method.name;
    each["distances"] = Json::array();
    for (const auto& [distance, scores] : method.by_distance) {
      Json at = scores.to_json();
      at["distance_m"] = distance;
      each["distances"].push_back(std::move(at));
    }
    json["methods"].push_back(std::move(each));
  }
  return json;
}

}  // namespace loci::apps::segmentation_evaluation
