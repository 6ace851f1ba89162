#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"

namespace loci::apps::changes {

struct RememberOptions {
  std::filesystem::path memory;                           ///< to be made
  std::filesystem::path map;                              ///< URDF; empty = none
  std::vector<std::filesystem::path> package_paths = {};  ///< where package:// of the map is looked for
  std::filesystem::path pipeline;                         ///< YAML; empty = the default one
  std::string program;
  int threads = 0;
};

/// Perceives a recording into a memory, as `loci-perceive run` does.
void remember(const std::shared_ptr<mapping::Recording>& recording, const RememberOptions& options,
              Progress& progress, Warnings& warnings);

}  // namespace loci::apps::changes
