#include "apps/evaluate/commands.h"
#include "apps/evaluate/mesh/comparison.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> recordings, package_paths;
  std::string out;
  mesh_claim::Settings settings;
};

void run(Arguments& arguments, Session& session) {
  mesh_claim::Settings& settings = arguments.settings;
  settings.threads = session.flags().threads;
  settings.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
  std::optional<TemporaryFolder> temporary;
  if (arguments.out.empty()) temporary.emplace("loci-evaluate-mesh");
  settings.folder = temporary ? temporary->path() : std::filesystem::path(arguments.out);
  std::vector<mesh_claim::Row> rows;
  for (const std::string& recording : arguments.recordings)
    for (mesh_claim::Row& row : compare_meshes(recording, settings, session.progress(), session.warnings()))
      rows.push_back(std::move(row));
  session.answer(to_text(rows), to_json(rows));
}

}  // namespace

Command mesh_command() {
  return {
      "mesh",
      "Meshes of rooms against true surfaces or frames left out, and another method",
      {"loci-simulate record apps/samples/walk.yaml -o demo-output/walk",
       "loci-evaluate mesh demo-output/walk", "loci-evaluate mesh demo-output/walk --voxel-m 0.02 --json"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<Arguments>();
        mesh_claim::Settings& settings = arguments->settings;
        table.positional("RECORDING...", &arguments->recordings,
                         "Recordings with poses, or worlds (URDF) that a simulated Kinect walks through");
        table.option("--voxel-m", &settings.voxel_m, "Size of the voxels",
                     {.unit = "m", .min = 0.002, .max = 0.1});
        table.flag("--open3d", settings.open3d,
                   "Runs Open3D's ScalableTSDFVolume, too, where it is installed");
        table.option("--places", &settings.places, "Places of a simulated walk where the person turns round",
                     {.min = 1, .max = 1000});
        table.option("--seed", &settings.seed, "Seed of paths and noise", {.min = 0, .max = 1000000});
        table.package_path(&arguments->package_paths);
        table.option("-o,--output FOLDER", &arguments->out,
                     "Keep simulated recordings in this folder; those in it are used again");
        return [arguments](Session& session) { run(*arguments, session); };
      }};
}

}  // namespace loci::apps
