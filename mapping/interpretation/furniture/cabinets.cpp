#include "mapping/interpretation/furniture/cabinets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/front_fit.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/world/contacts.h"
#include "mapping/world/furniture_classes.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

using Bounds = Eigen::AlignedBox3d;

/// Fronts of one body: their rectangle in the plane of the first, u to the right and v up.
struct Column {
  std::vector<size_t> fronts;
  Eigen::AlignedBox2d rect;
  double offset = 0;  ///< of the plane along its normal
  Vector3d normal = Vector3d::UnitX();
  int hinge = 0;  ///< of a single door, as seen from before it: -1 left, 1 right; 0 for other fronts
};

Column column_of(const Front& front, size_t index) {
  Column column;
  column.fronts = {index};
  const Vector2d middle(front.right().dot(front.centre), front.centre.z());
  const Vector2d half(front.width / 2, front.height / 2);
  column.rect = {middle - half, middle + half};
  column.normal = Vector3d(front.normal.x(), front.normal.y(), 0).normalized();  // Bodies stand upright.
  column.offset = column.normal.dot(front.centre);
  if (front.class_name == "door" && front.joint) column.hinge = front.joint->axis.dot(front.up) < 0 ? -1 : 1;
  return column;
}

bool same_plane(const Column& a, const Column& b) {
  return a.normal.dot(b.normal) > kCabinets.parallel_cosine &&
         std::abs(a.offset - b.offset) < kCabinets.same_face_m;
}

bool near(double a, double b) {
  return std::abs(a - b) < kCabinets.aligned_m;
}

/// Whether one stands on the other: between them is at most a cover.
bool stacked(const Column& a, const Column& b) {
  const double gap = std::max(a.rect.min().y() - b.rect.max().y(), b.rect.min().y() - a.rect.max().y());
  return near(a.rect.min().x(), b.rect.min().x()) && near(a.rect.max().x(), b.rect.max().x()) &&
         gap > -kCabinets.aligned_m && gap < kCabinets.max_cover_m;
}

/// Whether `left` and `right` are the two wings of one cupboard.
bool wings(const Column& left, const Column& right) {
  return left.hinge < 0 && right.hinge > 0 && near(left.rect.max().x(), right.rect.min().x()) &&
         near(left.rect.min().y(), right.rect.min().y()) && near(left.rect.max().y(), right.rect.max().y());
}

/// Joins the first two columns that are one body; false when there are none.
bool join_one(std::vector<Column>& columns) {
  for (size_t i = 0; i < columns.size(); ++i)
    for (size_t k = i + 1; k < columns.size(); ++k) {
      Column &a = columns[i], &b = columns[k];
      if (!same_plane(a, b) || !(stacked(a, b) || wings(a, b) || wings(b, a))) continue;
      a.rect.extend(b.rect);
      a.offset = std::min(a.offset, b.offset);
      a.fronts.insert(a.fronts.end(), b.fronts.begin(), b.fronts.end());
      a.hinge = 0;
      columns.erase(columns.begin() + static_cast<std::ptrdiff_t>(k));
      return true;
    }
  return false;
}

std::vector<Column> columns_of(const std::vector<Front>& fronts) {
  std::vector<Column> columns;
  for (size_t i = 0; i < fronts.size(); ++i)
    if (std::abs(fronts[i].normal.z()) < kCabinets.max_lean) columns.push_back(column_of(fronts[i], i));
  while (join_one(columns)) {
  }
  return columns;
}

/// "fridge" where one of the doors is one's: compartments of a refrigerator have one body. Other appliances
/// stand in cupboards that have further fronts.
std::string appliance_of(const Column& column, const std::vector<Front>& fronts) {
  const bool fridge = std::ranges::any_of(column.fronts, [&](size_t i) {
    return fronts[i].appliance == "fridge" || fronts[i].appliance == "freezer";
  });
  return fridge ? "fridge" : "";
}

/// All that slides as far open as it goes: drawers may run askew between the sides of their body.
JointState slid_open(const World& world) {
  JointState state;
  for (const Joint& joint : world.joints)
    if (joint.type == JointType::prismatic && joint.limits) state[joint.name] = joint.limits->upper;
  return state;
}

/// A solid of the map in a column's frame, with what it passes as it slides open.
struct Solid {
  Bounds bounds;
  std::string class_name;
};

struct Depth {
  enum class Source { assumed, support, wall };
  double metres = 0;
  Source from = Source::assumed;
};

