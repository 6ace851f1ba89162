#pragma once

#include <memory>
#include <string>

#include "apps/cli/program.h"
#include "mapping/recording/recording.h"
#include "mapping/world/semantic_map.h"

namespace loci::apps {

struct PosedRecording {
  std::unique_ptr<mapping::Recording> recording;
  bool tracked = false;  ///< it had no poses of its own
};

/// A recording to map from, in the frame of `map` if there is one. Error where its own poses do not fit the
/// depth: a map of them would be invented.
PosedRecording open_posed(const std::string& path, const mapping::RecordingOptions& reading, Session& session,
                          const mapping::SemanticMap* map = nullptr);

}  // namespace loci::apps
