#include "mapping/base/text/html.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/base64.h"
#include "mapping/base/text/text.h"

namespace loci {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --line: #8884; --faint: #888; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 0 auto; max-width: 70rem; padding: 1.5rem; }
h1 { font-size: 1.6rem; margin: 0 0 .5rem; } h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; }
table { border-collapse: collapse; display: block; overflow-x: auto; }
th, td { border-bottom: 1px solid var(--line); padding: .25rem .7rem; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
img, svg { max-width: 100%; height: auto; } pre { white-space: pre-wrap; } .faint { color: var(--faint); }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(22rem, 1fr)); gap: 1rem; align-items: start; }
.card, figure { border: 1px solid var(--line); border-radius: .5rem; padding: .75rem; margin: 0; min-width: 0; }
.card th, .card td { padding: .2rem .4rem; } td.number { white-space: nowrap; }
.card h3 { margin: 0; font-size: 1rem; } .card img { height: 5rem; margin-right: .5rem; }
figcaption { font-weight: 600; margin-bottom: .5rem; } .bars { display: table; width: 100%; }
.bars td:first-child { overflow-wrap: anywhere; } .bars td:last-child { width: 40%; }
.bar { height: .7rem; min-width: 1px; background: #48c; border-radius: 2px; }
details { margin: .25rem 0; } summary { cursor: pointer; }
input.search { position: sticky; top: .5rem; width: 100%; padding: .5rem; font: inherit; box-sizing: border-box; z-index: 1; }
@media print { input.search { display: none; } .card, figure, tr, pre { break-inside: avoid; } }
)";
// Words that are searched for must all be in what stays. Without scripts the page is whole, but for the
// field.
constexpr std::string_view kScript = R"(
const field = document.createElement('input');
field.type = 'search'; field.className = 'search'; field.placeholder = 'Search this page: object_3, red, table_1 …';
document.querySelector('h1').after(field);
field.addEventListener('input', () => {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  for (const part of document.querySelectorAll('.card, section > details, section > table tr:has(td), section > pre')) {
    const text = part.textContent.toLowerCase();
    part.hidden = !words.every(word => text.includes(word));
  }
});
addEventListener('beforeprint', () => document.querySelectorAll('details').forEach(part => part.open = true));
)";
constexpr std::string_view kEnd = "</main>";

bool is_number(const std::string& cell) {
  return !cell.empty() && (is_digit(cell.back()) || cell.back() == '%') &&
         std::all_of(cell.begin(), cell.end(), [](char c) {
           return is_digit(c) || c == '.' || c == '-' || c == '+' || c == ' ' || c == '%';
         });
}

std::string opening(std::string_view id) {
  return fmt::format("<section id=\"{}\">", html_escape(id));
}

}  // namespace

std::string html_escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string html_table(const std::vector<std::string>& header,
                       const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table><tr>";
  for (const std::string& cell : header) html += "<th>" + html_escape(cell) + "</th>";
  html += "</tr>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (const std::string& cell : row)
      html += (is_number(cell) ? "<td class=\"number\">" : "<td>") + html_escape(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string html_list(const std::vector<std::string>& items) {
  std::string html = "<ul>\n";
  for (const std::string& item : items) html += "<li>" + html_escape(item) + "</li>\n";
  return html + "</ul>\n";
}

std::string html_image(std::span<const unsigned char> bytes, std::string_view mime, std::string_view alt) {
  return fmt::format("<img alt=\"{}\" src=\"data:{};base64,{}\">\n", html_escape(alt), html_escape(mime),
                     base64_from_bytes(bytes));
}

std::string html_section(std::string_view id, std::string_view heading, std::string_view body) {
  return fmt::format("{}\n<h2>{}</h2>\n{}</section>\n", opening(id), html_escape(heading), body);
}

std::string html_page(std::string_view title, std::string_view sections) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"generator\" "
      "content=\"loci\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n"
      "<main>\n<h1>{0}</h1>\n{2}{3}\n<script>{4}</script>\n</body>\n</html>\n",
      html_escape(title), kStyle, sections, kEnd, kScript);
}

bool is_html_page(const std::string& text) {
  return text.starts_with("<!doctype html>") && text.find(kEnd) != std::string::npos;
}

std::string html_with_section(const std::string& page, std::string_view id, const std::string& section) {
  std::string grown = page;
  const size_t begin = grown.find(opening(id));
  if (begin != std::string::npos) {
    constexpr std::string_view kSectionEnd = "</section>\n";
    const size_t end = grown.find(kSectionEnd, begin);
    if (end != std::string::npos) return grown.replace(begin, end + kSectionEnd.size() - begin, section);
  }
  const size_t at = grown.rfind(kEnd);
  return grown.insert(at == std::string::npos ? grown.size() : at, section);
}

}  // namespace loci
