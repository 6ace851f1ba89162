#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string_view>

#include "mapping/base/error.h"
#include "mapping/image/image_io.h"

namespace loci::mapping {

/// Depth (CV_16UC1) of compressedDepth in RVL (Wilson, "Fast lossless depth image compression", 2017): width
/// and height (32 bits each); then lengths of runs without and with measurement, and the differences within
/// the latter, in groups of four bits that fill words of 32 bits from above. All is little endian. Error when
/// it ends early, the image has no pixel or more than `max_pixels`, a run goes beyond it, or a value does not
/// fit 16 bits.
cv::Mat decode_rvl(std::string_view bytes, const FileLocation& location,
                   uint64_t max_pixels = kMaxImagePixels);

}  // namespace loci::mapping
