// Feature structures and type systems: cas, types.

#include <fmt/format.h>
#include <algorithm>

#include "apps/perceive/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/ros/bag.h"
#include "perception/cas/cas.h"
#include "perception/cas/json.h"
#include "perception/cas/type_system.h"
#include "perception/cas/xmi.h"
#include "perception/conversions/ros_types.h"
#include "perception/types/scene_cas.h"

namespace loci::apps {

perception::RosTypes ros_types_of(const mapping::RosBag& bag) {
  perception::RosTypes types;
  for (const mapping::BagTopic& topic : bag.topics())
    types.add(topic.type, topic.definition, bag.path().string() + ": " + topic.name);
  return types;
}

perception::RosTypes ros_types_of(const std::filesystem::path& path) {
  if (mapping::is_ros2_bag(path))
    throw Error("messages of ROS 2 are not converted to a CAS", {path.string(), 0, {}},
                "give a bag of ROS 1, or read the recording with run");
  if (!std::filesystem::is_directory(path)) return ros_types_of(mapping::RosBag(path));
  perception::RosTypes types;
  types.add_folder(path);
  return types;
}

size_t add_ros_messages(const mapping::RosBag& bag, const perception::RosTypes& types,
                        const std::string& topic, size_t most, perception::cas::Cas& cas) {
  std::vector<std::string> names;
  for (const mapping::BagTopic& each : bag.topics()) names.push_back(each.name);
  if (!topic.empty() && bag.find(topic) == nullptr)
    throw Error(fmt::format("the bag has no topic {}", topic), {bag.path().string(), 0, {}},
                did_you_mean(topic, names));
  size_t count = 0;
  for (const mapping::BagTopic& each : bag.topics()) {
    if (!topic.empty() && each.name != topic) continue;
    for (size_t i = 0; i < std::min(most, each.messages); ++i, ++count) {
      try {
        cas.view(each.name).add_to_index(types.read(cas, each.type, bag.message(each.name, i)));
      } catch (const Error& error) {
        if (!error.location().file.empty()) throw;
        throw Error(error.message(), {fmt::format("{}: {}[{}]", bag.path().string(), each.name, i), 0, {}});
      }
    }
  }
  return count;
}

namespace {

namespace fs = std::filesystem;

struct CasArguments {
  std::string in, out;
  std::vector<fs::path> types, paths;
  bool ours = false;
  perception::cas::XmiOptions xmi;
  std::string topic;
  size_t messages = 1;
};

bool is_xmi(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".xmi" || ending == ".xml") return true;
  if (ending == ".json") return false;
  throw Error("the file's ending says neither XMI nor JSON", {path.string(), 0, {}},
              "it is .xmi, .xml or .json");
}

void read_cas(const CasArguments& given, perception::cas::Cas& cas, Session& session) {
  if (is_xmi(given.in))
    return perception::cas::from_xmi(cas, read_file(given.in), given.in, given.xmi, session.warnings());
  try {
    perception::cas::from_json(cas, read_json(given.in));
  } catch (const Error& error) {
    if (!error.location().file.empty()) throw;
    throw Error(error.message(), {given.in, 0, error.location().key}, error.hint());
  }
}

/// The CAS of a file; that of a bag brings its types along.
std::unique_ptr<perception::cas::Cas> load(const CasArguments& given, Session& session) {
  if (mapping::is_ros1_bag(given.in)) {
    const mapping::RosBag bag(given.in);
    const perception::RosTypes types = ros_types_of(bag);
    auto cas = std::make_unique<perception::cas::Cas>(
        perception::cas::TypeSystem::load({{given.in, types.xml()}}, given.types, given.paths));
    add_ros_messages(bag, types, given.topic, given.messages, *cas);
    return cas;
  }
  if (given.types.empty())
    throw Error("no type system was given", {given.in, 0, {}}, "give --types TYPES.xml");
  auto cas = std::make_unique<perception::cas::Cas>(
      given.ours ? perception::types::type_system_with(given.types, given.paths)
                 : perception::cas::TypeSystem::load(given.types, given.paths));
  read_cas(given, *cas, session);
  return cas;
}

void run(const CasArguments& given, Session& session) {
  const bool to_xmi = is_xmi(given.out);
  const std::unique_ptr<perception::cas::Cas> cas = load(given, session);
  const Json json = perception::cas::to_json(*cas);
  if (to_xmi)
    write_file_atomically(given.out, perception::cas::to_xmi(*cas));
  else
    write_json(given.out, json);
  const size_t views = json.at("views").size(), structures = json.at("structures").size();
  session.answer(fmt::format("{} views and {} feature structures in {}", views, structures, given.out),
                 {{"views", views}, {"structures", structures}, {"out", given.out}});
}

}  // namespace

