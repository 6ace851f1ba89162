#include "memory/store/memory_file.h"

#include <system_error>

#include "mapping/base/error.h"

namespace loci::memory {

namespace fs = std::filesystem;

void copy_memory(const fs::path& from, const fs::path& to) {
  std::error_code none;
  const fs::path log = from.string() + "-wal";
  if (fs::exists(log, none) && fs::file_size(log, none) > 0)
    throw Error("another program is writing to this memory", {from.string(), 0, {}},
                "wait until it has finished");
  std::error_code code;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, code);
  if (!code) return;
  fs::remove(to, none);
  // The library does not report a full disk as such.
  const auto space = fs::space(fs::absolute(to).parent_path(), none);
  const bool full = !none && space.available < fs::file_size(from, none);
  throw Error(full ? std::string("the disk is full") : "cannot be written: " + code.message(),
              {to.string(), 0, {}}, full ? "make room, or write it elsewhere" : "");
}

void TemporaryMemory::remove() const {
  std::error_code ignored;
  for (const char* end : {"", "-wal", "-shm", ".lock"}) fs::remove(path_.string() + end, ignored);
}

void create_atomically(const fs::path& memory, const std::function<void(const fs::path&)>& fill) {
  const TemporaryMemory partial(memory.string() + ".partial");
  try {
    fill(partial.path());
    fs::rename(partial.path(), memory);
  } catch (const Error& error) {
    if (error.location().file != partial.path().string()) throw;
    throw Error(error.message(), {memory.string(), 0, {}},
                "nothing of it remains; make room, or write it elsewhere");
  }
}

}  // namespace loci::memory
