#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"

namespace loci::mapping {

/// Of what is found with less, the report says that it is unsure.
inline constexpr double kUnsureConfidence = 0.6;

/// Drawn in photos where nothing was seen, BGR.
inline const cv::Scalar kUnseenColor(235, 235, 235);

/// Fronts in one vertical plane, as someone sees them who stands before it.
struct FurnitureRun {
  Vector3d normal = Vector3d::UnitX();
  double offset = 0;          ///< normal · p of the plane, m
  std::vector<Front> fronts;  ///< from left to right, top to bottom
};

/// Where a door or a flap is hinged, as someone sees it who stands before it.
enum class HingeSide { left, right, below, above };
HingeSide hinge_side(const Front& front);  ///< of one with a revolute joint

/// The runs of a map's furniture, widest first. Fronts less than 10 cm behind each other are one run.
std::vector<FurnitureRun> furniture_runs(const InterpretedMap& map);

/// One run drawn to scale, in centimetres, over the map's photos of it: fronts with their names, sizes and
/// handles, the floor and the supports above them. Lines of doors and flaps meet at the hinge, drawers have
/// an arrow; what was found with little confidence is dashed.
std::string elevation_svg(const InterpretedMap& map, const FurnitureRun& run);

/// Whether views from above show a link by its outline: fronts and what is inside the furniture are left out.
bool is_seen_from_above(const SemanticLink& link);

/// The room from above with dimensions along its longest wall and across: walls, supports with their heights,
/// fronts with the way they open.
std::string plan_svg(const InterpretedMap& map);

}  // namespace loci::mapping
