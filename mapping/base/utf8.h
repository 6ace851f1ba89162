#pragma once

#include <string>

namespace loci {

/// Error when a text that people gave is no UTF-8: it could not be written as JSON again.
void require_utf8(const std::string& text);

}  // namespace loci
