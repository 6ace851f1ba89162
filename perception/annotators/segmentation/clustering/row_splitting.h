#pragma once

#include <vector>

#include "perception/annotators/segmentation/clustering/stack_splitting.h"

namespace loci::perception {

/// Takes apart objects that stand behind each other in an oblique row, such as cups: far from the camera the
/// noise of the depth bridges the gaps between them, and edges are too coarse to part them. Both sides of a
/// cut stand on the support, little is measured in the gap between their footprints, and where they meet in
/// the image one is seen to begin behind the other. `members`: indices of the object. Gives the parts, or the
/// object itself.
std::vector<std::vector<size_t>> split_row(const StackCloud& cloud, std::vector<size_t> members);

}  // namespace loci::perception
