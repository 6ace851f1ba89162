#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/text/json.h"
#include "mapping/simulation/kitchen.h"

namespace loci::mapping::kitchen {

/// What a front is opened by. A rail is a bar over its whole width.
enum class Grip { none, bar, knob, rail };

/// Where a front has its hinge, if it has one.
enum class Opening { fixed, drawer, hinged_left, hinged_right, hinged_top, hinged_bottom };

/// Where on a door the grip is: high on base cabinets, low on those that hang, in the middle of tall ones.
enum class GripHeight { low, middle, high };

struct FrontStyle {
  Rgba color = Rgba::Ones();
  double thickness = 0.02;
  double seam = 0.003;       ///< between neighbours
  double bar_length = 0.16;  ///< of bars that are no rails
  double bar_radius = 0.006;
  double bar_distance = 0.03;  ///< of the bar's axis from the face
  double knob_radius = 0.015;
  bool knob_is_ball = true;  ///< else a disc
  double edge = 0.05;        ///< from the grip to the edge that opens
};

/// A rectangle of a cabinet's front plane, m: y to the right as seen from the room, z up.
struct FrontCell {
  double left = 0, right = 0, bottom = 0, top = 0;
};

/// Puts links together, and says what they are. Frames of furniture: x out of its front, y to the right of
/// somebody who stands before it, z up.
class Builder {
 public:
  Builder(const std::string& name, const Isometry3d& map_from_room);

  /// A new link KIND_N, fixed to `parent`.
  std::string link(const std::string& kind, const std::string& parent, const Isometry3d& parent_from_link);
  void box(const std::string& link, const Vector3d& low, const Vector3d& high, const Rgba& color);
  void rod(const std::string& link, const Vector3d& from, const Vector3d& to, double radius,
           const Rgba& color);
  void ball(const std::string& link, const Vector3d& centre, double radius, const Rgba& color);

  /// The board, joint and grip of a front in the plane x = 0 of a cabinet that is `depth` deep.
  void front(const std::string& cabinet, const FrontCell& cell, Opening opening, Grip grip,
             GripHeight grip_height, const FrontStyle& style, double depth);

  void describe_floor(const std::string& link, const std::vector<Vector2d>& outline);
  /// A level surface that objects can stand on; the outline is in the link's frame.
  void describe_support(const std::string& link, const std::string& class_name,
                        const std::vector<Vector2d>& outline, double height);
  /// `normal` (into the room) and corners are in the link's frame; openings with centre, width, height, kind.
  void describe_wall(const std::string& link, const Vector3d& normal, const std::vector<Vector3d>& corners,
                     const Json& openings);
  Vector3d in_map(const std::string& link, const Vector3d& point) const;

  DrawnKitchen take() { return std::move(kitchen_); }

 private:
  void add_link(const std::string& name, const std::string& parent, const Isometry3d& parent_from_link);
  void add_shape(const std::string& link, const Isometry3d& link_from_shape, const Geometry& shape,
                 const Rgba& color);
  /// Sides and back of a drawer belong to its link, the bottom is a link of its own, as in explored maps.
  void drawer_box(const std::string& drawer, const Vector2d& size, double depth, double thickness);
  void grip(const std::string& front, const Vector3d& face, const Vector2d& size, Opening opening, Grip grip,
            GripHeight height, const FrontStyle& style);
  void bar(const std::string& front, const Vector3d& foot, const Vector3d& along, double length,
           const FrontStyle& style);
  void knob(const std::string& front, const Vector3d& foot, const FrontStyle& style);
  SemanticLink& describe(const std::string& link, const std::string& class_name, const Json& geometry);

  DrawnKitchen kitchen_;
  std::map<std::string, int> counts_;
  std::map<std::string, Isometry3d> map_from_link_;
};

}  // namespace loci::mapping::kitchen
