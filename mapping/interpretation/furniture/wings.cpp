#include "mapping/interpretation/furniture/wings.h"

#include <algorithm>
#include <cmath>

#include "mapping/interpretation/furniture/parameters.h"

namespace loci::mapping {
namespace {

bool is_bare_door(const Front& front) {
  return !front.fixture && front.class_name == "door" && front.joint && front.joint->evidence == "prior" &&
         front.joint->type == ArticulationType::revolute;
}

/// Whether `b` is an equal door to the right of `a`, as seen from before them.
bool is_next(const Front& a, const Front& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) < kCabinets.aligned_m; };
  const Vector3d apart = b.centre - a.centre;
  return a.normal.dot(b.normal) > kCabinets.parallel_cosine &&
         std::abs(a.normal.dot(apart)) < kCabinets.same_face_m && near(a.up.dot(apart), 0) &&
         near(a.height, b.height) && near(a.width, b.width) && near(a.right().dot(apart), a.width) &&
         std::max(a.width, b.width) < kCabinets.max_wing_m;
}

void set_hinge(Front& front, bool right) {
  JointEstimate& joint = *front.joint;
  joint.hinge_from = "pair";
  const double turn = front.up.dot(joint.axis);  // a hinge on the right opens by +up
  if ((turn > 0) == right) return;
  joint.axis = -joint.axis;
  joint.origin -= 2 * front.right().dot(joint.origin - front.centre) * front.right();
}

}  // namespace

void pair_wings(std::vector<Front>& fronts) {
  std::vector<Front*> doors;
  for (Front& front : fronts)
    if (is_bare_door(front)) doors.push_back(&front);
  const auto next_of = [&](const Front* door) {
    const auto next = std::ranges::find_if(doors, [&](const Front* other) { return is_next(*door, *other); });
    return next == doors.end() ? nullptr : *next;
  };
  for (Front* door : doors) {
    door->joint->hinge_from = "assumed";
    if (std::ranges::any_of(doors, [&](const Front* other) { return is_next(*other, *door); })) continue;
    std::vector<Front*> row;
    for (Front* one = door; one != nullptr; one = next_of(one)) row.push_back(one);
    if (row.size() % 2 != 0) continue;  // which of them are pairs is open
    for (size_t i = 0; i < row.size(); ++i) set_hinge(*row[i], i % 2 != 0);
  }
}

}  // namespace loci::mapping
