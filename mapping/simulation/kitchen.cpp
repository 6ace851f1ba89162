#include "mapping/simulation/kitchen.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/sensor/laser.h"
#include "mapping/simulation/kitchen_furniture.h"

namespace loci::mapping {
namespace kitchen {
namespace {

Room rectangular(double x, double y) {
  return {.corners = {{0, 0}, {x, 0}, {x, y}, {0, y}}};
}

void dining_table(Furnisher& furnish, const Vector2d& centre) {
  const double yaw = furnish.uniform(-0.3, 0.3);
  const double depth = furnish.uniform(0.7, 0.9);
  const Vector2d size(furnish.uniform(1.0, 1.5), depth);
  furnish.table(centre, yaw, size, furnish.uniform(0.7, 0.77));
  const Vector2d along(std::cos(yaw), std::sin(yaw)), across(-along.y(), along.x());
  furnish.chair(centre + along * (size.x() / 2 + 0.2), yaw + kPi);
  furnish.chair(centre - across * (size.y() / 2 + 0.15) - along * 0.2, yaw + kPi / 2);
}

void line(Furnisher& furnish) {
  const double x = furnish.uniform(4.2, 5.0), y = furnish.uniform(3.2, 3.8);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 3, .from = 0.5},
                {.wall = 0, .from = x / 2, .width = 1.2, .bottom = 0.95, .top = 2.0}};
  furnish.room(room);
  const std::vector<Unit> tall = {furnish.refrigerator(), furnish.pantry(Grip::bar)};
  const double end = x - tall[0].width - tall[1].width - 0.1;
  furnish.tall_run(room, 2, 0.05, tall);  // wall 2 runs from the far right corner to the left
  furnish.base_run(room, 2, 1, x - end, x - 0.4);
  furnish.upper_run(room, 2, x - end + 0.1, x - 0.8);
  dining_table(furnish, {x / 2, 1.2});
  furnish.radiator(room, 0, x / 2 + 0.6);
}

void galley(Furnisher& furnish) {
  const double x = furnish.uniform(4.0, 4.8), y = furnish.uniform(2.3, 2.6);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 3, .from = 0.8}};
  furnish.room(room);
  const std::vector<Unit> tall = {furnish.oven_tower()};
  furnish.tall_run(room, 2, 0.02, tall);
  furnish.base_run(room, 2, 1, tall[0].width + 0.03, x - 0.9);
  furnish.upper_run(room, 2, tall[0].width + 0.1, x - 1.2);
  furnish.base_run(room, 0, 1, 1.2, x - 0.05);
  furnish.wall_shelf(room, 0, 1.5, x - 0.5, furnish.uniform(1.4, 1.5));
}

void corner(Furnisher& furnish) {
  const double x = furnish.uniform(4.0, 4.8), y = furnish.uniform(3.8, 4.4);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 0, .from = 0.6}, {.wall = 3, .from = 1.2, .width = 1.2, .bottom = 1.1, .top = 2.1}};
  furnish.room(room);
  const std::vector<Unit> tall = {furnish.refrigerator()};
  furnish.base_run(room, 1, 2, 1.1, x - 1.0);  // the right wall, then the far one
  furnish.tall_run(room, 2, x - 0.95, tall);
  furnish.upper_run(room, 2, 0.8, x - 1.3);
  dining_table(furnish, {1.5, 1.6});
}

void u_shape(Furnisher& furnish) {
  const double x = furnish.uniform(3.3, 4.0), y = furnish.uniform(3.6, 4.4);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 0, .from = x / 2 - 0.45},
                {.wall = 2, .from = x / 2 - 0.6, .width = 1.2, .bottom = 1.15, .top = 2.1}};
  furnish.room(room);
  furnish.base_run(room, 1, 3, 1.2, y - 1.3);
  furnish.upper_run(room, 1, 1.3, y - 0.7);
  furnish.tall_run(room, 3, y - 1.28, {furnish.pantry(Grip::knob)});
}

