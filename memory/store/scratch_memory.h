#pragma once

#include <filesystem>
#include <system_error>

namespace loci {

/// A memory in the making, with its log and lock: removed when it goes out of scope, unless it was moved to
/// its place.
class ScratchMemory {
 public:
  explicit ScratchMemory(std::filesystem::path path) : path_(std::move(path)) { remove(); }
  ~ScratchMemory() { remove(); }
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Where it was made as a whole; its Store must be closed. Throws std::filesystem::filesystem_error.
  void move_to(const std::filesystem::path& place) const { std::filesystem::rename(path_, place); }

 private:
  void remove() const {
    std::error_code ignored;
    for (const char* end : {"", "-wal", "-shm", ".lock"})
      std::filesystem::remove(path_.string() + end, ignored);
  }

  std::filesystem::path path_;
};

}  // namespace loci