Command cas_command() {
  return {"cas",
          "Convert a CAS between UIMA's XMI and canonical JSON",
          {"loci-perceive cas tests/data/weather.xmi --types tests/data/climate.xml -o "
           "demo-output/weather.json",
           "loci-perceive cas tests/data/weather.xmi --types tests/data/climate.xml -o "
           "demo-output/weather.xmi --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<CasArguments>();
            table.positional("INPUT", &given->in, "The CAS: .xmi, .xml, .json, or a ROS 1 bag");
            table.option("--types FILE", &given->types,
                         "Type system in UIMA's XML; may be repeated (a bag contains its own)");
            table.output("FILE", &given->out, "Converted CAS: .xmi, .xml or .json", {.replaces = true});
            table.option("--path FOLDER", &given->paths,
                         "Folder with imported type systems; may be repeated");
            table.flag("--with-loci", given->ours, "Add loci's own types");
            table.flag("--lenient", given->xmi.lenient, "Skip what the type system lacks, with a warning");
            table.begin_group("ROS bag");
            table.option("--topic NAME", &given->topic, "Convert only this topic");
            table.option("--max-messages N", &given->messages, "Maximum number of messages per topic");
            return [given](Session& session) { run(*given, session); };
          }};
}

namespace {

struct TypesArguments {
  std::vector<std::filesystem::path> files, paths;
  std::string ros, out;
  bool ours = false;
};

std::shared_ptr<const perception::cas::TypeSystem> load(const TypesArguments& given) {
  if (given.ros.empty())
    return given.ours ? perception::types::type_system_with(given.files, given.paths)
                      : perception::cas::TypeSystem::load(given.files, given.paths);
  const std::string xml = ros_types_of(given.ros).xml(std::filesystem::path(given.ros).stem().string());
  if (!given.out.empty()) write_file_atomically(given.out, xml);
  return perception::cas::TypeSystem::load({{given.ros, xml}}, given.files, given.paths);
}

}  // namespace

Command types_command() {
  return {"types",
          "Check and list type systems",
          {"loci-perceive types perception/types/scene.xml",
           "loci-perceive types tests/data/climate.xml --with-loci --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<TypesArguments>();
            table.positional("[FILE...]", &given->files, "Type systems in UIMA's XML");
            table.option("--path FOLDER", &given->paths,
                         "Folder with imported type systems; may be repeated");
            table.flag("--with-loci", given->ours, "Add loci's own types");
            table.option("--ros PATH", &given->ros, "Types of ROS messages: a bag, or a folder of .msg files",
                         {.excludes = {"FILE", "--with-loci"}});
            table.option("-o,--output FILE", &given->out, "Write the types of ROS messages as XML",
                         {.needs = {"--ros"}, .replaces = true});
            return [given](Session& session) {
              if (given->files.empty() && given->ros.empty()) throw UsageError("FILE or --ros is required");
              const auto system = load(*given);
              session.answer(perception::cas::types_text(*system), perception::cas::types_json(*system));
            };
          }};
}

}  // namespace loci::apps
