#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

#include "mapping/base/files.h"

namespace loci::apps {

/// An empty folder of this process, gone with all that is in it at the end.
class TemporaryFolder {
 public:
  /// `name` tells several of one process apart.
  explicit TemporaryFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("loci-evaluate-" + name + "-" + std::to_string(getpid()))) {
    make_folder(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace loci::apps
