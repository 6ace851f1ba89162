#include "memory/sentences/references.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/names/names.h"

namespace loci::memory {
namespace {

const std::set<std::string> kPronouns = {"it", "them", "that",     "this",    "they",
                                         "he", "she",  "that one", "this one"};

bool is_place(ParameterType type) {
  return type == ParameterType::place || type == ParameterType::part;
}
/// "Red mug" of "red mug that was put away in a drawer".
std::string kind_of(const std::string& name) {
  size_t end = name.size();
  for (const char* link : {" on ", " in ", " that ", " which "}) end = std::min(end, name.find(link));
  return name.substr(0, end);
}
bool names_something(ParameterType type) {
  return type == ParameterType::object || type == ParameterType::place || type == ParameterType::part ||
         type == ParameterType::spot;
}
std::optional<std::string> argument_of(const Query& query, const std::set<ParameterType>& types) {
  for (const Parameter& parameter : find_question(query.question)->parameters)
    if (types.contains(parameter.type) && query.arguments.contains(parameter.name))
      return query.argument(parameter.name);
  return std::nullopt;
}

}  // namespace

bool is_reference(const std::string& word) {
  return kPronouns.contains(word) || word == "there" || word == "one" || word == "ones";
}

void ReferenceResolver::remember(const Query& query, const Reply& reply) {
  last_objects_ = reply.objects;
  remember_objects(query);
  remember_place(query, reply);
}

/// What the question names, or what answers it: "What moved last?" Of several of one name the one that the
/// answer named.
void ReferenceResolver::remember_objects(const Query& query) {
  constexpr size_t kMaxNamed = 5;
  std::vector<std::string> names;
  for (const Id id : last_objects_) names.push_back(object_name(id));
  const auto subject = argument_of(query, {ParameterType::object, ParameterType::spot});
  referent_.clear();
  if (!subject && !names.empty()) {
    last_subject_ = names.size() <= kMaxNamed ? joined(names, " and ") : "";
  } else if (subject) {
    last_subject_ = *subject;
    const bool by_name = names.size() == 1 && query.arguments.contains("object");
    if (by_name && snapshot_.means_objects(*subject)) {
      const std::vector<Id> called = snapshot_.find_objects(*subject);
      if (called.size() > 1 && std::ranges::count(called, last_objects_[0]) > 0) referent_ = names[0];
    }
  }
}

/// "The drawer" is the one that the answer named, where it named one.
void ReferenceResolver::remember_place(const Query& query, const Reply& reply) {
  const auto place = argument_of(query, {ParameterType::place, ParameterType::part});
  if (place) last_place_ = *place;
  const bool answers =
      place ? snapshot_.places_meant(*place).size() > 1 : reply.objects.empty() || query.asks == Asks::place;
  if (answers && reply.places.size() == 1) last_place_ = name_in_words(reply.places[0]);
}

void ReferenceResolver::remember(const std::string& subject, const std::string& place) {
  referent_.clear();
  if (!subject.empty()) last_subject_ = subject;
  if (!place.empty()) last_place_ = place;
}

bool ReferenceResolver::resolve(Query& query, std::vector<std::string>& notes) {
  for (const Parameter& parameter : find_question(query.question)->parameters) {
    const auto given = query.arguments.find(parameter.name);
    if (given == query.arguments.end() || !names_something(parameter.type)) continue;
    std::string& text = given->second;
    if (text.ends_with(" one") && text != "other one" && text != "this one" && text != "that one" &&
        !last_subject_.empty())
      text.replace(text.size() - 3, 3, last_subject_.substr(last_subject_.rfind(' ') + 1));
    if (text == "other one" || text == "other" || text == "other ones") {
      if (last_subject_.empty()) return false;
      replace_other(text, kind_of(last_subject_), notes);
    } else if (text.starts_with("other ")) {
      replace_other(text, text.substr(text.find(' ') + 1), notes);
    }
    if (kPronouns.contains(text) && is_place(parameter.type) && !last_place_.empty()) {
      notes.push_back(fmt::format("'{}' is taken as {}", text, last_place_));
      text = last_place_;
    }
    const bool one = (text == "one" || text == "ones") && !last_subject_.empty();
    if (kPronouns.contains(text) && !referent_.empty()) {
      notes.push_back(fmt::format("'{}' is taken as {}", text, referent_));
      text = referent_;
    }
    if ((one || kPronouns.contains(text)) && !replace_pronoun(text, notes)) return false;
    if (text.starts_with("this ") || text.starts_with("that ")) replace_demonstrative(text, notes);
  }
  for (const Parameter& parameter : find_question(query.question)->parameters)
    if (parameter.type == ParameterType::place && query.argument(parameter.name) == "there")
      replace_there(query, parameter, notes);
  if (query.argument("at") == "then") replace_then(query, notes);
  return true;
}

/// "then" is when the object that a spot is named by was last seen.
void ReferenceResolver::replace_then(Query& query, std::vector<std::string>& notes) const {
  query.arguments.erase("at");
  const auto around = argument_of(query, {ParameterType::spot});
  if (!around || !snapshot_.places_called(*around).empty()) return;
  try {
    const Id object = snapshot_.find_objects(snapshot_.head_of(*around).value_or(*around)).front();
    const auto last = snapshot_.object_belief(object).last_seen;
    if (!last) return;
    query.arguments["at"] = format_time(last->time);
    notes.push_back(fmt::format("at {}, when the {} was last seen",
                                TimeWriter(snapshot_.store()).text(last->time), *around));
  } catch (const UnknownName&) {
    return;  // reported by the answer
  }
}

bool ReferenceResolver::replace_pronoun(std::string& text, std::vector<std::string>& notes) const {
  if (last_subject_.empty()) return false;
  notes.push_back(fmt::format("'{}' is taken as '{}'", text, last_subject_));
  text = last_subject_;
  return true;
}

/// "The other one" is of the kind spoken of, "the other cup" a cup, and neither what the last answer named.
void ReferenceResolver::replace_other(std::string& text, const std::string& kind,
                                      std::vector<std::string>& notes) const {
  try {
    // Besides the only blue bowl, the other one is another bowl.
    for (const std::string& name : {kind, kind.substr(kind.rfind(' ') + 1)})
      for (const Id object : snapshot_.find_objects(snapshot_.head_of(name).value_or(name)))
        if (std::ranges::count(last_objects_, object) == 0) {
          notes.push_back(fmt::format("'{}' is taken as {}", text, object_name(object)));
          text = object_name(object);
          return;
        }
    if (text == "other " + kind) {
      notes.push_back(fmt::format("the answer before named each '{0}': '{1}' is taken as '{0}'", kind, text));
      text = kind;
    }
  } catch (const UnknownName&) {
    return;  // reported by the answer
  }
}

/// The place of the most probable object that is meant; "" = unknown.
std::string ReferenceResolver::place_of(const std::string& subject) const {
  try {
    const Id object = snapshot_.find_objects(snapshot_.head_of(subject).value_or(subject)).front();
    const auto place = snapshot_.place_ref(snapshot_.belief(object)->place);
    return place ? place->name : "";
  } catch (const UnknownName&) {
    return "";  // reported by the answer
  }
}

/// "there" is the place named last, else where the object was seen last.
void ReferenceResolver::replace_there(Query& query, const Parameter& parameter,
                                      std::vector<std::string>& notes) const {
  const std::string subject = argument_of(query, {ParameterType::object}).value_or(last_subject_);
  const std::string place = !last_place_.empty() ? last_place_ : subject.empty() ? "" : place_of(subject);
  if (!place.empty()) {
    notes.push_back(fmt::format("'there' is taken as {}", place));
    query.arguments[parameter.name] = place;
  } else if (!parameter.required) {
    query.arguments.erase(parameter.name);  // anywhere
  }
}

/// "this drawer" is the drawer that was seen last.
void ReferenceResolver::replace_demonstrative(std::string& text, std::vector<std::string>& notes) const {
  const std::string name = text.substr(5);
  std::vector<PlaceRow> places;
  try {
    places = snapshot_.find_places(name);
  } catch (const UnknownName&) {
    text = name;
    return;
  }
  const PlaceRow* chosen = nullptr;
  TimeNs latest = 0;
  for (const PlaceRow& place : places)
    for (const VisibilityRow& view : snapshot_.store().visibility_of_place(place.id)) {
      const SceneRow* scene = snapshot_.scene(view.scene);
      if (scene == nullptr || view.fraction.value_or(0) <= 0 || scene->time < latest) continue;
      latest = scene->time;
      chosen = &place;
    }
  if (chosen == nullptr) chosen = &places[0];
  notes.push_back(fmt::format("'{}' is taken as {}, {}", text, chosen->name,
                              latest == 0 ? "the first of that name" : "which was looked at last"));
  text = chosen->name;
}

}  // namespace loci::memory
