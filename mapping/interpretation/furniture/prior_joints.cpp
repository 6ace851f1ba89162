#include "mapping/interpretation/furniture/prior_joints.h"

#include <algorithm>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/interpretation/furniture/sliding.h"

namespace loci::mapping {
namespace {

constexpr size_t index_of(ArticulationType type) {
  return static_cast<size_t>(type);
}

/// Sets joint and class; `odds` multiply the probability of what something beside the shape suggests.
void set_joint(Front& front, ArticulationType suggested, double odds) {
  JointEstimate joint = joint_prior(front);
  joint.probabilities[index_of(suggested)] *= odds;
  double sum = 0;
  for (const double p : joint.probabilities) sum += p;
  for (double& p : joint.probabilities) p /= sum;
  const auto& probabilities = joint.probabilities;
  if (!front.fixture) {
    if (probabilities[index_of(ArticulationType::rigid)] > kFurniture.max_fixed_probability) return;
    const bool slides = probabilities[index_of(ArticulationType::prismatic)] >
                        probabilities[index_of(ArticulationType::revolute)];
    const auto type = slides ? ArticulationType::prismatic : ArticulationType::revolute;
    JointEstimate opening = joint_prior(front, type);
    opening.probabilities = probabilities;
    joint = opening;
  }
  front.joint = joint;
  front.class_name = front_class(front, joint);
}

/// Whether nothing but its shape shows how a front opens, if it does.
bool is_bare(const Front& front) {
  return !front.fixture && !slides_sideways(front) && (!front.joint || front.joint->evidence == "prior");
}

bool near(double a, double b) {
  return std::abs(a - b) < kCabinets.aligned_m;
}

bool are_equal(const Front& a, const Front& b) {
  return a.normal.dot(b.normal) > kCabinets.parallel_cosine &&
         std::abs(a.normal.dot(b.centre - a.centre)) < kCabinets.same_face_m && near(a.height, b.height) &&
         near(a.width, b.width);
}

/// Whether `b` is an equal front to the right of `a`, as seen from before them.
bool is_next(const Front& a, const Front& b) {
  const Vector3d apart = b.centre - a.centre;
  return are_equal(a, b) && near(a.up.dot(apart), 0) && near(a.right().dot(apart), a.width);
}

/// Whether `b` is an equal front above or below `a`.
bool is_in_column(const Front& a, const Front& b) {
  const Vector3d apart = b.centre - a.centre;
  return are_equal(a, b) && near(a.right().dot(apart), 0) && near(std::abs(a.up.dot(apart)), a.height);
}

/// Whether a front may be one of the two doors of a cupboard.
bool may_be_wing(const Front& front) {
  const bool upright = front.height > front.width || front.class_name == "door";
  return is_bare(front) && upright && front.width < kCabinets.max_wing_m;
}

void become_wing(Front& front, bool right) {
  set_joint(front, ArticulationType::revolute, kFurniture.neighbour_odds);
  if (front.class_name != "door") return;
  JointEstimate& joint = *front.joint;
  joint.hinge_from = "pair";
  const double turn = front.up.dot(joint.axis);  // a hinge on the right opens by +up
  if ((turn > 0) == right) return;
  joint.axis = -joint.axis;
  joint.origin -= 2 * front.right().dot(joint.origin - front.centre) * front.right();
}

void pair_wings(std::vector<Front>& fronts) {
  std::vector<Front*> doors;
  for (Front& front : fronts)
    if (may_be_wing(front)) doors.push_back(&front);
  const auto next_of = [&](const Front* door) {
    const auto next = std::ranges::find_if(doors, [&](const Front* other) { return is_next(*door, *other); });
    return next == doors.end() ? nullptr : *next;
  };
  for (Front* door : doors) {
    if (std::ranges::any_of(doors, [&](const Front* other) { return is_next(*other, *door); })) continue;
    std::vector<Front*> row;
    for (Front* one = door; one != nullptr; one = next_of(one)) row.push_back(one);
    if (row.size() % 2 != 0) continue;  // which of them are pairs is open
    for (size_t i = 0; i < row.size(); ++i) become_wing(*row[i], i % 2 != 0);
  }
}

}  // namespace

void set_prior_joint(Front& front) {
  set_joint(front, ArticulationType::rigid, 1);
}

void follow_neighbours(std::vector<Front>& fronts) {
  for (Front& front : fronts) {
    if (!is_bare(front)) continue;
    const auto like = std::ranges::find_if(fronts, [&](const Front& other) {
      return other.fixture && other.joint &&
             (is_next(front, other) || is_next(other, front) || is_in_column(front, other));
    });
    if (like != fronts.end()) set_joint(front, like->joint->type, kFurniture.neighbour_odds);
    if (front.class_name == "door" && front.joint) front.joint->hinge_from = "assumed";
  }
  pair_wings(fronts);
}

}  // namespace loci::mapping
