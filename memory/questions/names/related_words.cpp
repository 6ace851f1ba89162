#include "memory/questions/names/related_words.h"

#include <algorithm>
#include <map>

#include "mapping/base/text/text.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

using wordnet::PartOfSpeech;

/// What WordNet does not say: the words of kitchens for what they hold.
const std::map<std::string, std::string>& household_kinds() {
  constexpr const char* kCrockery = "plate bowl cup mug saucer glass jug dish";
  constexpr const char* kPackage = "box carton cereal tea";
  constexpr const char* kCans = "can tin tomatoes soup";
  static const std::map<std::string, std::string> kinds = {{"crockery", kCrockery},
                                                           {"dishes", kCrockery},
                                                           {"dishware", kCrockery},
                                                           {"tableware", kCrockery},
                                                           {"packet", kPackage},
                                                           {"package", kPackage},
                                                           {"pack", kPackage},
                                                           {"tin", kCans},
                                                           {"tins", kCans},
                                                           {"cans", kCans},
                                                           {"can", kCans},
                                                           {"cookware", "pot pan wok casserole"},
                                                           {"cutlery", "spoon fork knife"},
                                                           {"silverware", "spoon fork knife"},
                                                           {"teabag", "tea"},
                                                           {"teabags", "tea"},
                                                           {"cornflakes", "cereal"},
                                                           {"muesli", "cereal"},
                                                           {"mug", "cup"},
                                                           {"mugs", "cup"},
                                                           {"cup", "mug"},
                                                           {"cups", "mug"},
                                                           {"teacup", "cup mug"},
                                                           {"beaker", "cup mug"},
                                                           {"marmalade", "jam"},
                                                           {"saucepan", "pot pan"},
                                                           {"goblet", "glass"},
                                                           {"tumbler", "glass"}};
  return kinds;
}

/// The noun without its ending; itself where it is none.
std::set<std::string> singulars(const std::string& word) {
  const std::vector<std::string> bases = wordnet::base_forms(word, PartOfSpeech::noun);
  std::set<std::string> all(bases.begin(), bases.end());
  all.insert(word);
  return all;
}

bool is_kind(const std::string& name, const std::string& word) {
  constexpr int kMaxSteps = 6;
  return wordnet::relation_of(name, word, kMaxSteps) != wordnet::Relation::none;
}

}  // namespace

std::set<std::string> related_names(const std::string& word, const std::set<std::string>& names) {
  std::set<std::string> found;
  if (word == "edible" || word == "edibles") {
    std::set<std::string> food = related_names("food", names);
    for (const char* one : {"oil", "butter", "salt", "sugar", "pepper", "vinegar"})
      if (names.contains(one)) food.insert(one);
    return food;
  }
  if (word == "drinkable" || word == "drinkables") return related_names("drink", names);
  const std::set<std::string> own = singulars(word);
  const auto listed = household_kinds().find(word);
  const std::vector<std::string> kinds =
      listed == household_kinds().end() ? std::vector<std::string>() : words_of(listed->second);
  for (const std::string& name : names)
    for (const std::string& one : singulars(name))
      if (!own.contains(name) && (std::ranges::count(kinds, one) > 0 || is_kind(one, word)))
        found.insert(name);
  if (!found.empty() || listed != household_kinds().end()) return found;
  // A teaspoon is a spoon; that a kettle is a pot makes it none of the pots that are here.
  for (const std::string& name : names)
    if (word != name && word.ends_with(name) &&
        wordnet::relation_of(word, name, 2) != wordnet::Relation::none)
      found.insert(name);
  return found;
}

bool may_have_related_names(const std::string& word) {
  if (word.find_first_of(" _0123456789'") != std::string::npos) return false;
  return household_kinds().contains(word) || word == "edible" || word == "drinkable" ||
         !wordnet::base_forms(word, PartOfSpeech::noun).empty();
}

