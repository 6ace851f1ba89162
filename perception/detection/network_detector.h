#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perception/detection/detection_set.h"
#include "perception/detection/network.h"

namespace loci::perception {

/// How the outputs of a detector are laid out; N candidates, C classes, M coefficients of masks:
/// - yolov5: (1, N, 5 + C + M): x, y, width, height in pixels of the input, objectness, scores of the
/// classes;
/// - yolov8: (1, 4 + C + M, N): the same without objectness;
/// - ssd: (1, N, C + 1) scores, background first, and (1, N, 4) corners in fractions of the input.
/// With masks (instance segmentation), a second output (1, M, rows, columns) has their prototypes.
enum class DetectorLayout { yolov5, yolov8, ssd };

/// A detector's description:
///
///   model: yolov5s.onnx         # beside this file
///   layout: yolov5
///   classes: coco.txt           # one name per line, or a data.yaml
///   input: {width: 640, height: 640}
///   min_score: 0.25
///   max_overlap: 0.45           # of two boxes of one class, intersection over union
struct DetectorDescription {
  std::filesystem::path model;
  DetectorLayout layout = DetectorLayout::yolov5;
  std::vector<std::string> classes;
  NetworkInput input;
  double min_score = 0.25;
  double max_overlap = 0.45;
  int max_detections = 100;  ///< the best of an image
  double max_memory_mb = 2048;

  /// Strict. Error with file and line.
  static DetectorDescription read(const std::filesystem::path& path);
};

/// What the outputs of a network say about an image of this size, best first: each candidate's best class,
/// without those that overlap a better one of the same class. Error when the outputs do not have the shapes
/// of the layout and the classes.
std::vector<Detection2D> decode_detections(const std::vector<Network::Output>& outputs,
                                           const DetectorDescription& description, const InputFit& fit,
                                           const cv::Size& image);

/// Finds objects in images with a network.
class ObjectDetector {
 public:
  /// Error when the description or the model cannot be used.
  explicit ObjectDetector(const std::filesystem::path& description);

  /// In an image (CV_8UC3, BGR).
  std::vector<Detection2D> detect(const cv::Mat& image) const;
  const DetectorDescription& description() const { return description_; }

 private:
  DetectorDescription description_;
  Network network_;
};

}  // namespace loci::perception