/// A row of drawers that stands free, and its slab.
void island_row(Furnisher& furnish, const std::string& kind, const Isometry3d& room_from_row, double length,
                double overhang) {
  const Row row = furnish.base_row();
  furnish.row(room_from_row, furnish.drawer_units(2 + (length > 1.3), length), length, row);
  furnish.slab(kind, room_from_row, length, row.depth, overhang);
}

void island(Furnisher& furnish) {
  const double x = furnish.uniform(4.6, 5.4), y = furnish.uniform(4.2, 4.8);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 1, .from = 0.5}};
  furnish.room(room);
  const std::vector<Unit> tall = {furnish.oven_tower(), furnish.refrigerator()};
  const double wide = tall[0].width + tall[1].width;
  furnish.tall_run(room, 2, x - wide - 0.05, tall);
  furnish.base_run(room, 2, 1, 0.1, x - wide - 0.07);
  furnish.upper_run(room, 2, 0.2, x - wide - 0.9);
  const double length = furnish.uniform(1.2, 1.8), front = y - furnish.depth() - furnish.uniform(1.15, 1.35);
  // Its drawers look at the counter.
  island_row(furnish, "island", map_from_base({x / 2 + length / 2, front, kPi / 2}), length, 0.25);
  for (const double along : {-0.35, 0.35}) furnish.stool({x / 2 + along, front - furnish.depth() - 0.55});
}

void peninsula(Furnisher& furnish) {
  const double x = furnish.uniform(4.8, 5.5), y = furnish.uniform(3.8, 4.4);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 3, .from = 1.5}, {.wall = 0, .from = 0.8, .width = 1.4, .bottom = 0.9, .top = 2.1}};
  furnish.room(room);
  furnish.base_run(room, 1, 2, y - 2.2, x / 2);
  furnish.upper_run(room, 1, y - 2.1, y - 0.6);
  furnish.tall_run(room, 2, x / 2 + 0.02, {furnish.refrigerator()});
  // From the right wall into the room; its drawers look at the far counter.
  const double length = furnish.uniform(1.3, 1.7);
  island_row(furnish, "counter",
             map_from_base({x - furnish.depth() - 0.1, y - 2.2 - furnish.uniform(0.03, 0.06), kPi / 2}),
             length, 0.2);
  furnish.stool({x - 0.6, y - 3.2});
  dining_table(furnish, {1.6, 1.2});
}

void diner(Furnisher& furnish) {
  const double x = furnish.uniform(3.4, 3.9), y = furnish.uniform(3.4, 4.0),
               far = x + furnish.uniform(3.0, 3.6);
  constexpr double kThick = 0.12;
  const double low = 0.5, high = low + furnish.uniform(0.95, 1.3);
  Room room{.corners = {{0, 0},
                        {x, 0},
                        {x, low},
                        {x + kThick, low},
                        {x + kThick, 0},
                        {far, 0},
                        {far, y},
                        {x + kThick, y},
                        {x + kThick, high},
                        {x, high},
                        {x, y},
                        {0, y}}};
  room.holes = {{.wall = 5, .from = 1.2, .width = 1.4, .bottom = 0.9, .top = 2.1}};
  furnish.room(room);
  furnish.base_run(room, 10, 2, 0.1, y - 1.0);  // the far wall, then the left one
  furnish.upper_run(room, 10, 0.2, x - 0.8);
  furnish.tall_run(room, 11, y - 0.95, {furnish.refrigerator()});
  dining_table(furnish, {(x + far) / 2 + 0.1, y / 2 - 0.2});
  const double length = furnish.uniform(1.2, 1.8), middle = (far - x) / 2;
  Row sideboard{.depth = 0.42, .top = furnish.uniform(0.7, 0.85), .plinth = 0.12, .has_top_board = true};
  furnish.row(room.row(6, middle + length / 2, sideboard.depth), furnish.base_units(length, {}), length,
              sideboard);
}

