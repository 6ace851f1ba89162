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
          [](CLI::App& app) {
            auto given = std::make_shared<TypesArguments>();
            auto* files = app.add_option("FILE", given->files, "Type systems in UIMA's XML");
            app.add_option("--path", given->paths,
                           "Folder in which imports by name are looked for; may be repeated")
                ->allow_extra_args(false);
            auto* ours = app.add_flag("--with-loci", given->ours,
                                      "Together with loci's own types, which the files may use");
            auto* ros = app.add_option("--ros", given->ros,
                                       "The types of ROS messages instead: a bag, or a folder of .msg files")
                            ->excludes(files)
                            ->excludes(ours);
            app.add_option("-o,--out", given->out, "Where the types of ROS messages are written as XML")
                ->needs(ros);
            app.parse_complete_callback([given] {
              if (given->files.empty() && given->ros.empty()) throw CLI::RequiredError("FILE or --ros");
            });
            return [given](Session& session) {
              const auto system = load(*given);
              session.answer(perception::cas::types_text(*system), perception::cas::types_json(*system));
            };
          }};
}

}  // namespace loci::apps
