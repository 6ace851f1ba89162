// Which objects and places people mean by a name or words.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/names.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

std::vector<std::string> lower_case_words(const std::string& text) {
  return words_of(lower_case(text), " ,");
}

/// words[first .. first + count) as one text.
std::string phrase(const std::vector<std::string>& words, size_t first, size_t count = std::string::npos) {
  const auto begin = words.begin() + static_cast<std::ptrdiff_t>(first);
  const size_t length = std::min(count, words.size() - first);
  return fmt::format("{}", fmt::join(begin, begin + static_cast<std::ptrdiff_t>(length), " "));
}

/// A name as written in maps: "drawer 1" is drawer_1.
std::string with_underscores(std::string name) {
  std::ranges::replace(name, ' ', '_');
  return name;
}

std::vector<Id> intersection(const std::vector<Id>& a, const std::vector<Id>& b) {
  std::vector<Id> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both;
}

const std::set<std::string> kFillers = {"the",   "a",      "an",     "my",      "our",  "your",
                                        "thing", "things", "object", "objects", "item", "items",
                                        "one",   "ones",   "all",    "any",     "some", "everything"};

/// "South counter" is counter_south.
bool has_all_words(const std::string& name, const std::vector<std::string>& asked) {
  const std::vector<std::string> words = words_of(lower_case(name), "_ ");
  return asked.size() > 1 && std::ranges::all_of(asked, [&](const std::string& word) {
           return std::ranges::count(words, word.ends_with("ern") ? word.substr(0, word.size() - 3) : word) >
                  0;
         });
}

