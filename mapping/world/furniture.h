#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/text/json.h"

namespace loci::mapping {

/// What a front is opened by: a bar (line model) or a knob (circle model). Map frame, all joints at 0.
struct Fixture {
  enum class Kind { handle, knob };
  Kind kind = Kind::handle;
  Vector3d centre = Vector3d::Zero();  ///< of the bar or the knob's head
  Vector3d axis = Vector3d::UnitZ();   ///< along the bar; out of the front for a knob
  double length = 0;                   ///< of the bar; a knob's diameter
  double radius = 0.006;               ///< of the bar; a knob's half diameter
  double protrusion = 0.03;            ///< of the centre before the front
  double confidence = 0;
  Json evidence = Json::object();
};

enum class ArticulationType { rigid, prismatic, revolute };
const char* to_text(ArticulationType type);

/// The joint of a moving part. Probabilities of the types sum to one.
struct JointEstimate {
  ArticulationType type = ArticulationType::rigid;
  std::array<double, 3> probabilities{1, 0, 0};  ///< by ArticulationType
  Vector3d axis = Vector3d::UnitX();   ///< map frame; prismatic: opens along +; revolute: opens by right hand
  Vector3d origin = Vector3d::Zero();  ///< revolute: a point of the hinge
  double lower = 0, upper = 0;         ///< metres or radians; 0 = closed
  double axis_sd_deg = 0, origin_sd_m = 0;  ///< uncertainty
  std::string evidence = "prior";           ///< prior, interaction, difference, track
  /// What shows the hinge's side of a door without fixture: "pair", or "assumed"; empty for other joints.
  std::string hinge_from;
};

/// The visible face of a drawer, door or flap: a rectangle. Map frame, all joints at 0.
struct Front {
  std::string name;                  ///< base name: "drawer_3"; empty until named
  std::string class_name = "front";  ///< front, drawer, door, flap
  Vector3d centre = Vector3d::Zero();
  Vector3d normal = Vector3d::UnitX();  ///< out of the furniture
  Vector3d up = Vector3d::UnitZ();
  double width = 0, height = 0;
  double depth = 0.5;  ///< of what is behind it, as far as known or assumed
  bool depth_measured = false;
  std::optional<Fixture> fixture;
  std::optional<JointEstimate> joint;  ///< unset: it is not known to move
  std::string appliance;               ///< fridge, oven, dishwasher, …; empty = none
  double confidence = 0;
  Json evidence = Json::object();

  /// To the right as seen by someone who stands before it.
  Vector3d right() const { return up.cross(normal); }

  /// Whether it is opened by a bar that is rather level than upright.
  bool has_level_bar() const {
    return fixture && fixture->kind == Fixture::Kind::handle &&
           std::abs(fixture->axis.dot(right())) > std::sqrt(0.5);
  }
};

}  // namespace loci::mapping
