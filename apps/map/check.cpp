#include "apps/map/commands.h"
#include "mapping/base/json.h"
#include "mapping/world/inspection.h"
#include "mapping/world/urdf.h"

namespace loci::apps {

Command check_command() {
  return {"check",
          "Says what a URDF holds, or why it is refused",
          {"loci-map check apps/samples/kitchen.urdf", "loci-map check demo-output/map.urdf --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string urdf;
              std::vector<std::string> package_paths;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("FILE", &arguments->urdf, "URDF file");
            table.option("--package-path", &arguments->package_paths,
                         "Folder that holds packages (package://NAME/…); can be given several times");
            return [arguments](Session& session) {
              const std::filesystem::path path = arguments->urdf;
              const mapping::MeshSearch search = {
                  {arguments->package_paths.begin(), arguments->package_paths.end()}, path.parent_path()};
              const mapping::World world = mapping::read_urdf(path);
              mapping::WorldInspection inspection = inspect(world, search, session.warnings());
              if (const auto sidecar = mapping::sidecar_path(path); std::filesystem::exists(sidecar))
                inspect_sidecar(mapping::read_semantic_map(sidecar), world, inspection, session.warnings());
              session.answer(inspection.report(), inspection.to_json());
            };
          }};
}

}  // namespace loci::apps
