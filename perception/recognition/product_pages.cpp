#include "perception/recognition/product_pages.h"

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/html_reader.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

constexpr int kMinSide = 48;  // pixels; smaller images are decoration

bool is_page(const fs::path& path) {
  return path.extension() == ".html" || path.extension() == ".htm";
}

/// What one page says.
struct Page {
  std::string title, heading;
  std::map<std::string, std::string> meta;  ///< og:title, description, …
  Properties properties;                    ///< of data first, then of tables and lists
  std::string name, description;            ///< of data
  std::vector<std::string> named_images, images;
};

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return value.dump();
  if (value.is_array() && !value.empty()) return text_of(value[0]);
  if (value.is_object())
    for (const char* key : {"name", "value", "url", "@value"})
      if (value.contains(key)) return text_of(value[key]);
  return {};
}

bool is_product(const Json& object) {
  if (!object.contains("@type")) return false;
  const Json& type = object["@type"];
  const auto is_kind = [](const Json& kind) { return kind == "Product" || kind == "Book"; };
  return is_kind(type) || (type.is_array() && std::any_of(type.begin(), type.end(), is_kind));
}

void add_offer(const Json& offers, Page& page) {
  const Json& offer = offers.is_array() && !offers.empty() ? offers[0] : offers;
  if (!offer.is_object()) return;
  const auto value = [&](const char* key) {
    return offer.contains(key) ? text_of(offer[key]) : std::string();
  };
  std::string price = value("price").empty() ? value("lowPrice") : value("price");
  if (!price.empty() && !value("priceCurrency").empty()) price += " " + value("priceCurrency");
  add_property(page.properties, "price", price);
  add_property(page.properties, "store", value("seller"));
}

/// Properties of schema.org whose names differ from ours.
std::string key_of(const std::string& name) {
  if (name.starts_with("gtin")) return "barcode";
  if (name == "author") return "authors";
  if (name == "datePublished") return "year";
  return name;
}

void add_data(const Json& object, Page& page) {
  for (const auto& [key, value] : object.items()) {
    if (key == "name") {
      page.name = text_of(value);
    } else if (key == "description") {
      page.description = html_text(text_of(value));
    } else if (key == "image") {
      const bool described = value.is_object() && value.contains("contentUrl");
      page.named_images.push_back(text_of(described ? value["contentUrl"] : value));
    } else if (key == "offers") {
      add_offer(value, page);
    } else if (key == "additionalProperty" && value.is_array()) {
      for (const Json& each : value)
        if (each.is_object() && each.contains("name") && each.contains("value"))
          add_property(page.properties, text_of(each["name"]), text_of(each["value"]));
    } else if (!key.starts_with("@") && key != "url" && key != "review" && key != "aggregateRating") {
      add_property(page.properties, key_of(key), html_text(text_of(value)));
    }
  }
}

/// The product may be the object itself, in a list, or in a graph.
void find_data(const Json& json, Page& page, int depth = 0) {
  if (depth > 8) return;
  if (json.is_array())
    for (const Json& each : json) find_data(each, page, depth + 1);
  if (!json.is_object()) return;
  if (is_product(json)) return add_data(json, page);
  for (const char* key : {"@graph", "mainEntity"})
    if (json.contains(key)) find_data(json[key], page, depth + 1);
}

class PageReader {
 public:
  static Page read(const std::string& html) {
    PageReader reader;
    read_html(
        html, [&](const HtmlTag& tag) { reader.on_tag(tag); },
        [&](const std::string& text) { reader.on_text(text); });
    for (const auto& [key, value] : reader.lists_) add_property(reader.page_.properties, key, value);
    return std::move(reader.page_);
  }

 private:
  void on_tag(const HtmlTag& tag) {
    const std::string& name = tag.name;
    if (name == "script") {
      data_ = !tag.closes && tag.attribute("type") == "application/ld+json";
      script_ = !tag.closes;
      return;
    }
    if (name == "style") script_ = !tag.closes;
    if (name == "meta") return on_meta(tag);
    if (name == "img") return on_image(tag);
    if (name == "br" || name == "p" || name == "li" || name == "div") text_ += ' ';
    if (name == "title" || name == "h1") return on_heading(tag);
    if (name == "tr") {
      if (tag.closes && cells_.size() == 2) lists_.emplace_back(cells_[0], cells_[1]);
      cells_.clear();
    }
    if (name == "th" || name == "td")
      return on_cell(tag, [&](std::string text) { cells_.push_back(std::move(text)); });
    if (name == "dt") return on_cell(tag, [&](std::string text) { term_ = std::move(text); });
    if (name == "dd")
      return on_cell(tag, [&](std::string text) { lists_.emplace_back(term_, std::move(text)); });
    if (!tag.closes && !tag.attribute("itemprop").empty()) on_item(tag);
  }

  void on_text(const std::string& text) {
    if (data_) {
      try {
        find_data(parse_json(text, {}), page_);
      } catch (const Error&) {
        // Pages hold what they hold.
      }
      data_ = false;
      return;
    }
    if (script_) return;
    const std::string plain = collapse_blanks(text);
    text_ += plain;
    if (item_.empty() || plain.find_first_not_of(' ') == std::string::npos) return;
    take_item(item_, plain);
    item_.clear();
  }

  void on_meta(const HtmlTag& tag) {
    for (const char* kind : {"property", "name"})
      if (const std::string key = tag.attribute(kind); !key.empty())
        page_.meta.emplace(key, tag.attribute("content"));
    if (const std::string item = tag.attribute("itemprop"); !item.empty())
      take_item(item, tag.attribute("content"));
  }

