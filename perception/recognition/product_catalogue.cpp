#include "perception/recognition/product_catalogue.h"

#include <algorithm>
#include <map>
#include <regex>

#include "mapping/base/files.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "perception/recognition/product_pages.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, std::string>& known_keys() {
  static const std::map<std::string, std::string> names = {{"ingredient", "ingredients"},
                                                           {"contains", "ingredients"},
                                                           {"weight", "weight"},
                                                           {"net_weight", "weight"},
                                                           {"net_wt", "weight"},
                                                           {"net_volume", "volume"},
                                                           {"contents", "volume"},
                                                           {"best_before", "shelf_life"},
                                                           {"expiry", "shelf_life"},
                                                           {"manufactured_by", "manufacturer"},
                                                           {"made_by", "manufacturer"},
                                                           {"producer", "manufacturer"},
                                                           {"product_category", "category"},
                                                           {"coarse_name", "category"},
                                                           {"product_group", "group"},
                                                           {"storing", "storage"},
                                                           {"store", "storage"},
                                                           {"country_of_origin", "origin"},
                                                           {"colour", "color"},
                                                           {"ean", "barcode"},
                                                           {"gtin", "barcode"},
                                                           {"upc", "barcode"}};
  return names;
}

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n.;");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n.;") - first + 1);
}

/// Lines and sentences of the form "Some key: its value".
void add_pairs(const std::string& text, Properties& properties) {
  static const std::regex pair(
      R"((?:^|[\n.;]\s*)([A-Z][A-Za-z ()/-]{1,40}):\s*([^\n;]*?)(?=\.\s|[\n;]|\.?$))");
  for (std::sregex_iterator it(text.begin(), text.end(), pair), end; it != end; ++it)
    add_property(properties, (*it)[1], (*it)[2]);
}

void add_amounts(const std::string& text, Properties& properties) {
  static const std::regex volume(
      R"((?:^|[^\w.,])(\d+(?:[.,]\d+)?)\s?(ml|cl|dl|l|litres?|liters?|fl\.? oz)\b)", std::regex::icase);
  static const std::regex weight(R"((?:^|[^\w.,])(\d+(?:[.,]\d+)?)\s?(mg|g|kg|grams?|kilograms?|oz|lbs?)\b)",
                                 std::regex::icase);
  std::smatch found;
  if (std::regex_search(text, found, volume))
    add_property(properties, "volume", found.str(1) + " " + lower_case(found.str(2)));
  if (std::regex_search(text, found, weight))
    add_property(properties, "weight", found.str(1) + " " + lower_case(found.str(2)));
}

void add_storage(const std::string& text, Properties& properties) {
  static const std::regex warm(R"(room temperature|long shelf life|pantry)"), frozen(R"(freezer|frozen|-18)"),
      cold(R"(refrigerat|fridge|chilled|keep cool|keep cold|\+?\d ?°c)");
  const std::string words = lower_case(text);
  const auto put = [&](const char* storage, const char* perishable) {
    add_property(properties, "storage", storage);
    add_property(properties, "perishable", perishable);
  };
  // What keeps in a warm room keeps in a cold one, too: texts that name both mean the first.
  if (std::regex_search(words, warm)) return put("room temperature", "no");
  if (std::regex_search(words, frozen)) return put("freezer", "yes");
  if (std::regex_search(words, cold)) return put("refrigerator", "yes");
}

void add_ingredients(const std::string& text, Properties& properties) {
  static const std::regex made(R"(\b(?:made|pressed|blend|mixed) (?:of|from|on|with) ([^.!\n]{3,120}))",
                               std::regex::icase);
  std::smatch found;
  if (std::regex_search(text, found, made)) add_property(properties, "ingredients", found[1]);
}

Product product_of_row(const CsvTable& table, size_t row, size_t image, size_t name, const fs::path& folder) {
  Product product;
  product.image = folder / table.cell(row, image);
  product.name = table.cell(row, name);
  for (size_t column = 0; column < table.header().size(); ++column)
    if (column != image && column != name)
      add_property(product.properties, table.header()[column], table.cell(row, column));
  const int description = table.column("description");
  if (description >= 0)
    for (const auto& [key, value] : properties_of_text(table.cell(row, static_cast<size_t>(description))))
      add_property(product.properties, key, value);
  return product;
}

