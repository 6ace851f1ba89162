#pragma once

#include <filesystem>
#include <functional>

namespace loci::memory {

/// Copies a memory that nobody writes to, so that all of it is in the one file.
void copy_memory(const std::filesystem::path& from, const std::filesystem::path& to);

/// A memory under construction: removed with its log and lock when it goes out of scope, unless it was moved.
class TemporaryMemory {
 public:
  explicit TemporaryMemory(std::filesystem::path path) : path_(std::move(path)) { remove(); }
  ~TemporaryMemory() { remove(); }
  TemporaryMemory(const TemporaryMemory&) = delete;
  TemporaryMemory& operator=(const TemporaryMemory&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void remove() const;

  std::filesystem::path path_;
};

/// Creates a memory completely or not at all: `fill` writes it under a temporary name, which is then renamed.
/// An Error about the temporary file is reported of `memory`.
void create_atomically(const std::filesystem::path& memory,
                       const std::function<void(const std::filesystem::path&)>& fill);

}  // namespace loci::memory
