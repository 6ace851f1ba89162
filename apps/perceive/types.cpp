#include "perception/types/types.h"

#include <fmt/format.h>

#include "apps/perceive/commands.h"
#include "apps/perceive/ros_input.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "perception/cas/listing.h"

namespace loci::apps {

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
          "Loads and lists type systems, or says with file and line why not",
          {"loci-perceive types perception/types/scene.xml",
           "loci-perceive types tests/data/climate.xml --with-loci --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<TypesArguments>();
            table.positional("[FILE...]", &given->files, "Type systems in UIMA's XML");
            table.option("--path", &given->paths,
                         "Folder in which imports by name are looked for; may be repeated");
            table.flag("--with-loci", given->ours, "Together with loci's own types, which the files may use");
            table.option("--ros", &given->ros,
                         "The types of ROS messages instead: a bag, or a folder of .msg files",
                         {.excludes = {"FILE", "--with-loci"}});
            table.option("-o,--output", &given->out, "Where the types of ROS messages are written as XML",
                         {.needs = {"--ros"}});
            return [given](Session& session) {
              if (given->files.empty() && given->ros.empty()) throw UsageError("FILE or --ros is required");
              const auto system = load(*given);
              session.answer(perception::cas::types_text(*system), perception::cas::types_json(*system));
            };
          }};
}

}  // namespace loci::apps
