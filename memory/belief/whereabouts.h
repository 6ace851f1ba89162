#pragma once

#include <vector>

#include "memory/belief/rates.h"

namespace loci::memory::belief {

/// Probabilities that an object was handled between two looks, and how. Nothing is handled twice.
struct Handling {
  double removed = 0, moved = 0, changed = 0;
  double returned = 0;  ///< of an object that had been taken away

  double untouched() const { return 1 - removed - moved - changed; }
};

/// For an object when `attention` units of its clock have gone by.
Handling handling(const ChangeRates& rates, double attention);

/// Where an object may be that was not seen lately. The places where things can be put are divided into cells
/// of equal size. The masses are probabilities that sum to one with that of its being beyond recognition
/// (moved and changed).
struct Whereabouts {
  double here = 1;                ///< as it was, where it was
  double changed = 0;             ///< where it was, looking different
  double gone = 0;                ///< taken away
  double moved = 0;               ///< somewhere else because it was moved; by cell below
  double returned = 0;            ///< somewhere else, put there after it had been taken away; by cell below
  std::vector<double> elsewhere;  ///< per cell; empty = nowhere

  double present() const { return here + changed + moved + returned; }
};

/// Number of things per cell that nobody believes in, by where they come from.
struct Untracked {
  std::vector<double> arrived, initial, lost;

  explicit Untracked(size_t cells = 0) : arrived(cells, 0.0), initial(cells, 0.0), lost(cells, 0.0) {}
  double at(size_t cell) const { return arrived[cell] + initial[cell] + lost[cell]; }
  double sum() const;
};

/// Time goes by for one object. What becomes unrecognisable is added to `untracked.lost`.
void predict(Whereabouts& object, const Handling& handling, size_t cells, Untracked& untracked);

/// Time goes by for what is not believed in; `arrivals` per cell.
void predict(Untracked& untracked, const Handling& handling, double arrivals);

/// The object was not among what was seen: `in_view` is the probability that its last place was in view,
/// `seen[cell]` the share of the cell that was. Returns the probability of that.
double not_seen(Whereabouts& object, double in_view, const std::vector<double>& seen);

/// What was looked at holds nothing that is not believed in: what was found is from now on.
void looked_at(Untracked& untracked, const std::vector<double>& seen);

}  // namespace loci::memory::belief
