#pragma once

#include <filesystem>
#include <vector>

namespace loci {

/// A recording that loci wrote names its files in this one, a line each.
inline constexpr const char* kRecordingManifest = ".loci-recording";

/// Throws Error when `output` lies within one of the folders, or within a recording that loci wrote: its
/// files belong together, and nothing is added to them.
void refuse_within(const std::filesystem::path& output, const std::vector<std::filesystem::path>& recordings);

}  // namespace loci
