#include "memory/questions/word_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>

namespace loci::memory {
namespace words {

std::string plural(size_t count, const char* word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string size_text(const Vector3d& size) {
  return fmt::format("{:.0f} x {:.0f} x {:.0f} cm", 100 * size.x(), 100 * size.y(), 100 * size.z());
}

std::string place_text(const PlaceRef& place) {
  return (place.container ? "in " : "on ") + place.name;
}

std::string point_text(const Vector3d& p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", p.x(), p.y(), p.z());
}

std::string spot_text(const std::optional<PlaceRef>& place, const std::optional<Vector3d>& position) {
  if (place && position) return place_text(*place) + " at " + point_text(*position);
  if (place) return place_text(*place);
  return position ? "at " + point_text(*position) : "at an unknown place";
}

std::string scene_text(const SceneRef& scene) {
  return scene.frame ? fmt::format("scene {}, frame {}", scene.scene, *scene.frame)
                     : fmt::format("scene {}", scene.scene);
}

/// "scenes 3, 4, 7 (frames 10, 11, 40)"; long lists are cut in the middle.
std::string scenes_text(const std::vector<SceneRef>& scenes) {
  std::vector<std::string> ids, frames;
  for (const SceneRef& scene : scenes) {
    ids.push_back(std::to_string(scene.scene));
    if (scene.frame) frames.push_back(std::to_string(*scene.frame));
  }
  const auto list = [](const std::vector<std::string>& all) {
    if (all.size() <= 8) return fmt::format("{}", fmt::join(all, ", "));
    return fmt::format("{}, ..., {}", fmt::join(all.begin(), all.begin() + 5, ", "),
                       fmt::join(all.end() - 2, all.end(), ", "));
  };
  std::string text = fmt::format("scene{} {}", ids.size() == 1 ? "" : "s", list(ids));
  if (frames.size() == ids.size())
    text += fmt::format(" (frame{} {})", frames.size() == 1 ? "" : "s", list(frames));
  return text;
}

std::string percent(double probability) {
  if (probability > 0.995 && probability < 1) return "more than 99 %";
  return fmt::format("{:.0f} %", 100 * probability);
}

namespace {

/// Why the memory believes that it is still (or no longer) there.
std::string evidence_text(const ObjectState& state, const TimeWriter& times) {
  std::vector<std::string> parts;
  if (state.looked_for)
    parts.push_back(fmt::format("looked for at {} and not seen", times.text(state.looked_for->time)));
  if (state.looks_hidden > 0)
    parts.push_back("hidden behind something in " + plural(state.looks_hidden, "scene"));
  if (state.looks_out_of_view > 0)
    parts.push_back("out of view in " + plural(state.looks_out_of_view, "scene"));
  if (parts.empty()) return {};
  return fmt::format("{}{}", state.status == "seen" ? "" : "since then ", fmt::join(parts, ", "));
}

}  // namespace

std::string state_text(const ObjectState& state, const TimeWriter& times) {
  const std::string name = object_text(state.object);
  const std::string spot = spot_text(state.place, state.position);
  const std::string seen = state.last_seen
                               ? fmt::format("last seen at {} ({})", times.text(state.last_seen->time),
                                             scene_text(*state.last_seen))
                               : "never seen since";
  const std::string why = evidence_text(state, times);
  if (state.status == "gone")
    return fmt::format(
        "{} has gone. It was {}, {}{}{}.", name, spot, seen, why.empty() ? "" : "; " + why,
        seen_once(state) ? "; it was seen in one look only and may never have been a thing of its own" : "");
  const std::string sure =
      state.probability < 0.995 ? fmt::format(" ({} sure)", percent(state.probability)) : "";
  const char* verb = state.probability >= 0.5 ? "is" : "was, and perhaps still is,";
  return fmt::format("{} {} {}{}, {}{}.", name, verb, spot, sure, seen, why.empty() ? "" : "; " + why);
}

std::string lines_text(const std::vector<std::string>& lines) {
  return lines.empty() ? "" : fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string status_text(const std::string& status) {
  return status == "out_of_view" ? "out of view" : status;
}

bool seen_once(const ObjectState& state) {
  return state.status == "gone" && state.sightings == 1;
}

std::string table_text(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths(rows[0].size(), 0);
  for (const auto& row : rows)
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (const auto& row : rows) {
    for (size_t i = 0; i + 1 < row.size(); ++i) text += fmt::format("{:<{}}  ", row[i], widths[i]);
    text += row.back() + "\n";
  }
  return text;
}

}  // namespace words

using namespace words;

namespace {

std::string joint_text(double position) {
  return fmt::format("{:.2f}", position);
}

/// "1 h 5 min"; empty below a minute.
std::string duration_text(TimeNs duration) {
  const int64_t minutes = duration / (60 * kSecond);
  if (minutes < 1) return {};
  if (minutes < 60) return fmt::format("{} min", minutes);
  if (minutes < 24 * 60) return fmt::format("{} h {} min", minutes / 60, minutes % 60);
  return fmt::format("{} d {} h", minutes / (24 * 60), minutes / 60 % 24);
}

std::string stay_text(const Stay& stay, const TimeWriter& times) {
  const TimeNs first = stay.scenes.front().time, last = stay.scenes.back().time;
  const std::string lasted = duration_text(last - first);
  return fmt::format("{}, {}, {}{}", times.span_text(first, last),
                     words::spot_text(stay.place, stay.position), words::scenes_text(stay.scenes),
                     lasted.empty() ? "" : ", for " + lasted + " at least");
}

std::string when_text(const Change& change, const TimeWriter& times) {
  if (!change.since || times.text(*change.since) == times.text(change.time)) return times.text(change.time);
  return fmt::format("{} (after {})", times.text(change.time), times.text(*change.since));
}

std::string change_line(const Change& change, const TimeWriter& times) {
  std::string line = fmt::format("{}  {}", when_text(change, times), change_text(change));
  if (change.probability < 0.995) line += fmt::format(" ({} sure)", words::percent(change.probability));
  if (change.scene) line += fmt::format(" [{}]", words::scene_text(*change.scene));
  if (change.source != "perceive" && !change.source.empty()) line += " - says " + change.source;
  return line;
}

std::string summary_text(const SceneSummary& summary, const TimeWriter& times) {
  std::string line = fmt::format("{}  {}", times.text(summary.scene.time), words::scene_text(summary.scene));
  if (summary.scene.recording) line += " of " + *summary.scene.recording;
  line += ": " + words::plural(summary.observations, "thing") + " seen";
  std::vector<std::string> places;
  for (const auto& [place, fraction] : summary.looked_at)
    places.push_back(fmt::format("{} {:.0f} %", place, 100 * fraction));
  if (!places.empty()) line += fmt::format("; looked at {}", fmt::join(places, ", "));
  if (!summary.has_pose) line += "; camera pose unknown";
  return line;
}

}  // namespace

std::string object_text(const ObjectRef& object) {
  std::vector<std::string> notes;
  if (object.color) notes.push_back(*object.color);
  if (object.size) notes.push_back(words::size_text(*object.size));
  for (const std::string& alias : object.aliases) notes.push_back("called " + alias);
  return notes.empty() ? object.name : fmt::format("{} ({})", object.name, fmt::join(notes, ", "));
}

std::string change_text(const Change& change) {
  const std::string who = change.object ? object_text(*change.object) : "";
  const auto on = [](const std::optional<PlaceRef>& place) {
    return place ? " " + words::place_text(*place) : std::string();
  };
  if (change.kind == "appeared") return fmt::format("{} appeared{}", who, on(change.place));
  if (change.kind == "gone")
    return fmt::format("{} has gone{}", who,
                       change.from_place ? " from " + change.from_place->name
                       : change.place    ? " from " + change.place->name
                                         : "");
  if (change.kind == "hidden")
    return fmt::format("{} is hidden behind something{}", who,
                       on(change.place ? change.place : change.from_place));
  if (change.kind == "reappeared") return fmt::format("{} is seen again{}", who, on(change.place));
  if (change.kind == "looks_different") return fmt::format("{} looks different{}", who, on(change.place));
  if (change.kind == "joint_changed") {
    const std::string name = change.joint.value_or(change.place ? change.place->name : "a joint");
    if (change.from_joint_position && change.joint_position)
      return fmt::format("{} {} from {} to {}", name,
                         *change.joint_position > *change.from_joint_position ? "opened" : "closed",
                         joint_text(*change.from_joint_position), joint_text(*change.joint_position));
    return fmt::format("{} moved{}", name,
                       change.joint_position ? " to " + joint_text(*change.joint_position) : "");
  }
  std::string text = who + " moved";
  const bool same = change.place && change.from_place && change.place->id == change.from_place->id;
  if (same)
    text += " " + words::place_text(*change.place);
  else if (change.from_place || change.place)
    text += (change.from_place ? " from " + change.from_place->name : std::string()) +
            (change.place ? " to " + change.place->name : std::string());
  if (change.position && change.from_position) {
    const double distance = (*change.position - *change.from_position).norm();
    text += distance < 0.995 ? fmt::format(" by {:.0f} cm", 100 * distance)
                             : fmt::format(" by {:.1f} m", distance);
  }
  return text;
}

std::string to_text(const WhereAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  if (answer.objects.size() > 1)
    lines.push_back(fmt::format("'{}' is {} objects:", answer.asked, answer.objects.size()));
  for (const ObjectState& state : answer.objects) {
    lines.push_back(words::state_text(state, times));
    for (const Alternative& other : state.alternatives)
      lines.push_back(fmt::format("  or else {} ({}): what was seen there in scene {} is taken for {}",
                                  words::spot_text(other.place, other.position),
                                  words::percent(other.probability), other.scene.scene,
                                  other.taken_for ? object_text(*other.taken_for) : "a false cluster"));
  }
  return words::lines_text(lines);
}

std::string to_text(const HistoryAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const ObjectHistory& history : answer.objects) {
    if (!lines.empty()) lines.emplace_back();
    lines.push_back(fmt::format("{}, seen in {}:", object_text(history.now.object),
                                words::plural(history.now.sightings, "scene")));
    // Stays and what happened, in one order of time.
    std::vector<std::pair<TimeNs, std::string>> entries;
    for (const Stay& stay : history.stays)
      entries.emplace_back(stay.scenes.front().time, stay_text(stay, times));
    for (const Change& change : history.changes) {
      Change brief = change;
      if (brief.object) brief.object = ObjectRef{.id = brief.object->id, .name = "it"};
      entries.emplace_back(change.time,
                           fmt::format("at {} {}", when_text(change, times), change_text(brief)));
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [time, text] : entries) lines.push_back("  " + text);
    lines.push_back("  now: " + words::state_text(history.now, times));
  }
  return words::lines_text(lines);
}

std::string to_text(const ContentsAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const PlaceContents& contents : answer.places) {
    const std::string where = words::place_text(contents.place);
    const std::string look =
        contents.last_look
            ? fmt::format("last looked at {} ({}{})", times.text(contents.last_look->time),
                          words::scene_text(*contents.last_look),
                          contents.fraction ? fmt::format(", {:.0f} % of it", 100 * *contents.fraction) : "")
            : "never looked at";
    if (contents.there.empty() && !answer.subject.empty())
      lines.push_back(fmt::format("No '{}' is known to be {} ({}).", answer.subject, where, look));
    else if (contents.there.empty())
      lines.push_back(fmt::format("Nothing is known to be {} ({}).", where, look));
    else
      lines.push_back(fmt::format("{} {} {} ({}):", words::plural(contents.there.size(), "object"),
                                  contents.there.size() == 1 ? "is" : "are", where, look));
    for (const ObjectState& state : contents.there) lines.push_back("  " + words::state_text(state, times));
    for (const ObjectState& state : contents.gone)
      lines.push_back("  no longer: " + words::state_text(state, times));
    if (contents.gone_in_all > contents.gone.size())
      lines.push_back(fmt::format("  no longer: {} more", contents.gone_in_all - contents.gone.size()));
  }
  return words::lines_text(lines);
}

std::string to_text(const WasAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  const std::string where =
      answer.place.empty() ? "seen anywhere" : (answer.container ? "in " : "on ") + answer.place;
  const std::string first = times.text(answer.from), last = times.text(answer.to);
  const std::string span = first == last ? "at " + first : fmt::format("between {} and {}", first, last);
  if (answer.objects.size() > 1) {
    const char* head = answer.verdict == Verdict::yes  ? "Yes, one of them was."
                       : answer.verdict == Verdict::no ? "No, none of them was."
                                                       : "Not observed.";
    lines.emplace_back(head);
  }
  for (const WasObject& object : answer.objects) {
    const std::string name = object_text(object.object);
    std::string line;
    if (object.verdict == Verdict::yes)
      line = fmt::format("Yes: {} was {} {}, seen in {}.", name, where, span,
                         words::scenes_text(object.seen_there));
    else if (object.verdict == Verdict::no)
      line = fmt::format("No: {} was not {} {}: {}.", name, where, span, object.reason);
    else
      line = fmt::format("Not observed: whether {} was {} {} is not known: {}.", name, where, span,
                         object.reason);
    lines.push_back(line);
    if (!object.seen_elsewhere.empty()) {
      std::vector<std::string> places;
      for (const auto& [scene, place] : object.seen_elsewhere)
        places.push_back(fmt::format("{} at {} ({})", place.empty() ? "off any place" : place,
                                     times.text(scene.time), words::scene_text(scene)));
      if (places.size() > 4) places.resize(4);
      lines.push_back(fmt::format("  seen elsewhere: {}", fmt::join(places, "; ")));
    }
    if (object.verdict != Verdict::yes && !object.looks.empty()) {
      std::vector<SceneRef> scenes;
      for (const PlaceLook& look : object.looks) scenes.push_back(look.scene);
      lines.push_back("  looked in " + words::scenes_text(scenes));
    }
    if (object.verdict != Verdict::yes && object.before)
      lines.push_back(fmt::format("  before that it was there at {} ({})", times.text(object.before->time),
                                  words::scene_text(*object.before)));
    if (object.verdict != Verdict::yes && object.after)
      lines.push_back(fmt::format("  after that it was there at {} ({})", times.text(object.after->time),
                                  words::scene_text(*object.after)));
  }
  return words::lines_text(lines);
}

std::string to_text(const ChangesAnswer& answer, const TimeWriter& times) {
  if (answer.changes.empty()) return "Nothing is known to have happened.\n";
  std::vector<std::string> lines;
  for (const Change& change : answer.changes) lines.push_back(change_line(change, times));
  return words::lines_text(lines);
}

std::string to_text(const ObjectsAnswer& answer, const TimeWriter& times) {
  if (answer.objects.empty()) return "No objects are known.\n";
  std::vector<std::vector<std::string>> rows = {
      {"object", "colour", "size", "place", "status", "seen", "last seen"}};
  for (const ObjectState& state : answer.objects) {
    const auto& aliases = state.object.aliases;
    rows.push_back(
        {state.object.name + (aliases.empty() ? "" : fmt::format(" ({})", fmt::join(aliases, ", "))),
         state.object.color.value_or("-"), state.object.size ? words::size_text(*state.object.size) : "-",
         state.place ? words::place_text(*state.place) : "-", words::status_text(state.status),
         std::to_string(state.sightings), state.last_seen ? times.text(state.last_seen->time) : "-"});
  }
  const auto once = std::ranges::count_if(answer.objects, words::seen_once);
  if (once == 0) return words::table_text(rows);
  return words::table_text(rows) +
         fmt::format(
             "{} of {} were seen in one look only and gone when somebody looked again: "
             "perhaps false detections, or others that looked different\n",
             once, answer.objects.size());
}

std::string to_text(const ScenesAnswer& answer, const TimeWriter& times) {
  if (answer.scenes.empty()) return "No scenes are known.\n";
  std::vector<std::string> lines;
  for (const SceneSummary& summary : answer.scenes) lines.push_back(summary_text(summary, times));
  return words::lines_text(lines);
}

std::string to_text(const TimelineAnswer& answer, const TimeWriter& times) {
  if (answer.entries.empty()) return "Nothing is known.\n";
  std::vector<std::string> lines;
  for (const TimelineEntry& entry : answer.entries) {
    lines.push_back(summary_text(entry.scene, times));
    for (const Change& change : entry.changes) {
      std::string line = "    " + change_text(change);
      if (change.probability < 0.995) line += fmt::format(" ({} sure)", words::percent(change.probability));
      lines.push_back(line);
    }
  }
  return words::lines_text(lines);
}

}  // namespace loci::memory
