#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "apps/evaluate/changes/day_world.h"

namespace loci::apps::changes {

inline constexpr int kScenesOfADay = 18;

/// A day as a scenario (YAML) for `loci-simulate record`: scenes over some ten hours in which 11 to 16
/// objects, three equal cups in a row among them, are put elsewhere, pushed, turned, taken away and brought.
/// The middle cup goes away (before the 6th scene) and comes back (before the 12th). Same seed, same day.
/// With `drawers`, drawers are opened, looked into, and shut again with what was put in or left in them,
/// where the world has any.
std::string random_day(const DayWorld& world, const std::filesystem::path& urdf, uint64_t seed,
                       int scenes = kScenesOfADay, bool drawers = false);

}  // namespace loci::apps::changes
