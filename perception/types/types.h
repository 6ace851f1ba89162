#pragma once

#include "perception/types/generated.h"

namespace loci::perception::types {

/// Our types, from texts that are part of the program. Made once.
const std::shared_ptr<const cas::TypeSystem>& type_system();

/// Our types together with a user's: files in UIMA's XML, which may use and extend ours by name (or import
/// them as "loci.scene" and so on). Throws Error with file and line when they do not fit.
std::shared_ptr<const cas::TypeSystem> type_system_with(
    const std::vector<std::filesystem::path>& files,
    const std::vector<std::filesystem::path>& path_dirs = {});

}  // namespace loci::perception::types
