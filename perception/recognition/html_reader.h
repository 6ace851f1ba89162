#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace loci::perception {

/// A tag of a page; names of tags and attributes are in lower case, values without entities.
struct HtmlTag {
  std::string name;
  bool closes = false;
  std::map<std::string, std::string> attributes;

  /// "" when there is none.
  std::string attribute(const std::string& key) const;
};

/// Reads HTML as it is found: tags need not match, comments are passed over, the content of scripts and
/// styles is one text. Pages that say that they are Latin-1 become UTF-8. Nothing is an error.
void read_html(std::string_view page, const std::function<void(const HtmlTag&)>& tag,
               const std::function<void(const std::string&)>& text);

/// Text with its entities replaced (&amp; &#228; &auml; …) and runs of blanks made one.
std::string html_text(std::string_view text);

}  // namespace loci::perception
