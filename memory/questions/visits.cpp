#include "memory/questions/visits.h"

#include <algorithm>

#include "memory/questions/presence.h"

namespace loci::memory {
namespace {

/// Of a visit so many views are counted, the last ones: recordings of a moving camera have thousands.
constexpr size_t kMaxViews = 16;

/// The views of a place that follow each other closely up to `last`, the last one first.
std::vector<VisibilityRow> views_before(const Store& store, const VisibilityRow& last) {
  std::vector<VisibilityRow> views = {last};
  AsOf before;
  while (views.size() < kMaxViews) {
    before.at = views.back().time - 1;
    const std::optional<VisibilityRow> view = store.last_visibility(*last.place, before);
    if (!view || views.back().time - view->time > kVisitGap) break;
    views.push_back(*view);
  }
  return views;
}

}  // namespace

std::optional<TimeNs> last_visit_begin(const Store& store, const AsOf& as_of) {
  const std::optional<SceneRow> last = store.latest_scene(as_of);
  if (!last) return std::nullopt;
  TimeNs begin = last->time;
  while (true) {
    const std::vector<SceneRow> before =
        store.scenes({.known_at = as_of.known_at}, begin - kVisitGap, begin - 1);
    if (before.empty()) return begin;
    begin = before.front().time;
  }
}

double fraction_of_visit(const Snapshot& snapshot, const PlaceRow& place, TimeNs from, TimeNs to,
                         double best_view) {
  return best_view >= kMinSeenFraction || from == to
             ? best_view
             : std::max(best_view, seen_fraction(snapshot, place, from, to));
}

std::optional<PlaceLook> last_look(const Snapshot& snapshot, const PlaceRow& place, double min_fraction) {
  const Store& store = snapshot.store();
  std::optional<VisibilityRow> last = store.last_visibility(place.id, snapshot.as_of());
  while (last) {
    const std::vector<VisibilityRow> views = views_before(store, *last);
    PlaceLook look{views.back().time, last->time, last->scene, last->fraction};
    for (const VisibilityRow& view : views)
      if (view.fraction) look.fraction = std::max(look.fraction.value_or(0), *view.fraction);
    if (look.fraction) look.fraction = fraction_of_visit(snapshot, place, look.from, look.to, *look.fraction);
    if (look.fraction.value_or(0) >= min_fraction) return look;
    last = store.last_visibility(place.id, {.at = look.from - 1});
  }
  return std::nullopt;
}

}  // namespace loci::memory
