#pragma once

#include <string>

#include "mapping/interpretation/face_raster.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// What stands behind a front, where its shape, place, handle and look say so: "oven" (a dark pane of the
/// standard width among lighter fronts), "fridge" (a tall narrow front with a long upright handle). Empty
/// where the evidence does not suffice: a dishwasher's front looks like a cupboard's.
std::string appliance_of(const Front& front, const FaceRect& rect, const FaceRays& rays);

}  // namespace loci::mapping
