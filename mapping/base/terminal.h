#pragma once

#include <string>
#include <string_view>

namespace loci {

/// Text that cannot steer a terminal, for all that programs print: recognised and foreign text may hold
/// escape sequences. Control characters other than line feed and tab, and those that reverse the direction of
/// text, become \u001b (which is what JSON calls them, too); a byte that is not UTF-8 becomes \x9b.
std::string terminal_text(std::string_view text);

}  // namespace loci
