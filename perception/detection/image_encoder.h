#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perception/detection/network.h"

namespace loci::perception {

/// A network that turns an image of an object into a vector (any image encoder), from its description:
///
///   model: encoder.onnx   # beside this file
///   name: clip            # of its vectors: those of one name are compared
///   output: embedding     # needed where the model has several outputs
///   input: {width: 224, height: 224, mean: [0.48, 0.46, 0.41], deviation: [0.27, 0.26, 0.28]}
class ImageEncoder {
 public:
  /// Error when the description or the model cannot be used.
  explicit ImageEncoder(const std::filesystem::path& description);

  const std::string& name() const { return name_; }
  /// A vector of unit length per image (CV_8UC3, BGR), all of one length; empty where the network gives none.
  std::vector<std::vector<float>> encode(const std::vector<cv::Mat>& images) const;

 private:
  struct Description {
    explicit Description(const std::filesystem::path& path);
    std::filesystem::path model;
    std::string name, output;
    NetworkInput input;
    double max_memory_mb = 2048;
  };
  explicit ImageEncoder(const Description& description);
  cv::Mat vectors(const std::vector<cv::Mat>& images) const;

  std::string name_, output_;
  Network network_;
  bool batches_ = false;
};

}  // namespace loci::perception
