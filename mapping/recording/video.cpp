#include "mapping/recording/video.h"

#include <dlfcn.h>

#include <string>

#include "mapping/base/error.h"

namespace loci::mapping {

void* load_symbol(const char* module, const char* symbol, const char* what, const char* install) {
  void* library = dlopen(module, RTLD_NOW | RTLD_LOCAL);
  void* found = library != nullptr ? dlsym(library, symbol) : nullptr;
  if (found == nullptr) throw Error(std::string(what) + " cannot be read: " + dlerror(), {}, install);
  return found;
}

Video::Video(const std::filesystem::path& path) {
  using OpenVideo = VideoDecoder* (*)(const std::filesystem::path&);
  static const auto open_video = reinterpret_cast<OpenVideo>(load_symbol(
      "loci_video.so", "loci_open_video", "videos", "install loci_video.so and libopencv-videoio"));
  decoder_.reset(open_video(path));
}

cv::Mat Video::frame(size_t i) const {
  const std::lock_guard lock(mutex_);
  return decoder_->frame(i);
}

}  // namespace loci::mapping
