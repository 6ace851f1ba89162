#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "mapping/interpretation/interpretation.h"

namespace loci::mapping {

// Images of what a map was made from, with what the map says drawn over it.

/// The points seen from above in their colours with the outlines of links, as SVG with the points as an image
/// inside.
std::string top_view_svg(const InterpretedMap& map, const ScanSet& scans);

/// A front with what is around it, as a person before it sees it: from the map's photos, else from the points
/// of the scans. Outline and handle are drawn in red. CV_8UC3, BGR, at most 260 pixels wide and high.
cv::Mat view_of_front(const InterpretedMap& map, const ScanSet& scans, const Front& front);

/// The place that a note of the map names, in a red circle: from before the furniture there, else from above.
/// Empty when it names none.
cv::Mat view_of_note(const InterpretedMap& map, const ScanSet& scans, const std::string& note);

}  // namespace loci::mapping