const std::map<std::string, SizeMeasure>& superlatives() {
  const SizeMeasure bulk = [](const Vector3d& size) { return size.prod(); };
  const SizeMeasure thrift = [](const Vector3d& size) { return -size.prod(); };
  const SizeMeasure height = [](const Vector3d& size) { return size.z(); };
  const SizeMeasure lowness = [](const Vector3d& size) { return -size.z(); };
  const SizeMeasure length = [](const Vector3d& size) { return size.maxCoeff(); };
  const SizeMeasure width = [](const Vector3d& size) { return std::max(size.x(), size.y()); };
  const SizeMeasure narrowness = [](const Vector3d& size) { return -std::max(size.x(), size.y()); };
  const SizeMeasure thickness = [](const Vector3d& size) { return size.minCoeff(); };
  const SizeMeasure thinness = [](const Vector3d& size) { return -size.minCoeff(); };
  // Of two the bigger one is the biggest.
  static const std::map<std::string, SizeMeasure> words = {
      {"biggest", bulk},        {"bigger", bulk},       {"largest", bulk},         {"larger", bulk},
      {"hugest", bulk},         {"smallest", thrift},   {"smaller", thrift},       {"littlest", thrift},
      {"tiniest", thrift},      {"tallest", height},    {"taller", height},        {"highest", height},
      {"shortest", lowness},    {"shorter", lowness},   {"flattest", lowness},     {"flatter", lowness},
      {"longest", length},      {"longer", length},     {"widest", width},         {"wider", width},
      {"broadest", width},      {"broader", width},     {"narrowest", narrowness}, {"narrower", narrowness},
      {"thickest", thickness},  {"thicker", thickness}, {"thinnest", thinness},    {"thinner", thinness},
      {"slimmest", narrowness}, {"slimmer", narrowness}};
  return words;
}

const std::map<std::string, std::string>& unmeasured() {
  static const std::map<std::string, std::string> words = [] {
    std::map<std::string, std::string> all;
    for (const auto& [property, degrees] :
         {std::pair("the weight", "heaviest heavier lightest"),
          {"the age", "oldest older youngest newest newer"},
          {"the price", "cheapest cheaper dearest priciest"},
          {"the temperature", "hottest hotter coldest colder warmest warmer"},
          {"the taste", "tastiest sweetest sourest"}})
      for (const std::string& degree : words_of(degrees)) all[degree] = property;
    return all;
  }();
  return words;
}

bool is_superlative(const std::string& word) {
  return superlatives().contains(word) || unmeasured().contains(word);
}

bool is_other_thing(const std::string& modifier, const std::string& noun) {
  constexpr int kMaxSteps = 6;
  const std::string compound = modifier + "_" + noun;
  return !wordnet::base_forms(compound, PartOfSpeech::noun).empty() &&
         wordnet::relation_of(compound, noun, kMaxSteps) == wordnet::Relation::none;
}

std::string singular_of(const std::string& word) {
  const std::vector<std::string> bases = wordnet::base_forms(word, PartOfSpeech::noun);
  return bases.empty() || std::ranges::count(bases, word) > 0 ? word : bases.front();
}

std::string singular_of_furniture(std::string name) {
  if (name.ends_with("ves"))
    name.replace(name.size() - 3, 3, "f");
  else if (name.ends_with('s'))
    name.pop_back();
  return name;
}

size_t rank_called(const std::string& word) {
  static const std::map<std::string, size_t> ranks = {{"second", 1}, {"2nd", 1},    {"third", 2},
                                                      {"3rd", 2},    {"fourth", 3}, {"4th", 3}};
  const auto found = ranks.find(word);
  return found == ranks.end() ? 0 : found->second;
}

std::string furniture_called(const std::string& word) {
  static const std::map<std::string, std::string> words = {
      {"worktop", "counter"},  {"countertop", "counter"}, {"worksurface", "counter"},
      {"benchtop", "counter"}, {"sideboard", "counter"},  {"desk", "table"},
      {"tabletop", "table"},   {"rack", "shelf"},         {"ledge", "shelf"},
      {"cupboard", "cabinet"}, {"locker", "cabinet"}};
  const auto found = words.find(word);
  return found == words.end() ? "" : found->second;
}

}  // namespace loci::memory
