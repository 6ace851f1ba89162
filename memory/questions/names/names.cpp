#include "memory/questions/names/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "mapping/base/text/text.h"

namespace loci::memory {
std::string Names::of(const ObjectRef& object) const {
  if (!object.label && !object.color) return object.name;
  const std::string word = object.label ? *object.label : *object.color;
  std::string name = object.label ? *object.label : *object.color + " object";
  const auto none_is = [&](const std::function<bool(const BeliefRow&)>& such) {
    return !snapshot_.has_namesake(word, object.id, such);
  };
  if (none_is([](const BeliefRow&) { return true; })) return name;
  if (object.label && object.color &&
      none_is([&](const BeliefRow& row) { return snapshot_.color_of(row) == object.color; }))
    return *object.color + " " + name;
  const BeliefRow* belief = snapshot_.belief(object.id);
  if (belief != nullptr && belief->place &&
      none_is([&](const BeliefRow& row) { return row.place == belief->place; }))
    if (const auto place = snapshot_.place_ref(belief->place)) return name + " " + in_words(*place);
  return object.label ? name + " " + object.name : *object.color + " " + object.name;
}

std::string with_article(const std::string& name) {
  static const std::set<std::string> determiners = {"the",  "a",   "an",  "my",    "our",
                                                    "your", "his", "her", "their", "its"};
  const std::string first = lower_case(name.substr(0, name.find(' ')));
  return determiners.contains(first) || first.ends_with("'s") ? name : "the " + name;
}

std::string Names::subject(const ObjectRef& object) const {
  const std::string name = of(object);
  return name == object.name ? name : with_article(name);
}

std::string name_in_words(const std::string& place) {
  constexpr std::string_view kBottom = "_bottom";
  return place.ends_with(kBottom) ? place.substr(0, place.size() - kBottom.size()) : place;
}

std::string piece_in_words(std::string name) {
  for (const std::string_view ending : {"_joint", "_front", "_bottom"})
    if (name.ends_with(ending)) name.resize(name.size() - ending.size());
  return name;
}

std::string name_key(const std::string& name) {
  std::string key = lower_case(name);
  std::ranges::replace(key, ' ', '_');
  for (const std::string_view article : {"the_", "a_", "an_"})
    if (key.starts_with(article)) return key.substr(article.size());
  return key;
}

std::string part_in_words(const std::string& name) {
  const bool numbered =
      name.find('_') != std::string::npos || name.find_first_of("0123456789") != std::string::npos;
  return numbered ? name_in_words(name) : with_article(name);
}

std::string in_words(const PlaceRef& place) {
  return (place.container ? "in " : "on ") + part_in_words(place.name);
}

std::string list_in_words(const std::vector<std::string>& names, size_t count) {
  if (names.empty()) return "nothing";
  if (names.size() == 1) return names[0];
  const size_t shown = names.size() > count ? count - 1 : names.size() - 1;
  return fmt::format("{} and {}",
                     fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                     names.size() > count ? fmt::format("{} more", names.size() - shown) : names.back());
}

}  // namespace loci::memory
