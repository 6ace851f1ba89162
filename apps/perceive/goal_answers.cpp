#include "apps/perceive/goal_answers.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/objects.h"
#include "perception/types/geometry.h"

namespace loci::apps {
namespace {

constexpr const char* kColors =
    "black, white, grey, red, brown, beige, orange, pink, yellow, green, cyan, blue or purple";

std::string color_named(const std::string& value) {
  std::vector<std::string> words{lower_case(value)};
  memory::name_basic_colors(words);
  if (words.size() != 1 || !memory::is_color_word(words[0]))
    throw Error(fmt::format("'{}' is the name of no colour", value), {"", 0, "--goal"},
                fmt::format("give {}", kColors));
  return memory::same_color(words[0]);
}

/// What the memory calls its objects: "cup".
std::map<memory::Id, std::string> names_in(const memory::Store* store) {
  std::map<memory::Id, std::string> names;
  if (store != nullptr)
    for (const memory::ObjectBelief& belief : ask(*store, memory::ObjectsQuestion{}).objects)
      names[belief.object.id] = belief.object.label.value_or("");
  return names;
}

std::string name_of(memory::Id object, const std::map<memory::Id, std::string>& names) {
  const auto known = names.find(object);
  return known == names.end() ? std::string() : known->second;
}

}  // namespace

std::vector<perception::GoalTerm> read_goal(const std::string& text) {
  return perception::parse_goal(text, [](const std::string& key, const std::string& value) {
    if (key == "color") return color_named(value);
    return key == "class" ? lower_case(value) : value;
  });
}

GoalAnswers::GoalAnswers(const perception::GoalPlan& plan) : untested_(plan.unanswered) {
  for (const perception::GoalTerm& term : plan.answered)
    answered_.push_back({term, perception::Condition::parse(term.condition, {}), 0, 0, {}});
  if (answered_.empty())
    throw Error(fmt::format("no annotator can test {}", joined(untested_, " or ")), {"", 0, "--goal"},
                "see `loci-perceive list`, give options with --annotator, or raise --budget-ms");
}

void GoalAnswers::look_at(const perception::types::SceneCas& scene, const std::vector<int>& objects) {
  const std::vector<perception::types::Cluster> clusters = scene.clusters();
  for (size_t i = 0; i < clusters.size(); ++i) {
    bool fits = true;
    for (Answered& each : answered_) {
      const std::vector<std::string> values = values_of(each.term, clusters[i]);
      each.values.insert(values.begin(), values.end());
      const bool holds = each.condition.holds(scene, clusters[i]);
      each.tested += holds || !values.empty() ? 1 : 0;
      each.fitting += holds ? 1 : 0;
      fits = fits && holds;
    }
    if (!fits) continue;
    found_.push_back({scene.scene().frame_index.get(), static_cast<int>(i) + 1, place_of(clusters[i]),
                      perception::types::from<Vector3d>(clusters[i].centroid.get()),
                      i < objects.size() ? objects[i] : 0});
  }
}

std::string GoalAnswers::line(const Find& find, const std::map<memory::Id, std::string>& names) const {
  std::string text = fmt::format("frame {}: cluster {}", find.frame, find.cluster);
  if (find.object != 0) {
    const std::string name = name_of(find.object, names);
    text += fmt::format(", {}{}", memory::object_name(find.object), name.empty() ? "" : " (" + name + ")");
  }
  if (!find.place.empty()) text += ", on " + find.place;
  text +=
      fmt::format(", at ({:.2f}, {:.2f}, {:.2f})", find.position.x(), find.position.y(), find.position.z());
  if (untested_.empty()) return text + " fits\n";
  std::vector<std::string> tested;
  for (const Answered& each : answered_) tested.push_back(each.term.text());
  return text + fmt::format(" fits {}; not tested: {}\n", joined(tested, ", "), joined(untested_, ", "));
}

std::string GoalAnswers::unmet(const Answered& answered) const {
  std::string text = fmt::format("nothing fits {}", answered.term.text());
  if (answered.values.empty()) return text + ": no cluster was tested\n";
  const std::vector<std::string> values(answered.values.begin(), answered.values.end());
  return text + fmt::format("; seen were {}\n", joined(values, ", "));
}

std::string GoalAnswers::text(const memory::Store* memory) const {
  const std::map<memory::Id, std::string> names =
      found_.empty() ? std::map<memory::Id, std::string>() : names_in(memory);
  std::string text;
  for (const Find& find : found_) text += line(find, names);
  if (!found_.empty()) return text;
  text += "nothing fits the goal\n";
  for (const Answered& each : answered_)
    if (each.fitting == 0) text += unmet(each);
  return text;
}

Json GoalAnswers::json(const memory::Store* memory) const {
  const std::map<memory::Id, std::string> names =
      found_.empty() ? std::map<memory::Id, std::string>() : names_in(memory);
  Json found = Json::array();
  for (const Find& find : found_) {
    Json json = {{"frame", find.frame},
                 {"cluster", find.cluster},
                 {"position", {find.position.x(), find.position.y(), find.position.z()}},
                 {"not_tested", untested_}};
    if (!find.place.empty()) json["place"] = find.place;
    if (find.object != 0) json["object"] = memory::object_name(find.object);
    if (const std::string name = name_of(find.object, names); !name.empty()) json["name"] = name;
    found.push_back(json);
  }
  Json terms = Json::array();
  for (const Answered& each : answered_)
    terms.push_back({{"for", each.term.text()},
                     {"tested", each.tested},
                     {"fitting", each.fitting},
                     {"seen", each.values}});
  return {{"found", found}, {"terms", terms}};
}

}  // namespace loci::apps
