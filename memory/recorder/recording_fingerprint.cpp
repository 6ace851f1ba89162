#include "mapping/base/hash.h"
#include "memory/recorder/recorder.h"

namespace loci {

std::string recording_fingerprint(const std::vector<FrameDigest>& frames,
                                  const std::vector<cv::Mat>& pictures) {
  std::string bytes;
  for (const FrameDigest& frame : frames)
    bytes += std::to_string(frame.index) + " " + std::to_string(frame.time) + "\n";
  for (const cv::Mat& picture : pictures) {
    bytes += std::to_string(picture.cols) + "x" + std::to_string(picture.rows) + "\n";
    for (int row = 0; row < picture.rows; ++row)
      bytes.append(reinterpret_cast<const char*>(picture.ptr(row)),
                   size_t(picture.cols) * picture.elemSize());
  }
  return content_hash(bytes);
}

}  // namespace loci
