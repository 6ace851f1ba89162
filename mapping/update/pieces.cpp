#include "mapping/update/pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/polygon.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/cabinets.h"
#include "mapping/update/parameters.h"
#include "mapping/world/furniture_classes.h"

namespace loci::mapping {
namespace {

using registration::Surfels;

constexpr int kNone = -1;

Vector2d plan_of(const Eigen::Vector3f& position) {
  return position.head<2>().cast<double>();
}

double rectangle_area(const std::vector<Vector2d>& corners) {
  return corners.empty() ? 0 : (corners[1] - corners[0]).norm() * (corners[2] - corners[1]).norm();
}

/// Disjoint sets of numbers.
class Sets {
 public:
  explicit Sets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  size_t root(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(size_t a, size_t b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<size_t> parent_;
};

/// Segments surfels: tops of supports first, then what is connected.
class Segmentation {
 public:
  Segmentation(const Surfels& surface, const std::vector<uint8_t>& chosen, const MapOutlines& map)
      : surface_(surface), map_(map) {
    for (uint32_t i = 0; i < surface.size(); ++i)
      if (chosen[i] != 0 && is_furniture(surface.position[i])) members_.push_back(i);
  }

  std::vector<Piece> pieces(bool only_free_standing) {
    std::vector<Piece> all = tops();
    const size_t supports = all.size();
    std::vector<Piece> components = connected();
    join_fragments(components, 0);  // The seat of a chair below a table goes with its back.
    for (Piece& component : components)
      if (const int host = host_of(component, all, supports); host != kNone)
        append(component, all[static_cast<size_t>(host)]);
      else
        all.push_back(std::move(component));
    join_fragments(all, supports);
    std::vector<Piece> standing;
    for (size_t i = 0; i < all.size(); ++i)
      if (only_free_standing ? stands_free(all[i], i < supports ? &map_.supports[support_of_[i]] : nullptr)
                             : all[i].surfels.size() >= kPieces.min_surfels / 2)
        standing.push_back(std::move(all[i]));
    for (Piece& piece : standing) piece.outline = outline_of(piece);
    return standing;
  }

 private:
  bool is_furniture(const Eigen::Vector3f& p) const {
    const double z = static_cast<double>(p.z());
    return z > kPieces.floor_m && z < kPieces.top_m &&
           std::ranges::none_of(map_.walls, [&](const auto& wall) { return wall.near(p, kPieces.wall_m); });
  }

  void add(uint32_t surfel, Piece& piece) const {
    piece.surfels.push_back(surfel);
    piece.box.extend(surface_.position[surfel]);
  }
  void append(const Piece& part, Piece& whole) const {
    for (const uint32_t i : part.surfels) add(i, whole);
  }

  /// A piece per support with its slab and what stands on it; these surfels are members no more.
  std::vector<Piece> tops() {
    std::vector<Piece> pieces(map_.supports.size());
    for (size_t k = 0; k < pieces.size(); ++k) {
      pieces[k].name = map_.supports[k].name;
      pieces[k].class_name = map_.supports[k].class_name;
      support_of_.push_back(k);
    }
    std::erase_if(members_, [&](uint32_t i) {
      const Eigen::Vector3f& p = surface_.position[i];
      for (size_t k = 0; k < pieces.size(); ++k) {
        const MapOutlines::Support& support = map_.supports[k];
        const double above = static_cast<double>(p.z()) - support.height;
        if (above < -kPieces.slab_m || above > kPieces.on_top_m) continue;
        if (!inside(support.outline, plan_of(p), kPieces.outline_margin_m)) continue;
        add(i, pieces[k]);
        return true;
      }
      return false;
    });
    return pieces;
  }

  /// Components of planes. Other surfels (thin legs, but also stray points between two objects) belong to the
  /// component from which they are reached first.
  std::vector<Piece> connected() const {
    const std::vector<std::vector<uint32_t>> near = neighbours();
    const auto is_plane = [&](size_t k) { return surface_.weight[members_[k]] > 0.F; };
    Sets sets(members_.size());
    std::vector<size_t> reached;
    for (size_t k = 0; k < members_.size(); ++k) {
      if (is_plane(k)) reached.push_back(k);
      for (const uint32_t other : near[k])
        if (is_plane(k) && is_plane(other)) sets.join(k, other);
    }
    std::vector<bool> done(members_.size(), false);
    for (const size_t k : reached) done[k] = true;
    for (size_t at = 0; at < reached.size(); ++at) {
      const size_t k = reached[at];
      for (const uint32_t other : near[k]) {
        if (done[other]) continue;
        done[other] = true;
        sets.join(k, other);
        reached.push_back(other);
      }
    }
    for (size_t k = 0; k < members_.size(); ++k)  // What no plane reaches.
      for (const uint32_t other : near[k])
        if (!done[k]) sets.join(k, other);
    std::map<size_t, Piece> by_root;
    for (size_t k = 0; k < members_.size(); ++k) add(members_[k], by_root[sets.root(k)]);
    std::vector<Piece> pieces;
    for (auto& [root, piece] : by_root) pieces.push_back(std::move(piece));
    return pieces;
  }

  /// The members that are nearer than `link_m` to each.
  std::vector<std::vector<uint32_t>> neighbours() const {
    CellIndex cells;
    std::vector<std::vector<uint32_t>> in_cell;
    for (uint32_t k = 0; k < members_.size(); ++k) {
      const uint32_t cell = cells.insert(cell_of(position(k), kPieces.link_m));
      in_cell.resize(cells.size());
      in_cell[cell].push_back(k);
    }
    constexpr auto kReach = static_cast<float>(kPieces.link_m);
    std::vector<std::vector<uint32_t>> near(members_.size());
    for (uint32_t k = 0; k < members_.size(); ++k)
      for (int n = 0; n < 27; ++n) {
        const Eigen::Vector3i step(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        const uint32_t cell = cells.find(cell_of(position(k), kPieces.link_m) + step);
        if (cell == CellIndex::kNone) continue;
        for (const uint32_t other : in_cell[cell])
          if (other != k && (position(other) - position(k)).norm() < kReach) near[k].push_back(other);
      }
    return near;
  }

  const Eigen::Vector3f& position(uint32_t member) const { return surface_.position[members_[member]]; }

  /// The support below whose top a component stands: its legs, its cabinets.
  int host_of(const Piece& component, const std::vector<Piece>& pieces, size_t supports) const {
    for (size_t k = 0; k < supports; ++k) {
      const MapOutlines::Support& support = map_.supports[k];
      if (pieces[k].surfels.empty() || static_cast<double>(component.box.min().z()) > support.height)
        continue;
      if (share_inside(component, support.outline, kPieces.below_margin_m) > kPieces.below_share)
        return static_cast<int>(k);
    }
    return kNone;
  }

  double share_inside(const Piece& piece, const std::vector<Vector2d>& outline, double margin) const {
    size_t within = 0;
    for (const uint32_t i : piece.surfels)
      within += inside(outline, plan_of(surface_.position[i]), margin) ? 1 : 0;
    return static_cast<double>(within) / static_cast<double>(piece.surfels.size());
  }

  bool has_plane(const Piece& piece) const {
    return std::ranges::any_of(piece.surfels, [&](uint32_t i) { return surface_.weight[i] > 0.F; });
  }

  std::vector<Vector2d> outline_of(const Piece& piece) const {
    std::vector<Vector2d> plan;
    for (const uint32_t i : piece.surfels) plan.push_back(plan_of(surface_.position[i]));
    return rectangle_around(plan);
  }

  /// Parts that stand within the outline of a larger piece belong to it: the back of a chair, legs whose
  /// upper ends nobody saw. Of several the smallest.
  void join_fragments(std::vector<Piece>& pieces, size_t supports) const {
    std::vector<std::vector<Vector2d>> outlines;
    std::vector<double> areas;
    for (const Piece& piece : pieces) {
      outlines.push_back(outline_of(piece));
      areas.push_back(rectangle_area(outlines.back()));
    }
    std::vector<size_t> order;
    for (size_t i = supports; i < pieces.size(); ++i) order.push_back(i);
    std::ranges::stable_sort(order, {}, [&](size_t i) { return areas[i]; });
    for (const size_t i : order) {
      size_t host = i;
      for (size_t j = 0; j < pieces.size(); ++j) {
        if (i == j || areas[j] <= areas[i] || (host != i && areas[host] <= areas[j])) continue;
        if (pieces[j].box.sizes().head<2>().maxCoeff() > static_cast<float>(kPieces.max_extent_m)) continue;
        // A back may seem to float over its seat; stray points over a piece would make it taller.
        const float top = has_plane(pieces[i]) ? 2 : pieces[j].box.max().z() + 0.05F;
        if (pieces[i].box.max().z() > top) continue;
        if (share_inside(pieces[i], outlines[j], kPieces.outline_margin_m) > kPieces.inside_share) host = j;
      }
      if (host == i) continue;
      append(pieces[i], pieces[host]);
      pieces[i].surfels.clear();
      outlines[i].clear();
      areas[i] = 0;
      outlines[host] = outline_of(pieces[host]);
      areas[host] = rectangle_area(outlines[host]);
    }
    // Supports stay in front.
    size_t kept = supports;
    for (size_t i = supports; i < pieces.size(); ++i)
      if (!pieces[i].surfels.empty()) {
        if (kept != i) pieces[kept] = std::move(pieces[i]);
        ++kept;
      }
    pieces.resize(kept);
  }

  /// Whether a piece begins at the height of another top beside it, above the floor: clutter on a counter is
  /// no furniture.
  bool lies_on_something(const Piece& piece) const {
    const double bottom = static_cast<double>(piece.box.min().z());
    if (bottom <= kPieces.stands_m) return false;
    const std::set<uint32_t> own(piece.surfels.begin(), piece.surfels.end());
    const std::vector<Vector2d> outline = outline_of(piece);
    size_t beside = 0;
    for (uint32_t i = 0; i < surface_.size(); ++i) {
      const Eigen::Vector3f& p = surface_.position[i];
      if (std::abs(static_cast<double>(p.z()) - bottom) > kPieces.level_m || surface_.normal[i].z() < 0.9F)
        continue;
      beside += !own.contains(i) && inside(outline, plan_of(p), kPieces.beside_m) ? 1 : 0;
    }
    return beside >= kPieces.min_beside;
  }

  bool stands_free(const Piece& piece, const MapOutlines::Support* support) const {
    if (piece.surfels.size() < kPieces.min_surfels) return false;
    if (support != nullptr && support->at_wall) return false;
    std::vector<Eigen::Vector3f> points;
    for (const uint32_t i : piece.surfels) points.push_back(surface_.position[i]);
    // Neither tables nor seats hang on walls, however near they stand, and thin legs are hardly seen.
    const bool may_hang = support == nullptr && shape_class(surface_, piece) == "piece";
    if (may_hang && lies_on_something(piece)) return false;
    return mapping::stands_free(points, map_.walls, may_hang);
  }

  const Surfels& surface_;
  const MapOutlines& map_;
  std::vector<uint32_t> members_;
  std::vector<size_t> support_of_;
};

/// Two or more numbers of an array.
Vector2d plan_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>()};
}

}  // namespace

MapOutlines outlines_of(const SemanticMap& semantics) {
  MapOutlines map;
  for (const auto& [name, link] : semantics.links) {
    const Json& geometry = link.geometry;
    if (!geometry.is_object() || !geometry.contains("outline")) continue;
    if (link.class_name == "wall") {
      WallRectangle wall;
      wall.normal = plan_of(geometry.at("normal"));
      wall.offset = geometry.at("offset").get<double>();
      wall.along_min = wall.bottom = 1e9;
      wall.along_max = wall.top = -1e9;
      for (const Json& corner : geometry.at("outline")) {
        const double along = plan_of(corner).dot(Vector2d(-wall.normal.y(), wall.normal.x()));
        const double z = corner.at(2).get<double>();
        wall.along_min = std::min(wall.along_min, along);
        wall.along_max = std::max(wall.along_max, along);
        wall.bottom = std::min(wall.bottom, z);
        wall.top = std::max(wall.top, z);
      }
      map.walls.push_back(wall);
      continue;
    }
    if (!is_support_class(link.class_name) || is_inferred_cabinet(link)) continue;
    MapOutlines::Support support;
    support.name = name;
    support.class_name = link.class_name;
    support.height = geometry.at("height").get<double>();
    for (const Json& corner : geometry.at("outline")) support.outline.push_back(plan_of(corner));
    if (link.evidence.is_object() && link.evidence.contains("edges"))
      for (const auto& [side, kind] : link.evidence.at("edges").items())
        if (kind == "wall") support.at_wall = true;
    map.supports.push_back(std::move(support));
  }
  return map;
}

std::vector<Piece> free_standing_pieces(const Surfels& surface, const std::vector<uint8_t>& chosen,
                                        const MapOutlines& map) {
  return Segmentation(surface, chosen, map).pieces(true);
}

std::vector<Piece> components_of(const Surfels& surface, const std::vector<uint8_t>& chosen,
                                 const MapOutlines& map) {
  return Segmentation(surface, chosen, map).pieces(false);
}

void name_pieces(const Surfels& surface, const SemanticMap& semantics, std::vector<Piece>& pieces) {
  const Json known = semantics.extra.is_object() && semantics.extra.contains("pieces")
                         ? semantics.extra.at("pieces")
                         : Json::object();
  std::set<std::string> used;
  for (const auto& [name, piece] : known.items()) used.insert(name);
  for (const auto& [name, link] : semantics.links) used.insert(name);
  for (Piece& piece : pieces) {
    if (!piece.name.empty()) {
      piece.links.push_back(piece.name);
      continue;
    }
    piece.class_name = shape_class(surface, piece);
    const Vector2d centre = piece.box.center().head<2>().cast<double>();
    for (const auto& [name, entry] : known.items())
      if (entry.contains("centre") &&
          (plan_of(entry.at("centre")) - centre).norm() < kChanges.known_piece_m) {
        piece.name = name;
        piece.class_name = entry.value("class", piece.class_name);
      }
    for (int number = 1; piece.name.empty(); ++number)
      if (const std::string name = fmt::format("{}_{}", piece.class_name, number); used.insert(name).second)
        piece.name = name;
  }
}

std::string shape_class(const Surfels& surface, const Piece& piece) {
  const Eigen::Vector3f size = piece.box.sizes();
  if (size.head<2>().maxCoeff() > 0.75F || size.head<2>().minCoeff() < 0.25F) return "piece";
  std::map<int, size_t> levels;  // Upward surfels by height, 5 cm.
  for (const uint32_t i : piece.surfels)
    if (surface.normal[i].z() > 0.9F) ++levels[static_cast<int>(surface.position[i].z() / 0.05F)];
  const auto seat = std::ranges::max_element(levels, {}, [](const auto& level) { return level.second; });
  if (seat == levels.end() || seat->second < 40) return "piece";
  const float height = 0.05F * static_cast<float>(seat->first) + 0.025F;
  const float above = piece.box.max().z() - height;
  if (height > 0.36F && height < 0.55F && above > 0.2F && above < 0.8F) return "chair";
  return height > 0.36F && height < 0.85F && above < 0.1F ? "stool" : "piece";
}

std::vector<Vector2d> rectangle_around(const std::vector<Vector2d>& points) {
  if (points.empty()) return {};
  std::vector<cv::Point2f> plan;
  for (const Vector2d& p : points) plan.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  std::array<cv::Point2f, 4> corners;
  cv::minAreaRect(plan).points(corners.data());
  std::vector<Vector2d> rectangle;
  for (const cv::Point2f& corner : corners)
    rectangle.emplace_back(static_cast<double>(corner.x), static_cast<double>(corner.y));
  return rectangle;
}

bool inside(const Polygon& polygon, const Vector2d& point, double margin) {
  return contains(polygon, point) || distance_to_edge(polygon, point) < margin;
}

}  // namespace loci::mapping