std::vector<Id> unique(std::vector<Id> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// What things are sold in: "jam jar".
bool is_package(const std::string& word) {
  static const std::set<std::string> words = {"jar",     "bottle", "carton", "box",       "packet",  "pack",
                                              "package", "tin",    "can",    "container", "bag",     "tube",
                                              "tub",     "jars",   "tins",   "cans",      "bottles", "boxes"};
  return words.contains(word);
}

/// What things are for: "cooking pot", "coffee cup", "dinner plate".
bool is_purpose(const std::string& word) {
  using wordnet::PartOfSpeech;
  constexpr int kMaxSteps = 6;
  const bool doing = word.ends_with("ing") && !wordnet::base_forms(word, PartOfSpeech::verb).empty();
  return word == "kitchen" || word == "fruit" || doing ||
         wordnet::relation_of(word, "food", kMaxSteps) != wordnet::Relation::none;
}

/// small, medium, large, tall, flat.
bool is_size_word(const std::string& word) {
  static const std::set<std::string> words = {"small", "medium", "large", "big", "tall", "flat"};
  return words.contains(word);
}

bool has_size(const std::string& word, const Vector3d& size) {
  const double largest = size.maxCoeff(), upright = size.z();
  const double across = std::max(size.x(), size.y());
  if (word == "small") return largest < 0.12;
  if (word == "large" || word == "big") return largest > 0.25;
  if (word == "medium") return largest >= 0.12 && largest <= 0.25;
  if (word == "tall") return upright > 1.5 * across;
  return word == "flat" && upright < 0.4 * across;
}

/// Objects most probable first, then most recent, then by id.
void order_objects(std::vector<Id>& objects, const Snapshot& snapshot) {
  const auto key = [&](Id id) {
    const BeliefRow* belief = snapshot.belief(id);
    const SceneRow* seen =
        belief != nullptr && belief->last_scene ? snapshot.scene(*belief->last_scene) : nullptr;
    const double probability =
        belief == nullptr || belief->status == ObjectStatus::gone ? 0 : belief->probability;
    return std::tuple(-std::round(probability * 100), seen == nullptr ? 0 : -seen->time, id);
  };
  std::sort(objects.begin(), objects.end(), [&](Id a, Id b) { return key(a) < key(b); });
}

/// Of objects the one with most of something, or next to it by its rank from 0; those that are there come
/// first. Unset when there is none of that rank with a known size.
std::optional<Id> most_of(const std::vector<Id>& objects, SizeMeasure measure, size_t rank,
                          const Snapshot& snapshot) {
  std::vector<std::tuple<bool, double, Id>> ranked;
  for (const Id id : objects) {
    const BeliefRow& row = *snapshot.belief(id);
    const bool away = row.status == ObjectStatus::gone || row.status == ObjectStatus::missed;
    if (row.size) ranked.emplace_back(away, -measure(*row.size), id);
  }
  std::ranges::stable_sort(ranked, {}, [](const auto& one) { return std::pair(get<0>(one), get<1>(one)); });
  return rank < ranked.size() ? std::optional(get<2>(ranked[rank])) : std::nullopt;
}

/// Of some objects those that show a colour in part: a blue bowl looks white from above.
std::vector<Id> partly_colored(const Snapshot& snapshot, std::vector<Id> objects, const std::string& color) {
  std::erase_if(objects, [&](Id id) { return std::ranges::count(snapshot.seen_colors(id), color) == 0; });
  return objects;
}

/// Of objects of several colours those of the colour whose hue is nearest to the one asked for.
void keep_nearest_color(const Snapshot& snapshot, const std::string& asked, std::vector<Id>& objects) {
  const auto away = [&](Id id) {
    const std::optional<HsvColor>& hsv = snapshot.belief(id)->hsv;
    return hsv ? degrees_from_color(hsv->hue, asked) : std::numeric_limits<double>::infinity();
  };
  if (objects.empty()) return;
  const Id nearest = *std::ranges::min_element(objects, {}, away);
  if (std::isfinite(away(nearest)))
    std::erase_if(objects,
                  [&](Id id) { return snapshot.belief(id)->color != snapshot.belief(nearest)->color; });
}

/// What a colour and a noun mean where nothing is called so: the only one of that noun that shows the colour
/// in part, or is in one that is like it, or those that share such a colour, or the only object in that
/// colour that nobody could name. Unset where nothing fits.
std::optional<std::string> only_similar(const Snapshot& snapshot, std::vector<std::string> words) {
  std::erase_if(words, [](const std::string& word) { return kFillers.contains(word); });
  if (words.size() != 2 || !is_color_word(words[0]) || is_color_word(words[1])) return {};
  const std::string asked = same_color(words[0]);
  std::vector<Id> called, present, similar;
  if (snapshot.means_objects(words[1])) called = snapshot.find_objects(words[1]);
  for (const Id id : snapshot.present_objects()) {
    const std::string color = same_color(lower_case(snapshot.belief(id)->color.value_or("")));
    const bool is_called = std::ranges::count(called, id) > 0;
    if (is_called && color == asked) return {};
    if (is_called) present.push_back(id);
    const bool nameless =
        called.empty() && is_package(words[1]) && color == asked && !snapshot.object_belief(id).object.label;
    if (nameless || (is_called && are_similar_colors(color, asked))) similar.push_back(id);
  }
  if (const std::vector<Id> partly = partly_colored(snapshot, present, asked); partly.size() == 1)
    return object_name(partly.front());
  keep_nearest_color(snapshot, asked, similar);
  const auto color_of = [&](Id id) { return snapshot.belief(id)->color.value_or(""); };
  const bool alike = !called.empty() && std::ranges::all_of(similar, [&](Id id) {
    return color_of(id) == color_of(similar[0]);
  });
  if (similar.empty() || (similar.size() > 1 && !alike)) return {};
  const std::string name = fmt::format("{} {}", color_of(similar[0]), words[1]);
  if (similar.size() > 1) return name;
  const bool one = !called.empty() && snapshot.find_objects(name).size() == 1;
  return one ? name : object_name(similar[0]);
}

}  // namespace

