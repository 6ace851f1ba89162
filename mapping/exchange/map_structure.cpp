#include "mapping/exchange/map_structure.h"
#include "mapping/interpretation/furniture/cabinets.h"

#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/furniture_structure.h"
#include "mapping/world/furniture_classes.h"
#include "mapping/world/urdf.h"
#include "mapping/world/world_triangles.h"

namespace loci::mapping {
namespace {

template <class T>
T value_of(const Json& json, const std::string& key, const std::string& file) {
  if (!json.contains(key)) throw Error("the key '" + key + "' is missing", {file, 0, ""});
  try {
    return json.at(key).get<T>();
  } catch (const Json::exception&) {
    throw Error("the value of '" + key + "' cannot be read", {file, 0, key});
  }
}

std::vector<Vector2d> polygon_of(const Json& corners) {
  std::vector<Vector2d> polygon;
  for (const Json& corner : corners)
    polygon.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  return polygon;
}

/// Extents of a wall from its corners.
void span(WallPatch& wall, const std::vector<Vector3d>& corners) {
  wall.along_min = wall.bottom = 1e9;
  wall.along_max = wall.top = -1e9;
  const Vector3d direction(-wall.normal.y(), wall.normal.x(), 0);
  for (const Vector3d& corner : corners) {
    const double along = direction.dot(corner);
    wall.along_min = std::min(wall.along_min, along);
    wall.along_max = std::max(wall.along_max, along);
    wall.bottom = std::min(wall.bottom, corner.z());
    wall.top = std::max(wall.top, corner.z());
  }
}

/// The openings of a wall, named after it, from its `openings` in a sidecar or `door_openings` in a truth.
void add_openings(const Json& openings, const WallPatch& wall, MapStructure& structure) {
  if (!structure.openings) structure.openings.emplace();  // even if this wall has none
  int count = 0;
  for (const Json& json : openings) {
    KnownFront opening;
    opening.front.class_name = json.value("kind", "doorway");
    opening.name = wall.name + "." + opening.front.class_name + "_" + std::to_string(++count);
    opening.region = wall.region;
    opening.front.centre = vector_from_json(json.at("centre"));
    opening.front.normal = wall.normal;
    opening.front.width = json.at("width").get<double>();
    opening.front.height = json.at("height").get<double>();
    structure.openings->push_back(std::move(opening));
  }
}

}  // namespace

MapStructure structure_from_sidecar(const SemanticMap& sidecar, const World& world, const std::string& file) {
  MapStructure structure;
  structure.source = "sidecar";
  structure.map_from_input = sidecar.map_from_input;
  for (const auto& [name, link] : sidecar.links) {
    const Json& geometry = link.geometry;
    try {
      if (link.class_name == "floor") structure.floor_height = geometry.at("height").get<double>();
      if (is_support_class(link.class_name) && !is_inferred_cabinet(link) && geometry.contains("outline"))
        structure.supports.push_back({name,
                                      link.class_name,
                                      "",
                                      geometry.at("height").get<double>(),
                                      {polygon_of(geometry.at("outline"))},
                                      link.class_name != "cabinet"});
      if (link.class_name == "wall") {
        WallPatch wall{name, "", vector_from_json(geometry.at("normal")),
                       geometry.at("offset").get<double>()};
        std::vector<Vector3d> corners;
        for (const Json& corner : geometry.at("outline")) corners.push_back(vector_from_json(corner));
        span(wall, corners);
        if (geometry.contains("openings")) add_openings(geometry.at("openings"), wall, structure);
        structure.walls.push_back(std::move(wall));
      }
    } catch (const Json::exception&) {
      throw Error("the geometry of a link lacks what its class needs", {file, 0, name});
    }
  }
  add_sidecar_furniture(world, sidecar, file, structure);
  return structure;
}

MapStructure structure_from_truth(const Json& truth, const std::string& file) {
  MapStructure structure;
  structure.source = "truth.json";
  for (const Json& surface : value_of<Json>(truth, "support_surfaces", file)) {
    SurfacePatch patch;
    patch.name = value_of<std::string>(surface, "name", file);
    patch.region = surface.value("region", "");
    patch.height = value_of<double>(surface, "height", file);
    patch.polygons = {polygon_of(value_of<Json>(surface, "polygon", file))};
    patch.main = surface.value("main", true);
    structure.supports.push_back(std::move(patch));
  }
  for (const Json& json : truth.value("walls", Json::array())) {
    WallPatch wall;
    wall.name = value_of<std::string>(json, "name", file);
    wall.region = json.value("region", "");
    wall.normal = vector_from_json(value_of<Json>(json, "normal", file));
    wall.offset = value_of<double>(json, "offset", file);
    const Vector3d centre = vector_from_json(value_of<Json>(json, "centre", file));
    const Vector3d right =
        vector_from_json(value_of<Json>(json, "right", file)) * (value_of<double>(json, "width", file) / 2);
    const Vector3d up = Vector3d::UnitZ() * (value_of<double>(json, "height", file) / 2);
    span(wall, {centre - right - up, centre + right + up});
    // Strips, pillars and window reveals fill little of their rectangle.
    wall.main = json.value("faces_furniture_side", true) && json.value("fill", 1.0) > 0.3;
    try {
      if (json.contains("door_openings")) add_openings(json["door_openings"], wall, structure);
    } catch (const Json::exception&) {
      throw Error("an opening needs a centre, a width and a height", {file, 0, wall.name});
    }
    structure.walls.push_back(std::move(wall));
  }
  add_truth_furniture(truth, file, structure);
  if (truth.contains("floor")) structure.floor_height = truth["floor"].value("offset", 0.0);
  return structure;
}

World moved_world(World world, const Isometry3d& map_from_world) {
  std::string root = "map";
  while (world.find_link(root) != nullptr) root += "_";
  Joint joint;
  joint.name = root + "_joint";
  joint.parent = root;
  joint.child = world.root;
  joint.parent_from_joint = map_from_world;
  Link link;
  link.name = world.root = root;
  world.links.push_back(std::move(link));
  world.joints.push_back(std::move(joint));
  return world;
}

MapStructure read_structure(const std::filesystem::path& path, const MeshSearch& search, Warnings& warnings,
                            const std::optional<Isometry3d>& map_from_input) {
  if (path.extension() == ".json") {
    const Json json = read_json(path);
    if (json.contains("support_surfaces")) return structure_from_truth(json, path.string());
    if (json.contains("links"))
      return structure_from_sidecar(semantic_map_from_json(json, path.string()), {}, path.string());
    if (json.contains("fronts")) {
      MapStructure structure;
      structure.source = path.filename().string();
      add_measured_fronts(json, path.string(), structure);
      return structure;
    }
    throw Error("this JSON file is neither a truth (support_surfaces or fronts) nor a sidecar (links)",
                {path.string(), 0, ""});
  }
  const World world = read_urdf(path, warnings);
  const std::filesystem::path sidecar = sidecar_path(path);
  if (std::filesystem::exists(sidecar))
    return structure_from_sidecar(read_semantic_map(sidecar), world, sidecar.string());
  const auto is_off_zero = [&] {
    Warnings later;  // The meshes are read again.
    const auto floor = floor_height(world, triangles_of(world, search, later));
    return floor && !is_at_zero(*floor);
  };
  const bool is_moved = map_from_input && is_off_zero();
  return structure_from_geometry(is_moved ? moved_world(world, *map_from_input) : world, search, warnings);
}

}  // namespace loci::mapping
