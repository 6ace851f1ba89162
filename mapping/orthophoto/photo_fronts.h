#pragma once

#include <vector>

#include "mapping/orthophoto/orthophoto.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

struct PhotoFrontSearch {
  std::vector<Front> fronts;
  std::vector<Fixture> ribs;  ///< bars that stand in rows, too near to each other for handles
};

/// Fronts with handles in an orthophoto, in the map and without joints. The image is cut along seams and
/// steps of colour into the rectangles that best explain the bars before the face: each front has one, where
/// usual furniture has it (front_log_likelihood()), and few lines cross it. Rectangles without a bar are no
/// fronts.
/// `known`: handles and knobs that are known otherwise, map frame; each takes the place of a bar.
PhotoFrontSearch find_photo_fronts(const Orthophoto& photo, const std::vector<Fixture>& known = {});

}  // namespace loci::mapping
