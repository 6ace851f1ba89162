#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

/// Templates of half of a recording's images, looked for in the other half.
struct TemplatesResult {
  size_t images = 0, templates = 0;
  int samples = 0;           ///< in the images tested, of which there are templates
  int right = 0, wrong = 0;  ///< matches: of the object that is there, and others
  double seconds = 0;        ///< an image
  std::vector<std::string> mistakes;

  std::string text() const;
  Json to_json() const;
};

/// `folder` as loci-perceive train takes it. A match is right when its region overlaps the object's by at
/// least 0.4.
TemplatesResult evaluate_templates(const std::filesystem::path& folder, Progress& progress);

}  // namespace loci::apps::description_evaluation
