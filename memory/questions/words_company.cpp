#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mapping/base/json.h"
#include "memory/questions/word_parts.h"

namespace loci::memory {

using namespace words;

std::string to_text(const NearAnswer& answer, const TimeWriter& times) {
  const std::string around = answer.around.empty() ? words::point_text(answer.point) : answer.around;
  if (answer.objects.empty())
    return fmt::format("Nothing is believed to be within {:.2f} m of {}.\n", answer.radius_m, around);
  std::vector<std::string> lines = {fmt::format("Within {:.2f} m of {}:", answer.radius_m, around)};
  for (const NearObject& near : answer.objects)
    lines.push_back(fmt::format("  {:.2f} m: {}", near.distance_m, words::state_text(near.object, times)));
  return words::lines_text(lines);
}

std::string to_text(const TogetherAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const TogetherObject& object : answer.objects) {
    const std::string name = object_text(object.object);
    if (object.company.empty()) {
      lines.push_back(fmt::format("{} was never seen with anything else.", name));
      continue;
    }
    lines.push_back(
        fmt::format("{} was seen in {}, together with", name, words::plural(object.scenes, "scene")));
    for (const Company& company : object.company)
      lines.push_back(fmt::format(
          "  {}: in {} ({} at one place); {} of the scenes with either{}", object_text(company.object),
          words::plural(company.together, "scene"), company.same_place, words::percent(company.share),
          company.last ? fmt::format(", last at {}", times.text(company.last->time)) : ""));
  }
  return words::lines_text(lines);
}

std::string to_text(const MissingAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const MissingPlace& place : answer.places) {
    const std::string where = words::place_text(place.place);
    const std::string hours = answer.occasion.empty() ? "" : " at the hours of " + answer.occasion;
    if (place.visits == 0) {
      lines.push_back(
          fmt::format("What belongs {}{} is not known: no visit saw anything like this.", where, hours));
      continue;
    }
    const std::string visits = words::plural(place.visits, "visit") + hours;
    lines.push_back(place.missing.empty() ? fmt::format("Nothing is missing {}, by {}.", where, visits)
                                          : fmt::format("Missing {}, by {}:", where, visits));
    for (const ExpectedObject& missing : place.missing)
      lines.push_back(fmt::format("  there in {} of {}: {}", missing.visits, visits,
                                  words::state_text(missing.now, times)));
    for (const ExpectedObject& present : place.present)
      lines.push_back(fmt::format("  present: {}, there in {} of {}", object_text(present.now.object),
                                  present.visits, visits));
  }
  return words::lines_text(lines);
}

std::string to_text(const KindAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> names;
  for (const ObjectRef& object : answer.objects) names.push_back(object_text(object));
  std::vector<std::string> lines = {
      fmt::format("The scene at {}: {}{}.", times.text(answer.scene.time),
                  names.empty() ? "no object" : fmt::format("{}", fmt::join(names, ", ")),
                  answer.places.empty() ? "" : fmt::format(", at {}", fmt::join(answer.places, ", ")))};
  for (const auto& [name, probability] : answer.occasions)
    lines.push_back(fmt::format("  as at {}: {}", name, words::percent(probability)));
  for (const LikeScene& like : answer.like)
    lines.push_back(fmt::format("  like that at {} ({}): {} of the objects in common",
                                times.text(like.scene.time), words::scene_text(like.scene),
                                words::percent(like.likeness)));
  return words::lines_text(lines);
}

std::string to_text(const LikeAnswer& answer, const TimeWriter& times) {
  if (answer.objects.empty()) return fmt::format("Of no other object an image was kept.\n");
  std::vector<std::string> lines = {fmt::format("Most like {}:", answer.asked)};
  for (const LikeObject& like : answer.objects)
    lines.push_back(
        fmt::format("  {}: {}", words::percent(like.likeness), words::state_text(like.object, times)));
  return words::lines_text(lines);
}

Json to_json(const NearAnswer& answer) {
  Json json = {
      {"asked", answer.asked}, {"point", words::vector_json(answer.point)}, {"radius", answer.radius_m}};
  if (!answer.around.empty()) json["around"] = answer.around;
  if (answer.level) json["level"] = true;
  json["objects"] = Json::array();
  for (const NearObject& near : answer.objects) {
    Json one = words::state_json(near.object);
    one["distance"] = near.distance_m;
    json["objects"].push_back(one);
  }
  return json;
}

Json to_json(const TogetherAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  if (!answer.other.empty()) json["other"] = answer.other;
  for (const TogetherObject& object : answer.objects) {
    Json entry = words::object_json(object.object);
    entry["scenes"] = object.scenes;
    entry["together"] = Json::array();
    for (const Company& company : object.company) {
      Json one = words::object_json(company.object);
      one["scenes"] = company.scenes;
      one["together"] = company.together;
      one["same_place"] = company.same_place;
      one["share"] = company.share;
      if (company.last) one["last"] = words::scene_json(*company.last);
      entry["together"].push_back(one);
    }
    json["objects"].push_back(entry);
  }
  return json;
}

namespace {

Json expected_json(const std::vector<ExpectedObject>& objects) {
  Json json = Json::array();
  for (const ExpectedObject& expected : objects) {
    Json one = words::state_json(expected.now);
    one["visits_there"] = expected.visits;
    one["share"] = expected.share;
    json.push_back(one);
  }
  return json;
}

}  // namespace

Json to_json(const MissingAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"places", Json::array()}};
  if (!answer.occasion.empty()) json["occasion"] = answer.occasion;
  for (const MissingPlace& place : answer.places)
    json["places"].push_back({{"place", place.place.name},
                              {"visits", place.visits},
                              {"missing", expected_json(place.missing)},
                              {"present", expected_json(place.present)}});
  return json;
}

Json to_json(const KindAnswer& answer) {
  Json json = {{"scene", words::scene_json(answer.scene)}, {"places", answer.places}};
  json["objects"] = json["like"] = Json::array();
  json["occasions"] = Json::object();
  for (const ObjectRef& object : answer.objects) json["objects"].push_back(words::object_json(object));
  for (const auto& [name, probability] : answer.occasions) json["occasions"][name] = probability;
  for (const LikeScene& like : answer.like)
    json["like"].push_back({{"scene", words::scene_json(like.scene)}, {"likeness", like.likeness}});
  return json;
}

Json to_json(const LikeAnswer& answer) {
  Json json = {{"asked", answer.asked}, {"objects", Json::array()}};
  for (const LikeObject& like : answer.objects) {
    Json one = words::state_json(like.object);
    one["likeness"] = like.likeness;
    if (like.scene) one["image"] = words::scene_json(*like.scene);
    json["objects"].push_back(one);
  }
  return json;
}

}  // namespace loci::memory
