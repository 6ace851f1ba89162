// A module of its own, as videoio brings ffmpeg and GStreamer.

#include <opencv2/videoio.hpp>

#include "mapping/base/error.h"
#include "mapping/recording/video.h"

namespace loci::mapping {
namespace {

class OpenCvVideo : public VideoDecoder {
 public:
  explicit OpenCvVideo(std::filesystem::path path) : path_(std::move(path)) { open(); }

  cv::Mat frame(size_t i) override {
    if (i < next_) open();  // Seeking is not exact in all containers; decoding from the start is.
    for (; next_ < i; ++next_)
      if (!video_.grab()) throw ended(i);
    cv::Mat image;
    if (!video_.read(image) || image.type() != CV_8UC3) throw ended(i);
    ++next_;
    return image;
  }

 private:
  void open() {
    if (!video_.open(path_.string(), cv::CAP_FFMPEG) && !video_.open(path_.string()))
      throw Error("the video cannot be decoded", {path_.string(), 0, {}});
    video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);  // Intrinsics are those of the sensor.
    next_ = 0;
  }
  Error ended(size_t i) const {
    return Error("the video has no frame " + std::to_string(i), {path_.string(), 0, {}},
                 "it is truncated, or does not belong to this recording");
  }

  std::filesystem::path path_;
  cv::VideoCapture video_;
  size_t next_ = 0;
};

}  // namespace
}  // namespace loci::mapping

extern "C" loci::mapping::VideoDecoder* loci_open_video(const std::filesystem::path& path) {
  return new loci::mapping::OpenCvVideo(path);
}
