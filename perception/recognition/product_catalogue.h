#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/error.h"

namespace loci::perception {

/// Keys and values, in the order in which they were found; keys in lower case with underscores, each once.
using Properties = std::vector<std::pair<std::string, std::string>>;

/// "Nutrition Facts (per 100 g)" is nutrition_facts_per_100_g; of British and American, singular and plural
/// names of what packages tell, one: "Ingredient" is ingredients, "Best before" shelf_life, "Manufactured by"
/// manufacturer.
std::string normalised_key(const std::string& key);

/// Adds a property by its normalised key, unless there is one already or the value is empty.
void add_property(Properties& properties, const std::string& key, const std::string& value);

/// What a description says: lines and sentences like "Weight: 500 g" as they are; else an amount ("1.5 l") as
/// volume or weight, how it is stored ("refrigerator", "room temperature") as storage and perishable, "made
/// of …" as ingredients.
Properties properties_of_text(const std::string& text);

struct Product {
  std::string name;
  Properties properties;
  std::filesystem::path image;
};

/// Reads a catalogue: a folder with catalogue.csv (a column image; name, class_name, product or title;
/// description; all others become properties), or of saved web pages (read_product_pages()), or of images
/// named after what they show, each perhaps with its description beside it in a file of the same name (.txt:
/// text; .json: an object of keys and values). A product may have several images: those of the same name,
/// or NAME_1.jpg, NAME_2.jpg. Error when there is no image at all.
std::vector<Product> read_catalogue(const std::filesystem::path& folder);

}  // namespace loci::perception
