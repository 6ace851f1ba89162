// Finished maps: check, compare, export.

#include <chrono>

#include "apps/map/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/comparison/compare.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/exchange/formats/mjcf.h"
#include "mapping/exchange/formats/occupancy_grid.h"
#include "mapping/exchange/formats/owl.h"
#include "mapping/exchange/formats/ply.h"
#include "mapping/exchange/formats/sdf.h"
#include "mapping/exchange/link_graph.h"
#include "mapping/world/inspection.h"
#include "mapping/world/mesh_files.h"
#include "mapping/world/urdf.h"

namespace loci::apps {

Command check_command() {
  return {"check",
          "Check a URDF and list its contents",
          {"loci-map check apps/samples/kitchen.urdf", "loci-map check demo-output/map.urdf --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string urdf;
              std::vector<std::string> package_paths;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("URDF", &arguments->urdf, "URDF file; the sidecar of a map is found beside it");
            table.package_path(&arguments->package_paths);
            return [arguments](Session& session) {
              const std::filesystem::path path = arguments->urdf;
              const mapping::MeshSearch search = {
                  {arguments->package_paths.begin(), arguments->package_paths.end()}, path.parent_path()};
              const mapping::World world = mapping::read_urdf(path, session.warnings());
              mapping::WorldInspection inspection = inspect(world, search, session.warnings());
              if (const auto sidecar = mapping::sidecar_path(path); std::filesystem::exists(sidecar))
                inspect_sidecar(mapping::read_semantic_map(sidecar), world, inspection, session.warnings());
              session.answer(inspection.report(), inspection.to_json());
            };
          }};
}

Command compare_command() {
  return {"compare",
          "Compare a map with another map or with ground truth",
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
            table.package_path(&arguments->package_paths);
            table.options(table_of(arguments->options), "Comparison");
            return [arguments](Session& session) {
              const auto read = [&](const std::string& path,
                                    const std::optional<Isometry3d>& map_from_input) {
                mapping::MeshSearch search;
                for (const std::string& folder : arguments->package_paths)
                  search.package_paths.emplace_back(folder);
                search.urdf_folder = std::filesystem::path(path).parent_path();
                return read_structure(path, search, session.warnings(), map_from_input);
              };
              const mapping::MapStructure map = read(arguments->map, {});
              const mapping::Comparison result =
                  compare(map, read(arguments->truth, map.map_from_input), arguments->options);
              session.answer(result.text(), result.report());
            };
          }};
}

