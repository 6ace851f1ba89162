#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string_view>

#include "perception/detection/people_detector.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// View of the scene with the pixels of people: CV_8U, 255; depth image.
inline constexpr std::string_view kPeopleView = "people";

/// Finds people, and arms of those out of view, before objects are looked for: their points are taken out of
/// the cloud. After clusters have been made it only annotates.
class PersonAnnotator : public Annotator {
 public:
  static constexpr const char* kName = "PersonAnnotator";
  AnnotatorDescriptor descriptor() const override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::optional<PeopleDetector> detector_;
};

}  // namespace loci::perception
