#include "mapping/simulation/kitchen_furniture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mapping/base/math/math.h"
#include "mapping/base/math/shuffle.h"
#include "mapping/sensor/laser.h"
#include "mapping/simulation/household_shapes.h"

namespace loci::mapping::kitchen {
namespace {

const Rgba kWall(0.88F, 0.87F, 0.83F, 1), kCarcass(0.82F, 0.79F, 0.72F, 1), kPlinth(0.22F, 0.22F, 0.23F, 1),
    kBlack(0.07F, 0.07F, 0.08F, 1), kMetal(0.7F, 0.71F, 0.73F, 1), kFloor(0.55F, 0.45F, 0.36F, 1),
    kRadiator(0.93F, 0.93F, 0.92F, 1);
constexpr double kWallThickness = 0.1, kPanel = 0.018;
/// Between two rows that meet in a corner, so that drawers pass the grips of the other row.
constexpr double kCornerFiller = 0.07;
/// Between the back of furniture and its wall.
constexpr double kWallGap = 0.004;

Isometry3d pose(const Vector2d& position, double yaw) {
  return map_from_base({position.x(), position.y(), yaw});
}

double turn_of(const Vector2d& before, const Vector2d& after) {
  return before.x() * after.y() - before.y() * after.x();
}

std::vector<Vector2d> rectangle(const Vector2d& low, const Vector2d& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

}  // namespace

double total_width(const std::vector<Unit>& units) {
  return std::accumulate(units.begin(), units.end(), 0.0,
                         [](double sum, const Unit& unit) { return sum + unit.width; });
}

Vector2d Room::normal(size_t wall) const {
  const Vector2d along = direction(wall);
  return {-along.y(), along.x()};
}

Isometry3d Room::row(size_t wall, double end, double depth) const {
  const Vector2d out = normal(wall);
  return pose(corner(wall) + direction(wall) * end + out * (depth + kWallGap), std::atan2(out.y(), out.x()));
}

Furnisher::Furnisher(Builder& builder, const Random& random)
    : builder_(builder),
      random_(random),
      worktop_height_(uniform(0.86, 0.95)),
      worktop_thickness_(uniform(0.02, 0.045)),
      depth_(uniform(0.54, 0.6)),
      front_color_(household::chance(random_, 0.6)
                       ? household::drawn_color(random_, {20, 60}, {0, 0.15}, {0.6, 0.95})
                       : household::drawn_color(random_, {0, 360}, {0.1, 0.5}, {0.3, 0.8})),
      worktop_color_(household::drawn_color(random_, {15, 45}, {0, 0.5}, {0.2, 0.75})),
      wood_color_(household::drawn_color(random_, {20, 35}, {0.4, 0.6}, {0.35, 0.7})),
      grip_(std::array{Grip::bar, Grip::bar, Grip::knob, Grip::rail}[random_.index(4)]) {
  style_ = drawn_style();
}

FrontStyle Furnisher::drawn_style() {
  FrontStyle style;
  style.thickness = uniform(0.016, 0.022);
  style.seam = uniform(0.002, 0.004);
  style.bar_length = uniform(0.11, 0.26);
  style.bar_radius = uniform(0.005, 0.007);
  style.bar_distance = uniform(0.025, 0.045);
  style.knob_radius = uniform(0.0125, 0.018);
  style.knob_is_ball = household::chance(random_, 0.5);
  style.edge = uniform(0.04, 0.065);
  return style;
}

Rgba Furnisher::shade(const Rgba& color, double spread) {
  Rgba shaded = color + Rgba::Constant(static_cast<float>(uniform(-spread, spread)));
  return shaded.cwiseMax(0).cwiseMin(1);
}

Row Furnisher::base_row() const {
  return {.depth = depth_, .top = worktop_height_ - worktop_thickness_};
}

void Furnisher::room(const Room& room) {
  Eigen::AlignedBox2d bounds;
  for (const Vector2d& corner : room.corners) bounds.extend(corner);
  const std::string floor = builder_.link("floor", "room", Isometry3d::Identity());
  builder_.box(floor, {bounds.min().x() - 0.1, bounds.min().y() - 0.1, -0.05},
               {bounds.max().x() + 0.1, bounds.max().y() + 0.1, 0}, kFloor);
  builder_.describe_floor(floor, room.corners);
  for (size_t i = 0; i < room.corners.size(); ++i) {
    const Vector2d along = room.direction(i);
    const double length = room.length(i), yaw = std::atan2(along.y(), along.x());
    const std::string wall = builder_.link("wall", "room", pose(room.corner(i), yaw));
    // Walls close the outer corners; at inner ones of the plan (a chimney) they end behind each other.
    const bool closes = turn_of(along, room.direction((i + 1) % room.corners.size())) > 0;
    const bool follows =
        turn_of(room.direction((i + room.corners.size() - 1) % room.corners.size()), along) < 0;
    double from = follows ? kWallThickness : 0;
    const double end = length + (closes ? kWallThickness : 0);
    Json openings = Json::array();
    const auto part = [&](double begin, double finish, double low, double high) {
      if (finish - begin > 1e-3 && high - low > 1e-3)
        builder_.box(wall, {begin, -kWallThickness, low}, {finish, 0, high}, kWall);
    };
    for (const WallHole& hole : room.holes) {
      if (hole.wall != i) continue;
      part(from, hole.from, 0, room.height);
      part(hole.from, hole.from + hole.width, 0, hole.bottom);
      part(hole.from, hole.from + hole.width, hole.top, room.height);
      from = hole.from + hole.width;
      const Vector3d centre =
          builder_.in_map(wall, {hole.from + hole.width / 2, 0, (hole.bottom + hole.top) / 2});
      openings.push_back({{"kind", hole.kind()},
                          {"centre", {centre.x(), centre.y(), centre.z()}},
                          {"width", hole.width},
                          {"height", hole.top - hole.bottom}});
    }
    part(from, end, 0, room.height);
    builder_.describe_wall(wall, Vector3d::UnitY(),
                           {{0, 0, 0}, {length, 0, 0}, {length, 0, room.height}, {0, 0, room.height}},
                           openings);
  }
}

Unit Furnisher::oven() {
  return {0.6,
          {{Cell::Kind::drawer, 0.2},
           {Cell::Kind::flap_down, 0.65, Grip::bar, kBlack},
           {Cell::Kind::panel, 0.15, {}, kMetal}},
          false};
}

Unit Furnisher::dishwasher() {
  return {0.6,
          {{Cell::Kind::flap_down, 1, Grip::bar, household::chance(random_, 0.5) ? kMetal : style_.color}},
          false};
}

Unit Furnisher::sink() {
  return {uniform(0.8, 0.95), {{Cell::Kind::doors}}, true};
}

Unit Furnisher::refrigerator() {
  const Rgba color = household::chance(random_, 0.6) ? kMetal : Rgba(0.93F, 0.93F, 0.93F, 1);
  return {uniform(0.58, 0.64),
          {{Cell::Kind::door, uniform(0.6, 0.75), Grip::bar, color},
           {Cell::Kind::door, uniform(1.0, 1.2), Grip::bar, color}},
          false};
}

Unit Furnisher::oven_tower() {
  return {0.61,
          {{Cell::Kind::drawer, 0.3},
           {Cell::Kind::drawer, 0.3},
           {Cell::Kind::flap_down, 0.6, Grip::bar, kBlack},
           {Cell::Kind::panel, 0.1, {}, kMetal},
           {Cell::Kind::door, 0.65}},
          false};
}

Unit Furnisher::pantry(Grip grip) {
  if (household::chance(random_, 0.5)) return {uniform(0.75, 0.95), {{Cell::Kind::doors, 1, grip}}};
  return {uniform(0.45, 0.6), {{Cell::Kind::door, 0.9, grip}, {Cell::Kind::door, 1.2, grip}}};
}

std::vector<Unit> Furnisher::base_units(double length, const std::vector<Unit>& fixed) {
  std::vector<Unit> units;
  double left = length;
  for (const Unit& unit : fixed)
    if (left >= unit.width) {
      units.push_back(unit);
      left -= unit.width;
    }
  constexpr double kNarrowest = 0.3;
  while (left >= kNarrowest) {
    Unit unit{.width = uniform(0.35, 0.6)};
    switch (random_.index(6)) {
      case 0: {
        const size_t count = 2 + random_.index(3);
        for (size_t i = 0; i < count; ++i)
          unit.cells.push_back({Cell::Kind::drawer, i + 1 == count && count > 2 ? 0.6 : 1.0});
        unit.width = uniform(0.4, 0.9);
        break;
      }
      case 1:
        unit.cells = {{Cell::Kind::door}};
        break;
      case 2:
        unit.cells = {{Cell::Kind::door, 0.75}, {Cell::Kind::drawer, 0.25}};
        break;
      case 3:
        unit.width = uniform(0.7, 0.95);
        unit.cells = {{Cell::Kind::doors, 0.75}, {Cell::Kind::drawer, 0.25}};
        break;
      case 4:
        unit.width = uniform(0.7, 1.0);
        unit.cells = {{Cell::Kind::doors}};
        break;
      default:
        unit.cells = household::chance(random_, 0.3) ? std::vector<Cell>{{Cell::Kind::open}}
                                                     : std::vector<Cell>{{Cell::Kind::drawer, 1}};
        unit.width = uniform(0.3, 0.45);
    }
    unit.width = std::min(unit.width, left);
    if (left - unit.width < kNarrowest) unit.width = left;
    if (unit.width > 0.65 && unit.cells.size() == 1 && unit.cells[0].kind != Cell::Kind::drawer)
      unit.cells[0].kind = Cell::Kind::doors;
    left -= unit.width;
    units.push_back(unit);
  }
  shuffle(units, random_);
  return units;
}

std::vector<Unit> Furnisher::drawer_units(size_t columns, double length) {
  std::vector<Unit> units(columns, {length / static_cast<double>(columns), {}});
  const size_t count = 2 + random_.index(2);
  for (Unit& unit : units)
    for (size_t i = 0; i < count; ++i) unit.cells.push_back({Cell::Kind::drawer});
  return units;
}

std::vector<Unit> Furnisher::upper_units(double length) {
  std::vector<Unit> units;
  double left = length;
  while (left >= 0.3) {
    Unit unit{.width = std::min(left, uniform(0.35, 0.95))};
    if (left - unit.width < 0.3) unit.width = left;
    const Cell::Kind wide = household::chance(random_, 0.5) ? Cell::Kind::doors : Cell::Kind::flap_up;
    unit.cells = {{unit.width > 0.55 ? wide : Cell::Kind::door}};
    if (household::chance(random_, 0.15)) unit.cells = {{Cell::Kind::open}};
    left -= unit.width;
    units.push_back(unit);
  }
  return units;
}

void Furnisher::row(const Isometry3d& room_from_row, std::vector<Unit> units, double length, const Row& row) {
  double stretchy = 0;
  for (const Unit& unit : units) stretchy += unit.stretches ? unit.width : 0;
  const double factor = stretchy > 0 ? (length - (total_width(units) - stretchy)) / stretchy : 1;
  double left = 0;
  for (Unit& unit : units) {
    if (unit.stretches) unit.width *= factor;
    column(room_from_row, left, unit, row);
    left += unit.width;
  }
}

void Furnisher::column(const Isometry3d& room_from_row, double left, const Unit& unit, const Row& row) {
  const std::string cabinet =
      builder_.link("cabinet", "room", room_from_row * Eigen::Translation3d(0, left, 0));
  const double width = unit.width, base = row.bottom + (row.bottom == 0 ? row.plinth : 0);
  const auto board = [&](const Vector3d& low, const Vector3d& high) {
    builder_.box(cabinet, low, high, kCarcass);
  };
  board({-row.depth, 0, base}, {0, kPanel, row.top});
  board({-row.depth, width - kPanel, base}, {0, width, row.top});
  board({-row.depth, kPanel, base}, {-row.depth + 0.008, width - kPanel, row.top});
  board({-row.depth + 0.008, kPanel, base}, {0, width - kPanel, base + kPanel});
  if (row.has_top_board) {
    board({-row.depth + 0.008, kPanel, row.top - kPanel}, {0, width - kPanel, row.top});
    builder_.describe_support(cabinet, "cabinet", rectangle({-row.depth, 0}, {0, width}), row.top);
  }
  if (base > row.bottom) builder_.box(cabinet, {-row.depth, 0, 0}, {-0.05, width, base}, kPlinth);
  double shares = 0, bottom = base;
  for (const Cell& one : unit.cells) shares += one.share;
  for (size_t i = 0; i < unit.cells.size(); ++i) {
    const double top = bottom + (row.top - base) * unit.cells[i].share / shares;
    cell(cabinet, unit.cells[i], width, bottom, top, row);
    const bool drawers = unit.cells[i].kind == Cell::Kind::drawer && i + 1 < unit.cells.size() &&
                         unit.cells[i + 1].kind == Cell::Kind::drawer;
    if (i + 1 < unit.cells.size() && !drawers)
      board({-row.depth + 0.008, kPanel, top - kPanel / 2}, {-0.002, width - kPanel, top + kPanel / 2});
    bottom = top;
  }
}

void Furnisher::cell(const std::string& cabinet, const Cell& cell, double width, double bottom, double top,
                     const Row& row) {
  FrontStyle style = style_;
  style.color = cell.color.value_or(shade(front_color_, 0.03));
  Grip grip = cell.grip.value_or(grip_);
  if (!cell.grip && household::chance(random_, 0.12)) grip = Grip::none;
  if (grip == Grip::rail && width < 0.3) grip = Grip::bar;
  const FrontCell all{0, width, bottom, top};
  const auto front = [&](const FrontCell& where, Opening opening, Grip by) {
    builder_.front(cabinet, where, opening, by, row.grip_height, style, row.depth);
  };
  const bool left_hinge = household::chance(random_, 0.5);
  switch (cell.kind) {
    case Cell::Kind::drawer:
      return front(all, Opening::drawer, grip);
    case Cell::Kind::door:
      return front(all, left_hinge ? Opening::hinged_left : Opening::hinged_right, grip);
    case Cell::Kind::doors:
      front({0, width / 2, bottom, top}, Opening::hinged_left, grip);
      return front({width / 2, width, bottom, top}, Opening::hinged_right, grip);
    case Cell::Kind::flap_up:
      return front(all, Opening::hinged_top, grip);
    case Cell::Kind::flap_down:
      return front(all, Opening::hinged_bottom, grip);
    case Cell::Kind::panel:
      return front(all, Opening::fixed, Grip::none);
    case Cell::Kind::open: {
      const double middle = (bottom + top) / 2;
      builder_.box(cabinet, {-row.depth + 0.008, kPanel, middle - kPanel / 2},
                   {-0.01, width - kPanel, middle + kPanel / 2}, kCarcass);
    }
  }
}

void Furnisher::worktop(const Room& room, size_t first_wall, size_t walls, double begin, double end) {
  const double deep = depth_ + kWallGap + 0.03, low = worktop_height_ - worktop_thickness_;
  const Rgba color = shade(worktop_color_, 0.02);
  const std::string counter = builder_.link("counter", "room", Isometry3d::Identity());
  std::vector<Vector2d> at_wall, outer;
  for (size_t i = 0; i < walls; ++i) {
    const size_t wall = first_wall + i;
    const Vector2d along = room.direction(wall), out = room.normal(wall);
    const double from = i == 0 ? begin : 0, to = i + 1 == walls ? end : room.length(wall);
    const Vector2d start = room.corner(wall) + along * from, finish = room.corner(wall) + along * to;
    at_wall.push_back(start);
    outer.push_back(start + out * deep + (i == 0 ? Vector2d(0, 0) : Vector2d(along * deep)));
    if (i + 1 == walls) {
      at_wall.push_back(finish);
      outer.push_back(finish + out * deep);
    }
    // The next wall's part leaves out the corner.
    const Vector2d skipped = i == 0 ? start : Vector2d(start + along * deep);
    const Vector2d other = finish + out * deep;
    builder_.box(counter, {std::min(skipped.x(), other.x()), std::min(skipped.y(), other.y()), low},
                 {std::max(skipped.x(), other.x()), std::max(skipped.y(), other.y()), worktop_height_},
                 color);
  }
  std::vector<Vector2d> outline = at_wall;
  outline.insert(outline.end(), outer.rbegin(), outer.rend());
  builder_.describe_support(counter, "counter", outline, worktop_height_);
}

void Furnisher::slab(const std::string& kind, const Isometry3d& room_from_row, double length, double depth,
                     double overhang) {
  const std::string link = builder_.link(kind, "room", room_from_row);
  const Vector2d low(-depth - overhang, -0.02), high(0.03, length + 0.02);
  builder_.box(link, {low.x(), low.y(), worktop_height_ - worktop_thickness_},
               {high.x(), high.y(), worktop_height_}, shade(worktop_color_, 0.02));
  builder_.describe_support(link, kind, rectangle(low, high), worktop_height_);
}

void Furnisher::base_run(const Room& room, size_t first_wall, size_t walls, double begin, double end) {
  const Row row = base_row();
  std::vector<Unit> fixed = {sink(), oven(), dishwasher()};
  for (size_t i = 0; i < walls; ++i) {
    const size_t wall = first_wall + i;
    const double corner = depth_ + kWallGap + kCornerFiller;
    const double from = i == 0 ? begin : corner, to = i + 1 == walls ? end : room.length(wall) - corner;
    const size_t share = (fixed.size() + walls - 1 - i) / (walls - i);
    const std::vector<Unit> here(fixed.begin(), fixed.begin() + static_cast<long>(share));
    fixed.erase(fixed.begin(), fixed.begin() + static_cast<long>(share));
    this->row(room.row(wall, to, depth_), base_units(to - from, here), to - from, row);
    clutter(room.row(wall, to, depth_), to - from, depth_, worktop_height_);
    if (i + 1 == walls) continue;
    // Boards close the corner on both sides.
    const std::string filler = builder_.link("filler", "room", room.row(wall, room.length(wall), depth_));
    const double inner = depth_ + kWallGap, outer = inner + kCornerFiller;
    builder_.box(filler, {-kPanel, inner, row.plinth}, {0, outer, row.top}, shade(front_color_, 0.02));
    builder_.box(filler, {0, inner - kPanel, row.plinth}, {kCornerFiller, inner, row.top},
                 shade(front_color_, 0.02));
  }
  worktop(room, first_wall, walls, begin, end);
}

void Furnisher::upper_run(const Room& room, size_t wall, double begin, double end) {
  const double depth = uniform(0.32, 0.38), bottom = worktop_height_ + uniform(0.5, 0.6);
  const Row hanging{.depth = depth,
                    .bottom = bottom,
                    .top = bottom + uniform(0.55, 0.75),
                    .plinth = 0,
                    .has_top_board = true,
                    .grip_height = GripHeight::low};
  row(room.row(wall, end, depth), upper_units(end - begin), end - begin, hanging);
}

void Furnisher::wall_shelf(const Room& room, size_t wall, double begin, double end, double height) {
  const double depth = uniform(0.2, 0.3);
  const std::string shelf = builder_.link("shelf", "room", room.row(wall, end, depth));
  builder_.box(shelf, {-depth, 0, height - 0.03}, {0, end - begin, height}, wood_color_);
  builder_.describe_support(shelf, "shelf", rectangle({-depth, 0}, {0, end - begin}), height);
}

void Furnisher::tall_run(const Room& room, size_t wall, double begin, std::vector<Unit> units) {
  const double length = total_width(units);
  row(room.row(wall, begin + length, depth_ + 0.02), std::move(units), length,
      {.depth = depth_ + 0.02,
       .top = uniform(1.9, 2.15),
       .has_top_board = true,
       .grip_height = GripHeight::middle});
}

void Furnisher::table(const Vector2d& centre, double yaw, const Vector2d& size, double height) {
  const std::string link = builder_.link("table", "room", pose(centre, yaw));
  const Vector2d half = size / 2;
  const Rgba color = shade(wood_color_, 0.05);
  builder_.box(link, {-half.x(), -half.y(), height - 0.03}, {half.x(), half.y(), height}, color);
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) {
      const Vector2d leg(x * (half.x() - 0.05), y * (half.y() - 0.05));
      builder_.box(link, {leg.x() - 0.025, leg.y() - 0.025, 0},
                   {leg.x() + 0.025, leg.y() + 0.025, height - 0.03}, color);
    }
  builder_.describe_support(link, "table", rectangle(-half, half), height);
}

void Furnisher::chair(const Vector2d& centre, double yaw) {
  const std::string link = builder_.link("chair", "room", pose(centre, yaw));
  const Rgba color = shade(wood_color_, 0.1);
  builder_.box(link, {-0.21, -0.21, 0.43}, {0.21, 0.21, 0.46}, color);
  builder_.box(link, {-0.21, -0.2, 0.6}, {-0.185, 0.2, 0.9}, color);
  for (const double x : {-0.19, 0.19})
    for (const double y : {-0.18, 0.18}) {
      builder_.rod(link, {x, y, 0}, {x, y, 0.43}, 0.016, color);
      if (x < 0) builder_.rod(link, {x, y, 0.46}, {x, y, 0.6}, 0.012, color);
    }
}

void Furnisher::stool(const Vector2d& centre) {
  const std::string link = builder_.link("stool", "room", pose(centre, 0));
  builder_.rod(link, {0, 0, 0.64}, {0, 0, 0.68}, 0.17, shade(wood_color_, 0.1));
  builder_.rod(link, {0, 0, 0.02}, {0, 0, 0.64}, 0.025, kMetal);
  builder_.rod(link, {0, 0, 0}, {0, 0, 0.02}, 0.2, kMetal);
}

void Furnisher::radiator(const Room& room, size_t wall, double middle) {
  constexpr double kWidth = 0.9, kDepth = 0.1;
  const std::string link = builder_.link("radiator", "room", room.row(wall, middle + kWidth / 2, kDepth));
  builder_.box(link, {-0.06, 0, 0.14}, {-0.02, kWidth, 0.62}, kRadiator);
  for (double y = 0.05; y < kWidth; y += 0.1)
    builder_.rod(link, {-0.01, y, 0.17}, {-0.01, y, 0.59}, 0.012, kRadiator);
}

void Furnisher::clutter(const Isometry3d& room_from_row, double length, double depth, double height) {
  for (double y = uniform(0.2, 0.5); y < length - 0.2; y += uniform(0.4, 1.0)) {
    const double yaw = uniform(-0.5, 0.5), behind = uniform(0.2, depth - 0.15);
    const Isometry3d place =
        room_from_row * Eigen::Translation3d(-behind, y, height) * Eigen::AngleAxisd(yaw, Vector3d::UnitZ());
    const std::string link = builder_.link("clutter", "room", place);
    const Rgba color = household::any_color(random_);
    const auto upright = [&](double radius, double tall) {
      builder_.rod(link, Vector3d::Zero(), {0, 0, tall}, radius, color);
    };
    switch (random_.index(3)) {
      case 0: {
        const double radius = uniform(0.05, 0.09);
        upright(radius, uniform(0.15, 0.25));
        break;
      }
      case 1: {
        const double radius = uniform(0.03, 0.045);
        upright(radius, uniform(0.2, 0.32));
        break;
      }
      default: {
        const double half_y = uniform(0.06, 0.14), half_x = uniform(0.03, 0.1);
        const Vector3d half(half_x, half_y, 0);
        builder_.box(link, -half, half + Vector3d(0, 0, uniform(0.1, 0.3)), color);
      }
    }
  }
}

}  // namespace loci::mapping::kitchen
