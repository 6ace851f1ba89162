#include "perception/types/types.h"
#include "apps/perceive/commands.h"
#include "perception/cas/listing.h"

namespace loci {

namespace {

struct TypesArguments {
  std::vector<std::filesystem::path> files, paths;
  bool ours = false;
};

}  // namespace

Command types_command() {
  return {"types",
          "Loads and lists type systems, or says with file and line why not",
          {"loci-perceive types perception/types/scene.xml",
           "loci-perceive types tests/data/climate.xml --with-loci --json"},
          [](CLI::App& app) {
            auto given = std::make_shared<TypesArguments>();
            app.add_option("FILE", given->files, "Type systems in UIMA's XML")->required();
            app.add_option("--path", given->paths,
                           "Folder in which imports by name are looked for; may be repeated")
                ->allow_extra_args(false);
            app.add_flag("--with-loci", given->ours,
                         "Together with loci's own types, which the files may use");
            return [given](Session& session) {
              const auto system = given->ours ? types::type_system_with(given->files, given->paths)
                                              : cas::TypeSystem::load(given->files, given->paths);
              session.answer(cas::types_text(*system), cas::types_json(*system));
            };
          }};
}

}  // namespace loci
