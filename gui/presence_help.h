#pragma once

namespace loci::gui {

/// What the states of objects mean, for tooltips.
inline constexpr const char* kPresenceHelp =
    "seen: in the scene of the chosen time\n"
    "remembered: out of view, believed to be where it was\n"
    "hidden: behind something\n"
    "missed: looked for and not found, but it may still be there\n"
    "gone: looked for, and not there";

}  // namespace loci::gui
