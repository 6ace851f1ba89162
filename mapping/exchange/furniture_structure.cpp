#include "mapping/exchange/furniture_structure.h"

#include <algorithm>

#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/furniture_links.h"

namespace loci::mapping {
namespace {

bool is_fixture(const SemanticLink& link) {
  return (link.class_name == "handle" || link.class_name == "knob") && link.geometry.contains("centre");
}

/// The moving link or static front that a fixture's link hangs on.
std::string front_above(const std::string& name, const World& world, const std::vector<KnownFront>& fronts) {
  for (const Joint* joint = world.parent_joint(name); joint != nullptr;
       joint = world.parent_joint(joint->parent)) {
    if (std::ranges::any_of(fronts, [&](const KnownFront& front) { return front.name == joint->parent; }))
      return joint->parent;
    if (joint->type != JointType::fixed) break;
  }
  return {};
}

JointEstimate joint_of(const Json& json) {
  JointEstimate joint;
  joint.type = json.at("type") == "prismatic" ? ArticulationType::prismatic : ArticulationType::revolute;
  joint.axis = vector_from_json(json.at("axis"));
  joint.origin = vector_from_json(json.at("origin"));
  joint.lower = json.at("limits").at(0).get<double>();
  joint.upper = json.at("limits").at(1).get<double>();
  return joint;
}

KnownFront front_of(const Json& json) {
  KnownFront known;
  known.name = json.at("child").get<std::string>();
  known.region = json.value("region", "");
  known.main = json.value("visible_when_closed", true);
  Front& front = known.front;
  front.name = known.name;
  front.class_name = json.at("kind").get<std::string>();
  const Json& face = json.at("front");
  front.centre = vector_from_json(face.at("centre"));
  front.normal = vector_from_json(face.at("normal"));
  front.up = vector_from_json(face.at("up"));
  front.width = face.at("width").get<double>();
  front.height = face.at("height").get<double>();
  front.joint = joint_of(json);
  return known;
}

KnownFixture fixture_of(const Json& json) {
  KnownFixture known;
  known.name = json.at("link").get<std::string>();
  known.region = json.value("region", "");
  known.front = json.value("front_link", "");
  known.main = json.value("visible_when_closed", true);
  // A mapper sees the bar, not the middle of bar and posts.
  known.fixture.centre = vector_from_json(json.at(json.contains("bar_centre") ? "bar_centre" : "centre"));
  known.fixture.axis = vector_from_json(json.at("axis"));
  known.fixture.length = json.value("length", 0.0);
  return known;
}

}  // namespace

void add_sidecar_furniture(const World& world, const SemanticMap& sidecar, const std::string& file,
                           MapStructure& structure) {
  for (Front& front : fronts_of(world, sidecar)) {
    KnownFront known;
    known.name = front_link(front.name, sidecar).value_or(front.name);
    // A panel that does not open may be found, and need not be.
    known.main = front.joint && front.joint->type != ArticulationType::rigid;
    known.front = std::move(front);
    structure.fronts.push_back(std::move(known));
  }
  for (const auto& [name, link] : sidecar.links) {
    if (!is_fixture(link)) continue;
    try {
      KnownFixture known;
      known.name = name;
      known.front = front_above(name, world, structure.fronts);
      known.fixture.kind = link.class_name == "knob" ? Fixture::Kind::knob : Fixture::Kind::handle;
      known.fixture.centre = vector_from_json(link.geometry.at("centre"));
      known.fixture.axis = vector_from_json(link.geometry.at("axis"));
      known.fixture.length = link.geometry.at("length").get<double>();
      structure.fixtures.push_back(std::move(known));
    } catch (const Json::exception&) {
      throw Error("the geometry of a link lacks what its class needs", {file, 0, name});
    }
  }
}

void add_truth_furniture(const Json& truth, const std::string& file, MapStructure& structure) {
  try {
    for (const Json& joint : truth.value("joints", Json::array())) {
      const std::string kind = joint.value("kind", "");
      if ((kind == "drawer" || kind == "door" || kind == "flap") && joint.contains("front"))
        structure.fronts.push_back(front_of(joint));
    }
    for (const Json& handle : truth.value("handles", Json::array()))
      structure.fixtures.push_back(fixture_of(handle));
    for (const auto& [key, value] : truth.items())
      if (const size_t end = key.rfind("_bounds"); end != std::string::npos && end > 0)
        structure.regions[key.substr(0, end)] = {vector_from_json(value.at("min")),
                                                 vector_from_json(value.at("max"))};
  } catch (const Json::exception& error) {
    throw Error(std::string("a handle or joint of the truth cannot be read (") + error.what() + ")",
                {file, 0, ""});
  }
}

void add_measured_fronts(const Json& truth, const std::string& file, MapStructure& structure) {
  structure.only_listed_faces = true;
  try {
    for (const Json& json : truth.at("fronts")) {
      KnownFront known;
      known.name = json.at("name").get<std::string>();
      Front& front = known.front;
      front.name = known.name;
      front.centre = vector_from_json(json.at("centre"));
      front.normal = vector_from_json(json.at("normal")).normalized();
      front.up = vector_from_json(json.at("up")).normalized();
      front.width = json.at("width").get<double>();
      front.height = json.at("height").get<double>();
      if (json.contains("handle")) {
        const Json& handle = json.at("handle");
        KnownFixture fixture;
        fixture.name = handle.at("name").get<std::string>();
        fixture.front = known.name;
        fixture.fixture.centre = vector_from_json(handle.at("centre"));
        fixture.fixture.axis = vector_from_json(handle.at("axis"));
        fixture.fixture.length = handle.value("length", 0.0);
        fixture.tolerance = json.value("tolerance", 0.0);
        structure.fixtures.push_back(std::move(fixture));
      }
      structure.fronts.push_back(std::move(known));
    }
  } catch (const Json::exception& error) {
    throw Error(std::string("a front of the truth cannot be read (") + error.what() + ")", {file, 0, ""});
  }
}

}  // namespace loci::mapping
