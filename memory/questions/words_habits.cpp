#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "mapping/base/json.h"
#include "memory/questions/word_parts.h"

namespace loci::memory {

using namespace words;

namespace {

constexpr std::array<const char*, 7> kDays = {"Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"};

/// "most at 7:00 (3), 12:00 (2)".
std::string hours_text(const std::map<int, size_t>& by_hour) {
  std::vector<std::pair<int, size_t>> hours(by_hour.begin(), by_hour.end());
  std::stable_sort(hours.begin(), hours.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  if (hours.size() > 3) hours.resize(3);
  std::vector<std::string> parts;
  for (const auto& [hour, count] : hours) parts.push_back(fmt::format("{}:00 ({})", hour, count));
  return fmt::format("most in the hours from {}", fmt::join(parts, ", "));
}

std::string during_text(const std::string& during) {
  return during.empty() ? "" : fmt::format(" ({})", during);
}

std::string days_text(const std::map<int, size_t>& by_weekday) {
  std::vector<std::string> parts;
  for (const auto& [day, count] : by_weekday)
    parts.push_back(fmt::format("{} {}", kDays.at(static_cast<size_t>(day)), count));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::string to_text(const UsualAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const UsualObject& object : answer.objects) {
    const std::string name = object_text(object.now.object);
    if (object.places.empty()) {
      lines.push_back(fmt::format("{} was never seen at a place{}.", name, during_text(answer.during)));
      continue;
    }
    size_t all = 0;
    for (const UsualPlace& place : object.places) all += place.sightings;
    const UsualPlace& first = object.places[0];
    lines.push_back(fmt::format("{} is usually {}{}: seen there in {} of {} scenes ({:.0f} %), {}; {}.", name,
                                words::place_text(first.place), during_text(answer.during), first.sightings,
                                all, 100 * first.share, hours_text(first.by_hour),
                                days_text(first.by_weekday)));
    for (size_t i = 1; i < object.places.size(); ++i)
      lines.push_back(fmt::format("  also {} in {} ({:.0f} %), last at {}",
                                  words::place_text(object.places[i].place),
                                  words::plural(object.places[i].sightings, "scene"),
                                  100 * object.places[i].share, times.text(object.places[i].last.time)));
  }
  return words::lines_text(lines);
}

std::string to_text(const KeptAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const KeptPlace& kept : answer.places) {
    const std::string where = words::place_text(kept.place);
    if (kept.objects.empty()) {
      lines.push_back(kept.looks == 0
                          ? fmt::format("What is kept {} is not known: nobody has looked there.", where)
                          : fmt::format("Nothing was seen {} in the {} that looked there.", where,
                                        words::plural(kept.looks, "scene")));
      continue;
    }
    lines.push_back(
        fmt::format("{} {} seen {} ({} looked there):", words::plural(kept.objects.size(), "object"),
                    kept.objects.size() == 1 ? "was" : "were", where, words::plural(kept.looks, "scene")));
    for (const KeptObject& object : kept.objects) {
      const std::string first = times.text(object.first.time), last = times.text(object.last.time);
      lines.push_back(fmt::format("  {}: in {} {}, {:.0f} % of all that saw it at a place; {}.",
                                  object_text(object.now.object), words::plural(object.sightings, "scene"),
                                  first == last ? "at " + first : fmt::format("from {} to {}", first, last),
                                  100 * object.share,
                                  object.still_there ? "still there" : "no longer there"));
    }
  }
  return words::lines_text(lines);
}

std::string to_text(const TaskAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const TaskItem& item : answer.items) {
    std::string line = words::state_text(item.object, times);
    if (!item.needed_as.empty()) line = item.needed_as + ": " + line;
    if (item.target && item.done)
      line += fmt::format(" It is where it is to be ({}).", item.target->reason);
    else if (item.target)
      line += fmt::format(" To go {} ({}).", words::place_text(item.target->place), item.target->reason);
    lines.push_back(line);
  }
  if (answer.items.empty()) lines.emplace_back("No object is concerned.");
  for (const std::string& missing : answer.missing) lines.push_back("Missing: " + missing + ".");
  for (const std::string& note : answer.notes) lines.push_back("Note: " + note + ".");
  return words::lines_text(lines);
}

std::string to_text(const AnyAnswer& answer, const TimeWriter& times) {
  return std::visit([&](const auto& one) { return to_text(one, times); }, answer);
}

std::string to_text(const SpokenAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  if (answer.command) lines.push_back("= loci-memory " + answer.command->text());
  for (const std::string& note : answer.notes) lines.push_back("(" + note + ")");
  if (answer.why_not) lines.push_back(answer.why_not->text);
  if (!answer.nearest.empty()) lines.emplace_back("What is understood, for example:");
  for (const std::string& sentence : answer.nearest) lines.push_back("  " + sentence);
  return words::lines_text(lines) + (answer.answer ? to_text(*answer.answer, times) : "");
}

Json to_json(const UsualAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  if (!answer.during.empty()) json["during"] = answer.during;
  for (const UsualObject& object : answer.objects) {
    Json entry = words::state_json(object.now);
    entry["places"] = Json::array();
    for (const UsualPlace& place : object.places) {
      Json one = {{"place", place.place.name}, {"sightings", place.sightings},
                  {"share", place.share},      {"last", words::scene_json(place.last)},
                  {"by_hour", Json::object()}, {"by_weekday", Json::object()}};
      for (const auto& [hour, count] : place.by_hour) one["by_hour"][std::to_string(hour)] = count;
      for (const auto& [day, count] : place.by_weekday)
        one["by_weekday"][kDays.at(static_cast<size_t>(day))] = count;
      entry["places"].push_back(one);
    }
    json["objects"].push_back(entry);
  }
  return json;
}

Json to_json(const KeptAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"places", Json::array()}};
  for (const KeptPlace& kept : answer.places) {
    Json entry = {{"place", kept.place.name}, {"looks", kept.looks}, {"objects", Json::array()}};
    if (kept.last_look) entry["last_look"] = words::scene_json(*kept.last_look);
    for (const KeptObject& object : kept.objects) {
      Json one = words::state_json(object.now);
      one["sightings_there"] = object.sightings;
      one["share"] = object.share;
      one["first_there"] = words::scene_json(object.first);
      one["last_there"] = words::scene_json(object.last);
      one["still_there"] = object.still_there;
      entry["objects"].push_back(one);
    }
    json["places"].push_back(entry);
  }
  return json;
}

