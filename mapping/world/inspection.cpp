#include "mapping/world/inspection.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

const char* kind_of(const Geometry& geometry) {
  constexpr std::array<const char*, 4> kKinds = {"box", "cylinder", "sphere", "mesh"};
  static_assert(std::variant_size_v<Geometry> == kKinds.size());
  return kKinds[geometry.index()];
}

/// "gazebo" of "<gazebo reference=…".
std::string element_name(const std::string& xml) {
  const size_t end = xml.find_first_of(" \t\r\n/>");
  return xml.starts_with('<') && end != std::string::npos ? xml.substr(1, end - 1) : "text";
}

void count_extensions(const World& world, std::map<std::string, size_t>& counts) {
  const auto count = [&](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) ++counts[element_name(text)];
  };
  count(world.extensions);
  for (const Joint& joint : world.joints) count(joint.extensions);
  for (const Link& link : world.links) {
    count(link.extensions);
    for (const Visual& visual : link.visuals) count(visual.extensions);
    for (const Collision& collision : link.collisions) count(collision.extensions);
  }
}

/// "3 fixed, 1 revolute".
std::string list(const std::map<std::string, size_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text;
}

}  // namespace

WorldInspection inspect(const World& world, const MeshSearch& search, Warnings& warnings) {
  WorldInspection result;
  result.name = world.name;
  result.root = world.root;
  result.links = world.links.size();
  result.joints = world.joints.size();
  for (const Joint& joint : world.joints) ++result.joints_by_type[joint_type_name(joint.type)];
  const std::vector<Isometry3d> root_from = root_from_links(world, {});
  std::map<std::string, TriangleMesh> loaded;
  for (size_t i = 0; i < world.links.size(); ++i) {
    const Link& link = world.links[i];
    result.collisions += link.collisions.size();
    if (link.inertial) {
      result.mass += link.inertial->mass;
      ++result.links_with_mass;
    }
    for (const Visual& visual : link.visuals) {
      ++result.visuals_by_kind[kind_of(visual.geometry)];
      const Mesh* mesh = std::get_if<Mesh>(&visual.geometry);
      const std::string key =
          mesh ? fmt::format("{} {} {} {}", mesh->uri, mesh->scale.x(), mesh->scale.y(), mesh->scale.z())
               : "";
      if (!mesh || !loaded.contains(key)) {
        loaded[key] = triangulate(visual.geometry, search, warnings);
        if (mesh && loaded[key].triangles.empty()) result.missing_meshes.push_back(mesh->uri);
      }
      const TriangleMesh& triangles = loaded[key];
      result.triangles += triangles.triangles.size();
      const Isometry3d root_from_visual = root_from[i] * visual.link_from_visual;
      for (const Eigen::Vector3f& vertex : triangles.vertices)
        result.bounds.extend(Vector3d(root_from_visual * vertex.cast<double>()));
    }
  }
  result.contacts = closed_contacts(world);
  count_extensions(world, result.extensions);
  return result;
}

void require_metres(const Eigen::AlignedBox3d& bounds, const std::string& file) {
  // Of halls, and of a flat in centimetres or a cupboard in millimetres.
  constexpr double kMaxHeight = 100, kMaxSide = 1000;
  if (bounds.isEmpty()) return;
  const Vector3d size = bounds.sizes();
  if (size.z() < kMaxHeight && std::max(size.x(), size.y()) < kMaxSide) return;
  throw Error(fmt::format("the world measures {:.0f} x {:.0f} x {:.0f} m: it seems to be in millimetres or "
                          "centimetres",
                          size.x(), size.y(), size.z()),
              {file, 0, {}}, "URDF is in metres: scale it, meshes by the attribute 'scale' of <mesh>");
}

void inspect_sidecar(const SemanticMap& sidecar, const World& world, WorldInspection& inspection,
                     Warnings& warnings) {
  inspection.classes.emplace();
  std::vector<std::string> names;
  for (const Link& link : world.links) names.push_back(link.name);
  const std::set<std::string> known(names.begin(), names.end());
  for (const auto& [name, link] : sidecar.links) {
    ++(*inspection.classes)[link.class_name];
    if (known.contains(name)) continue;
    const std::string hint = did_you_mean(name, names);
    warnings.add("the sidecar speaks of link '" + name + "', which the map does not have" +
                 (hint.empty() ? "" : "; " + hint));
  }
}

std::string WorldInspection::summary() const {
  return fmt::format("{}: {} link{}, {} joint{}, {} triangle{}", name, links, links == 1 ? "" : "s", joints,
                     joints == 1 ? "" : "s", triangles, triangles == 1 ? "" : "s");
}

std::string WorldInspection::report() const {
  std::string text;
  const auto line = [&](const char* title, const std::string& value) {
    text += fmt::format("{:<12}{}\n", title, value);
  };
  line("name", name);
  line("links", fmt::format("{}, root '{}'", links, root));
  line("joints", fmt::format("{}{}", joints, joints ? " (" + list(joints_by_type) + ")" : ""));
  line("visuals", visuals_by_kind.empty() ? "none" : list(visuals_by_kind));
  line("collisions", std::to_string(collisions));
  line("contacts", contacts.empty() ? "none in the closed state"
                                    : fmt::format("{} in the closed state, the deepest {:.1f} mm ({}, {})",
                                                  contacts.size(), 1000 * contacts[0].depth,
                                                  contacts[0].first, contacts[0].second));
  line("triangles", std::to_string(triangles));
  if (!missing_meshes.empty()) line("missing", fmt::format("{} meshes", missing_meshes.size()));
  line("mass", links_with_mass ? fmt::format("{:.6g} kg in {} links", mass, links_with_mass) : "none stated");
  if (bounds.isEmpty())
    line("bounds", "nothing visible");
  else
    line("bounds",
         fmt::format("{:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f} m", bounds.min().x(), bounds.min().y(),
                     bounds.min().z(), bounds.max().x(), bounds.max().y(), bounds.max().z()));
  if (!extensions.empty()) line("extensions", list(extensions));
  if (classes) line("classes", classes->empty() ? "none" : list(*classes));
  text.pop_back();
  return text;
}

Json WorldInspection::to_json() const {
  Json json = {{"name", name},
               {"root", root},
               {"links", links},
               {"joints", joints},
               {"joints_by_type", joints_by_type},
               {"visuals_by_kind", visuals_by_kind},
               {"collisions", collisions},
               {"triangles", triangles},
               {"missing_meshes", missing_meshes},
               {"mass_kg", links_with_mass ? Json(mass) : Json()}};
  json["bounds"] = bounds.isEmpty() ? Json()
                                    : Json{{"min", json_from_vector(bounds.min())},
                                           {"max", json_from_vector(bounds.max())}};
  Json& touching = json["closed_contacts"] = Json::array();
  for (const Contact& contact : contacts)
    touching.push_back({{"links", {contact.first, contact.second}}, {"depth_m", contact.depth}});
  json["extensions"] = extensions;
  if (classes) json["classes"] = *classes;
  return json;
}

}  // namespace loci::mapping
