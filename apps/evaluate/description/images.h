#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

struct ImagesOptions {
  std::vector<std::string> experts = {"SIFTBag:svm", "ORBBag:svm", "HOG:svm"};
  int parts = 3;
  int seed = 0;

  void declare(OptionTable& table);
};

/// Each expert alone, and all fused, on images that they have not learned.
struct ImagesResult {
  struct Row {
    std::string name;
    int right = 0, samples = 0;
    double log_loss = 0;  ///< mean of -log of the true class's probability
  };
  size_t classes = 0;
  std::vector<Row> rows;  ///< the last is the fused one

  std::string text() const;
  Json to_json() const;
};

/// Experts of images (bags of words of key points, gradients) learn what DIR/labels.csv's images show
/// (columns file, class_name) from all parts but one and are tested on that one, each in its turn.
ImagesResult evaluate_images(const std::filesystem::path& folder, const ImagesOptions& options, int threads,
                             Progress& progress);

}  // namespace loci::apps::description_evaluation
