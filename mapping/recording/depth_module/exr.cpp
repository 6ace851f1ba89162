// Depth as OpenEXR: one channel of half or float, or that named Z.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/depth/codecs.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 1 << 14;  ///< pixels; OpenEXR takes memory for whole groups of lines

/// "Z", "depth", "ViewLayer.Depth.Z": what renderers name depth.
bool is_depth_name(const std::string& name) {
  const std::string last = lower_case(name.substr(name.rfind('.') + 1));
  return last == "z" || last == "depth";
}

/// The channel with depth: the only one, or the only one of that name.
std::string depth_channel(const Imf::Header& header, const FileLocation& location) {
  std::vector<std::string> all, named;
  for (auto each = header.channels().begin(); each != header.channels().end(); ++each) {
    all.emplace_back(each.name());
    if (is_depth_name(all.back())) named.push_back(all.back());
  }
  if (all.size() == 1) named = all;
  if (named.size() != 1)
    throw Error(
        fmt::format("which of the {} channels of this OpenEXR image is depth is not clear", all.size()),
        location, "write one channel, or name it Z");
  const Imf::Channel& channel = header.channels()[named[0]];
  if (channel.type == Imf::UINT || channel.xSampling != 1 || channel.ySampling != 1)
    throw Error("depth as OpenEXR has a half or float for each pixel", location);
  return named[0];
}

DepthHeader decode(const fs::path& path, cv::Mat* pixels) {
  const FileLocation location{path.string(), 0, {}};
  Imf::InputFile file(path.c_str(), 0);
  const Imath::Box2i window = file.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  require_depth_size(static_cast<uint64_t>(width), static_cast<uint64_t>(height), path);
  if (window != file.header().displayWindow())
    throw Error("an OpenEXR image whose data cover a part of it only is not read as depth", location);
  const std::string channel = depth_channel(file.header(), location);
  if (!file.isComplete()) throw truncated_depth(path);
  if (pixels != nullptr) {
    cv::Mat image(height, width, CV_32FC1);
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, image.data, window, sizeof(float), image.step));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    *pixels = image;
  }
  return {width, height, true};
}

}  // namespace
}  // namespace loci::mapping

extern "C" loci::mapping::DepthHeader loci_decode_exr_depth(const std::filesystem::path& path,
                                                            cv::Mat* pixels) {
  using namespace loci;
  static const bool limited = [] {
    Imf::Header::setMaxImageSize(mapping::kMaxSide, mapping::kMaxSide);
    Imf::Header::setMaxTileSize(mapping::kMaxSide, mapping::kMaxSide);
    return true;
  }();
  static_cast<void>(limited);
  try {
    return mapping::decode(path, pixels);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw mapping::damaged_depth(error.what(), path);
  }
}
