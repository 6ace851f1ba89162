#include "memory/questions/replies/answer_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "memory/questions/names/names.h"

namespace loci::memory {
namespace format {

std::string percent(double probability) {
  if (probability > 0.995 && probability < 1) return "more than 99 %";
  return fmt::format("{:.0f} %", 100 * probability);
}

std::string size_text(const Vector3d& size) {
  return fmt::format("{:.0f} x {:.0f} x {:.0f} cm", 100 * size.x(), 100 * size.y(), 100 * size.z());
}

std::string point_text(const Vector3d& p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", p.x(), p.y(), p.z());
}

std::string place_text(const PlaceRef& place) {
  return (place.container ? "in " : "on ") + place.name;
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

std::string status_text(ObjectStatus status) {
  return status == ObjectStatus::out_of_view ? "out of view" : to_text(status);
}

std::string when_text(const Change& change, const TimeWriter& times) {
  if (!change.since || times.text(*change.since) == times.text(change.time)) return times.text(change.time);
  return fmt::format("{} (after {})", times.text(change.time), times.text(*change.since));
}

std::string looked_for_text(const std::vector<TimeNs>& looks, const std::string& where,
                            const TimeWriter& times) {
  const std::string first = times.text(looks.front()), last = times.text(looks.back());
  return fmt::format("looked for {}{}{} and not seen", where, where.empty() ? "" : " ",
                     first == last ? "at " + first : fmt::format("from {} to {}", first, last));
}

std::string joint_in_words(const Change& change) {
  if (change.joint_is_named) return *change.joint;
  if (change.place) return part_in_words(change.place->name);
  return change.joint ? part_in_words(piece_in_words(*change.joint)) : "a joint";
}

namespace {

std::string evidence_text(const ObjectBelief& belief, const TimeWriter& times) {
  std::vector<std::string> parts;
  if (belief.last_missed) parts.push_back(looked_for_text({belief.last_missed->time}, "", times));
  if (belief.scenes_hidden > 0)
    parts.push_back("hidden behind something in " + counted(belief.scenes_hidden, "scene"));
  if (belief.scenes_out_of_view > 0)
    parts.push_back("out of view in " + counted(belief.scenes_out_of_view, "scene"));
  if (parts.empty()) return {};
  return fmt::format("; {}{}", belief.status == ObjectStatus::seen ? "" : "since then ",
                     fmt::join(parts, ", "));
}

}  // namespace

std::string belief_text(const ObjectBelief& belief, const TimeWriter& times) {
  const std::string name = to_text(belief.object);
  const std::string spot = spot_text(belief.place, belief.position);
  const std::string seen = belief.last_seen
                               ? fmt::format("last seen at {} ({})", times.text(belief.last_seen->time),
                                             scene_text(*belief.last_seen))
                               : "never seen since";
  const std::string evidence = evidence_text(belief, times);
  if (belief.status == ObjectStatus::gone)
    return fmt::format(
        "{} has gone. It was {}, {}{}{}.", name, spot, seen, evidence,
        seen_once(belief) ? "; it was seen in one scene only and may be a false detection" : "");
  const std::string sure =
      belief.probability < 0.995 ? fmt::format(" ({} sure)", percent(belief.probability)) : "";
  const char* verb = belief.probability >= 0.5 ? "is" : "was, and perhaps still is,";
  return fmt::format("{} {} {}{}, {}{}.", name, verb, spot, sure, seen, evidence);
}

bool seen_once(const ObjectBelief& belief) {
  return belief.status == ObjectStatus::gone && belief.sightings == 1;
}

std::string lines_text(const std::vector<std::string>& lines) {
  return lines.empty() ? "" : fmt::format("{}\n", fmt::join(lines, "\n"));
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

}  // namespace format

using namespace format;

namespace {

std::string joint_text(const Change& change) {
  const std::string name = joint_in_words(change);
  if (change.from_joint_position && change.joint_position)
    return fmt::format("{} {} from {:.2f} to {:.2f}", name,
                       *change.joint_position > *change.from_joint_position ? "opened" : "closed",
                       *change.from_joint_position, *change.joint_position);
  return fmt::format("{} moved{}", name,
                     change.joint_position ? fmt::format(" to {:.2f}", *change.joint_position) : "");
}

/// " by 1.2 m"; empty where a position is unknown.
std::string distance_text(const Change& change) {
  if (!change.position || !change.from_position) return "";
  const double distance = (*change.position - *change.from_position).norm();
  return distance < 0.995 ? fmt::format(" by {:.0f} cm", 100 * distance)
                          : fmt::format(" by {:.1f} m", distance);
}

/// " from table_1 to counter_1 by 1.2 m".
std::string move_text(const Change& change) {
  std::string text;
  const bool same = change.place && change.from_place && change.place->id == change.from_place->id;
  if (same) {
    text += fmt::format(" {}", place_text(*change.place));
  } else {
    if (change.from_place) text += " from " + change.from_place->name;
    if (change.place) text += " to " + change.place->name;
  }
  return text + distance_text(change);
}

}  // namespace

bool is_opening(const Change& change) {
  return std::abs(change.joint_position.value_or(0)) > std::abs(change.from_joint_position.value_or(0));
}

std::string to_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::yes:
      return "yes";
    case Verdict::no:
      return "no";
    case Verdict::not_observed:
      return "not_observed";
  }
  return {};
}

std::string to_text(const ObjectRef& object) {
  std::vector<std::string> notes;
  if (object.color) notes.push_back(*object.color);
  if (object.size) notes.push_back(size_text(*object.size));
  for (const std::string& alias : object.aliases)
    if (alias != object.label) notes.push_back("called " + alias);
  if (object.label) notes.insert(notes.begin(), object.name);
  const std::string& name = object.label ? *object.label : object.name;
  return notes.empty() ? name : fmt::format("{} ({})", name, fmt::join(notes, ", "));
}

std::string to_text(const Change& change) {
  const std::string object = change.object ? to_text(*change.object) : "";
  const auto on = [](const std::optional<PlaceRef>& place) {
    return place ? fmt::format(" {}", place_text(*place)) : "";
  };
  switch (change.kind) {
    case EventKind::appeared:
      return fmt::format("{} appeared{}", object, on(change.place));
    case EventKind::moved:
      return fmt::format("{} moved{}", object, move_text(change));
    case EventKind::looks_different:
      return fmt::format("{} looks different{}", object, on(change.place));
    case EventKind::gone: {
      const auto& from = change.from_place ? change.from_place : change.place;
      return fmt::format("{} has gone{}", object, from ? " from " + from->name : "");
    }
    case EventKind::hidden:
      return fmt::format("{} is hidden behind something{}", object,
                         on(change.place ? change.place : change.from_place));
    case EventKind::reappeared:
      return fmt::format("{} is seen again{}", object, on(change.place));
    case EventKind::joint_changed:
      return joint_text(change);
    case EventKind::place_moved:
      return fmt::format("{} was moved{}", change.place ? change.place->name : "furniture",
                         distance_text(change));
  }
  return {};
}

}  // namespace loci::memory