std::vector<PlaceRow> Snapshot::places_called(const std::string& asked) const {
  const std::string name = lower_case(asked);
  const std::string joined = with_underscores(name);
  std::vector<PlaceRow> found;
  const auto take_also = [&](auto matches) {
    std::ranges::copy_if(reads_->places, std::back_inserter(found), matches);
  };
  const auto take = [&](auto matches) {
    if (found.empty()) take_also(matches);
  };
  take([&](const PlaceRow& place) { return lower_case(place.name) == joined; });
  take([&](const PlaceRow& place) { return lower_case(place.name) == name; });
  take([&](const PlaceRow& place) {
    return std::any_of(reads_->facts.begin(), reads_->facts.end(), [&](const FactRow& fact) {
      return fact.place == place.id && fact.key == "alias" && name_key(*fact.value) == name_key(asked);
    });
  });
  // What was renamed is found by its old name, too.
  if (found.empty() &&
      std::ranges::any_of(reads_->facts, [](const FactRow& f) { return f.key == kPlaceNameKey; })) {
    for (const PlaceRow& before : store_.places())
      if (lower_case(before.name) == joined)
        take([&](const PlaceRow& place) { return place.id == before.id; });
  }
  take([&](const PlaceRow& place) { return lower_case(place.name).starts_with(joined + "_"); });
  take([&](const PlaceRow& place) { return lower_case(place.class_name) == joined; });
  if (found.empty())  // "drawer_1_front", or what the map calls it besides its name
    for (const EnvironmentPart& part : parts_named(*this, asked))
      take_also([&](const PlaceRow& place) { return part.place && part.place->id == place.id; });
  const std::vector<std::string> words = lower_case_words(name);
  take([&](const PlaceRow& place) { return has_all_words(place.name, words); });
  return found;
}

std::vector<PlaceRow> Snapshot::places_meant(const std::string& asked) const {
  std::vector<std::string> words = lower_case_words(with_names_joined(asked));
  while (words.size() > 1 && kFillers.contains(words.front())) words.erase(words.begin());
  std::vector<PlaceRow> found = places_called(phrase(words, 0));
  // "kitchen table" may be any table, "top drawer" and "north counter" not any of their kind.
  static const std::set<std::string> restricting = {
      "top",    "bottom", "upper", "lower", "left", "right",    "middle",   "other",   "next",
      "lowest", "north",  "south", "east",  "west", "northern", "southern", "eastern", "western"};
  const bool restricted =
      std::ranges::any_of(words, [](const std::string& word) { return restricting.contains(word); });
  // What a scene has not looked into yet has a name, too.
  const bool has_name = found.empty() && !parts_named(*this, phrase(words, 0)).empty();
  if (found.empty() && words.size() > 1 && !restricted && !has_name) found = places_called(words.back());
  if (found.empty() && restricted)
    for (const Id id : find_places_by_level(*this, phrase(words, 0)))
      std::ranges::copy_if(reads_->places, std::back_inserter(found),
                           [&](const PlaceRow& place) { return place.id == id; });
  if (found.empty() && !words.empty()) {  // "the drawers", "shelves"
    words.back() = singular_of_furniture(words.back());
    found = places_called(phrase(words, 0));
  }
  if (found.empty() && !words.empty())
    if (const std::string other = furniture_called(words.back());
        !other.empty() && !restricted &&
        (words.size() < 2 || !is_other_thing(words[words.size() - 2], words.back())))
      found = places_called(other);
  return found;
}

std::vector<PlaceRow> Snapshot::find_places(const std::string& asked) const {
  std::vector<PlaceRow> found = places_meant(asked);
  if (!found.empty()) return found;
  std::vector<std::string> names;
  for (const PlaceRow& place : reads_->places) names.push_back(place.name);
  const std::optional<EnvironmentPart> part = find_part_without_place(*this, asked);
  const std::string hint =
      !part ? did_you_mean(asked, names)
      : part->unseen_place
          ? fmt::format("{} is called so, but no scene has seen its contents", part->name)
          : fmt::format("{0} is called so, but the map has no surface in or on {0}", part->name);
  throw UnknownName(UnknownName::Kind::place, fmt::format("no place is called '{}'", asked), file(),
                    !hint.empty()   ? hint
                    : names.empty() ? "this memory knows no places"
                                    : fmt::format("known: {}", fmt::join(names, ", ")));
}

std::vector<Id> Snapshot::find_by_word(const std::string& word) const {
  std::vector<Id> found = find_named(word);
  // Classes of detectors are one word: "flower cup" is a flower_cup.
  if (found.empty() && word.find(' ') != std::string::npos && places_called(word).empty())
    found = find_named(with_underscores(word));
  const std::vector<std::string> related = names_related_to(word, !found.empty());
  const bool known = !found.empty();
  for (const std::string& name : related) {
    const std::vector<Id>& named = find_named(name);  // all by verdict, or none
    if (known && !named.empty() && !is_by_verdict(named.front(), name)) continue;
    for (const Id id : named)
      if (!is_color_word(name) || is_labelled(id, name)) found.push_back(id);
  }
  return related.empty() ? found : unique(std::move(found));
}

