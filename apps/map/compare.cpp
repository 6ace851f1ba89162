#include "mapping/exchange/compare.h"

#include "apps/map/commands.h"
#include "mapping/base/json.h"

namespace loci::apps {

Command compare_command() {
  return {"compare",
          "Compares a map with another map or with the truth",
          {"loci-map compare apps/samples/kitchen.urdf apps/samples/kitchen.urdf",
           "loci-map compare demo-output/map.urdf apps/samples/kitchen.urdf --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string map, truth;
              std::vector<std::string> package_paths;
              mapping::ComparisonOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("MAP", &arguments->map, "URDF of the map");
            table.positional("TRUTH", &arguments->truth, "URDF (with sidecar or geometry) or truth.json");
            table.option("--package-path", &arguments->package_paths,
                         "Folder for package:// names; may repeat");
            table.options(table_of(arguments->options));
            return [arguments](Session& session) {
              const auto read = [&](const std::string& path) {
                mapping::MeshSearch search;
                for (const std::string& folder : arguments->package_paths)
                  search.package_paths.emplace_back(folder);
                search.urdf_folder = std::filesystem::path(path).parent_path();
                return read_structure(path, search, session.warnings());
              };
              const mapping::Comparison result =
                  compare(read(arguments->map), read(arguments->truth), arguments->options);
              session.answer(result.text(), result.report());
            };
          }};
}

}  // namespace loci::apps