std::vector<Product> read_table(const fs::path& file) {
  const CsvTable table = CsvTable::read(file);
  const size_t image = table.require_column("image");
  int name = -1;
  for (const char* key : {"name", "class_name", "product", "title"})
    if (name < 0) name = table.column(key);
  if (name < 0)
    throw Error("a catalogue needs the names of its products", {file.string(), 1, {}},
                "add a column name, class_name, product or title");
  std::vector<Product> products;
  for (size_t row = 0; row < table.rows(); ++row) {
    products.push_back(product_of_row(table, row, image, static_cast<size_t>(name), file.parent_path()));
    if (products.back().name.empty()) throw Error("the product has no name", table.location(row));
  }
  return products;
}

bool is_image(const fs::path& path) {
  const std::string ending = lower_case(path.extension().string());
  return ending == ".jpg" || ending == ".jpeg" || ending == ".png";
}

Properties properties_beside(const fs::path& image) {
  Properties properties;
  fs::path text = image, json = image;
  if (fs::exists(json.replace_extension(".json"))) {
    const Json object = read_json(json);
    if (!object.is_object())
      throw Error("a product's file holds an object of keys and values", {json.string(), 0, {}});
    for (const auto& [key, value] : object.items())
      add_property(properties, key, value.is_string() ? value.get<std::string>() : value.dump());
  }
  if (fs::exists(text.replace_extension(".txt"))) add_property(properties, "description", read_file(text));
  const auto description = std::find_if(properties.begin(), properties.end(),
                                        [](const auto& property) { return property.first == "description"; });
  if (description == properties.end()) return properties;
  const std::string words = description->second;
  for (const auto& [key, value] : properties_of_text(words)) add_property(properties, key, value);
  return properties;
}

std::vector<Product> read_images(const fs::path& folder) {
  static const std::regex numbered("(.+)_[0-9]+");
  std::vector<Product> products;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!is_image(entry.path())) continue;
    Product product;
    product.image = entry.path();
    product.name = std::regex_replace(entry.path().stem().string(), numbered, "$1");
    product.properties = properties_beside(entry.path());
    products.push_back(std::move(product));
  }
  std::sort(products.begin(), products.end(),
            [](const Product& a, const Product& b) { return a.image < b.image; });
  return products;
}

}  // namespace

std::string normalised_key(const std::string& key) {
  std::string name;
  for (const char c : lower_case(key)) {
    const bool letter =
        (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80;
    if (letter)
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  if (!name.empty() && name.back() == '_') name.pop_back();
  const auto known = known_keys().find(name);
  return known == known_keys().end() ? name : known->second;
}

void add_property(Properties& properties, const std::string& key, const std::string& value) {
  const std::string name = normalised_key(key);
  const bool known = std::any_of(properties.begin(), properties.end(),
                                 [&](const auto& property) { return property.first == name; });
  if (!name.empty() && !trimmed(value).empty() && !known) properties.emplace_back(name, trimmed(value));
}

Properties properties_of_text(const std::string& text) {
  Properties properties;
  add_pairs(text, properties);
  add_amounts(text, properties);
  add_storage(text, properties);
  add_ingredients(text, properties);
  return properties;
}

std::vector<Product> read_catalogue(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw Error("there is no such catalogue", {folder.string(), 0, {}}, "give a folder of images");
  const fs::path table = folder / "catalogue.csv";
  std::vector<Product> products = fs::exists(table)           ? read_table(table)
                                  : has_product_pages(folder) ? read_product_pages(folder)
                                                              : read_images(folder);
  if (products.empty())
    throw Error("the catalogue has no products", {folder.string(), 0, {}},
                "it holds a catalogue.csv, saved web pages, or images named after what they show");
  return products;
}

}  // namespace loci::perception