void alcove(Furnisher& furnish) {
  const double x = furnish.uniform(4.4, 5.0), y = furnish.uniform(4.2, 4.8), cut = furnish.uniform(1.4, 1.8);
  // The lower left corner is missing; a chimney stands in the far wall.
  const double chimney = x * 0.62, wide = 0.5, deep = 0.35;
  Room room{.corners = {{cut, 0},
                        {x, 0},
                        {x, y},
                        {chimney + wide, y},
                        {chimney + wide, y - deep},
                        {chimney, y - deep},
                        {chimney, y},
                        {0, y},
                        {0, cut},
                        {cut, cut}}};
  room.holes = {{.wall = 0, .from = 0.4}, {.wall = 1, .from = 1.2, .width = 1.2, .bottom = 1.0, .top = 2.0}};
  furnish.room(room);
  furnish.base_run(room, 6, 2, 0.02, y - cut - 0.8);
  furnish.wall_shelf(room, 6, 0.2, chimney - 0.7, furnish.uniform(1.35, 1.45));
  furnish.wall_shelf(room, 7, 0.8, y - cut - 1.0, furnish.uniform(1.35, 1.45));
  furnish.tall_run(room, 2, 0.05, {furnish.refrigerator()});
  dining_table(furnish, {x / 2 + 0.5, 1.6});
  furnish.radiator(room, 1, 1.8);
}

void workshop(Furnisher& furnish) {
  const double x = furnish.uniform(4.6, 5.2), y = furnish.uniform(4.0, 4.6);
  Room room = rectangular(x, y);
  room.holes = {{.wall = 0, .from = 0.5, .width = 1.0}};
  furnish.room(room);
  std::vector<Unit> tall;
  while (total_width(tall) < x - 1.6) tall.push_back(furnish.pantry(Grip::knob));
  furnish.tall_run(room, 2, 0.3, tall);
  Row sideboard{.depth = 0.45, .top = furnish.uniform(0.75, 0.9), .has_top_board = true};
  const double length = furnish.uniform(1.6, 2.2);
  furnish.row(room.row(3, 0.6 + length, sideboard.depth), furnish.base_units(length, {}), length, sideboard);
  const double bench = furnish.uniform(1.4, 1.9);
  island_row(furnish, "island", map_from_base({x / 2 + 0.4 + bench / 2, y / 2 - 0.1, kPi / 2}), bench, 0.1);
  furnish.wall_shelf(room, 1, 1.0, 2.4, furnish.uniform(1.2, 1.4));
}

}  // namespace
}  // namespace kitchen

DrawnKitchen draw_kitchen(std::string_view layout, uint64_t seed) {
  using kitchen::Furnisher;
  constexpr std::array<void (*)(Furnisher&), kKitchenLayouts.size()> kDraw = {
      kitchen::line,      kitchen::galley, kitchen::corner, kitchen::u_shape, kitchen::island,
      kitchen::peninsula, kitchen::diner,  kitchen::alcove, kitchen::workshop};
  const auto* const found = std::ranges::find(kKitchenLayouts, layout);
  if (found == kKitchenLayouts.end())
    throw Error(fmt::format("no layout '{}' is known", layout), {},
                fmt::format("take {}", fmt::join(kKitchenLayouts, ", ")));
  Random random = Random(seed).fork(static_cast<uint64_t>(found - kKitchenLayouts.begin()));
  // Draws are apart: the arguments of a call have no order.
  const double yaw = random.uniform(-kPi / 4, kPi / 4), y = random.uniform(-1.5, 1.5),
               x = random.uniform(-1.5, 1.5);
  kitchen::Builder builder(fmt::format("{}_{}", layout, seed), map_from_base({x, y, yaw}));
  Furnisher furnisher(builder, random.fork(1));
  kDraw[static_cast<size_t>(found - kKitchenLayouts.begin())](furnisher);
  return builder.take();
}

}  // namespace loci::mapping
