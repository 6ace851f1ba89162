#pragma once

#include <optional>
#include <string>

#include "mapping/base/math/tally.h"
#include "perception/detection/network_detector.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// What a network finds in the colour image, as clusters with their classes.
class NetworkDetector : public Annotator {
 public:
  static constexpr const char* kName = "NetworkDetector";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;
  void finish(Context& context) override;

 private:
  std::string path_;
  double min_score_ = 0;
  std::optional<ObjectDetector> detector_;
  Tally lifted_{"detection"};
};

}  // namespace loci::perception
