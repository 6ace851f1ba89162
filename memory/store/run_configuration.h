#pragma once

#include <filesystem>

#include "mapping/base/text/json_fwd.h"
#include "memory/store/rows/rows.h"

namespace loci::memory {

/// Programs whose configurations have ids; that of an edit may go on, as "loci-memory edit undo".
inline constexpr const char* kEditProgram = "loci-memory edit";
inline constexpr const char* kReasonProgram = "loci-memory reason";
/// Key of an edit of another memory that a merge did not take over.
inline constexpr const char* kLeftBehind = "left_behind";

/// The configuration of a run of an edit or of reasoning. Its keys that programs use have the types that they
/// rely on: "text", "undoes", "redoes", "last_scene", "label", "map", "part", "split", "identity". Error with
/// table, row and column when one has not, or when it is not JSON. `file` is the memory's, for the message.
Json configuration_of(const RunRow& run, const std::filesystem::path& file);

}  // namespace loci::memory
