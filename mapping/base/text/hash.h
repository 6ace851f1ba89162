#pragma once

#include <string>
#include <string_view>

namespace loci {

/// SHA-256 of some bytes as 64 hexadecimal digits: identifies content independent of where it is stored.
std::string content_hash(std::string_view bytes);

/// Hexadecimal digits, eight a word, that nobody can guess. Whatever else is the same in two runs, these are
/// not.
std::string unguessable_hex(int words);

}  // namespace loci
