#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace loci {

/// Text for HTML or SVG: & < > " ' are escaped.
std::string html_escape(std::string_view text);

/// A table; cells are text and get escaped. Numbers are set flush right.
std::string html_table(const std::vector<std::string>& header,
                       const std::vector<std::vector<std::string>>& rows);

/// A list of texts.
std::string html_list(const std::vector<std::string>& items);

/// An image inside the page; `mime` as in "image/png".
std::string html_image(std::span<const unsigned char> bytes, std::string_view mime, std::string_view alt);

/// A section with a heading; `body` is HTML.
std::string html_section(std::string_view id, std::string_view heading, std::string_view body);

/// A page without external files. Its script adds a search field that hides cards, rows and details without
/// the given words; in print all details are open and the field is hidden. `sections` is HTML from
/// html_section().
std::string html_page(std::string_view title, std::string_view sections);
bool is_html_page(const std::string& text);

/// A page made by html_page() with a section replaced (same id) or appended.
std::string html_with_section(const std::string& page, std::string_view id, const std::string& section);

}  // namespace loci
