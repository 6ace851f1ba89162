#pragma once

#include "perception/classification/local_features.h"

namespace loci::perception {

/// "Household": what tells household objects apart whatever camera sees them. Metric sizes, the width by
/// height, shares of surfaces by direction, roundness, hollowness, curvature, planarity, outline and colours;
/// each from 0 to 1, and a last value that makes their sum the same for all vectors, so that scaling to a sum
/// keeps metres. Empty when the view shows fewer than 30 points, or nothing is known of what the object
/// stands on.
FeatureVector household_features(const ObjectView& view);

}  // namespace loci::perception
