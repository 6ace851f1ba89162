#pragma once

#include <string>

#include "mapping/interpretation/interpretation.h"

namespace loci::mapping {

/// A page about a map, in one file: plan, elevations over the photos of the map, what opens, images of what
/// is unsure and of what was left out, links with evidence, configuration and timings; with the
/// map's GLB also a 3-D view. Others may add sections with html_with_section.
std::string map_report(const InterpretedMap& map, const ScanSet& scans, const std::string& input,
                       const std::string& glb = {});

}  // namespace loci::mapping