bool Snapshot::is_labelled(Id object, const std::string& name) const {
  return lower_case(object_ref(object).label.value_or("")) == name;
}

bool Snapshot::is_noun(const std::string& name) const {
  if (!is_color_word(lower_case(name))) return true;
  const std::vector<Id>& called = find_named(lower_case(name));
  return std::ranges::any_of(called, [&](Id id) { return is_labelled(id, lower_case(name)); });
}

std::vector<std::string> Snapshot::names_related_to(const std::string& word) const {
  return names_related_to(word, !find_named(word).empty());
}

std::vector<std::string> Snapshot::names_related_to(const std::string& word, bool known) const {
  if (kFillers.contains(word) || !may_have_related_names(word)) return {};
  const auto [slot, fresh] = reads_->related_to.try_emplace(word);
  if (!fresh) return slot->second;
  if (!reads_->class_names) {
    reads_->class_names.emplace();
    for (const FactRow& fact : reads_->facts)
      if (fact.object && fact.key == "class") reads_->class_names->insert(lower_case(*fact.value));
  }
  std::set<std::string> related = related_names(word, *reads_->class_names);
  if (related.empty() && !known) {
    std::set<std::string> annotated;
    for (std::string& value : store_.annotation_values())
      if (value.find_first_of(" ,0123456789") == std::string::npos && is_noun(value))
        annotated.insert(std::move(value));
    related = related_names(word, annotated);
  }
  // What is called so is meant by it, and what else is of that kind where it is a word for kinds.
  if (!(known && related.size() < 2)) slot->second.assign(related.begin(), related.end());
  return slot->second;
}

bool Snapshot::has_gone(Id object) const {
  const BeliefRow* row = belief(object);
  return row == nullptr || row->status == ObjectStatus::gone;
}

bool Snapshot::has_namesake(const std::string& name, Id object,
                            const std::function<bool(const BeliefRow&)>& such) const {
  const Among among = has_gone(object) ? Among::all : Among::present;
  const auto is_other = [&](Id id) {
    const BeliefRow* row = belief(id);
    return row != nullptr && id != object && (among == Among::all || !has_gone(id)) && such(*row);
  };
  try {
    const std::string word = phrase(significant_words(name), 0);
    const auto named = [&](const Candidate& one) {
      return one.object == object && is_named(one) && is_by_verdict(one, word);
    };
    if (std::ranges::none_of(candidates_named(word, among), named))
      return std::ranges::any_of(find_objects(name), is_other);
    // Where it is called so itself, find_objects() goes no further than to others that are.
    std::vector<std::string> words = names_related_to(word, true);
    words.push_back(word);
    return std::ranges::any_of(words, [&](const std::string& one) {
      return std::ranges::any_of(candidates_named(one, among), [&](const Candidate& candidate) {
        return is_other(candidate.object) && is_named(candidate) && is_by_verdict(candidate, one);
      });
    });
  } catch (const UnknownName&) {
    return false;  // a name that is not a word of a question
  }
}

const std::vector<Id>& Snapshot::present_candidates() const {
  if (!reads_->present_candidates) reads_->present_candidates = store_.present_candidates(as_of_);
  return *reads_->present_candidates;
}

std::vector<Id> Snapshot::present_objects() const {
  std::vector<Id> present = present_candidates();
  std::erase_if(present, [&](Id object) { return has_gone(object); });
  return present;
}

const std::vector<Id>& Snapshot::find_named(const std::string& word) const {
  const auto known = reads_->named.find(word);
  if (known != reads_->named.end()) return known->second;
  std::vector<Id> found, perhaps;
  for (const Candidate& candidate : candidates_named(word))
    if (is_named(candidate)) (is_by_verdict(candidate, word) ? found : perhaps).push_back(candidate.object);
  return reads_->named[word] = unique(found.empty() ? std::move(perhaps) : std::move(found));
}

bool Snapshot::is_named(const Candidate& candidate) const {
  if (belief(candidate.object) == nullptr) return false;
  if (candidate.class_name.empty()) return true;
  const std::optional<ClassVerdict>& verdict = class_verdict(candidate.object);
  return verdict && verdict->calls_it(candidate.class_name);
}

