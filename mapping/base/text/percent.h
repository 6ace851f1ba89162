#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace loci {

/// Percent-encoding of URIs: all but letters, digits, '-', '.', '_' and '~' becomes %XX.
std::string percent_encoded(std::string_view text);
/// The text that %XX stand for; unset where a '%' begins no such code.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace loci
