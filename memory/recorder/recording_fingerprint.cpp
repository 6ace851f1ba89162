#include "mapping/base/hash.h"
#include "memory/recorder/recorder.h"

namespace loci::memory {

std::string recording_fingerprint(const std::vector<FrameDigest>& frames,
                                  const std::vector<cv::Mat>& images) {
  std::string bytes;
  for (const FrameDigest& frame : frames)
    bytes += std::to_string(frame.index) + " " + std::to_string(frame.time) + "\n";
  for (const cv::Mat& image : images) {
    bytes += std::to_string(image.cols) + "x" + std::to_string(image.rows) + "\n";
    for (int row = 0; row < image.rows; ++row)
      bytes.append(reinterpret_cast<const char*>(image.ptr(row)), size_t(image.cols) * image.elemSize());
  }
  return content_hash(bytes);
}

}  // namespace loci::memory
