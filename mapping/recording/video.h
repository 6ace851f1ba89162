#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>

namespace loci::mapping {

/// What the module of mapping/recording/video implements.
class VideoDecoder {
 public:
  virtual ~VideoDecoder() = default;
  virtual cv::Mat frame(size_t i) = 0;
};

/// Frames of a video by number, CV_8UC3 BGR, fastest in order. Safe to use from several threads.
class Video {
 public:
  /// Error when the file cannot be decoded.
  explicit Video(const std::filesystem::path& path);
  cv::Mat frame(size_t i) const;

 private:
  mutable std::mutex mutex_;
  std::unique_ptr<VideoDecoder> decoder_;
};

}  // namespace loci::mapping