bool Snapshot::is_by_verdict(Id object, const std::string& word) const {
  return std::ranges::any_of(candidates_named(word), [&](const Candidate& candidate) {
    return candidate.object == object && is_by_verdict(candidate, word);
  });
}

bool Snapshot::is_by_verdict(const Candidate& candidate, const std::string& word) const {
  if (candidate.class_name.empty()) return true;
  const std::string name = lower_case(class_verdict(candidate.object)->name);
  return name == lower_case(candidate.class_name) || reads_->taxonomy.meanings(word).contains(name);
}

const std::vector<Snapshot::Candidate>& Snapshot::candidates_named(const std::string& word,
                                                                   Among among) const {
  const std::pair key(word, among);
  const auto known = reads_->candidates.find(key);
  return known != reads_->candidates.end() ? known->second
                                           : reads_->candidates[key] = search_named(word, among);
}

namespace {

/// "ada's" and, as it is typed, "adas"; "jonas'" and "jonas".
bool is_possessive_of(const std::string& word, const std::string& name) {
  if (!word.starts_with(name)) return false;
  const std::string ending = word.substr(name.size());
  return ending == "'s" || (name.ends_with('s') ? ending.empty() || ending == "'" : ending == "s");
}

}  // namespace

std::vector<Snapshot::Candidate> Snapshot::search_named(const std::string& word, Among among) const {
  if (const auto id = object_id(word)) return of_number(*id);
  std::vector<Candidate> found;
  // The name of a place means what is there now, not what once was.
  for (const PlaceRow& place : reads_->places) {
    if (lower_case(place.name) != word) continue;
    for (const Id id : objects_at(place.id)) found.push_back({id});
    return found;
  }
  // Who was given a name is meant by it, not everything of that kind.
  found = with_fact([&](const std::string& key, const std::string& value) {
    return key == "alias" && (value == word || with_underscores(value) == word);
  });
  if (!found.empty()) return found;
  const std::set<std::string> meanings = reads_->taxonomy.meanings(word);
  found = with_fact([&](const std::string& key, const std::string& value) {
    return key == "owner" ? is_possessive_of(word, value) : meanings.contains(value);
  });
  for (const std::vector<Candidate>& more : {of_looks(word, among), of_class(word, meanings, among)})
    found.insert(found.end(), more.begin(), more.end());
  return found;
}

std::vector<Snapshot::Candidate> Snapshot::of_number(Id id) const {
  if (belief(id) != nullptr) return {{id}};
  if (const auto other = object_instead_of(id)) return of_number(*other);
  // What a tombstone stands for is not known any more.
  if (id <= store_.max_object_id() && !store_.forgotten().empty())
    throw UnknownName(
        UnknownName::Kind::object,
        fmt::format("there is no {}: it may be one that was forgotten on request", object_name(id)), file(),
        "");
  return {};
}

std::optional<Id> Snapshot::object_instead_of(Id id) const {
  const bool known = belief(id) != nullptr || as_of_.known_at.has_value();
  return known ? std::nullopt : store_.object_instead_of(id);
}

std::vector<Snapshot::Candidate> Snapshot::with_fact(
    const std::function<bool(const std::string& key, const std::string& value)>& is_so) const {
  std::vector<Candidate> found;
  for (const FactRow& fact : reads_->facts)
    if (fact.object && belief(*fact.object) != nullptr && is_so(fact.key, lower_case(*fact.value)))
      found.push_back({*fact.object});
  return found;
}

/// By colour and size.
std::vector<Snapshot::Candidate> Snapshot::of_looks(const std::string& word, Among among) const {
  if (!is_size_word(word) && !is_color_word(word)) return {};
  std::vector<Candidate> found;
  const auto take = [&](const BeliefRow& row) {
    const std::optional<std::string> looks = color_of(row);
    const bool color = looks && has_color(*looks, word);
    const bool size = row.size && is_size_word(word) && has_size(word, *row.size);
    if (color || size) found.push_back({row.object});
  };
  if (among == Among::all)
    std::ranges::for_each(beliefs(), take);
  else
    for (const Id id : present_candidates())
      if (const BeliefRow* row = belief(id)) take(*row);
  return found;
}

