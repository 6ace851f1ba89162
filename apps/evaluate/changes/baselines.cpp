#include <algorithm>

#include "apps/evaluate/changes/story.h"
#include "apps/evaluate/pairing.h"
#include "memory/belief/evidence/similarity.h"

namespace loci::apps::changes {
namespace {

constexpr double kReach = 0.25;          ///< metres; beyond that nothing is a neighbour
constexpr double kMinCombined = 0.2;     ///< RoboSherlock's
constexpr double kMoved = 0.05;          ///< metres between two looks; visible parts differ by less
constexpr double kMinSimilar = 0.5;      ///< below, it looks different
constexpr double kNear = 0.3, kFar = 5;  ///< metres that a camera sees

/// An object as it was seen last.
struct Entry {
  memory::Id id = 0;
  memory::belief::Observation last;
};

double similar(const Entry& old, const Sight& seen) {
  return memory::belief::compare(old.last.descriptors, seen.evidence.descriptors, {}, 1)
      .similarity()
      .value_or(0.5);
}

double distance(const Entry& old, const Sight& seen) {
  return (old.last.box.centre - seen.evidence.box.centre).norm();
}

bool in_image(const Vector3d& point, const Moment& moment) {
  if (!moment.camera) return false;
  const Vector3d p = moment.map_from_camera.inverse() * point;
  if (p.z() < kNear || p.z() > kFar) return false;
  const double u = moment.camera->fx * p.x() / p.z() + moment.camera->cx;
  const double v = moment.camera->fy * p.y() / p.z() + moment.camera->cy;
  return u >= 0 && v >= 0 && u < moment.camera->width && v < moment.camera->height;
}

/// RoboSherlock's similarity of a pair, in [0,1].
double combined(const Entry& old, const Sight& seen) {
  const double proximity = memory::belief::gaussian_similarity(distance(old, seen), kReach);
  return 0.5 * similar(old, seen) + 0.5 * proximity;
}

Pairs greedy_pairs(const std::vector<Entry>& old, const std::vector<Sight>& seen) {
  return mutual_best(old.size(), seen.size(), kMinCombined,
                     [&](size_t o, size_t k) { return combined(old[o], seen[k]); });
}

Pairs nearest_pairs(const std::vector<Entry>& old, const std::vector<Sight>& seen) {
  return nearest_first(old.size(), seen.size(), kReach,
                       [&](size_t o, size_t k) { return distance(old[o], seen[k]); });
}

using Similarity = double (*)(const Entry&, const Sight&);

/// A similarity read as the probability of being the same; of what is new, that it is none of the known.
template <class PairUp>
Story tell(const Moments& moments, PairUp pair_up, Similarity similarity) {
  Story story;
  std::vector<Entry> old;
  memory::Id next = 1;
  for (const auto& [frame, moment] : moments) {
    Told& told = story[frame];
    std::vector<bool> found(old.size()), known(moment.sights.size());
    if (similarity != nullptr)
      for (const Sight& sight : moment.sights) {
        double& is_new = told.probability[sight.observation] = 1;
        for (const Entry& entry : old) is_new = std::min(is_new, 1 - similarity(entry, sight));
      }
    for (const auto& [o, k] : pair_up(old, moment.sights)) {
      const Sight& sight = moment.sights[k];
      found[o] = known[k] = true;
      told.object_of[sight.observation] = old[o].id;
      if (similarity != nullptr) told.probability[sight.observation] = similarity(old[o], sight);
      if (distance(old[o], sight) > kMoved)
        told.events[old[o].id].insert("moved");
      else if (similar(old[o], sight) < kMinSimilar)
        told.events[old[o].id].insert("looks_different");
      old[o].last = sight.evidence;
    }
    std::vector<Entry> kept;
    for (size_t o = 0; o < old.size(); ++o) {
      const bool gone = !found[o] && in_image(old[o].last.box.centre, moment);
      if (gone) told.events[old[o].id].insert("gone");
      if (!gone) kept.push_back(std::move(old[o]));
    }
    for (size_t k = 0; k < moment.sights.size(); ++k) {
      if (known[k]) continue;
      const Entry fresh{next++, moment.sights[k].evidence};
      told.object_of[moment.sights[k].observation] = fresh.id;
      told.events[fresh.id].insert("appeared");
      kept.push_back(fresh);
    }
    old = std::move(kept);
  }
  return story;
}

}  // namespace

Story greedy_story(const Moments& moments) {
  return tell(moments, greedy_pairs, combined);
}

Story nearest_story(const Moments& moments) {
  return tell(moments, nearest_pairs, nullptr);
}

}  // namespace loci::apps::changes
