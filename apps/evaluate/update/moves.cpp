#include "apps/evaluate/update/moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/world/kinematics.h"

namespace loci::apps::update_claim {
namespace {

constexpr int kDraws = 200;

/// The name without its number: "island_cabinet_2" and "island" are of the family "island".
bool is_of(const std::string& link, const std::string& family) {
  return link.starts_with(family);
}

std::string shape_of(const mapping::Link& link) {
  std::string text;
  for (const mapping::Visual& visual : link.visuals)
    if (const auto* box = std::get_if<mapping::Box>(&visual.geometry))
      text += fmt::format("b{:.3f},{:.3f},{:.3f};", box->size.x(), box->size.y(), box->size.z());
    else
      text += fmt::format("g{};", visual.geometry.index());
  return text;
}

bool is_round(const mapping::Link& link) {
  return std::ranges::all_of(link.visuals, [](const mapping::Visual& visual) {
    return std::holds_alternative<mapping::Cylinder>(visual.geometry) &&
           visual.link_from_visual.translation().head<2>().norm() < 1e-6;
  });
}

Polygon hull_of(const std::vector<cv::Point2f>& points) {
  std::vector<cv::Point2f> corners;
  cv::convexHull(points, corners);
  Polygon hull;
  for (const cv::Point2f& corner : corners)
    hull.emplace_back(static_cast<double>(corner.x), static_cast<double>(corner.y));
  return hull;
}

Polygon moved_hull(const Polygon& hull, const Isometry3d& motion) {
  Polygon moved;
  for (const Eigen::Vector2d& p : hull) moved.push_back((motion * Vector3d(p.x(), p.y(), 0)).head<2>());
  return moved;
}

}  // namespace

std::optional<double> Group::turn_error_deg(const Isometry3d& error) const {
  if (period == 0) return std::nullopt;
  return std::abs(std::remainder(rpy_from_rotation(error.linear()).z(), period)) / kDegree;
}

MovableWorld::MovableWorld(mapping::World world, const mapping::MeshSearch& search,
                           const std::vector<std::string>& families, Warnings& warnings)
    : world_(std::move(world)), sight_(world_, search, warnings) {
  const std::vector<Isometry3d> root_from_link = root_from_links(world_, {});
  std::map<std::string, int> group_of;
  for (const mapping::Link& link : world_.links) {
    // Children follow in the order of the file or not: climb to the branch that is of a family.
    std::string at = link.name;
    for (;;) {
      const auto family = std::ranges::find_if(families, [&](const std::string& f) { return is_of(at, f); });
      const mapping::Joint* joint = world_.parent_joint(at);
      const bool parent_too = joint != nullptr && std::ranges::any_of(families, [&](const std::string& f) {
                                return is_of(joint->parent, f);
                              });
      if (family != families.end() && !parent_too) {
        // An island and its cabinets are one piece; chairs are one each.
        const std::string name = *family == "island" ? *family : at;
        auto group = std::ranges::find(groups_, name, &Group::name);
        if (group == groups_.end()) {
          group = groups_.insert(groups_.end(), Group());
          group->name = name;
        }
        if (std::ranges::find(group->branches, at) == group->branches.end()) group->branches.push_back(at);
        group->links.push_back(link.name);
        group->shape += shape_of(link);
        group_of[link.name] = static_cast<int>(group - groups_.begin());
        break;
      }
      if (joint == nullptr) break;
      at = joint->parent;
    }
  }
  std::vector<Eigen::AlignedBox3d> boxes(groups_.size());
  for (size_t i = 0; i < world_.links.size(); ++i) {
    const mapping::Link& link = world_.links[i];
    if (link.name == "floor" || link.name == "ceiling") continue;
    const auto group = group_of.find(link.name);
    for (const mapping::Visual& visual : link.visuals) {
      Prism prism;
      prism.low = 1e9, prism.high = -1e9;
      prism.group = group == group_of.end() ? -1 : group->second;
      std::vector<cv::Point2f> plan;
      for (const Eigen::Vector3f& vertex : triangulate(visual.geometry, search, warnings).vertices) {
        const Vector3d p = root_from_link[i] * visual.link_from_visual * vertex.cast<double>();
        plan.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
        prism.low = std::min(prism.low, p.z());
        prism.high = std::max(prism.high, p.z());
        if (prism.group >= 0) boxes[static_cast<size_t>(prism.group)].extend(p);
      }
      if (plan.empty()) continue;
      prism.hull = hull_of(plan);
      prisms_.push_back(std::move(prism));
    }
  }
  for (size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].centre = boxes[g].center();
    groups_[g].map_from_group = root_from_link[world_.link_index(groups_[g].branches.front())];
    for (const double turn : {kPi, kPi / 2})
      if (looks_same(g, turn)) groups_[g].period = turn;
    if (std::ranges::all_of(groups_[g].links,
                            [&](const std::string& link) { return is_round(*world_.find_link(link)); }))
      groups_[g].period = 0;
  }
}

