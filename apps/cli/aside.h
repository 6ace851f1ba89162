#pragma once

// Private to this module: what is printed beside the answer.

#include <string_view>

namespace loci::apps {

/// Prints on stderr, as far as that is possible: the work goes on where nobody can read it.
void print_aside(std::string_view text);

}  // namespace loci::apps
