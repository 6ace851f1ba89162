#include "perception/annotators/description/perceptual_hash_annotator.h"

#include "perception/conversions/opencv.h"
#include "perception/recognition/perceptual_hash.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

AnnotatorDescriptor PerceptualHashAnnotator::descriptor() const {
  return {"PerceptualHash",
          "Gives each object's image a perceptual hash and colours by which it is known again.",
          {"Cluster", "StandaloneImageROI"},
          {"StandaloneImageROI.phash"}};
}

void PerceptualHashAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Mat image = types::from<cv::Mat>(roi.image.get());
    if (image.empty() || image.type() != CV_8UC3) continue;
    roi.phash.set(static_cast<int64_t>(perceptual_hash(image)));
    const cv::Mat colors = cell_colors(image);
    const auto* begin = colors.ptr<float>();
    roi.cell_colors.set(std::vector<float>(begin, begin + colors.total() * 3));
  }
}

}  // namespace loci::perception
