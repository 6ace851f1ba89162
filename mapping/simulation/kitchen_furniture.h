#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/simulation/kitchen_builder.h"

namespace loci::mapping::kitchen {

/// A doorway or window in a wall.
struct WallHole {
  size_t wall = 0;  ///< index into the room's corners: it begins there
  double from = 0, width = 0.9;
  double bottom = 0, top = 2.03;
  const char* kind() const { return bottom > 0 ? "window" : "doorway"; }
};

/// A floor plan with right angles: corners counter-clockwise; wall i goes from corner i to the next.
struct Room {
  std::vector<Vector2d> corners;
  std::vector<WallHole> holes = {};
  double height = 2.5;

  Vector2d corner(size_t i) const { return corners[i % corners.size()]; }
  Vector2d direction(size_t wall) const { return (corner(wall + 1) - corner(wall)).normalized(); }
  Vector2d normal(size_t wall) const;  ///< into the room
  double length(size_t wall) const { return (corner(wall + 1) - corner(wall)).norm(); }
  /// The frame of a row of furniture that is `depth` deep and whose left end, as seen from the room, is `end`
  /// along the wall: x into the room, origin in the front plane at the floor.
  Isometry3d row(size_t wall, double end, double depth) const;
};

/// A front, fronts or nothing between two heights of a unit.
struct Cell {
  enum class Kind { drawer, door, doors, flap_up, flap_down, panel, open };
  Kind kind = Kind::door;
  double share = 1;  ///< of the unit's height
  std::optional<Grip> grip = {};
  std::optional<Rgba> color = {};
};

/// A column of a row of furniture; cells from bottom to top.
struct Unit {
  double width = 0.6;
  std::vector<Cell> cells = {};
  bool stretches = true;  ///< to fill the row; appliances do not
};

double total_width(const std::vector<Unit>& units);

/// A row of cabinets.
struct Row {
  double depth = 0.58, bottom = 0, top = 0.87;
  double plinth = 0.1;
  bool has_top_board = false;  ///< where no worktop lies on it
  GripHeight grip_height = GripHeight::high;
};

/// What of a kitchen's look is drawn once, and what it is furnished with.
class Furnisher {
 public:
  Furnisher(Builder& builder, const Random& random);

  double uniform(double low, double high) { return random_.uniform(low, high); }
  double depth() const { return depth_; }  ///< of base cabinets
  Row base_row() const;

  void room(const Room& room);
  /// Draws base units until they fill a length; the first of `fixed` are among them.
  std::vector<Unit> base_units(double length, const std::vector<Unit>& fixed);
  std::vector<Unit> drawer_units(size_t columns, double length);
  std::vector<Unit> upper_units(double length);
  Unit oven();
  Unit dishwasher();
  Unit sink();
  Unit refrigerator();
  Unit oven_tower();
  Unit pantry(Grip grip);

  /// Puts units side by side from the frame's origin to the right.
  void row(const Isometry3d& room_from_row, std::vector<Unit> units, double length, const Row& row);
  /// A worktop along neighbouring walls: from `begin` on the first of them to `end` on the last, m from
  /// where the wall begins.
  void worktop(const Room& room, size_t first_wall, size_t walls, double begin, double end);
  /// A slab on a row that stands free.
  void slab(const std::string& kind, const Isometry3d& room_from_row, double length, double depth,
            double overhang);
  /// Base cabinets and their worktop along neighbouring walls.
  void base_run(const Room& room, size_t first_wall, size_t walls, double begin, double end);
  void upper_run(const Room& room, size_t wall, double begin, double end);
  void wall_shelf(const Room& room, size_t wall, double begin, double end, double height);
  void tall_run(const Room& room, size_t wall, double begin, std::vector<Unit> units);

  void table(const Vector2d& centre, double yaw, const Vector2d& size, double height);
  void chair(const Vector2d& centre, double yaw);
  void stool(const Vector2d& centre);
  void radiator(const Room& room, size_t wall, double middle);
  /// Kettles, bottles, boxes: what may not be taken for furniture.
  void clutter(const Isometry3d& room_from_row, double length, double depth, double height);

 private:
  FrontStyle drawn_style();
  Rgba shade(const Rgba& color, double spread);
  void column(const Isometry3d& room_from_row, double left, const Unit& unit, const Row& row);
  void cell(const std::string& cabinet, const Cell& cell, double width, double bottom, double top,
            const Row& row);

  Builder& builder_;
  Random random_;
  double worktop_height_, worktop_thickness_, depth_;
  Rgba front_color_, worktop_color_, wood_color_;
  FrontStyle style_;
  Grip grip_;
};

}  // namespace loci::mapping::kitchen
