#pragma once

#include "gui/data/browser_data.h"
#include "gui/scene3d/colored_cloud.h"

namespace loci {

/// The measured points of a scene in the map frame with the colours of its picture (grey without one), at
/// most `limit` of them, taken in even steps. Empty without depth or pose.
ColoredCloud frame_cloud(const SceneContent& content, size_t limit);

}  // namespace loci
