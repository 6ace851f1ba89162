#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/evaluate/segmentation/scores.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "perception/annotators/segmentation/flat_objects.h"

namespace loci::apps::segmentation_evaluation {

struct FlatComparisonOptions {
  int workspaces = 6;
  int images = 8;
  int empty_images = 100;
  double nearest_m = 1.0;
  double farthest_m = 1.5;
  int seed = 1;

  void declare(OptionTable& table);
};

/// One way to find flat objects: the scores at each distance.
struct FlatMethod {
  std::string name;
  Scores all;
  std::vector<std::pair<double, Scores>> by_distance;
};

struct FlatComparison {
  int workspaces = 0;
  int images = 0;
  std::vector<FlatMethod> methods;

  std::string text() const;
  Json to_json() const;
};

/// Simulated workspaces (FlatWorkspace): the two-stage method and a threshold of 5 mm, each with and without
/// calibration on images of the empty tables, and that threshold over the tables' ideal plane. Masks are
/// compared in the colour image. With `images` the last image of each workspace goes there, with the
/// truth and what both methods found.
FlatComparison compare_flat(const FlatComparisonOptions& options, const perception::FlatOptions& flat,
                            const std::filesystem::path& images, Progress& progress);

}  // namespace loci::apps::segmentation_evaluation