Json to_json(const TaskAnswer& answer) {
  Json json = {{"task", task_name(answer.kind)}, {"asked", answer.asked}, {"objects", Json::array()}};
  for (const TaskItem& item : answer.items) {
    Json entry = words::state_json(item.object);
    if (item.target)
      entry["target"] = {{"place", item.target->place.name},
                         {"probability", item.target->probability},
                         {"reason", item.target->reason}};
    entry["done"] = item.done;
    if (!item.needed_as.empty()) entry["needed_as"] = item.needed_as;
    json["objects"].push_back(entry);
  }
  json["missing"] = answer.missing;
  json["notes"] = answer.notes;
  return json;
}

Json to_json(const AnyAnswer& answer) {
  return std::visit([](const auto& one) { return to_json(one); }, answer);
}

Json to_json(const SpokenAnswer& answer) {
  Json json = {{"sentence", answer.sentence}, {"understood", answer.command.has_value()}};
  if (answer.command) json["command"] = answer.command->text();
  if (!answer.notes.empty()) json["notes"] = answer.notes;
  if (answer.answer) json["answer"] = to_json(*answer.answer);
  if (answer.why_not) json["why_not"] = {{"reason", answer.why_not->reason}, {"text", answer.why_not->text}};
  if (!answer.nearest.empty()) json["nearest"] = answer.nearest;
  return json;
}

}  // namespace loci::memory
