#include "perception/cas/cas.h"

#include <fmt/format.h>

#include "apps/perceive/commands.h"
#include "apps/perceive/ros_input.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "perception/cas/json.h"
#include "perception/cas/xmi.h"
#include "perception/types/types.h"

namespace loci::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
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

void read_cas(const Arguments& given, perception::cas::Cas& cas, Session& session) {
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
std::unique_ptr<perception::cas::Cas> load(const Arguments& given, Session& session) {
  if (mapping::is_ros_bag(given.in)) {
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

void run(const Arguments& given, Session& session) {
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
          "Converts a CAS between UIMA's XMI and canonical JSON",
          {"loci-perceive cas tests/data/weather.xmi --types tests/data/climate.xml -o "
           "demo-output/weather.json",
           "loci-perceive cas tests/data/weather.xmi --types tests/data/climate.xml -o "
           "demo-output/weather.xmi --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.positional("IN", &given->in, "The CAS: .xmi, .xml or .json; or a ROS 1 bag");
            table.option("--types", &given->types,
                         "Its type system in UIMA's XML; may be repeated (a bag has its own)");
            table.option("-o,--output", &given->out, "Where to: .xmi, .xml or .json", {.required = true});
            table.option("--path", &given->paths,
                         "Folder in which imports by name are looked for; may be repeated");
            table.flag("--with-loci", given->ours, "Together with loci's own types");
            table.flag("--lenient", given->xmi.lenient,
                       "Leaves out what the type system does not know, with a warning");
            table.option("--topic", &given->topic, "Of a bag: only this topic");
            table.option("--messages", &given->messages, "Of a bag: so many messages of each topic");
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci::apps
