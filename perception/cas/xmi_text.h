#pragma once

#include <string>
#include <string_view>

namespace loci::perception::cas {

/// The view that UIMA makes by itself, and that needs no sofa.
inline constexpr const char* kInitialView = "_InitialView";

/// Text for attributes and elements: markup, line ends and outer blanks as entities; what XML 1.0 does not
/// allow (control characters, bytes that are no UTF-8) as blanks.
std::string xml_text(std::string_view text);

/// Whether xml_text() lost something.
bool xml_loses(std::string_view text);

/// Elements that hold nothing but blanks keep them in parsers that take blanks between elements for layout.
std::string with_blanks_kept(std::string_view xml);

}  // namespace loci::perception::cas
