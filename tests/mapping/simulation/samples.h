#pragma once

#include <filesystem>

namespace loci::mapping {

/// The scenarios and kitchens that come with the project.
inline const std::filesystem::path kSamples = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples";

}  // namespace loci::mapping
