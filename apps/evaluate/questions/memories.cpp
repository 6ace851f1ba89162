#include "apps/evaluate/questions/memories.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <string_view>

#include "apps/evaluate/changes/remember.h"
#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/simulation/record.h"
#include "memory/questions/facts.h"
#include "memory/questions/names/taxonomy.h"

namespace loci::apps::questions {
namespace {

namespace fs = std::filesystem;

constexpr int kFirstSeed = 41;

struct TrueObject {
  std::string name, model;
  Vector3d centre;
};

std::map<TimeNs, std::vector<TrueObject>> read_visible(const fs::path& recording) {
  std::map<TimeNs, std::vector<TrueObject>> visible;
  std::istringstream lines(read_file(recording / "truth.jsonl"));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    const Json frame = parse_json(line, "truth.jsonl");
    for (const Json& object : frame.at("objects")) {
      if (object.at("pixels").get<double>() <= 0) continue;
      const auto pose = object.at("pose").get<std::vector<double>>();
      visible[frame.at("time_ns").get<TimeNs>()].push_back(
          {object.at("id"), object.at("model"),
           Vector3d(pose.at(0), pose.at(1), pose.at(2) + object.at("size").at(2).get<double>() / 2)});
    }
  }
  return visible;
}

/// The true object of each object, with its model.
std::map<memory::Id, TrueObject> true_objects(const memory::Store& store, const fs::path& recording) {
  constexpr double kNear_m = 0.12;
  const auto visible = read_visible(recording);
  std::map<memory::Id, TrueObject> result;
  for (const memory::ObjectRow& object : store.objects()) {
    std::map<std::string, std::pair<size_t, TrueObject>> votes;
    for (const memory::ObjectObservation& seen : store.observations_of(object.id)) {
      const auto frame = visible.find(seen.time);
      if (frame == visible.end() || !seen.observation.position) continue;
      const TrueObject* nearest = nullptr;
      const auto distance = [&](const TrueObject& one) {
        return (one.centre - *seen.observation.position).norm();
      };
      for (const TrueObject& one : frame->second)
        if (distance(one) < (nearest == nullptr ? kNear_m : distance(*nearest))) nearest = &one;
      if (nearest == nullptr) continue;
      auto& [count, one] = votes[nearest->name];
      ++count;
      one = *nearest;
    }
    const auto most = std::ranges::max_element(votes, {}, [](const auto& vote) { return vote.second.first; });
    if (most != votes.end()) result[object.id] = most->second.second;
  }
  return result;
}

/// "mug" for a mug called cup_1, "cereal" for cereal, "jar" for jar_3 and, in a drawn kitchen, day_jar_3.
std::string class_of(const TrueObject& object) {
  constexpr std::string_view kPrefix = "day_";
  if (object.model == "mug") return object.model;
  const std::string name =
      object.name.starts_with(kPrefix) ? object.name.substr(kPrefix.size()) : object.name;
  return name.substr(0, name.find('_'));
}

/// As a person would with `loci-memory fact set` and `taxonomy load`.
void name_objects(const fs::path& file, const std::map<memory::Id, TrueObject>& objects,
                  const fs::path& samples) {
  memory::Store store = memory::Store::open_write(file);
  for (const auto& [id, object] : objects)
    set_fact(store, memory::object_name(id), "class", class_of(object));
  memory::Taxonomy::read(samples / "household.yaml").save(store);
}

Twins twins_of(const fs::path& scenario) {
  std::map<std::string, std::string> first;  // by how it is drawn
  Twins twins;
  const Config root = Config::parse(read_file(scenario), scenario.string());
  for (const auto& object : root.node("objects")) {
    const auto name = object.first.as<std::string>();
    twins[name] = first.emplace(YAML::Dump(object.second), name).first->second;
  }
  return twins;
}

/// The scenario of a memory's day.
fs::path scenario_of(const std::string& name, const AskedFolders& from) {
  if (name == "day" || name == "plain") return from.samples / "day.yaml";
  const fs::path day = from.days / (name + ".yaml");
  if (!fs::exists(day))
    throw Error(fmt::format("no memory '{}' is known", name), {from.days.string(), 0, {}},
                "take day, plain or a scenario of this folder");
  return day;
}

/// Other noise in each kitchen.
int seed_of(const std::string& name) {
  if (name == "day" || name == "plain") return mapping::RecordOptions().seed;
  if (name == "kitchen") return kFirstSeed;
  if (name == "corner") return kFirstSeed + 1;
  return std::accumulate(name.begin(), name.end(), kFirstSeed);
}

}  // namespace

AskedMemory asked_memory(const std::string& name, const fs::path& folder, const AskedFolders& from,
                         int threads, Progress& progress, Warnings& warnings) {
  const mapping::Scenario scenario = mapping::read_scenario(scenario_of(name, from));
  const fs::path recording = folder / (name == "plain" ? "day" : name), file = folder / (name + ".loci");
  PartialProgress recording_it(progress, 0, 0.6), remembering(progress, 0.6, 1);
  if (!fs::exists(recording / "frames.csv")) {
    mapping::RecordOptions options;
    options.threads = threads;
    options.seed = seed_of(name);
    record(scenario, recording, options, recording_it, warnings);
  }
  const bool fresh = !fs::exists(file);
  if (fresh) {
    changes::RememberOptions options;
    options.memory = file;
    options.map = scenario.world;
    options.program = "loci-evaluate questions";
    options.threads = threads;
    changes::remember(mapping::open_recording(recording), options, remembering, warnings);
  }
  const auto objects = true_objects(memory::Store::open_read(file), recording);
  if (fresh && name != "plain") name_objects(file, objects, from.samples);
  AskedMemory asked{.file = file};
  asked.twins = twins_of(scenario_of(name, from));
  for (const auto& [id, object] : objects) asked.names[id] = object.name;
  return asked;
}

}  // namespace loci::apps::questions
