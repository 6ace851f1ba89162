#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "mapping/base/math/polygon.h"
#include "mapping/base/math/pose.h"
#include "mapping/registration/surfels.h"
#include "mapping/world/free_standing.h"
#include "mapping/world/semantic_map.h"

namespace loci::mapping {

/// What a map says of its room: walls, and the supports that bound furniture. Map frame.
struct MapOutlines {
  struct Support {
    std::string name, class_name;
    std::vector<Vector2d> outline;
    double height = 0;
    bool at_wall = false;
  };
  std::vector<WallRectangle> walls;
  std::vector<Support> supports;
};
MapOutlines outlines_of(const SemanticMap& semantics);

/// A free-standing piece of furniture as surfels.
struct Piece {
  std::string name, class_name;  ///< of its support in the map; empty names are given later
  std::vector<uint32_t> surfels;
  Eigen::AlignedBox3f box;
  std::vector<Vector2d> outline;   ///< smallest rectangle around it on the floor plan
  std::vector<std::string> links;  ///< of the map, that are fixed to the floor and belong to it
};

/// Segments the chosen surfels that are neither floor nor wall into connected components and returns those
/// that can stand free: not hanging, not as large as a row of cabinets, not built in along a wall. The tops
/// of the map's supports bound components, so that a chair that is pushed below a table is one of its own.
std::vector<Piece> free_standing_pieces(const registration::Surfels& surface,
                                        const std::vector<uint8_t>& chosen, const MapOutlines& map);

/// All components, standing free or not.
std::vector<Piece> components_of(const registration::Surfels& surface, const std::vector<uint8_t>& chosen,
                                 const MapOutlines& map);

/// Gives names to pieces: that of their support in the map, that of a piece in the sidecar's `extra.pieces`
/// at the same place, otherwise a new one by class.
void name_pieces(const registration::Surfels& surface, const SemanticMap& semantics,
                 std::vector<Piece>& pieces);

/// Class by shape: "chair" (a seat with a back), "stool" (a seat), otherwise "piece".
std::string shape_class(const registration::Surfels& surface, const Piece& piece);

/// The smallest rectangle around points of the floor plan.
std::vector<Vector2d> rectangle_around(const std::vector<Vector2d>& points);

/// Whether a point is in a polygon grown by `margin`.
bool inside(const Polygon& polygon, const Vector2d& point, double margin);

}  // namespace loci::mapping
