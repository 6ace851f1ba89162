#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/segmentation/peers.h"
#include "apps/evaluate/segmentation/scores.h"
#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "mapping/simulation/household_scenes.h"

namespace loci::apps::segmentation_evaluation {

struct ComparisonOptions {
  bool peers = true;
  PeerOptions peer;

  void declare(OptionTable& table);
};

/// What one method did to a folder.
struct MethodResult {
  std::string name;
  Scores scores;
  std::vector<std::pair<std::string, Scores>> by_category;  ///< as scenes.csv names them
  std::vector<double> seconds;                              ///< of each frame
};

/// One frame: what it shows, and what every method made of it, in order of Comparison::methods.
struct FrameResult {
  std::string name;
  std::string category;
  std::vector<Scores> scores;
};

struct Comparison {
  std::string folder;
  std::vector<MethodResult> methods;
  std::vector<FrameResult> frames;

  std::string text(bool verbose) const;
  Json to_json() const;
};

/// The labels of an image: 0 = not judged, 1 to 19 the table, from 20 on label / 10 is the object.
LabelledImage read_labels(const std::filesystem::path& path);

/// Scenes whose objects are known.
struct LabelledScenes {
  std::string name;
  std::shared_ptr<mapping::Recording> recording;
  /// What the frame that was read last shows; nothing where the frame has no labels.
  std::function<std::optional<LabelledImage>(const std::string& frame)> labels;
  std::function<std::string(const std::string& frame)> category;  ///< "" = none
};

/// A recording with a FRAME_label.png beside its depth images, and scenes.csv with categories if there is
/// one.
LabelledScenes open_labelled_scenes(const std::filesystem::path& folder);

/// Rendered tables with household objects. Those of which fewer pixels are seen than the smallest cluster has
/// are not judged.
LabelledScenes drawn_tables(mapping::Arrangement arrangement, int tables, int seed);

/// Segments every labelled frame: our pipeline (`pipeline`: a YAML file; empty = the default one) without a
/// map, and PCL's methods; one thread. With `images` a strip per frame goes there: colour, truth, and each
/// method.
Comparison compare(const LabelledScenes& scenes, const std::filesystem::path& pipeline,
                   const std::filesystem::path& images, const ComparisonOptions& options, Progress& progress,
                   Warnings& warnings);

}  // namespace loci::apps::segmentation_evaluation
