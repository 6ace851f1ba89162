#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/time.h"
#include "perception/detection/image_region.h"

namespace loci::perception {

/// A named position in the image.
struct KeyPoint2D {
  std::string name;
  double x = 0, y = 0;  ///< pixels, as in ImageRegion
};

/// What a detector found in an image.
struct Detection2D {
  ImageRegion region;
  std::vector<KeyPoint2D> key_points;                   ///< those that the detector saw
  std::vector<std::pair<std::string, double>> classes;  ///< with scores, the best first; may be empty
  std::optional<double> score;                          ///< uncalibrated, 0 to 1
};

/// Those of one image; empty when nothing was found in it.
struct ImageDetections {
  std::string image;           ///< its file, without folder and ending
  std::optional<TimeNs> time;  ///< of the image, where its name or the file says it
  std::vector<Detection2D> detections;
};

/// The names of a detector's classes, class 0 first: one per line, or `names` of a data.yaml.
std::vector<std::string> read_class_names(const std::filesystem::path& file);

/// Detections in the images of a recording:
/// - a COCO file (*.json): a data set with images, annotations and categories, or a list of results;
/// - a YOLO folder: a text file per image, a line `class x y width height [score]` per box or
///   `class x y x y … [score]` per outline, in fractions of the image. Class names: classes.txt or data.yaml
///   in the folder or beside it. With `kpt_shape` in data.yaml, `class x y width height px py v … [score]`;
/// - JSON Lines (*.jsonl) of images: `time` and `detections` with `bbox` or `mask`, and `class`, `score`,
/// `key_points`.
class DetectionSet {
 public:
  /// Strict: Error with file and line or key for the first thing that cannot be read.
  static DetectionSet read(const std::filesystem::path& path, Warnings& warnings);

  /// The detections in the image of a frame: by name, else by time where every image has one, else by the
  /// number at the end of both names. nullptr when the image was not looked at.
  const ImageDetections* find(const std::string& frame_name, int64_t frame_index, TimeNs time) const;

  const std::vector<ImageDetections>& images() const { return images_; }

 private:
  void index();

  std::vector<ImageDetections> images_;
  std::map<std::string, size_t> by_name_;
  std::map<int64_t, size_t> by_number_;
  std::map<TimeNs, size_t> by_time_;
};

/// Most detections of one image that are accepted.
inline constexpr size_t kMaxDetectionsPerImage = 1000;
/// Most pixels that the masks of one image may cover together.
inline constexpr size_t kMaxMaskPixelsPerImage = 200'000'000;

}  // namespace loci::perception
