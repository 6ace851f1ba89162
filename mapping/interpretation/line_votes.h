#pragma once

#include <vector>

#include "mapping/base/pose.h"

namespace loci::mapping {

/// Hough votes of pieces of upright surface for the lines in the ground plan on which they lie: an angle of
/// the normal and an offset. Each piece knows its normal and votes for the angles near it only.
class LineVotes {
 public:
  struct Bins {
    int angles = 120;  ///< over the full turn
    int spread = 2;    ///< bins to each side of a piece's own angle that it votes for
    double offset_m = 0.03;
  };

  /// `reach`: metres from the origin to the farthest piece that will vote.
  LineVotes(double reach, const Bins& bins);

  void vote(const Vector2d& position, const Vector2d& normal, int amount);

  struct Peak {
    Vector2d normal;
    double offset = 0;
    int votes = 0;
    size_t bin = 0;
  };
  Peak strongest() const;
  /// No votes are left for it; later ones count.
  void forget(const Peak& peak) { votes_[peak.bin] = 0; }

 private:
  Vector2d direction(int angle) const;

  Bins bins_;
  double step_;
  int offsets_;
  std::vector<int> votes_;
};

}  // namespace loci::mapping
