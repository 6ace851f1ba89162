#pragma once

#include <optional>
#include <string>

#include "mapping/base/tally.h"
#include "perception/detection/detection_set.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// What another detector found in the colour images of the recording, as clusters with their classes: boxes
/// and masks are lifted by the depth of the frame. A cluster that is there already takes the class of a
/// detection with which it shares most pixels.
class Detections2D : public Annotator {
 public:
  static constexpr const char* kName = "Detections2D";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;
  void finish(Context& context) override;

 private:
  std::string path_;
  std::optional<DetectionSet> set_;
  Tally lifted_{"detection"};
};

}  // namespace loci::perception
