#include "memory/questions/names/color_words.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "mapping/base/text/text.h"

namespace loci::memory {
namespace {

/// Without what is rather a food, a plant or a glass: olive, lime, mint, wine.
const std::map<std::string, std::string>& basic_colors() {
  static const std::map<std::string, std::string> all = [] {
    std::map<std::string, std::string> result;
    for (const auto& [basic, words] :
         std::map<std::string, const char*>{{"black", "blackish"},
                                            {"white", "whitish ivory"},
                                            {"grey", "greyish grayish silver silvery"},
                                            {"red", "reddish maroon burgundy crimson scarlet"},
                                            {"brown", "brownish tan bronze"},
                                            {"beige", "khaki"},
                                            {"orange", "orangey orangish amber"},
                                            {"pink", "pinkish"},
                                            {"yellow", "yellowish gold golden"},
                                            {"green", "greenish"},
                                            {"cyan", "turquoise teal aqua"},
                                            {"blue", "bluish blueish navy azure"},
                                            {"purple", "purplish violet lilac mauve magenta"}})
      for (const std::string& word : words_of(words)) result[word] = basic;
    return result;
  }();
  return all;
}

bool is_shade(const std::string& word) {
  static const std::set<std::string> all = {"dark", "light", "bright", "pale", "deep", "vivid"};
  return all.contains(word);
}

}  // namespace

bool is_color_word(const std::string& word) {
  static const std::set<std::string> words = {"black", "white", "grey",   "gray",  "red",
                                              "brown", "beige", "orange", "pink",  "yellow",
                                              "green", "cyan",  "blue",   "purple"};
  return words.contains(word);
}

std::string same_color(const std::string& word) {
  return word == "gray" ? "grey" : word;
}

bool has_color(const std::string& color, const std::string& name) {
  std::vector<std::string> words = words_of(lower_case(color));
  name_basic_colors(words);
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return same_color(word) == same_color(name); });
}

bool are_similar_colors(const std::string& a, const std::string& b) {
  static const std::set<std::pair<std::string, std::string>> all = {
      {"white", "grey"},  {"white", "beige"},  {"black", "grey"},   {"beige", "brown"}, {"orange", "yellow"},
      {"orange", "red"},  {"orange", "brown"}, {"pink", "red"},     {"pink", "purple"}, {"blue", "cyan"},
      {"blue", "purple"}, {"green", "cyan"},   {"green", "yellow"}, {"red", "brown"},   {"red", "purple"}};
  return all.contains({a, b}) || all.contains({b, a});
}

double degrees_from_color(double hue, const std::string& color) {
  // As mapping::color_name() bounds them; what begins above its end goes through 0.
  static const std::map<std::string, std::pair<double, double>> hues = {
      {"red", {345, 14}},   {"pink", {300, 14}},   {"orange", {14, 42}}, {"brown", {14, 68}},
      {"beige", {14, 68}},  {"yellow", {42, 68}},  {"green", {68, 165}}, {"cyan", {165, 195}},
      {"blue", {195, 255}}, {"purple", {255, 345}}};
  const auto found = hues.find(color);
  if (found == hues.end()) return std::numeric_limits<double>::infinity();
  const auto [first, last] = found->second;
  const bool within = first < last ? hue >= first && hue <= last : hue >= first || hue <= last;
  const auto apart = [hue](double other) { return 180 - std::abs(180 - std::abs(hue - other)); };
  return within ? 0 : std::min(apart(first), apart(last));
}

void name_basic_colors(std::vector<std::string>& words) {
  for (std::string& word : words)
    if (const auto basic = basic_colors().find(word); basic != basic_colors().end()) word = basic->second;
  for (size_t i = 0; i + 1 < words.size();)
    if (is_shade(words[i]) && is_color_word(words[i + 1]))
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
}

}  // namespace loci::memory
