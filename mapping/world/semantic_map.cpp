#include "mapping/world/semantic_map.h"

#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci::mapping {
namespace {

constexpr int kVersion = 1;

/// Reads one object field by field; complains with file and key.
class Reader {
 public:
  Reader(const std::string& file, std::string key) : file_(file), key_(std::move(key)) {}

  [[noreturn]] void fail(const std::string& what, const std::string& field = {}) const {
    throw Error(what, FileLocation{file_, 0,
                                   field.empty()  ? key_
                                   : key_.empty() ? field
                                                  : key_ + "." + field});
  }

  std::string text(const Json& value, const std::string& field) const {
    if (!value.is_string()) fail("must be a text", field);
    return value.get<std::string>();
  }

  double number(const Json& value, const std::string& field) const {
    if (!value.is_number()) fail("must be a number", field);
    return value.get<double>();
  }

  const Json& object(const Json& value, const std::string& field) const {
    if (!value.is_object()) fail("must be an object", field);
    return value;
  }

 private:
  const std::string& file_;
  std::string key_;
};

SemanticLink link_from_json(const Json& json, const Reader& reader) {
  if (!json.is_object()) reader.fail("must be an object");
  if (!json.contains("class")) reader.fail("has no class");
  SemanticLink link;
  for (const auto& [key, value] : json.items()) {
    if (key == "class") {
      link.class_name = reader.text(value, key);
      if (link.class_name.empty()) reader.fail("must not be empty", key);
    } else if (key == "confidence") {
      link.confidence = reader.number(value, key);
      if (!(link.confidence >= 0 && link.confidence <= 1)) reader.fail("must be from 0 to 1", key);
    } else if (key == "geometry") {
      link.geometry = reader.object(value, key);
    } else if (key == "evidence") {
      link.evidence = reader.object(value, key);
    } else if (key == "aliases") {
      if (!value.is_array()) reader.fail("must be a list of texts", key);
      for (const Json& alias : value) link.aliases.push_back(reader.text(alias, key));
    } else if (key == "appliance") {
      link.appliance = reader.text(value, key);
    } else {
      link.extra[key] = value;
    }
  }
  return link;
}

Isometry3d pose_from_json(const Json& json, const Reader& reader, const std::string& file) {
  const std::string key = "map_from_input";
  if (!json.is_array() || json.size() != 7) reader.fail("must be [x, y, z, qx, qy, qz, qw]", key);
  std::array<double, 7> values{};
  for (size_t i = 0; i < 7; ++i) values[i] = reader.number(json[i], key);
  return pose_from_values(values, FileLocation{file, 0, key});
}

}  // namespace

Json to_json(const SemanticMap& map) {
  Json json = {{"version", kVersion}, {"frame", map.frame}};
  if (map.map_from_input) json["map_from_input"] = values_from_pose(*map.map_from_input);
  Json& links = json["links"] = Json::object();
  for (const auto& [name, link] : map.links) {
    Json& entry = links[name] = Json{{"class", link.class_name}, {"confidence", link.confidence}};
    if (!link.geometry.is_null()) entry["geometry"] = link.geometry;
    if (!link.evidence.is_null()) entry["evidence"] = link.evidence;
    if (!link.aliases.empty()) entry["aliases"] = link.aliases;
    if (!link.appliance.empty()) entry["appliance"] = link.appliance;
    for (const auto& [key, value] : link.extra.items()) entry[key] = value;
  }
  for (const auto& [key, value] : map.extra.items()) json[key] = value;
  return json;
}

SemanticMap semantic_map_from_json(const Json& json, const std::string& file) {
  const Reader reader(file, "");
  if (!json.is_object()) reader.fail("a semantic map is a JSON object");
  if (!json.contains("version")) reader.fail("has no version", "version");
  if (!json.contains("links")) reader.fail("a semantic map has links", "links");
  SemanticMap map;
  for (const auto& [key, value] : json.items()) {
    if (key == "version") {
      if (!value.is_number_integer()) reader.fail("must be a whole number", key);
      if (value.get<int64_t>() != kVersion)
        reader.fail("is " + value.dump() + "; this program reads version " + std::to_string(kVersion), key);
    } else if (key == "frame") {
      map.frame = reader.text(value, key);
    } else if (key == "map_from_input") {
      map.map_from_input = pose_from_json(value, reader, file);
    } else if (key == "links") {
      for (const auto& [name, link] : reader.object(value, key).items())
        map.links[name] = link_from_json(link, Reader(file, "links." + name));
    } else {
      map.extra[key] = value;
    }
  }
  return map;
}

SemanticMap read_semantic_map(const std::filesystem::path& path) {
  return semantic_map_from_json(read_json(path), path.string());
}

void write_semantic_map(const SemanticMap& map, const std::filesystem::path& path) {
  write_json(path, to_json(map));
}

std::filesystem::path sidecar_path(const std::filesystem::path& urdf) {
  return std::filesystem::path(urdf).replace_extension(".semantic.json");
}

}  // namespace loci::mapping
