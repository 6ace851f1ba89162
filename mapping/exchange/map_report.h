#pragma once

#include <string>

#include "mapping/interpretation/interpretation.h"

namespace loci::mapping {

/// A page about a map, in one file: top view of the points with outlines drawn over, links with evidence,
/// what was left out, configuration and timings. Others may add sections with html_with_section.
std::string map_report(const InterpretedMap& map, const ScanSet& scans, const std::string& input);

/// The top view alone, as SVG with the points as an image inside.
std::string top_view_svg(const InterpretedMap& map, const ScanSet& scans);

}  // namespace loci::mapping
