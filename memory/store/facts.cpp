#include "memory/store/facts.h"

#include <fmt/format.h>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"

namespace loci::memory {

bool has_control_characters(std::string_view text) {
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto before = i > 0 ? static_cast<unsigned char>(text[i - 1]) : 0U;
    if (byte < 0x20 || byte == 0x7f || (before == 0xc2 && byte < 0xa0)) return true;
  }
  return false;
}

std::string fact_value(const std::string& key, const std::string& value) {
  require_utf8(key);
  require_utf8(value);
  std::string stored = trimmed(value);
  if (trimmed(key).empty() || stored.empty())
    throw Error("a fact needs a key and a value", {}, "fact set X owner Ada");
  if (has_control_characters(key) || has_control_characters(stored))
    throw Error(fmt::format("the value of '{}' has line breaks or other control characters",
                            has_control_characters(key) ? "a key" : key),
                {}, "write it in one line");
  return stored;
}

}  // namespace loci::memory
