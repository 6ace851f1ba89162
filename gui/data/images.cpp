#include "gui/data/images.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "mapping/image/image_io.h"
#include "memory/store/store.h"

namespace loci::gui {

cv::Mat read_image(const memory::Store& store, memory::Id blob) {
  const std::string name = fmt::format("{}: image {}", store.path().string(), blob);
  const memory::BlobRow row = store.blob(blob);
  const std::vector<unsigned char> bytes(row.bytes.begin(), row.bytes.end());
  const cv::Mat image = mapping::decode_image(bytes, name);
  if (image.type() == CV_8UC3) return image;
  if (image.depth() != CV_8U) throw Error("an image with more than 8 bits", {name, 0, {}});
  cv::Mat color;
  cv::cvtColor(image, color, image.channels() == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return color;
}

}  // namespace loci::gui
