#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/evaluate/system/scene_counts.h"
#include "apps/evaluate/system/throughput.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::system_evaluation {

struct SystemOptions {
  int scenes = 103;
  int seed = 1;
  int frames = 0;     ///< of which the throughput is measured; 0 = one per scene
  bool words = true;  ///< read barcodes and printed words
  int threads = 0;
  std::filesystem::path map = "apps/samples/kitchen_l.urdf";
  std::filesystem::path pipeline = {};  ///< YAML; empty = the default one, and words

  void declare(OptionTable& table);
};

/// How the objects of one kind were found.
struct KindScore {
  bool flat = false;
  size_t there = 0;     ///< sightings: 150 pixels and 30 % of it are to be seen
  size_t found = 0;     ///< that a cluster covers: intersection over union of at least a half
  size_t clusters = 0;  ///< most of whose points are of this kind, each sighting's own and further ones
};

/// A line of table 8.5: how often a type occurs, and on what.
struct TypeCount {
  std::string type;
  size_t count = 0;
};

struct SystemResult {
  size_t scenes = 0;
  size_t true_objects = 0;                            ///< different ones that were set up
  size_t objects = 0;                                 ///< that the memory knows in the end
  size_t clusters = 0;                                ///< all observations
  size_t false_clusters = 0;                          ///< of no object
  Histogram flat_set, solid_set, total_set;           ///< tables 8.1 to 8.3: set up
  Histogram flat_found, solid_found, total_found;     ///< the same of what the pipeline found
  std::vector<size_t> points;                         ///< of each cluster (table 8.4)
  std::vector<TypeCount> scene_types, cluster_types;  ///< table 8.5: on scenes and views, on clusters
  std::map<std::pair<std::string, std::string>, size_t> results;  ///< table 8.6: category and title
  std::vector<TypeCount> kept_types;  ///< table 8.7: every feature structure of all scenes
  std::map<std::string, KindScore> kinds;
  std::vector<StepTime> steps;  ///< the whole pipeline with the memory
  Throughput throughput;        ///< the tabletop pipeline alone
  std::string figure;           ///< figure 8.1 as SVG: what is known of one object

  /// Over flat, other, or all kinds.
  KindScore sum(bool flat, bool solid) const;
};

/// Simulates the scenes into `folder`/recording, runs everything into `folder`/memory.loci, and compares with
/// what was set up.
SystemResult run_system(const SystemOptions& options, const std::filesystem::path& folder, Progress& progress,
                        Warnings& warnings);

std::string text_of(const SystemResult& result);
Json json_of(const SystemResult& result);

}  // namespace loci::apps::system_evaluation
