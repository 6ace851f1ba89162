#pragma once

#include <vector>

#include "perception/detection/people_detector.h"

namespace loci::perception {

/// Finds arms of people who are out of view: what is narrow and round, hangs in the air, comes in from the
/// border of the depth image, and ends over a table or a counter with a colour of skin (§10.1). Horizontal
/// surfaces need not be in the map; other furniture that is not, and that an arm touches, hides it, and
/// gloves are no hands. None without depth, colour or a pose of the frame. The persons have no head; the
/// score is the share of skin of the hand.
std::vector<Person> find_arms(const PeopleFrame& frame);

}  // namespace loci::perception
