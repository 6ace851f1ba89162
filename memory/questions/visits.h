#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// Looks that follow each other closer than this are one visit: no single view sees all of a place.
inline constexpr TimeNs kVisitGap = 600 * kSecond;

/// The first scene of the visit that ends with the last scene as of a time; unset without a scene.
inline std::optional<TimeNs> last_visit_begin(const Store& store, const AsOf& as_of) {
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

}  // namespace loci::memory