bool MovableWorld::looks_same(size_t group, double turn) const {
  constexpr double kSame = 0.98;  // Of the area: truth and its turned copy are equal but for rounding.
  const Vector3d& centre = groups_[group].centre;
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
  motion.translation() = centre - motion.linear() * centre;
  const auto is_own = [&](const Prism& prism) { return prism.group == static_cast<int>(group); };
  return std::ranges::all_of(prisms_, [&](const Prism& prism) {
    if (!is_own(prism)) return true;
    const Polygon turned = moved_hull(prism.hull, motion);
    return std::ranges::any_of(prisms_, [&](const Prism& other) {
      return is_own(other) && std::abs(other.low - prism.low) < 1e-3 &&
             std::abs(other.high - prism.high) < 1e-3 &&
             shared_area(turned, other.hull) > kSame * std::max(area_of(turned), area_of(other.hull));
    });
  });
}

bool MovableWorld::collides(size_t group, const Isometry3d& motion,
                            const std::vector<Isometry3d>& others) const {
  for (const Prism& own : prisms_) {
    if (own.group != static_cast<int>(group)) continue;
    const Polygon hull = moved_hull(own.hull, motion);
    for (const Prism& other : prisms_) {
      if (other.group == own.group || other.low > own.high || other.high < own.low) continue;
      const Isometry3d there =
          other.group >= 0 ? others[static_cast<size_t>(other.group)] : Isometry3d::Identity();
      if (shared_area(hull, moved_hull(other.hull, there)) > 0) return true;
    }
  }
  return false;
}

std::vector<Move> MovableWorld::draw(size_t count, Random& random, const MoveLimits& limits) const {
  std::vector<Isometry3d> motions(groups_.size(), Isometry3d::Identity());
  std::vector<size_t> order;
  for (size_t g = 0; g < groups_.size(); ++g) order.push_back(g);
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  std::vector<Move> moves;
  for (const size_t g : order) {
    if (moves.size() == count) break;
    for (int draw = 0; draw < kDraws; ++draw) {
      const double distance = limits.min_m * std::pow(limits.max_m / limits.min_m, random.uniform());
      const double direction = random.uniform(0, 2 * kPi);
      Isometry3d motion = Isometry3d::Identity();
      motion.linear() =
          Eigen::AngleAxisd(random.uniform(-limits.max_turn, limits.max_turn), Vector3d::UnitZ())
              .toRotationMatrix();
      const Vector3d target =
          groups_[g].centre + distance * Vector3d(std::cos(direction), std::sin(direction), 0);
      motion.translation() = target - motion.linear() * groups_[g].centre;
      if (collides(g, motion, motions) || !sight_.in_room(groups_[g].centre, target)) continue;
      motions[g] = motion;
      moves.push_back({g, motion});
      break;
    }
  }
  return moves;
}

mapping::World MovableWorld::moved(const std::vector<Move>& moves) const {
  mapping::World world = world_;
  const std::vector<Isometry3d> root_from_link = root_from_links(world_, {});
  for (const Move& move : moves)
    for (mapping::Joint& joint : world.joints) {
      if (std::ranges::find(groups_[move.group].branches, joint.child) == groups_[move.group].branches.end())
        continue;
      const Isometry3d& root_from_parent = root_from_link[world_.link_index(joint.parent)];
      joint.parent_from_joint =
          root_from_parent.inverse() * move.now_from_before * root_from_parent * joint.parent_from_joint;
    }
  return world;
}

size_t MovableWorld::points_on(size_t group, const Isometry3d& now_from_before,
                               const std::vector<Vector3d>& points) const {
  constexpr double kNear = 0.02;
  const Isometry3d before_from_now = now_from_before.inverse();
  size_t count = 0;
  for (const Vector3d& point : points) {
    const Vector3d p = before_from_now * point;
    if ((p - groups_[group].centre).head<2>().norm() > 1.5) continue;
    for (const Prism& prism : prisms_) {
      if (prism.group != static_cast<int>(group) || p.z() < prism.low - kNear || p.z() > prism.high + kNear)
        continue;
      std::vector<cv::Point2f> hull;
      for (const Eigen::Vector2d& corner : prism.hull)
        hull.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
      if (cv::pointPolygonTest(hull, {static_cast<float>(p.x()), static_cast<float>(p.y())}, true) < -kNear)
        continue;
      ++count;
      break;
    }
  }
  return count;
}

}  // namespace loci::apps::update_claim
