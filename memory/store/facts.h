#pragma once

#include <string>
#include <string_view>

namespace loci::memory {

/// Whether a newer statement of this key takes the place of an older one, as that of an owner does.
inline bool has_one_value(std::string_view key) {
  return key != "alias";
}

/// The key of the facts that make an object an example of a class.
inline constexpr const char* kTaughtKey = "taught";

/// Whether a text has line breaks or other control characters (C0, DEL, C1); it is UTF-8.
bool has_control_characters(std::string_view text);

/// A value that somebody states, as it is stored: without the blanks around it. Error where the key or the
/// value is empty, is not UTF-8, or has control characters.
std::string fact_value(const std::string& key, const std::string& value);

}  // namespace loci::memory
