// An annotator outside of loci: how bright each object looks.

#include <opencv2/imgproc.hpp>

#include "brightness/generated.h"
#include "perception/conversions/opencv.h"
#include "perception/pipeline/plugin.h"

namespace {

using namespace loci::perception;

class BrightnessAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {"Brightness",
            "Says how bright each object looks.",
            {"Cluster", "StandaloneImageROI"},  // needs
            {"BrightnessAnnotation"}};          // makes
  }

  void declare(loci::OptionTable& table) override {
    table.number("dark", dark_, "", "Objects whose mean is below this are dark.", 0, 1);
    table.number("bright", bright_, "", "Objects whose mean is above this are bright.", 0, 1);
  }

  void process(cas::Cas& cas, Context& /*context*/) override {
    for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
      const auto region = cluster.hypotheses.first<types::StandaloneImageROI>();
      if (!region) continue;  // Not in the colour image.
      cv::Mat grey;
      cv::cvtColor(types::from<cv::Mat>(region.image.get()), grey, cv::COLOR_BGR2GRAY);
      const double mean = cv::mean(grey, types::from<cv::Mat>(region.mask.get()))[0] / 255;
      const auto annotation = brightness::BrightnessAnnotation::create(cas);
      annotation.mean.set(mean);
      annotation.word.set(mean < dark_ ? "dark" : mean > bright_ ? "bright" : "medium");
      cluster.annotations.push_back(annotation);
    }
  }

 private:
  double dark_ = 0.25;
  double bright_ = 0.6;
};

void add_annotators(AnnotatorRegistry& registry) {
  registry.add<BrightnessAnnotator>();
}

}  // namespace

LOCI_PLUGIN("brightness", add_annotators, brightness::type_sources)
