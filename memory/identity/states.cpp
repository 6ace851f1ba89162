#include "memory/identity/states.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

// In the order of the enumerators.
constexpr std::array kExplanations = {"stay",    "move",      "newview", "appear",
                                      "clutter", "disappear", "missed",  "hidden"};
constexpr std::array kEventKinds = {"appeared", "moved",      "looks_different", "gone",
                                    "hidden",   "reappeared", "joint_changed",   "place_moved"};
constexpr std::array kObjectStatuses = {"seen", "missed", "hidden", "out_of_view", "gone"};

template <class State, size_t N>
State parse(std::string_view text, const std::array<const char*, N>& names, const char* what) {
  const auto found = std::ranges::find(names, text, [](const char* name) { return std::string_view(name); });
  if (found == names.end())
    throw Error(fmt::format("'{}' is not {}", text, what), {},
                fmt::format("one of {}", fmt::join(names, ", ")));
  return static_cast<State>(found - names.begin());
}

}  // namespace

const char* to_text(Explanation explanation) {
  return kExplanations.at(static_cast<size_t>(explanation));
}
const char* to_text(EventKind kind) {
  return kEventKinds.at(static_cast<size_t>(kind));
}
const char* to_text(ObjectStatus status) {
  return kObjectStatuses.at(static_cast<size_t>(status));
}

template <>
Explanation parse_state(std::string_view text) {
  return parse<Explanation>(text, kExplanations, "an explanation");
}
template <>
EventKind parse_state(std::string_view text) {
  return parse<EventKind>(text, kEventKinds, "a kind of event");
}
template <>
ObjectStatus parse_state(std::string_view text) {
  return parse<ObjectStatus>(text, kObjectStatuses, "a status of an object");
}

void to_json(Json& json, Explanation explanation) {
  json = to_text(explanation);
}
void to_json(Json& json, EventKind kind) {
  json = to_text(kind);
}
void to_json(Json& json, ObjectStatus status) {
  json = to_text(status);
}

}  // namespace loci::memory
