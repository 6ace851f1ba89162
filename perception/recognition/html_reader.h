#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace loci::perception {

/// A tag of a page. Names of tags and attributes are in lower case; values have their entities replaced and
/// runs of blanks made one.
struct HtmlTag {
  std::string name;
  bool closes = false;
  std::map<std::string, std::string> attributes;

  /// "" when there is none.
  std::string attribute(const std::string& key) const;
};

/// Parses a page as browsers do (libgumbo) and reports its tags and texts in document order. Texts have their
/// entities replaced; scripts and styles are one text each. Missing closing tags are reported where the
/// parser closes the element; elements without content (img, meta, br, …) are not closed. Pages in Latin-1
/// become UTF-8. A page of more than 8 MB, 50,000 tags or 2,000 open
/// elements counts as empty.
void read_html(std::string_view page, const std::function<void(const HtmlTag&)>& tag,
               const std::function<void(const std::string&)>& text);

/// The text of a piece of HTML, without tags, with entities replaced (&amp; &#228; &auml; …) and runs of
/// blanks made one.
std::string html_text(std::string_view html);

/// Runs of blanks (also no-break spaces) made one.
std::string collapse_blanks(std::string_view text);

}  // namespace loci::perception
