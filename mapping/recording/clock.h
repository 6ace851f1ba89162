#pragma once

#include <vector>

#include "mapping/recording/file_recording.h"

namespace loci::mapping {

/// Sorts frames by time. A clock that was set back, so that two passages would interleave, goes on instead:
/// frames keep the order of the file, and a line of the problems says from where on and by how much the
/// stamps were moved. Rows that are merely in another order than time are sorted, with a line.
void order_by_time(std::vector<FrameFiles>& frames, RecordingInfo& info);

}  // namespace loci::mapping
