#pragma once

#include <fstream>
#include <mutex>

#include "mapping/recording/file_recording.h"

namespace loci::mapping {

/// Whether a file is a ScanNet stream (.sens, version 4).
bool is_sens(const std::filesystem::path& path);

/// A ScanNet stream: one file with cameras, poses and compressed images. A truncated one gives the frames
/// that are whole.
class SensRecording : public FrameListRecording {
 public:
  explicit SensRecording(const std::filesystem::path& path);

  RgbdFrame frame(size_t i) const override;

 private:
  struct Images {
    uint64_t color_at = 0, color_size = 0, depth_at = 0, depth_size = 0;
  };
  template <typename T>
  T take();
  std::string read(uint64_t at, uint64_t count) const;
  void read_header();
  bool read_frame(int64_t index);
  cv::Mat depth_image(const Images& images, const FileLocation& location) const;
  cv::Mat color_image(const Images& images, const FileLocation& location) const;

  std::filesystem::path path_;
  mutable std::mutex mutex_;
  mutable std::ifstream file_;
  uint64_t file_size_ = 0, at_ = 0, frames_claimed_ = 0;
  bool zlib_depth_ = false, has_color_ = false;
  bool raw_color_ = false;  ///< RGB, not compressed
  float depth_shift_ = 1000;
  std::vector<Images> images_;  ///< by index of the frame
};

}  // namespace loci::mapping
