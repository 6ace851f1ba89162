#include "mapping/interpretation/furniture/sliding.h"

#include <algorithm>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/furniture/parameters.h"

namespace loci::mapping {
namespace {

/// By how much `a` stands before `b`, whose neighbour it is, if both are panels that may pass each other; 0
/// for others.
double step_between(const Front& a, const Front& b) {
  const Vector3d apart = b.centre - a.centre;
  // Both may lean against the face that they were found in.
  const double slope = (a.evidence.value("slope", 0.0) + b.evidence.value("slope", 0.0)) / 2;
  const double step = slope * a.right().dot(apart) - a.normal.dot(apart);
  if (a.normal.dot(b.normal) < kCabinets.parallel_cosine || step < kSliding.min_step_m ||
      step > kSliding.max_step_m)
    return 0;
  const double lift = a.up.dot(apart), taller = (b.height - a.height) / 2;
  const bool level = std::max(std::abs(lift + taller), std::abs(lift - taller)) < kCabinets.aligned_m;
  // What is seen of the rear panel ends at the front one, or somewhat behind its edge.
  const double gap = std::abs(a.right().dot(apart)) - (a.width + b.width) / 2;
  const bool meet = std::abs(gap) < step + kCabinets.aligned_m;
  const bool alike = std::min(a.width, b.width) > kSliding.min_width_ratio * std::max(a.width, b.width);
  return level && meet && alike && !a.has_level_bar() && !b.has_level_bar() ? step : 0;
}

/// The joint of a panel that slides past another one.
void set_slide(Front& front, const Front& other, double step) {
  if (slides_sideways(front)) return;  // It has neighbours on both sides.
  JointEstimate joint = front.joint ? *front.joint : joint_prior(front);
  for (double& probability : joint.probabilities) probability *= 1 - kSliding.probability;
  joint.probabilities[static_cast<size_t>(ArticulationType::prismatic)] += kSliding.probability;
  joint.type = ArticulationType::prismatic;
  const double side = front.right().dot(other.centre - front.centre);
  joint.axis = side > 0 ? front.right() : Vector3d(-front.right());
  joint.origin = front.centre;
  joint.lower = 0;
  joint.upper = std::min(front.width, other.width);
  joint.hinge_from.clear();
  front.joint = joint;
  front.class_name = front_class(front, joint);
  front.evidence["step_to_neighbour_m"] = std::round(1e3 * step) / 1e3;
}

}  // namespace

bool slides_sideways(const Front& front) {
  return front.joint && front.joint->type == ArticulationType::prismatic &&
         std::abs(front.joint->axis.normalized().dot(front.normal)) < std::sqrt(0.5);
}

void pair_sliding_panels(std::vector<Front>& fronts) {
  const std::vector<Front> found = fronts;
  for (size_t i = 0; i < found.size(); ++i)
    for (size_t k = 0; k < found.size(); ++k) {
      const double step = i == k ? 0 : step_between(found[i], found[k]);
      if (step == 0) continue;
      set_slide(fronts[i], found[k], step);
      set_slide(fronts[k], found[i], step);
    }
}

}  // namespace loci::mapping
