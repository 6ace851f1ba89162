// The answer of `was` as text and JSON.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "memory/questions/presence.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"

namespace loci::memory {

using namespace format;

namespace {

std::string verdict_text(const WasObject& object, const std::string& where, const std::string& period,
                         const TimeWriter& times) {
  const std::string name = to_text(object.object);
  if (object.unseen)
    return fmt::format("{}: {} was {} {} ({}), seen there at {}{}.",
                       object.verdict == Verdict::yes ? "Yes" : "No", name,
                       spot_text(object.unseen->place, std::nullopt), period,
                       percent(object.unseen->probability), times.text(object.unseen->before),
                       object.unseen->after ? " and " + times.text(*object.unseen->after) : "");
  if (object.verdict == Verdict::yes)
    return fmt::format("Yes: {} was {} {}, seen in {}.", name, where, period, scenes_text(object.seen_there));
  if (object.verdict == Verdict::no)
    return fmt::format("No: {} was not {} {}: {}.", name, where, period, object.reason);
  return fmt::format("Not observed: nobody saw whether {} was {} {}: {}.", name, where, period,
                     object.reason);
}

void add_evidence(const WasObject& object, const TimeWriter& times, std::vector<std::string>& lines) {
  const auto seen_at = [&](const SceneRef& scene) {
    return fmt::format("{} ({})", times.text(scene.time), scene_text(scene));
  };
  if (!object.seen_elsewhere.empty()) {
    std::vector<std::string> places;
    for (const auto& [scene, place] : object.seen_elsewhere)
      places.push_back(fmt::format("{} at {}", place.empty() ? "off any place" : place, seen_at(scene)));
    if (places.size() > 4) places.resize(4);
    lines.push_back(fmt::format("  seen elsewhere: {}", fmt::join(places, "; ")));
  }
  if (object.verdict == Verdict::yes) return;
  if (!object.views.empty()) {
    std::vector<SceneRef> scenes;
    for (const PlaceView& view : object.views) scenes.push_back(view.scene);
    lines.push_back("  looked in " + scenes_text(scenes));
  }
  if (object.before) lines.push_back("  before that it was there at " + seen_at(*object.before));
  if (object.after) lines.push_back("  after that it was there at " + seen_at(*object.after));
}

using Elsewhere = std::pair<SceneRef, std::string>;
const Record<Elsewhere>& elsewhere_record() {
  static const auto record =
      Record<Elsewhere>("SceneElsewhere")
          .with(&Elsewhere::first, scene_record())
          .value("place", [](const Elsewhere& seen) { return unless_empty(seen.second); });
  return record;
}

const Record<PlaceView>& view_record() {
  static const auto record = Record<PlaceView>("PlaceView")
                                 .with(&PlaceView::scene, scene_record())
                                 .value("fraction", &PlaceView::fraction)
                                 .value("spot", &PlaceView::spot);
  return record;
}

const Record<WasObject>& was_object_record() {
  static const auto record =
      Record<WasObject>("WasObject")
          .with(&WasObject::object, object_record())
          .value("verdict", &WasObject::verdict)
          .value("reason", [](const WasObject& object) { return unless_empty(object.reason); })
          .record("seen_there", &WasObject::seen_there, scene_record())
          .record("seen_elsewhere", &WasObject::seen_elsewhere, elsewhere_record())
          .record("looks", &WasObject::views, view_record())
          .record("before", &WasObject::before, scene_record())
          .record("after", &WasObject::after, scene_record());
  return record;
}

}  // namespace

std::string to_text(const WasAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  const std::string where =
      answer.place.empty() ? "seen anywhere" : (answer.container ? "in " : "on ") + answer.place;
  // "09:00" without seconds means the end of that minute (TimeReader).
  const auto minute = [](TimeNs time) { return time % kMinute == kMinute - 1 ? time - kMinute + 1 : time; };
  const std::string first = times.text(minute(answer.from)), last = times.text(minute(answer.to));
  const std::string period = first == last ? "at " + first : fmt::format("between {} and {}", first, last);
  if (answer.objects.size() > 1)
    lines.emplace_back(answer.verdict == Verdict::yes  ? "Yes, one of them was."
                       : answer.verdict == Verdict::no ? "No, none of them was."
                                                       : "Nobody saw one of them there.");
  for (const WasObject& object : answer.objects) {
    lines.push_back(verdict_text(object, where, period, times));
    add_evidence(object, times, lines);
  }
  return lines_text(lines);
}

namespace format {

const Record<WasAnswer>& was_record() {
  static const auto record =
      Record<WasAnswer>("WasAnswer")
          .value("asked", &WasAnswer::asked)
          .value("place", [](const WasAnswer& answer) { return unless_empty(answer.place); })
          .time("from", &WasAnswer::from)
          .time("to", &WasAnswer::to)
          .value("verdict", &WasAnswer::verdict)
          .record("objects", &WasAnswer::objects, was_object_record());
  return record;
}

}  // namespace format

Json to_json(const WasAnswer& answer) {
  return was_record().json(answer);
}

}  // namespace loci::memory
