#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/json.h"
#include "mapping/interpretation/furniture_links.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

constexpr std::string_view kSuffix = "_front";

bool is_front(const SemanticLink& link) {
  return link.class_name == "front" || link.class_name == "drawer" || link.class_name == "door" ||
         link.class_name == "flap";
}

Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::string base_name(const std::string& link) {
  return link.ends_with(kSuffix) && link.size() > kSuffix.size()
             ? link.substr(0, link.size() - kSuffix.size())
             : link;
}

class FrontReader {
 public:
  FrontReader(const World& world, const SemanticMap& semantics)
      : world_(world), semantics_(semantics), map_from_link_(root_from_links(world, {})) {}

  Front read(const std::string& name, const SemanticLink& link) const {
    Front front;
    front.name = base_name(name);
    front.class_name = link.class_name;
    front.centre = vector_of(link.geometry.at("centre"));
    front.normal = vector_of(link.geometry.at("normal"));
    front.up = vector_of(link.geometry.at("up"));
    front.width = link.geometry.at("width").get<double>();
    front.height = link.geometry.at("height").get<double>();
    front.depth = link.geometry.value("depth", front.depth);
    front.depth_measured = link.extra.value("depth_measured", false);
    front.appliance = link.appliance;
    front.confidence = link.confidence;
    if (link.evidence.is_object()) front.evidence = link.evidence;
    front.joint = joint_of(name, link);
    front.fixture = fixture_of(name, front);
    return front;
  }

 private:
  /// The joint that moves a link; nullptr when nothing does.
  const Joint* moving_joint(const std::string& name) const {
    const Joint* joint = world_.parent_joint(name);
    while (joint != nullptr && joint->type == JointType::fixed) joint = world_.parent_joint(joint->parent);
    return joint;
  }

  std::optional<JointEstimate> joint_of(const std::string& name, const SemanticLink& link) const {
    if (world_.find_link(name) == nullptr) return std::nullopt;  // a sidecar without its world
    const Joint* moving = moving_joint(name);
    JointEstimate estimate;
    if (moving != nullptr) {
      const Isometry3d& map_from_joint = map_from_link_[world_.link_index(moving->child)];
      estimate.type = moving->type == JointType::prismatic ? JointEstimate::Type::prismatic
                                                           : JointEstimate::Type::revolute;
      estimate.axis = map_from_joint.linear() * moving->axis.normalized();
      if (estimate.type == JointEstimate::Type::revolute) estimate.origin = map_from_joint.translation();
      if (moving->limits) {
        estimate.lower = moving->limits->lower;
        estimate.upper = moving->limits->upper;
      }
    } else if (!link.extra.contains("joint_evidence")) {
      return std::nullopt;
    }
    estimate.evidence = link.extra.value("joint_evidence", estimate.evidence);
    const Json said = link.extra.value("joint_probabilities", Json::object());
    estimate.probabilities = {};
    for (size_t i = 0; i < estimate.probabilities.size(); ++i) {
      const auto type = static_cast<JointEstimate::Type>(i);
      estimate.probabilities[i] =
          said.empty() ? (type == estimate.type ? 1 : 0) : said.value(joint_estimate_type_name(type), 0.0);
    }
    const Json uncertainty = link.extra.value("joint_uncertainty", Json::object());
    estimate.axis_sd_deg = uncertainty.value("axis_sd_deg", 0.0);
    estimate.origin_sd_m = uncertainty.value("origin_sd_m", 0.0);
    return estimate;
  }

  /// The first handle or knob that is fixed to a link, directly or through others.
  std::optional<Fixture> fixture_of(const std::string& name, const Front& front) const {
    std::vector<std::string> open = {name};
    for (size_t i = 0; i < open.size(); ++i) {
      const auto found = semantics_.links.find(open[i]);
      if (found != semantics_.links.end() &&
          (found->second.class_name == "handle" || found->second.class_name == "knob"))
        return read_fixture(found->second, front);
      for (const Joint& joint : world_.joints)
        if (joint.parent == open[i] && joint.type == JointType::fixed) open.push_back(joint.child);
    }
    return std::nullopt;
  }

  static Fixture read_fixture(const SemanticLink& link, const Front& front) {
    Fixture fixture;
    fixture.kind = link.class_name == "knob" ? Fixture::Kind::knob : Fixture::Kind::handle;
    fixture.centre = vector_of(link.geometry.at("centre"));
    fixture.axis = link.geometry.contains("axis") ? vector_of(link.geometry.at("axis")) : front.normal;
    fixture.length = link.geometry.value("length", 0.0);
    fixture.radius = link.geometry.value("radius", fixture.radius);
    fixture.protrusion = link.geometry.value("protrusion", front.normal.dot(fixture.centre - front.centre));
    fixture.confidence = link.confidence;
    if (link.evidence.is_object()) fixture.evidence = link.evidence;
    return fixture;
  }

  const World& world_;
  const SemanticMap& semantics_;
  std::vector<Isometry3d> map_from_link_;
};

}  // namespace

std::optional<std::string> front_link(const std::string& name, const SemanticMap& semantics) {
  for (const std::string& link : {name + std::string(kSuffix), name}) {
    const auto found = semantics.links.find(link);
    if (found != semantics.links.end() && is_front(found->second)) return link;
  }
  return std::nullopt;
}

std::vector<Front> fronts_of(const World& world, const SemanticMap& semantics) {
  const FrontReader reader(world, semantics);
  std::vector<Front> fronts;
  for (const auto& [name, link] : semantics.links) {
    if (!is_front(link) || !link.geometry.contains("centre")) continue;
    try {
      fronts.push_back(reader.read(name, link));
    } catch (const Json::exception&) {
      throw Error("the geometry or joint of the front '" + name +
                  "' in the sidecar lacks what its class needs");
    }
  }
  return fronts;
}

}  // namespace loci::mapping