/// What a person called its class overrules what it looked like to an annotator.
std::vector<Snapshot::Candidate> Snapshot::of_class(const std::string& word,
                                                    const std::set<std::string>& meanings,
                                                    Among among) const {
  std::map<Id, std::string> class_of;
  std::set<std::string> classes;
  for (const FactRow& fact : reads_->facts)
    if (fact.object && fact.key == "class") classes.insert(class_of[*fact.object] = lower_case(*fact.value));
  std::vector<Candidate> found;
  for (const std::string& meaning : meanings) {
    // Where people call some objects mugs, one that they call a jar is not a cup, whatever it looked like;
    // one that they call a mug is both.
    std::set<std::string> related = related_names(meaning, classes);
    if (classes.contains(meaning)) related.insert(meaning);
    const auto is_stated_otherwise = [&](Id id) {
      const auto stated = class_of.find(id);
      return !related.empty() && stated != class_of.end() && !related.contains(stated->second);
    };
    const auto take = [&](std::vector<Id> objects, const std::string& class_name) {
      if (among == Among::present) objects = intersection(objects, present_candidates());
      for (const Id id : objects) {
        const auto color = is_color_word(meaning) ? this->stated(id, "colour") : std::nullopt;
        const bool is_other = color && class_name.empty() && !has_color(*color, meaning);
        if (!is_stated_otherwise(id) && !is_other) found.push_back({id, class_name});
      }
    };
    const bool only_noun = is_color_word(meaning) && meaning != word;  // "oranges"
    if (!only_noun) take(store_.objects_annotated(meaning, kClassType, false, as_of_), "");
    take(store_.objects_annotated(meaning, kClassType, true, {{}, as_of_.known_at}), meaning);
  }
  return found;
}

std::vector<std::string> Snapshot::known_names() const {
  std::set<std::string> names;
  for (const BeliefRow& row : beliefs()) {
    names.insert(object_name(row.object));
    if (const auto color = color_of(row)) names.insert(*color);
  }
  for (const FactRow& fact : reads_->facts)
    if (fact.object) names.insert(*fact.value);
  // Words, not sentences.
  for (const std::string& value : store_.annotation_values())
    if (value.find_first_of(",0123456789") == std::string::npos && !find_named(lower_case(value)).empty())
      names.insert(value);
  for (const PlaceRow& place : reads_->places) names.erase(place.name);
  names.erase("");
  return {names.begin(), names.end()};
}

std::vector<Id> Snapshot::find_at_place(const std::string& name) const {
  std::vector<Id> found;
  for (const PlaceRow& place : find_places(name))
    for (const Id object : objects_at(place.id)) found.push_back(object);
  return unique(std::move(found));
}

std::vector<Id> Snapshot::objects_at(Id place) const {
  std::vector<Id> found;
  for (const Id object : store_.objects_at(place, as_of_)) {
    const BeliefRow* row = belief(object);
    if (row != nullptr && row->place == place && row->status != ObjectStatus::gone) found.push_back(object);
  }
  return found;
}

std::string Snapshot::hint_for(const std::vector<std::string>& words, size_t unknown) const {
  const auto some_of = [](const std::vector<std::string>& names) {
    constexpr size_t kMax = 12;
    const auto end = names.begin() + static_cast<std::ptrdiff_t>(std::min(kMax, names.size()));
    return fmt::format("{}{}", fmt::join(names.begin(), end, ", "), names.size() > kMax ? ", ..." : "");
  };
  if (as_of_.at) {
    const Snapshot later(store_, {{}, as_of_.known_at});
    for (const Id object : later.find_by_word(words[unknown]))
      if (const auto first = store_.first_observation_after(object, *as_of_.at, {}))
        return "it was first seen at " + TimeWriter(store_).text(first->time, *as_of_.at);
  }
  // "red cup", where no cup is known: the objects that are red may be meant.
  std::vector<std::string> known_words, meant;
  std::vector<Id> objects;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "on" || words[i] == "in") break;
    const std::vector<Id> matching = i == unknown ? std::vector<Id>() : find_by_word(words[i]);
    if (matching.empty()) continue;
    objects = known_words.empty() ? matching : intersection(objects, matching);
    known_words.push_back(words[i]);
  }
  for (const Id object : objects) meant.push_back(object_name(object));
  if (!meant.empty()) return fmt::format("{}: {}", fmt::join(known_words, " "), some_of(meant));
  const std::vector<std::string> names = known_names();
  if (std::string hint = did_you_mean(words[unknown], names); !hint.empty()) return hint;
  if (names.empty()) return "this memory knows no objects";
  std::vector<std::string> descriptive;  // preferred to ids
  std::ranges::copy_if(names, std::back_inserter(descriptive),
                       [](const std::string& name) { return !object_id(name); });
  return "known: " + some_of(descriptive.empty() ? names : descriptive);
}

