#pragma once

#include <array>

namespace loci::memory {

/// The views that people may rely on (docs/memory.md), without their prefix "v_".
inline constexpr std::array kPublicViews = {"objects",          "observations", "events", "scenes",
                                            "place_visibility", "log",          "facts"};

}  // namespace loci::memory
