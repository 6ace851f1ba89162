#pragma once

#include <filesystem>
#include <system_error>

#include "mapping/base/error.h"

namespace loci::memory {

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

/// Makes a memory as a whole or not at all: `make` fills it under another name, which is then its own. What
/// goes wrong with that file is told of the memory that was asked for.
template <class Make>
void make_as_a_whole(const std::filesystem::path& memory, Make make) {
  const ScratchMemory scratch(memory.string() + ".partial");
  try {
    make(scratch.path());
    scratch.move_to(memory);
  } catch (const Error& error) {
    if (error.location().file != scratch.path().string()) throw;
    throw Error(error.message(), {memory.string(), 0, {}},
                "nothing is left of it; make room, or write it elsewhere");
  }
}

}  // namespace loci::memory
