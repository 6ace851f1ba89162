#pragma once

#include <string>
#include <string_view>

namespace loci {

/// SHA-256 of some bytes, 64 hexadecimal digits: names content wherever it lies.
std::string content_hash(std::string_view bytes);

}  // namespace loci
