#pragma once

#include <optional>
#include <string>

#include "mapping/base/math/tally.h"
#include "perception/detection/detection_set.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Lifts detections in the colour image of a scene by its depth. A cluster that is there already takes the
/// class of a detection of the same object; of the others clusters are made. `source`: the
/// annotator; `lifted_detections` counts them.
void add_detections(cas::Cas& cas, const std::vector<Detection2D>& detections, const std::string& source,
                    Tally& lifted_detections);
/// A warning that says how many were not lifted, and why; `file` is where they come from.
void warn_of_unlifted(const Tally& lifted_detections, const std::string& file, Warnings& warnings);

/// What another detector found in the colour images of the recording, as clusters with their classes.
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
