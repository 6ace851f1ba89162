#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/progress.h"

namespace loci::apps::detection_evaluation {

/// An object that an image shows.
struct TrueObject {
  std::string name;  ///< one of rendered_classes()
  cv::Rect box;      ///< pixels
};

struct RenderedTable {
  cv::Mat color;  ///< CV_8UC3, BGR
  std::vector<TrueObject> objects;
};

/// The groups of household objects, sorted: "board", "bottle", …; "other" for what belongs to none.
const std::vector<std::string>& rendered_classes();

/// Tables with drawn household objects, endless, the same for the same seed. Objects of which little is seen
/// are left out.
class RenderedTables {
 public:
  RenderedTables(int scenes, const Random& random) : scenes_(scenes), random_(random) {}
  int size() const { return scenes_; }
  RenderedTable table(int scene) const;

 private:
  int scenes_;
  Random random_;
};

/// Writes FOLDER/images/N.jpg and FOLDER/labels/N.txt (`class x y width height` per object, in fractions of
/// the image) with FOLDER/data.yaml: what trainers of YOLO read.
void write_training_images(const RenderedTables& tables, const std::filesystem::path& folder, int threads,
                           Progress& progress);

}  // namespace loci::apps::detection_evaluation