  void on_image(const HtmlTag& tag) {
    const std::string source = tag.attribute("src");
    if (source.empty()) return;
    (tag.attribute("itemprop") == "image" ? page_.named_images : page_.images).push_back(source);
  }

  void on_heading(const HtmlTag& tag) {
    std::string& target = tag.name == "h1" ? page_.heading : page_.title;
    if (tag.closes && target.empty()) target = trimmed(text_);
    // <h1 itemprop="name">
    if (!tag.closes && tag.attribute("itemprop") == "name") item_ = "name";
    text_.clear();
  }

  template <class Take>
  void on_cell(const HtmlTag& tag, const Take& take) {
    if (tag.closes) take(trimmed(text_));
    text_.clear();
  }

  void on_item(const HtmlTag& tag) {
    const std::string item = tag.attribute("itemprop");
    for (const char* carrier : {"content", "datetime", "value"})
      if (const std::string value = tag.attribute(carrier); !value.empty()) return take_item(item, value);
    if (!tag.attributes.contains("itemscope")) item_ = item;
  }

  void take_item(const std::string& item, const std::string& value) {
    if (item == "name" && page_.name.empty())
      page_.name = trimmed(value);
    else if (item == "description" && page_.description.empty())
      page_.description = trimmed(value);
    else if (item == "image")
      page_.named_images.push_back(value);
    else if (item != "name" && item != "description" && item != "url")
      add_property(page_.properties, key_of(item), value);
  }

  /// "Weight:" in a table is weight.
  static std::string trimmed(const std::string& text) {
    const std::string plain = collapse_blanks(text);
    const size_t first = plain.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return plain.substr(first, plain.find_last_not_of(" :") - first + 1);
  }

  Page page_;
  std::vector<std::pair<std::string, std::string>> lists_;
  std::vector<std::string> cells_;
  std::string text_, term_, item_;
  bool data_ = false, script_ = false;
};

/// "%20" is a blank; what follows ? or # is no part of a file's name.
std::string file_name_of(const std::string& url) {
  const std::string path = url.substr(0, url.find_first_of("?#"));
  std::string name;
  for (size_t i = 0; i < path.size(); ++i) {
    const bool escaped = path[i] == '%' && i + 2 < path.size() &&
                         std::isxdigit(static_cast<unsigned char>(path[i + 1])) &&
                         std::isxdigit(static_cast<unsigned char>(path[i + 2]));
    name += escaped ? static_cast<char>(std::stoi(path.substr(i + 1, 2), nullptr, 16)) : path[i];
    if (escaped) i += 2;
  }
  return name;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  const fs::path relative = fs::weakly_canonical(path).lexically_relative(fs::weakly_canonical(folder));
  return !relative.empty() && *relative.begin() != "..";
}

/// Where an image was saved: at its address relative to the page, or by its name beside it or in a folder
/// that is named after the page; empty when it was not, or is none.
fs::path saved_image(const std::string& url, const fs::path& page) {
  const std::string name = file_name_of(url);
  const fs::path last = fs::path(name).filename();
  std::vector<fs::path> places;
  if (name.find("://") == std::string::npos && !name.starts_with('/'))
    places.push_back(page.parent_path() / name);
  places.push_back(page.parent_path() / last);
  for (const char* ending : {"_files", ".files", "-Dateien", ""})
    places.push_back(page.parent_path() / (page.stem().string() + ending) / last);
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (last.empty() || !fs::is_regular_file(place, ignored) || !is_below(place, page.parent_path()))
      continue;
    try {
      const mapping::ImageHeader header = mapping::read_image_header(place);
      if (std::min(header.width, header.height) >= kMinSide) return place;
    } catch (const Error&) {
      continue;
    }
  }
  return {};
}

fs::path image_of(const Page& page, const fs::path& file) {
  std::vector<std::string> named = page.named_images;
  for (const char* key : {"og:image", "twitter:image"})
    if (page.meta.contains(key)) named.push_back(page.meta.at(key));
  for (const std::string& url : named)
    if (fs::path saved = saved_image(url, file); !saved.empty()) return saved;
  fs::path largest;
  int most = 0;
  for (const std::string& url : page.images) {
    const fs::path saved = saved_image(url, file);
    if (saved.empty()) continue;
    const mapping::ImageHeader header = mapping::read_image_header(saved);
    if (header.width * header.height <= most) continue;
    most = header.width * header.height;
    largest = saved;
  }
  return largest;
}

std::string first_of(const std::vector<std::string>& texts) {
  const auto found =
      std::find_if(texts.begin(), texts.end(), [](const std::string& text) { return !text.empty(); });
  return found == texts.end() ? std::string() : *found;
}

Product product_of(const fs::path& file) {
  Page page = PageReader::read(read_file(file));
  Product product;
  product.image = image_of(page, file);
  product.name = first_of({page.name, page.meta["og:title"], page.heading, page.title});
  product.properties = page.properties;
  const std::string description =
      first_of({page.description, page.meta["og:description"], page.meta["description"]});
  add_property(product.properties, "price", page.meta["product:price:amount"]);
  add_property(product.properties, "brand", page.meta["product:brand"]);
  add_property(product.properties, "description", description);
  for (const auto& [key, value] : properties_of_text(product.name + ". " + description))
    add_property(product.properties, key, value);
  return product;
}

}  // namespace

bool has_product_pages(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_page(entry.path())) return true;
  return false;
}

std::vector<Product> read_product_pages(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_page(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Product> products;
  for (const fs::path& file : files) {
    Product product = product_of(file);
    if (!product.name.empty() && !product.image.empty()) products.push_back(std::move(product));
  }
  return products;
}

}  // namespace loci::perception
