#include "memory/recorder/news.h"

#include <algorithm>
#include <cmath>

namespace loci::memory {
namespace {

// Smaller changes make no row of belief (they are told in the schema).
constexpr double kToldProbability = 0.05;
constexpr double kToldDistance_m = 0.005;  ///< and the standard deviation
constexpr double kToldSize_m = 0.01;
constexpr double kToldSizeShare = 0.1;
constexpr double kJointMoved = 0.01;  ///< metres or radians

}  // namespace

bool is_news(const BeliefRow& before, const BeliefRow& row, bool seen_now) {
  const bool gone = row.status == ObjectStatus::gone;
  if (gone != (before.status == ObjectStatus::gone)) return true;
  if (row.place != before.place || !before.position || !before.size) return true;
  if ((*row.position - *before.position).norm() > std::max(kToldDistance_m, before.sigma.value_or(0)))
    return true;
  const Eigen::Array3d resized = (*row.size - *before.size).array().abs();
  if ((resized > kToldSize_m + kToldSizeShare * before.size->array()).any()) return true;
  const double expected = seen_now ? 1.0 : faded(before, row.then);
  return !gone && std::abs(row.probability - expected) > kToldProbability;
}

bool joint_moved(double from, double to) {
  return std::abs(to - from) > kJointMoved;
}

ObjectStatus unseen_status(const belief::Visibility& v) {
  if (v.observed() >= v.out_of_view && v.observed() >= v.hidden + v.unmeasured) return ObjectStatus::missed;
  return v.out_of_view >= v.hidden + v.unmeasured ? ObjectStatus::out_of_view : ObjectStatus::hidden;
}

double unseen_probability(const belief::Visibility& v, ObjectStatus status) {
  const double share = status == ObjectStatus::missed        ? v.observed()
                       : status == ObjectStatus::out_of_view ? v.out_of_view
                                                             : v.hidden + v.unmeasured;
  return std::clamp(share, 0.0, 1.0);
}

}  // namespace loci::memory
