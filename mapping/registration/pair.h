#pragma once

#include "mapping/registration/prepared_scan.h"
#include "mapping/registration/start_search.h"

namespace loci::mapping::registration {

/// The window that the options' expected errors ask for.
SearchWindow window_of(const RegistrationOptions& options);

/// Aligns two prepared scans; the guess and the result are between the scans' own frames.
PairAlignment align_pair(const PreparedScan& target, const PreparedScan& source,
                         const Isometry3d& target_from_source, const SearchWindow& window,
                         const RegistrationOptions& options);

/// Part of the source's coarse surface that lies within reach of the target's at a guess: a fixed-radius
/// search modelled on the expected localisation error (§7.3).
double expected_overlap(const PreparedScan& target, const PreparedScan& source,
                        const Isometry3d& target_from_source);

}  // namespace loci::mapping::registration
