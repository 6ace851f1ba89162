#include "perception/recognition/html_reader.h"

#include <gumbo.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "mapping/base/text/text.h"

namespace loci::perception {
namespace {

/// libgumbo recurses over the depth of a page and scans its open elements at each tag.
constexpr size_t kMaxBytes = size_t{8} << 20;
constexpr int kMaxTags = 50'000;
constexpr int kMaxDepth = 2'000;  ///< elements whose closing tag is left out count as open

/// What often has no closing tag, by how it begins: empty elements, comments.
constexpr const char* kEmptyElements[] = {"br", "img", "meta", "link", "input", "hr", "sourc", "!"};

bool exceeds_limits(std::string_view page) {
  if (page.size() > kMaxBytes) return true;
  int tags = 0, depth = 0, max_depth = 0;
  for (size_t at = page.find('<'); at != std::string_view::npos; at = page.find('<', at + 1)) {
    ++tags;
    const std::string name = lower_case(page.substr(at + 1, 5));
    const auto begins = [&](const char* word) { return name.starts_with(word); };
    if (std::any_of(std::begin(kEmptyElements), std::end(kEmptyElements), begins)) continue;
    depth = std::max(0, depth + (name.starts_with('/') ? -1 : 1));
    max_depth = std::max(max_depth, depth);
  }
  return tags > kMaxTags || max_depth > kMaxDepth;
}

struct Destroy {
  void operator()(GumboOutput* output) const { gumbo_destroy_output(&kGumboDefaultOptions, output); }
};
using ParsedPage = std::unique_ptr<GumboOutput, Destroy>;

bool declares_latin1(std::string_view page) {
  const std::string head = lower_case(page.substr(0, 4096));
  size_t at = head.find("charset=");
  if (at == std::string::npos) return false;
  at = head.find_first_not_of("\"' ", at + 8);
  const std::string name = at == std::string::npos ? std::string() : head.substr(at);
  return name.starts_with("iso-8859-1") || name.starts_with("windows-1252");
}

std::string utf8_from_latin1(std::string_view text) {
  std::string utf8;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x80) utf8 += static_cast<char>(0xc0 | code >> 6);
    utf8 += static_cast<char>(code < 0x80 ? code : 0x80 | (code & 0x3f));
  }
  return utf8;
}

HtmlTag tag_of(const GumboElement& element) {
  HtmlTag tag;
  tag.name = gumbo_normalized_tagname(element.tag);
  if (tag.name.empty()) {  // Not a tag of HTML.
    GumboStringPiece name = element.original_tag;
    gumbo_tag_from_original_text(&name);
    tag.name = lower_case({name.data, name.length});
  }
  for (unsigned i = 0; i < element.attributes.length; ++i) {
    const auto* attribute = static_cast<const GumboAttribute*>(element.attributes.data[i]);
    tag.attributes.emplace(lower_case(attribute->name), collapse_blanks(attribute->value));
  }
  return tag;
}

bool has_content(GumboTag tag) {
  constexpr GumboTag kVoid[] = {GUMBO_TAG_AREA,  GUMBO_TAG_BASE, GUMBO_TAG_BR,    GUMBO_TAG_COL,
                                GUMBO_TAG_EMBED, GUMBO_TAG_HR,   GUMBO_TAG_IMG,   GUMBO_TAG_INPUT,
                                GUMBO_TAG_LINK,  GUMBO_TAG_META, GUMBO_TAG_PARAM, GUMBO_TAG_SOURCE,
                                GUMBO_TAG_TRACK, GUMBO_TAG_WBR};
  return std::find(std::begin(kVoid), std::end(kVoid), tag) == std::end(kVoid);
}

/// Visits nodes in document order without recursion.
void visit(const GumboNode* root, const std::function<void(const HtmlTag&)>& on_tag,
           const std::function<void(const std::string&)>& on_text) {
  struct Open {
    const GumboElement* element;
    unsigned next = 0;  ///< child to visit
  };
  std::vector<Open> open;
  const auto enter = [&](const GumboNode* node) {
    if (node->type == GUMBO_NODE_ELEMENT || node->type == GUMBO_NODE_TEMPLATE) {
      on_tag(tag_of(node->v.element));
      open.push_back({&node->v.element});
    } else if (node->type != GUMBO_NODE_COMMENT && node->type != GUMBO_NODE_DOCUMENT) {
      on_text(node->v.text.text);
    }
  };
  enter(root);
  while (!open.empty()) {
    Open& top = open.back();
    if (top.next < top.element->children.length) {
      enter(static_cast<const GumboNode*>(top.element->children.data[top.next++]));
      continue;
    }
    if (has_content(top.element->tag)) on_tag({tag_of(*top.element).name, true, {}});
    open.pop_back();
  }
}

}  // namespace

std::string HtmlTag::attribute(const std::string& key) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? std::string() : found->second;
}

std::string collapse_blanks(std::string_view text) {
  std::string result;
  for (size_t at = 0; at < text.size(); ++at) {
    const bool no_break = text.substr(at, 2) == "\xc2\xa0";
    if (!no_break && !is_space(text[at]))
      result += text[at];
    else if (!result.empty() && result.back() != ' ')
      result += ' ';
    at += no_break ? 1 : 0;
  }
  return result;
}

std::string html_text(std::string_view html) {
  if (html.find_first_of("&<") == std::string_view::npos) return collapse_blanks(html);
  std::string text;
  read_html(
      html, [](const HtmlTag&) {}, [&](const std::string& part) { text += part; });
  return collapse_blanks(text);
}

void read_html(std::string_view page, const std::function<void(const HtmlTag&)>& tag,
               const std::function<void(const std::string&)>& text) {
  if (exceeds_limits(page)) return;
  std::string converted;
  if (declares_latin1(page)) page = converted = utf8_from_latin1(page);
  const ParsedPage parsed(gumbo_parse_with_options(&kGumboDefaultOptions, page.data(), page.size()));
  if (parsed) visit(parsed->root, tag, text);
}

}  // namespace loci::perception