namespace {

struct ExportArguments {
  std::string input, format, out, root;
  std::vector<std::string> package_paths;
  mapping::GridOptions grid;
};

/// The format that was named, or else that a file's ending means.
std::string format_of(const ExportArguments& arguments) {
  if (!arguments.format.empty()) return arguments.format;
  const std::string ending = std::filesystem::path(arguments.out).extension();
  for (const char* format : {"glb", "sdf", "mjcf", "owl", "ply", "bt", "svg"})
    if (ending == std::string(".") + format) return format;
  if (ending == ".xml") return "mjcf";
  if (ending == ".pgm" || ending == ".yaml") return "grid";
  throw Error("the ending of '" + arguments.out + "' names no format", {},
              "give --format: glb, sdf, mjcf, owl, ply, grid, bt, svg");
}

/// PGM and YAML side by side. Returns what to tell.
Json write_grid(const mapping::OccupancyGrid& grid, const std::filesystem::path& out,
                const Session& session) {
  const std::filesystem::path pgm = std::filesystem::path(out).replace_extension(".pgm");
  const std::filesystem::path yaml = std::filesystem::path(out).replace_extension(".yaml");
  session.check_outputs({}, {pgm, yaml});
  write_file_atomically(pgm, pgm_text(grid));
  write_file_atomically(yaml, grid_yaml(grid, pgm.filename()));
  return {{"files", {pgm.string(), yaml.string()}},
          {"cells", {grid.width, grid.height}},
          {"occupied", std::ranges::count(grid.cells, mapping::Occupancy::occupied)},
          {"free", std::ranges::count(grid.cells, mapping::Occupancy::free)}};
}

Json write_text(const std::string& text, const std::filesystem::path& out) {
  write_file_atomically(out, text);
  return {{"files", {out.string()}}, {"bytes", text.size()}};
}

int64_t modified_ns(const std::filesystem::path& file) {
  const auto time = std::chrono::file_clock::to_sys(std::filesystem::last_write_time(file));
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

Json export_map(const ExportArguments& arguments, const std::string& format, Session& session) {
  mapping::World world = mapping::read_urdf(arguments.input);
  const std::filesystem::path folder = std::filesystem::path(arguments.input).parent_path();
  const std::filesystem::path sidecar = mapping::sidecar_path(arguments.input);
  const bool described = std::filesystem::exists(sidecar);
  const mapping::SemanticMap semantics =
      described ? mapping::read_semantic_map(sidecar) : mapping::SemanticMap{};
  if (format == "sdf") {
    move_mesh_names(world, folder, std::filesystem::path(arguments.out).parent_path());
    return write_text(sdf_text(world, session.warnings()), arguments.out);
  }
  if (format == "svg") return write_text(link_graph_svg(world, semantics, arguments.root), arguments.out);
  if (format == "owl") {
    if (!described)
      throw Error("what the links are is not known", {arguments.input, 0, ""},
                  "OWL needs the sidecar " + sidecar.string());
    const std::string name =
        world.name.empty() || world.name == "map" ? mapping::map_name(folder) : world.name;
    return write_text(owl_text(world, semantics, name, modified_ns(arguments.input)), arguments.out);
  }
  mapping::MeshSearch search;
  search.package_paths.assign(arguments.package_paths.begin(), arguments.package_paths.end());
  search.urdf_folder = folder;
  if (format == "glb") return write_text(glb_bytes(world, search, session.warnings()), arguments.out);
  if (format == "mjcf") return write_text(mjcf_text(world, search, session.warnings()), arguments.out);
  const std::vector<mapping::WorldTriangle> triangles = triangles_of(world, search, session.warnings());
  if (format == "ply") return write_text(ply_text(triangles), arguments.out);
  if (format == "grid")
    return write_grid(occupancy_grid(triangles, arguments.grid, session.warnings()), arguments.out, session);
  write_surface_tree(triangles, arguments.grid.resolution_m, arguments.out);
  return {{"files", {arguments.out}}};
}

Json export_scans(const ExportArguments& arguments, const std::string& format, Session& session) {
  const mapping::ScanSet scans = mapping::read_registered_scans(arguments.input, session.warnings());
  if (format == "ply") return write_text(ply_text(scans), arguments.out);
  if (format != "grid" && format != "bt")
    throw Error("scans have no links and joints", {arguments.input, 0, ""},
                "export the map for " + format + "; scans go to ply, grid, bt");
  if (format == "grid") return write_grid(occupancy_grid(scans, arguments.grid), arguments.out, session);
  mapping::OccupancyOptions options;
  options.resolution_m = arguments.grid.resolution_m;
  if (scans.range_max > 0) options.range_max_m = scans.range_max;
  mapping::OccupancyMap map(options);
  for (const mapping::Scan& scan : scans.scans) map.insert(scan);
  map.write_bt(arguments.out);
  return {{"files", {arguments.out}}};
}

void run(const ExportArguments& arguments, Session& session) {
  const std::string format = format_of(arguments);
  const std::filesystem::path input = arguments.input;
  if (!std::filesystem::exists(input)) throw Error("does not exist", {arguments.input, 0, ""});
  const bool scans = std::filesystem::is_directory(input) || input.extension() == ".pcd";
  Json answer = {{"format", format}};
  answer.update(scans ? export_scans(arguments, format, session) : export_map(arguments, format, session));
  std::string text = format + ":";
  for (const Json& file : answer["files"]) text += " " + file.get<std::string>();
  session.answer(text + "\n", answer);
}

}  // namespace

Command export_command() {
  return {
      "export",
      "Export a map as GLB, SDF, MJCF, OWL, PLY, grid, OctoMap or link graph; scans as PLY, grid or OctoMap",
      {"loci-map export apps/samples/kitchen.urdf -o demo-output/kitchen.sdf",
       "loci-map export demo-output/map.urdf -o demo-output/kitchen.glb",
       "loci-map export demo-output/map.urdf --format mjcf -o demo-output/kitchen.xml",
       "loci-map export apps/samples/kitchen.urdf --format grid --resolution-m 0.02 -o "
       "demo-output/floor.yaml"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<ExportArguments>();
        table.positional("MAP", &arguments->input,
                         "URDF of the map (the sidecar is found beside it), or a folder of scans");
        table.output("FILE", &arguments->out, "File to write", {.replaces = true});
        table.option("--format FORMAT", &arguments->format, "Format",
                     {.default_text = "by the file name",
                      .choices = {"glb", "sdf", "mjcf", "owl", "ply", "grid", "bt", "svg"}});
        table.option("--root LINK", &arguments->root, "Link with which the link graph begins");
        table.package_path(&arguments->package_paths);
        table.options(table_of(arguments->grid), "Grid");
        return [arguments](Session& session) {
          table_of(arguments->grid).validate({"", 0, "export"});
          run(*arguments, session);
        };
      }};
}

}  // namespace loci::apps
