#pragma once

#include <array>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

#include "mapping/base/config.h"

namespace loci::perception {

/// How an image becomes the input of a network.
struct NetworkInput {
  cv::Size size;             ///< pixels; empty = as the model has it
  bool rgb = true;           ///< order of the channels, else BGR
  double scale = 1 / 255.0;  ///< values are (pixel · scale - mean) / deviation
  std::array<double, 3> mean = {0, 0, 0}, deviation = {1, 1, 1};  ///< in the order of the channels
  bool letterbox = true;  ///< keeps the proportions, with grey borders; else stretched

  /// `input: {width, height, channels, scale, mean, deviation, resize}`. Error with its line.
  static NetworkInput read(const Config& config);
};

/// Where an image lies in the input of a network: input = image · scale + offset, per axis, in positions of
/// detectors (pixel n covers [n, n + 1)).
struct InputFit {
  cv::Point2d scale, offset;

  cv::Point2d to_image(const cv::Point2d& input) const {
    return {(input.x - offset.x) / scale.x, (input.y - offset.y) / scale.y};
  }
};

/// A network that OpenCV runs: one input, an image (batch, 3, height, width).
class Network {
 public:
  /// Error, one line, for what is not a model, for one that OpenCV cannot read (which operator) and for one
  /// that needs more than `max_memory_mb`.
  Network(const std::filesystem::path& model, const NetworkInput& input, double max_memory_mb);

  const NetworkInput& input() const { return input_; }
  const std::string& file() const { return file_; }
  /// Whether the model was exported for any number of images.
  bool takes_batches() const { return takes_batches_; }
  /// The fit of an image of this size.
  InputFit fit(const cv::Size& image) const;

  struct Output {
    std::string name;
    cv::Mat values;  ///< CV_32F, batch first
  };
  /// All outputs for an image (CV_8UC3, BGR). Error when the network fails on it.
  std::vector<Output> run(const cv::Mat& image) const { return run(std::vector<cv::Mat>{image}); }
  /// All outputs for several images at once.
  std::vector<Output> run(const std::vector<cv::Mat>& images) const;

 private:
  cv::Mat prepared(const cv::Mat& image) const;

  std::string file_;
  NetworkInput input_;
  mutable cv::dnn::Net net_;
  std::vector<std::string> outputs_;
  bool takes_batches_ = false;
};

}  // namespace loci::perception