std::optional<Id> Snapshot::find_superlative(const std::vector<std::string>& words) const {
  for (size_t i = 0; i < words.size(); ++i) {
    if (const auto degree = unmeasured().find(words[i]); degree != unmeasured().end())
      throw Error(fmt::format("{} of objects is not measured", degree->second), file());
    const auto superlative = superlatives().find(words[i]);
    if (superlative == superlatives().end()) continue;
    const size_t rank = i > 0 ? rank_called(words[i - 1]) : 0;
    std::vector<std::string> rest = words;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i - (rank > 0 ? 1 : 0)),
               rest.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    auto most = most_of(find_objects(phrase(rest, 0)), superlative->second, rank, *this);
    if (!most)
      throw UnknownName(UnknownName::Kind::object,
                        rank > 0 ? "there are not so many of them" : "no size is known of any of them",
                        file(), "");
    return most;
  }
  return std::nullopt;
}

std::vector<Id> Snapshot::find_longest_name(const std::vector<std::string>& words, size_t& next) const {
  std::vector<Id> matching;
  size_t count = std::min<size_t>(4, words.size() - next);
  while ((matching = find_by_word(phrase(words, next, count))).empty() && count > 1) --count;
  if (matching.empty()) {
    // "kitchen roll" is one name where neither word means anything.
    const auto ends = [&](const std::string& word) {
      static const std::set<std::string> joints = {"on", "in", "and", "or"};
      return joints.contains(word) || !find_by_word(word).empty();
    };
    const auto rest = words.begin() + static_cast<std::ptrdiff_t>(next);
    const auto unknown = static_cast<size_t>(std::find_if(rest + 1, words.end(), ends) - rest);
    const bool is_place = std::ranges::any_of(
        reads_->places, [&](const PlaceRow& place) { return lower_case(place.name) == words[next]; });
    throw is_place ? UnknownName(UnknownName::Kind::object,
                                 fmt::format("nothing is known to be at {}", words[next]), file(), "")
                   : UnknownName(UnknownName::Kind::object,
                                 fmt::format("nothing is known as '{}'", phrase(words, next, unknown)),
                                 file(), hint_for(words, next));
  }
  next += count;
  return matching;
}

std::string Snapshot::with_names_joined(std::string text) const {
  text = phrase(words_of(text), 0);
  std::vector<std::string> names;
  for (const FactRow& fact : reads_->facts) {
    if (fact.key != "alias") continue;
    const std::vector<std::string> words = lower_case_words(*fact.value);
    if (words.size() > 1 &&
        std::ranges::any_of(words, [](const auto& word) { return kFillers.contains(word); }))
      names.push_back(phrase(words, 0));
  }
  std::ranges::sort(names, std::greater(), &std::string::size);
  const auto in_word = [](const std::string& all, size_t i) {
    return i < all.size() && (std::isalnum(static_cast<unsigned char>(all[i])) != 0 || all[i] == '_');
  };
  for (const std::string& name : names) {
    const std::string lower = lower_case(text);
    for (size_t at = lower.find(name); at != std::string::npos; at = lower.find(name, at + name.size())) {
      if ((at > 0 && in_word(lower, at - 1)) || in_word(lower, at + name.size())) continue;
      text.replace(at, name.size(), with_underscores(name));
    }
  }
  return text;
}

