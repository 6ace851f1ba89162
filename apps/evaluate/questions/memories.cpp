#include "apps/evaluate/questions/memories.h"

#include <algorithm>
#include <sstream>

#include "apps/evaluate/changes/random_day.h"
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

constexpr int kScenes = 12;
constexpr uint64_t kFirstSeed = 41;

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

/// "mug" for a mug called cup_1, "cereal" for cereal, "jar" for jar_3.
std::string class_of(const TrueObject& object) {
  return object.model == "mug" ? object.model : object.name.substr(0, object.name.find('_'));
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

/// A random day in one of the sample kitchens as a scenario beside its recording.
fs::path write_random_day(const std::string& name, const fs::path& folder, const fs::path& samples) {
  const std::string world = name == "kitchen" ? "kitchen" : "kitchen_l";
  fs::path scenario = folder / (name + ".yaml");
  write_file_atomically(
      scenario,
      changes::random_day(changes::sample_day_world(world), fs::absolute(samples / (world + ".urdf")),
                          kFirstSeed + (name == "kitchen" ? 0 : 1), kScenes, true));
  return scenario;
}

}  // namespace

AskedMemory asked_memory(const std::string& name, const fs::path& folder, const fs::path& samples,
                         int threads, Progress& progress, Warnings& warnings) {
  if (name != "day" && name != "plain" && name != "kitchen" && name != "corner")
    throw Error("no memory '" + name + "' is known", {}, "take day, plain, kitchen or corner");
  const bool sample_day = name == "day" || name == "plain";
  const fs::path recording = folder / (sample_day ? "day" : name), file = folder / (name + ".loci");
  PartialProgress recording_it(progress, 0, 0.6), remembering(progress, 0.6, 1);
  if (!fs::exists(recording / "frames.csv")) {
    mapping::RecordOptions options;
    if (!sample_day) options.seed = static_cast<int>(kFirstSeed) + (name == "kitchen" ? 0 : 1);
    options.threads = threads;
    const fs::path scenario = sample_day ? samples / "day.yaml" : write_random_day(name, folder, samples);
    record(mapping::read_scenario(scenario), recording, options, recording_it, warnings);
  }
  const bool fresh = !fs::exists(file);
  if (fresh) {
    changes::RememberOptions options;
    options.memory = file;
    options.map = samples / (name == "corner" ? "kitchen_l.urdf" : "kitchen.urdf");
    options.program = "loci-evaluate questions";
    options.threads = threads;
    changes::remember(mapping::open_recording(recording), options, remembering, warnings);
  }
  const auto objects = true_objects(memory::Store::open_read(file), recording);
  if (fresh && name != "plain") name_objects(file, objects, samples);
  AskedMemory asked{.file = file};
  asked.twins = twins_of(sample_day ? samples / "day.yaml" : folder / (name + ".yaml"));
  for (const auto& [id, object] : objects) asked.names[id] = object.name;
  return asked;
}

}  // namespace loci::apps::questions
