#include "mapping/recording/video.h"

#include "mapping/base/load_symbol.h"

namespace loci::mapping {

Video::Video(const std::filesystem::path& path) {
  using OpenVideo = VideoDecoder* (*)(const std::filesystem::path&);
  static const auto open_video =
      reinterpret_cast<OpenVideo>(load_symbol("loci_video.so", "loci_open_video", "videos cannot be read",
                                              "install loci_video.so and libopencv-videoio"));
  decoder_.reset(open_video(path));
}

cv::Mat Video::frame(size_t i) const {
  const std::lock_guard lock(mutex_);
  return decoder_->frame(i);
}

}  // namespace loci::mapping
