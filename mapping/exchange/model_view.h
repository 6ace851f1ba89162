#pragma once

#include <string>

namespace loci::mapping {

/// A section "model" of a page: a map's GLB to look at and to download. It needs no other file; without WebGL
/// only the download remains.
std::string model_section(const std::string& glb);

}  // namespace loci::mapping
