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

inline constexpr const char* kTemporaryEnding = ".tmp";  ///< NAME.tmpPID_N, of files and folders

/// A new folder beside the one that it becomes, NAME.tmpPID_N. Those of the same NAME whose programs were
/// killed are removed first. Creates the parent as well.
std::filesystem::path make_partial_folder(const std::filesystem::path& target);
/// Whether make_partial_folder() of this machine made it, and nobody put it in its place.
bool is_partial_folder(const std::filesystem::path& folder);
/// Puts it in its place. A folder that is there goes: whether it may, the caller has checked. Error, and what
/// was there stays, when that fails.
void commit_partial_folder(const std::filesystem::path& partial, const std::filesystem::path& target);

}  // namespace loci
