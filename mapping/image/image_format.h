#pragma once

#include <string>
#include <string_view>

#include "mapping/image/image_io.h"

namespace loci::mapping {

/// Checks the structure of a whole PNG (every chunk and its check sum, up to IEND) or JPEG (SOI to EOI):
/// decoders return half an image for a truncated file. Throws Error that says what is wrong.
void require_whole_image(std::string_view bytes, const std::string& name);

/// The header from the first bytes of a PNG or JPEG. Error when it is neither.
ImageHeader parse_image_header(std::string_view head, const std::string& name);

/// Whether the last bytes of a file are the end of an image of the kind that its first bytes announce.
bool has_image_end(std::string_view head, std::string_view tail);

}  // namespace loci::mapping
