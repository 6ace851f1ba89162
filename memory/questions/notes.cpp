#include "memory/questions/notes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mapping/base/text/text.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/forgotten.h"
#include "memory/questions/names/names.h"
#include "memory/questions/names/related_words.h"

namespace loci::memory {
namespace {

/// Which half of the day a time is taken for, and which of two times of one name.
void note_times(const Snapshot& snapshot, const Query& query, std::vector<std::string>& notes) {
  const TimeReader times(snapshot.store());
  const TimeWriter writer(snapshot.store());
  std::string noted;
  for (const char* name : {"at", "from", "to", "unseen-since"}) {
    const std::string text = query.argument(name);
    const std::optional<TimeSpan> span = text.empty() ? std::nullopt : times.try_read(text);
    if (!span) continue;
    const bool end = name == std::string("at") || name == std::string("to");
    const bool is_moment =
        name == std::string("at") || (text == query.argument("from") && text == query.argument("to"));
    const TimeSpan taken = is_moment ? read_moment(snapshot.store(), text) : *span;
    if (times.is_repeated(text, end) && text != noted)
      notes.push_back(fmt::format("clocks showed '{}' twice; {} is taken", text,
                                  writer.text(end ? taken.last : taken.first)));
    else if (text != noted && times.may_be_other_half(text))
      notes.push_back(fmt::format("'{}' is taken as {}", text, writer.text(span->first)));
    noted = text;
  }
}

/// A part of the time asked about that was forgotten. Where all of it was, the reply says so; the note is the
/// time of what is answered instead.
void note_forgotten(const Snapshot& snapshot, const Query& query, std::vector<std::string>& notes) {
  const Store& store = snapshot.store();
  const AsOf as_of = read_as_of(store, query.argument("at"), query.argument("known-at"), snapshot.as_of());
  const std::optional<ForgottenTime> forgotten = forgotten_time(store, query, as_of);
  if (!forgotten) return;
  const TimeWriter times(store);
  if (!forgotten->all) notes.push_back(forgotten_text(forgotten->period, times));
  if (forgotten->all && forgotten->before)
    notes.push_back(fmt::format("what follows was known before, at {}", times.text(*forgotten->before)));
}

/// Without words before it that do not say which it is: "on the table" is a table.
std::string without_article(const std::string& name) {
  const size_t space = name.find(' ');
  const std::string first = name.substr(0, space);
  const bool says_nothing = first == "on" || first == "in" || with_article(name) == name;
  return space != std::string::npos && says_nothing ? without_article(name.substr(space + 1)) : name;
}

void note_place(const Snapshot& snapshot, const std::string& given, std::vector<std::string>& notes) {
  const std::string name = without_article(given);
  const bool several = name.find(" or ") != std::string::npos || name.find(" and ") != std::string::npos;
  if (several || !snapshot.places_called(name).empty() ||
      !snapshot.places_called(singular_of_furniture(lower_case(name))).empty())
    return;
  const std::vector<PlaceRow> places = snapshot.places_meant(name);
  if (!places.empty())
    notes.push_back(
        fmt::format("no place is called '{}'; {} is meant", name,
                    places.size() == 1 ? places[0].name : "any " + name.substr(name.rfind(' ') + 1)));
}

void note_object(const Snapshot& snapshot, const std::string& name, std::vector<std::string>& notes) {
  if (const std::optional<std::string> head = snapshot.head_of(name))
    notes.push_back(fmt::format("nothing is called '{}'; '{}' is meant", name, *head));
  for (const std::string& word : words_of(lower_case(name))) {
    const std::optional<Id> number = object_id(word);
    if (const auto other = number ? snapshot.object_instead_of(*number) : std::nullopt)
      notes.push_back(fmt::format("{} is {} now", word, object_name(*other)));
    if (const std::vector<std::string> names = snapshot.names_related_to(word); !names.empty())
      notes.push_back(fmt::format("'{}' is taken as {}", word, fmt::join(names, ", ")));
  }
}

}  // namespace

std::vector<std::string> notes_on(const Snapshot& snapshot, const Query& query) {
  using enum ParameterType;
  std::vector<std::string> notes;
  note_times(snapshot, query, notes);
  note_forgotten(snapshot, query, notes);
  const Question* const question = find_question(query.question);
  if (question == nullptr) return notes;  // `why` and the like, which no sentence means
  const std::vector<Parameter>& parameters = question->parameters;
  const auto each = [&](const auto& is_of_type, const auto& note) {
    for (const Parameter& parameter : parameters)
      if (const std::string name = query.argument(parameter.name);
          is_of_type(parameter.type) && !name.empty())
        note(name);
  };
  each([](ParameterType type) { return type == place; },
       [&](const std::string& name) { note_place(snapshot, name, notes); });
  each([](ParameterType type) { return type == part; },
       [&](const std::string& name) {
         if (const std::string kind = kind_meant(snapshot, name); !kind.empty())
           notes.push_back(fmt::format("no part is called '{}'; any {} is meant", name, kind));
       });
  each([](ParameterType type) { return type == object || type == spot; },
       [&](const std::string& name) { note_object(snapshot, name, notes); });
  return notes;
}

}  // namespace loci::memory
