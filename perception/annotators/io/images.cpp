#include "perception/annotators/io/images.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

const std::array<cv::Scalar, 8> kPalette = {{{60, 60, 230},
                                             {60, 200, 60},
                                             {230, 120, 40},
                                             {40, 200, 230},
                                             {220, 60, 220},
                                             {220, 220, 60},
                                             {80, 140, 255},
                                             {200, 120, 160}}};

}  // namespace

cv::Mat label_image(const types::SceneCas& scene, const std::vector<int>& numbers) {
  const cv::Mat depth = types::view_image(scene, types::SceneCas::kDepth);
  cv::Mat labels = cv::Mat::zeros(depth.size(), CV_16U);
  const std::vector<types::Cluster> clusters = scene.clusters();
  for (size_t i = 0; i < clusters.size(); ++i) {
    const int number = numbers.empty() ? static_cast<int>(i) + 1 : numbers.at(i);
    for (const int32_t index : cluster_indices(clusters[i]))
      labels.ptr<uint16_t>()[index] = static_cast<uint16_t>(number);
  }
  return labels;
}

std::vector<int> tracked_numbers(const types::SceneCas& scene) {
  std::vector<int> numbers;
  for (const types::Cluster& cluster : scene.clusters()) {
    int& number = numbers.emplace_back(0);
    for (const types::Annotation& annotation : cluster.annotations)
      if (const auto tracking = types::try_as<types::TrackingAnnotation>(annotation))
        if (tracking->annotator_id.get() == tracking->source.get())  // others are votes of simple trackers
          number = static_cast<int>(tracking->tracking_id.get());
  }
  return numbers;
}

void write_label_image(const types::SceneCas& scene, const std::filesystem::path& folder,
                       const std::vector<int>& numbers) {
  mapping::write_image(folder / (scene.scene().frame_name.get() + "_label.png"), label_image(scene, numbers));
}

void write_overlay(const types::SceneCas& scene, const std::filesystem::path& folder) {
  if (!scene.has(types::SceneCas::kColor)) return;
  cv::Mat image = types::view_image(scene, types::SceneCas::kColor).clone();
  int number = 0;
  for (const types::Cluster& cluster : scene.clusters()) {
    const cv::Scalar color = kPalette[static_cast<size_t>(number++) % kPalette.size()];
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Rect box = types::from<cv::Rect>(roi.roi.get());
    cv::Mat part = image(box);
    cv::Mat tinted(part.size(), part.type(), color);
    cv::addWeighted(part, 0.5, tinted, 0.5, 0, tinted);
    tinted.copyTo(part, types::from<cv::Mat>(roi.mask.get()));
    cv::rectangle(image, box, color);
    cv::putText(image, std::to_string(number), box.tl() + cv::Point(2, 14), cv::FONT_HERSHEY_SIMPLEX, 0.5,
                cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  }
  mapping::write_image(folder / (std::to_string(scene.scene().frame_index.get()) + ".png"), image);
}

}  // namespace loci::perception
