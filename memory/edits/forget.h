#pragma once

#include <filesystem>

#include "memory/edits/edits.h"

namespace loci::memory {

/// Erases what a request names from a memory, its belief and its reasoning, by rewrite_memory(): in its
/// place, or at `output` where one is given. After a period the scenes that follow are reasoned about anew,
/// as after an edit, if the evidence of all scenes is there: what they show is what they would show had
/// nothing been seen in the period. So are those before it from the first on of which later looks decided.
/// Error for an unknown object.
ForgetResult forget(const std::filesystem::path& memory, const ForgetRequest& request,
                    const std::filesystem::path& output = {}, Progress& progress = no_progress());

}  // namespace loci::memory
