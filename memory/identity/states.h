#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include "mapping/base/text/json_fwd.h"

namespace loci::memory {

/// How data association explains an observation (stay to clutter) or an object that it did not match.
enum class Explanation { stay, move, newview, appear, clutter, disappear, missed, hidden };

/// What happened to an object, to a joint of the map, or to a place (the next map has it elsewhere).
enum class EventKind {
  appeared,
  moved,
  looks_different,
  gone,
  hidden,
  reappeared,
  joint_changed,
  place_moved
};

/// How a scene relates to a believed object: observed in it, looked for in vain, behind something, outside
/// the view, or believed to be gone. For a place, whether the scene observed it.
enum class ObjectStatus { seen, missed, hidden, out_of_view, gone };

/// The name in SQL and JSON: "looks_different".
const char* to_text(Explanation explanation);
const char* to_text(EventKind kind);
const char* to_text(ObjectStatus status);

/// The inverse of to_text(). Error with the names for any other text.
template <class State>
State parse_state(std::string_view text);
template <>
Explanation parse_state(std::string_view text);
template <>
EventKind parse_state(std::string_view text);
template <>
ObjectStatus parse_state(std::string_view text);

template <class T>
concept StateEnum =
    std::is_same_v<T, Explanation> || std::is_same_v<T, EventKind> || std::is_same_v<T, ObjectStatus>;

/// JSON has the name; without these it would have the number of the enumerator.
void to_json(Json& json, Explanation explanation);
void to_json(Json& json, EventKind kind);
void to_json(Json& json, ObjectStatus status);

}  // namespace loci::memory
