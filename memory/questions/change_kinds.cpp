#include "memory/questions/change_kinds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "mapping/base/error.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

const std::set<std::string> kKinds = {
    "appeared", "came", "gone", "hidden", "joint_changed", "left", "looks_different", "moved", "reappeared"};

bool is_at(const std::set<Id>& places, const std::optional<PlaceRef>& place) {
  return place && places.contains(place->id);
}

bool is_of_kind(const Change& change, const std::string& kind, const std::set<Id>& places) {
  const bool moved = change.kind == "moved";
  if (kind == "left")
    return change.kind == "gone" ||
           (moved && is_at(places, change.from_place) && !is_at(places, change.place));
  if (kind == "came")
    return change.kind == "appeared" || change.kind == "reappeared" ||
           (moved && is_at(places, change.place) && !is_at(places, change.from_place));
  return change.kind == kind;
}

}  // namespace

ChangesAnswer ask_for_kind(const Store& store, const ChangesQuestion& question, const std::string& kind) {
  if (!kind.empty() && !kKinds.contains(kind))
    throw Error(fmt::format("'{}' is no kind of change", kind), {},
                fmt::format("kinds: {}", fmt::join(kKinds, ", ")));
  ChangesAnswer answer = ask(store, question);
  if (kind.empty()) return answer;
  std::set<Id> places;
  if (!question.place.empty())
    for (const PlaceRow& place : Snapshot(store, question.as_of).find_places(question.place))
      places.insert(place.id);
  std::erase_if(answer.changes, [&](const Change& change) { return !is_of_kind(change, kind, places); });
  return answer;
}

}  // namespace loci::memory
