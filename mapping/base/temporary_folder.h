#pragma once

#include <filesystem>
#include <string>

namespace loci {

/// A new folder that only its user can read, gone with all that is in it at the end.
class TemporaryFolder {
 public:
  /// `name` begins that of the folder. Error when `parent` cannot be written.
  explicit TemporaryFolder(const std::string& name,
                           const std::filesystem::path& parent = std::filesystem::temp_directory_path());
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace loci
