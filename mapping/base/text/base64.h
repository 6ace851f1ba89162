#pragma once

#include <span>
#include <string>
#include <string_view>

namespace loci {

/// RFC 4648, with padding.
std::string base64_from_bytes(std::string_view bytes);
std::string base64_from_bytes(std::span<const unsigned char> bytes);

/// Throws Error when the text is not base64.
std::string bytes_from_base64(std::string_view text);

}  // namespace loci
