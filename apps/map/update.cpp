// A map and new scans of the same room: update.

#include <set>

#include "apps/map/commands.h"
#include "apps/map/posed_recording.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/exchange/map_report.h"
#include "mapping/fusion/fusion.h"
#include "mapping/update/placement.h"
#include "mapping/update/update.h"
#include "mapping/world/map_files.h"
#include "mapping/world/urdf.h"

namespace loci::apps {
namespace {

namespace fs = std::filesystem;

struct UpdateArguments {
  std::string map, scans, out, earlier;
  mapping::RecordingOptions reading;
  mapping::UpdateOptions options;
};

/// A scan set, or a recording, which is fused. One without poses is tracked, and placed by the earlier scans,
/// as is one whose poses are in another frame.
mapping::ScanSet read_new(const UpdateArguments& arguments, const mapping::SemanticMap& semantics,
                          const mapping::ScanSet& earlier, Session& session) {
  const std::string& path = arguments.scans;
  if (fs::exists(fs::path(path) / "scans.yaml") || fs::path(path).extension() == ".pcd")
    return mapping::read_registered_scans(path, session.warnings());
  auto [recording, tracked] = open_posed(path, arguments.reading, session, &semantics);
  recording = placed_in_map(std::move(recording), tracked, semantics, earlier, session.flags().threads,
                            session.progress(), session.warnings());
  mapping::FusionOptions options;
  options.threads = session.flags().threads;
  mapping::FusionResult fused = fuse(*recording, options, session.progress());
  fused.frames.explain("frame", {path, 0, {}}, session.warnings());
  return std::move(fused.scans);
}

mapping::ScanSet read_earlier(const UpdateArguments& arguments, const mapping::SemanticMap& semantics,
                              Session& session) {
  const fs::path folder = arguments.earlier.empty() ? fs::path(arguments.map).parent_path() / "scans"
                                                    : fs::path(arguments.earlier);
  if (!fs::exists(folder))
    throw Error("the scans that the map was made from are not there", {folder.string(), 0, {}},
                "give their folder with --scans-before");
  return read_scans_of_map(folder, semantics, session.warnings());
}

/// The textures of a map that its update still names.
std::set<std::string> textures_of(const mapping::World& world, const fs::path& folder) {
  std::set<std::string> names;
  for (const mapping::Link& link : world.links)
    for (const mapping::Visual& visual : link.visuals) {
      const auto* mesh = std::get_if<mapping::Mesh>(&visual.geometry);
      if (mesh == nullptr || fs::path(mesh->uri).parent_path() != "textures") continue;
      for (const char* ending : {".obj", ".jpg"}) names.insert(fs::path(mesh->uri).replace_extension(ending));
      names.insert("textures/textures.mtl");
    }
  std::erase_if(names, [&](const std::string& name) { return !fs::exists(folder / name); });
  return names;
}

void write_update(mapping::UpdateResult& result, const fs::path& before,
                  const std::set<std::string>& textures, const std::string& out, Warnings& warnings) {
  const fs::path folder = out;
  make_folder(folder);
  if (!textures.empty()) make_folder(folder / "textures");
  for (const std::string& name : textures) write_file_atomically(folder / name, read_file(before / name));
  write_map(result.map.world, result.map.semantics, folder / "map.urdf");
  write_scan_set(result.scans, folder / "scans");
  write_json(folder / "changes.json", result.report());
  write_file_atomically(folder / "changes.svg", change_plan_svg(result));
  result.map.photos = photos_of_textures(result.map, folder, warnings);
  write_file_atomically(
      folder / "report.html",
      map_report(result.map, result.scans, out, glb_bytes(result.map.world, {{}, folder}, warnings)));
}

void run(UpdateArguments& arguments, Session& session) {
  if (fs::exists(arguments.out) && fs::equivalent(arguments.out, fs::absolute(arguments.map).parent_path()))
    throw Error("the new map would replace the old one", {arguments.out, 0, {}},
                "give another folder with -o");
  session.check_outputs(arguments.out, {"map.urdf", "map.semantic.json", "scans/scans.yaml", "changes.json",
                                        "changes.svg", "report.html"});
  arguments.options.threads = session.flags().threads;
  const mapping::World world = mapping::read_urdf(arguments.map);
  const mapping::SemanticMap semantics = mapping::read_semantic_map(mapping::sidecar_path(arguments.map));
  const mapping::ScanSet earlier = read_earlier(arguments, semantics, session);
  mapping::UpdateResult result =
      update(world, semantics, earlier, read_new(arguments, semantics, earlier, session), arguments.options,
             session.progress());
  session.timing("update", result.seconds);
  for (const std::string& note : result.notes) session.warnings().add(note);
  const fs::path before = fs::path(arguments.map).parent_path();
  keep_textures(world, result.map);
  color_links(result.scans, session.flags().threads, result.map);
  const std::set<std::string> textures = textures_of(result.map.world, before);
  session.check_outputs(arguments.out, {textures.begin(), textures.end()});
  write_update(result, before, textures, arguments.out, session.warnings());
  session.answer(result.text() + "in " + arguments.out + "/map.urdf, see " + arguments.out + "/changes.svg\n",
                 result.report());
}

}  // namespace

Command update_command() {
  return {"update",
          "Compare new scans of a room with its map: furniture that moved, came or went, joints; write the "
          "new map",
          {"loci-map update demo-output/map.urdf demo-output/scans -o demo-output/updated",
           "loci-map update demo-output/map.urdf demo-output/tour -o demo-output/updated --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<UpdateArguments>();
            table.positional("MAP", &arguments->map, "URDF of the map; the sidecar is found beside it");
            table.positional(
                "SCANS", &arguments->scans,
                "Folder of new scans in about the map's frame, or of a recording, which needs no poses");
            table.output("FOLDER", &arguments->out, "Folder of the new map, its scans and the changes",
                         {.replaces = true});
            table.option("--scans-before FOLDER", &arguments->earlier, "Scans that the map was made from",
                         {.default_text = "scans/ beside MAP"});
            table.options(table_of(arguments->options), "Update");
            table.options(table_of(arguments->reading), "Recording");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