std::optional<std::string> Snapshot::head_of(const std::string& subject) const {
  const std::vector<std::string> said = lower_case_words(subject);
  std::vector<std::string> words = said;
  name_basic_colors(words);
  for (size_t i = 0; i + 2 < words.size(); ++i)  // "jar of jam"
    if (is_package(words[i]) && words[i + 1] == "of" && !find_by_word(words[i + 2]).empty())
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i),
                  words.begin() + static_cast<std::ptrdiff_t>(i) + 2);
  const auto describes = [](const std::string& word) {
    return is_color_word(word) || is_size_word(word) || is_superlative(word) || kFillers.contains(word);
  };
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    size_t of = i + 1;  // "big red pot"
    while (is_size_word(words[i]) && of + 1 < words.size() && describes(words[of])) ++of;
    const std::string &modifier = words[i], &noun = words[of];
    const bool package = is_package(noun), size = is_size_word(modifier);
    if (is_other_thing(modifier, noun) || (describes(modifier) && !size) || describes(noun) ||
        (!package && !size && !is_purpose(modifier)))
      continue;
    const std::vector<Id> modified = find_by_word(modifier), called = find_by_word(noun);
    if (!intersection(modified, called).empty() ||
        !find_by_word(fmt::format("{} {}", modifier, noun)).empty())
      continue;
    const bool content = package && !modified.empty();
    if (!content && called.empty()) continue;
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(content ? i + 1 : i));
  }
  const std::string name = phrase(words, 0);
  if (words.size() < said.size() || (words != said && is_known_as(name))) return name;
  return only_similar(*this, words);
}

bool Snapshot::means_objects(const std::string& subject) const {
  if (is_known_as(subject)) return true;
  const std::optional<std::string> head = head_of(subject);
  return head && is_known_as(*head);
}

bool Snapshot::is_known_as(const std::string& subject) const {
  std::vector<std::string> words = lower_case_words(with_names_joined(subject));
  std::erase_if(words,
                [](const std::string& word) { return kFillers.contains(word) || is_superlative(word); });
  for (size_t next = 0; next < words.size();) {
    size_t count = std::min<size_t>(4, words.size() - next);
    while (count > 0 && find_by_word(phrase(words, next, count)).empty()) --count;
    if (count == 0) return false;
    next += count;
  }
  return !words.empty();
}

std::vector<Id> Snapshot::find_objects(const std::string& subject) const {
  try {
    return find_exactly(subject);
  } catch (const UnknownName&) {
    const std::optional<std::string> head = head_of(subject);
    if (!head) throw;
    try {
      return find_exactly(*head);
    } catch (const UnknownName&) {  // the name as it was said is reported
    }
    throw;
  }
}

std::vector<std::string> Snapshot::significant_words(const std::string& subject) const {
  std::vector<std::string> words = lower_case_words(with_names_joined(subject));
  std::erase_if(words, [](const std::string& word) { return kFillers.contains(word); });
  return words;
}

std::vector<Id> Snapshot::find_exactly(const std::string& subject) const {
  std::vector<std::string> words = significant_words(subject);
  std::vector<Id> found;
  if (!words.empty()) found = find_by_word(phrase(words, 0));
  if (const auto joint =
          std::ranges::find_if(words, [](const std::string& word) { return word == "and" || word == "or"; });
      found.empty() && joint != words.end() && joint != words.begin() && joint + 1 != words.end() &&
      std::ranges::none_of(words, &is_superlative)) {
    // "milk and jam": either of them.
    const auto at = static_cast<size_t>(joint - words.begin());
    found = find_objects(phrase(words, 0, at));
    for (const Id id : find_objects(phrase(words, at + 1))) found.push_back(id);
    found = unique(std::move(found));
  }
  if (found.empty()) {
    if (const auto one = find_superlative(words)) return {*one};
    for (const BeliefRow& row : beliefs()) found.push_back(row.object);
    for (size_t i = 0; i < words.size();) {
      if ((words[i] == "on" || words[i] == "in") && i + 1 < words.size()) {
        found = intersection(found, find_at_place(phrase(words, i + 1)));
        break;
      }
      found = intersection(found, find_longest_name(words, i));
    }
    if (found.empty())
      throw UnknownName(UnknownName::Kind::object, fmt::format("no object is '{}'", subject), file(),
                        "ask with fewer words");
  }
  order_objects(found, *this);
  return found;
}

}  // namespace loci::memory
