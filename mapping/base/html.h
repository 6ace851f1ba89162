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

/// A whole page that needs no other file: style inside, and a script of some lines that adds a field to
/// search in it (cards, rows and details without the words are hidden). `sections` is HTML made by
/// html_section. For print everything is opened and the field is gone.
std::string html_page(std::string_view title, std::string_view sections);
bool is_html_page(const std::string& text);

/// The page with a section put in the place of the one with the same id, or else at its end. For pages made
/// by html_page: a report that grows.
std::string html_with_section(const std::string& page, std::string_view id, const std::string& section);

}  // namespace loci