const char* to_text(Depth::Source source) {
  switch (source) {
    case Depth::Source::support:
      return "support";
    case Depth::Source::wall:
      return "wall";
    case Depth::Source::assumed:
      break;
  }
  return "assumed";
}

class CabinetWriter {
 public:
  CabinetWriter(const Column& column, const std::vector<Front>& fronts, const World& world,
                const SemanticMap& semantics)
      : column_(column), fronts_(fronts) {
    const Vector2d middle = column.rect.center();
    const Vector3d right = Vector3d::UnitZ().cross(column.normal);
    map_from_.linear() << column.normal, right, Vector3d::UnitZ();
    map_from_.translation() =
        column.offset * column.normal + middle.x() * right + middle.y() * Vector3d::UnitZ();
    const std::vector<Isometry3d> closed = root_from_links(world, {}),
                                  open = root_from_links(world, slid_open(world));
    for (const SolidBox& box : solid_boxes(world)) {
      const auto link = semantics.links.find(world.links[box.link].name);
      const Bounds bounds = bounds_of(box, map_from_.inverse() * closed[box.link])
                                .merged(bounds_of(box, map_from_.inverse() * open[box.link]));
      solids_.push_back({bounds, link == semantics.links.end() ? "" : link->second.class_name});
    }
  }

  /// Whether a wall tells how deep the body is.
  bool stands_at_wall() const { return depth_behind().from == Depth::Source::wall; }

  /// Writes the body outside of those that are `taken`, and adds it to them.
  void write(const std::string& name, const std::string& parent, World& world, SemanticMap& semantics,
             std::vector<SolidBox>& taken) {
    const Depth depth = depth_behind();
    for (const SolidBox& body : taken) solids_.push_back({bounds_of(body, map_from_.inverse()), ""});
    const Vector2d half = column_.rect.sizes() / 2;
    const double front = -kFurniture.panel_m - kFurniture.gap_m, back = -depth.metres + kFurniture.gap_m;
    const double board = kCabinets.board_m;
    if (front - back < kFurniture.min_drawer_m || half.x() < 2 * board) return;
    const std::array<Bounds, 5> boards = {
        Bounds(Vector3d(back, -half.x(), -half.y()), Vector3d(front, board - half.x(), half.y())),
        Bounds(Vector3d(back, half.x() - board, -half.y()), Vector3d(front, half.x(), half.y())),
        Bounds(Vector3d(back, board - half.x(), -half.y()),
               Vector3d(back + board / 2, half.x() - board, half.y())),
        // Outside of the fronts' rectangle: drawers need all of it.
        Bounds(Vector3d(back, -half.x(), -half.y() - board), Vector3d(front, half.x(), -half.y())),
        Bounds(Vector3d(back, -half.x(), half.y()), Vector3d(front, half.x(), half.y() + board))};
    const Bounds inside(Vector3d(back + board / 2, board - half.x(), -half.y()),
                        Vector3d(front, half.x() - board, half.y()));
    const Vector3d origin(inside.center().x(), 0, inside.min().z());
    std::vector<LinkPart> parts;
    for (const Bounds& one : boards)
      for (const Bounds& part : free_of_solids(one))
        parts.push_back(box_part(part.center() - origin, part.sizes()));
    if (parts.empty()) return;
    const Isometry3d map_from_parent = root_from_links(world, {})[world.link_index(parent)];
    const Isometry3d map_from_link = map_from_ * Eigen::Translation3d(origin);
    add_link(world, name, "cabinet", parent, map_from_parent.inverse() * map_from_link, parts);
    semantics.links[name] = described(inside, depth);
    taken.push_back({0, map_from_ * Eigen::Translation3d(inside.center()), inside.sizes() / 2});
  }

 private:
  /// How far back the body reaches from the fronts' plane.
  Depth depth_behind() const {
    Depth depth{usual_depth()};
    double support = 0;
    for (const Solid& solid : solids_) {
      if (!is_behind(solid)) continue;
      const double behind = -solid.bounds.max().x();
      if (solid.class_name == "wall" && behind > kCabinets.min_depth_m && behind < kCabinets.max_depth_m &&
          (depth.from != Depth::Source::wall || behind < depth.metres))
        depth = {behind, Depth::Source::wall};
      const double above = solid.bounds.min().z() - column_.rect.sizes().y() / 2;
      if (is_support_class(solid.class_name) && solid.class_name != "cabinet" &&
          std::abs(above) < kCabinets.max_cover_m)
        support = std::max(support, -solid.bounds.min().x());
    }
    if (depth.from != Depth::Source::wall && support > kCabinets.min_depth_m)
      depth = {std::min(support, kCabinets.max_depth_m), Depth::Source::support};
    return depth;
  }

