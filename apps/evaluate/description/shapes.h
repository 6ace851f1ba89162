#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

struct ShapesOptions {
  int train_scenes = 160;
  int test_scenes = 80;
  int folds = 5;
  int seed = 0;
  std::vector<std::string> experts = {"VFH:svm", "CVFH:svm", "ESF:svm",
                                      "PFH:svm", "SHOT:svm", "GaussImage:svm"};

  void declare(OptionTable& table);
};

/// How objects of each class (rows) were classified (columns).
struct Confusion {
  std::vector<std::string> classes;
  std::vector<std::vector<int>> counts;
  double log_loss = 0;                ///< mean of -log of the true class's probability
  int missed = 0;                     ///< objects that the segmentation did not find
  std::vector<std::string> mistakes;  ///< "frame: truth taken for answer (probability)"

  double rate(size_t row) const;  ///< share of the class that is right; NaN when there is none
  double accuracy() const;        ///< share of all that is right
};

struct ShapesResult {
  struct Row {
    std::string name;                    ///< of the expert, or "fused"
    std::vector<Confusion> by_test_set;  ///< in order of test_sets
  };
  std::vector<std::string> test_sets;
  size_t trained_on = 0;
  std::vector<Row> rows;

  std::string text() const;
  Json to_json() const;
};

/// Trains each expert alone and all fused on simulated clusters (primitive_scenes()), and tests them on other
/// simulated ones and on recordings with label images and scenes.csv: objects of scenes whose category
/// speaks of boxes are boxes, those of "cylindric" ones cylinders, others are left out. Everything is
/// segmented by the tabletop pipeline.
ShapesResult evaluate_shapes(const std::vector<std::string>& folders, const ShapesOptions& options,
                             int threads, Progress& progress, Warnings& warnings);

}  // namespace loci::apps::description_evaluation
