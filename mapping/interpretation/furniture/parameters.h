#pragma once

namespace loci::mapping {

/// Sizes that scans do not show, and the order of names.
struct FurnitureParameters {
  double panel_m = 0.02;               ///< thickness of fronts
  double board_m = 0.012;              ///< of a drawer's sides and bottom
  double runner_m = 0.019;             ///< between a drawer's side and the edge of its front
  double min_drawer_m = 0.05;          ///< depth of the shallowest drawer
  double post_inset = 0.15;            ///< of a bar's length, position of its posts
  double wall_m = 0.05;                ///< thickness of walls, floor and ceiling
  double strip_m = 0.05;               ///< of the boxes that approximate a polygon
  double min_joint_probability = 0.5;  ///< without which no joint is claimed
  double row_m = 0.3;                  ///< faces less far behind each other are one row of furniture
  double column_m = 0.1;               ///< between the left edges of fronts of one column
  double wood_density = 600;           ///< kg/m³
  double steel_density = 7800;         ///< kg/m³
};
inline constexpr FurnitureParameters kFurniture;

}  // namespace loci::mapping
