#include "mapping/interpretation/line_votes.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math.h"

namespace loci::mapping {

LineVotes::LineVotes(double reach, const Bins& bins)
    : bins_(bins),
      step_(2 * kPi / bins.angles),
      offsets_(2 * static_cast<int>(reach / bins.offset_m + 2) + 1),
      votes_(static_cast<size_t>(bins.angles * offsets_), 0) {}

Vector2d LineVotes::direction(int angle) const {
  return {std::cos(angle * step_), std::sin(angle * step_)};
}

void LineVotes::vote(const Vector2d& position, const Vector2d& normal, int amount) {
  const int centre = static_cast<int>(std::lround(std::atan2(normal.y(), normal.x()) / step_));
  for (int d = -bins_.spread; d <= bins_.spread; ++d) {
    const int angle = (centre + d + 2 * bins_.angles) % bins_.angles;
    const int offset =
        static_cast<int>(std::lround(direction(angle).dot(position) / bins_.offset_m)) + offsets_ / 2;
    votes_[static_cast<size_t>(angle * offsets_ + offset)] += amount;
  }
}

LineVotes::Peak LineVotes::strongest() const {
  const auto best = std::max_element(votes_.begin(), votes_.end());
  const int at = static_cast<int>(best - votes_.begin());
  return {direction(at / offsets_), (at % offsets_ - offsets_ / 2) * bins_.offset_m, *best,
          static_cast<size_t>(at)};
}

}  // namespace loci::mapping
