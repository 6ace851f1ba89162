#pragma once

#include <optional>

#include "memory/belief/state.h"

namespace loci::memory::belief {

/// The extents of an object by all views of its present pose, metres: length, width and height. Of each
/// extent the upper quartile of the whole views that see its faces, else the most that any view shows. Stored
/// views forget what a side looked like before: extents shrink slowly from those `before`. Unset where no
/// view was measured.
std::optional<Vector3d> extents_of(const ProtoObject& object, const std::optional<Vector3d>& before = {});

}  // namespace loci::memory::belief
