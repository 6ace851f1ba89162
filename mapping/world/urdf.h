#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Parses a URDF file through urdfdom. Error with the reason when it is refused: not XML, a cycle (with the
/// links on it), a missing parent, two roots, a link that is not unique, sizes that are not finite and
/// positive, a movable joint without limits.
/// Limits in reverse order, as of mirrored doors that were published so, are swapped, with one warning.
World read_urdf(const std::filesystem::path& path, Warnings& warnings);
World parse_urdf(const std::string& text, const std::string& file, Warnings& warnings);
/// The same where nobody reads warnings.
World read_urdf(const std::filesystem::path& path);
World parse_urdf(const std::string& text, const std::string& file);

/// URDF text that urdfdom reads back equal; keeps materials, mimic, safety, calibration, dynamics and
/// extensions.
std::string urdf_text(const World& world);
void write_urdf(const World& world, const std::filesystem::path& path);

/// What a map in a folder is called: the folder's name, "map" where it has none.
std::string map_name(const std::filesystem::path& folder);

}  // namespace loci::mapping