  double usual_depth() const {
    double depth = 0;
    for (const size_t i : column_.fronts) depth = std::max(depth, fronts_[i].depth);
    return depth + kFurniture.gap_m + kCabinets.board_m;
  }

  /// Whether a solid covers more than half of the column's width.
  bool is_behind(const Solid& solid) const {
    const double half = column_.rect.sizes().x() / 2;
    return std::min(half, solid.bounds.max().y()) - std::max(-half, solid.bounds.min().y()) > half;
  }

  std::vector<Bounds> free_of_solids(const Bounds& board) const {
    std::vector<Bounds> parts = {board};
    for (const Solid& solid : solids_) {
      std::vector<Bounds> rest;
      const Vector3d gap = Vector3d::Constant(kCabinets.clearance_m);
      const Bounds wide(solid.bounds.min() - gap, solid.bounds.max() + gap);
      for (const Bounds& part : parts) cut_out(wide, part, rest);
      parts = std::move(rest);
    }
    return parts;
  }

  SemanticLink described(const Bounds& inside, const Depth& depth) const {
    SemanticLink link;
    link.class_name = "cabinet";
    link.confidence = 1;
    Json names = Json::array();
    for (const size_t i : column_.fronts) {
      link.confidence = std::min(link.confidence, fronts_[i].confidence);
      names.push_back(fronts_[i].name);
    }
    if (depth.from == Depth::Source::assumed) link.confidence *= kCabinets.assumed_depth;
    Json outline = Json::array();
    for (const auto& [x, y] : {std::pair{inside.min().x(), inside.min().y()},
                               {inside.max().x(), inside.min().y()},
                               {inside.max().x(), inside.max().y()},
                               {inside.min().x(), inside.max().y()}}) {
      const Vector3d corner = map_from_ * Vector3d(x, y, 0);
      outline.push_back({corner.x(), corner.y()});
    }
    const double middle = map_from_.translation().z();
    link.geometry = {
        {"height", middle + inside.min().z()}, {"top", middle + inside.max().z()}, {"outline", outline}};
    link.appliance = appliance_of(column_, fronts_);
    link.evidence = {{"source", "prototype"}, {"depth", to_text(depth.from)}};
    link.extra["fronts"] = names;
    return link;
  }

  const Column& column_;
  const std::vector<Front>& fronts_;
  Isometry3d map_from_ = Isometry3d::Identity();  ///< origin in the middle of the fronts' plane
  std::vector<Solid> solids_;
};

std::vector<std::string> names_of(const std::vector<Column>& columns, const std::vector<Front>& fronts) {
  std::vector<std::string> names;
  size_t fridges = 0;
  for (const Column& column : columns) {
    const bool fridge = !appliance_of(column, fronts).empty();
    fridges += fridge ? 1 : 0;
    names.push_back(fridge ? fmt::format("fridge_{}", fridges)
                           : fmt::format("cabinet_{}", names.size() + 1 - fridges));
  }
  return names;
}

}  // namespace

void add_cabinets(const std::vector<Front>& fronts, const std::string& parent, World& world,
                  SemanticMap& semantics) {
  const std::vector<Column> columns = columns_of(fronts);
  const std::vector<std::string> names = names_of(columns, fronts);
  std::vector<SolidBox> taken;
  // What a wall bounds is certain; others give way to it.
  for (const bool at_wall : {true, false})
    for (size_t i = 0; i < columns.size(); ++i) {
      CabinetWriter writer(columns[i], fronts, world, semantics);
      if (semantics.links.contains(names[i]) || writer.stands_at_wall() != at_wall) continue;
      writer.write(names[i], parent, world, semantics, taken);
    }
  limit_joints(fronts, world, semantics);
}

bool is_inferred_cabinet(const SemanticLink& link) {
  return link.class_name == "cabinet" && link.evidence.is_object() &&
         link.evidence.value("source", "") == "prototype";
}

void remove_cabinets(World& world, SemanticMap& semantics) {
  const auto is_ours = [&](const std::string& name) {
    const auto link = semantics.links.find(name);
    return link != semantics.links.end() && is_inferred_cabinet(link->second);
  };
  std::erase_if(world.links, [&](const Link& link) { return is_ours(link.name); });
  std::erase_if(world.joints, [&](const Joint& joint) { return is_ours(joint.child); });
  std::erase_if(semantics.links, [](const auto& link) { return is_inferred_cabinet(link.second); });
}

}  // namespace loci::mapping
