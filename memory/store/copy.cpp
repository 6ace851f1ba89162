#include "memory/store/copy.h"

#include "mapping/base/error.h"

namespace loci::memory {

void copy_memory(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code none;
  const std::filesystem::path log = from.string() + "-wal";
  if (std::filesystem::exists(log, none) && std::filesystem::file_size(log, none) > 0)
    throw Error("another program is writing to this memory", {from.string(), 0, {}},
                "wait until it has finished");
  std::error_code code;
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, code);
  if (!code) return;
  std::filesystem::remove(to, none);
  // What the library says of a full disk is not that it is full.
  const auto space = std::filesystem::space(std::filesystem::absolute(to).parent_path(), none);
  const bool full = !none && space.available < std::filesystem::file_size(from, none);
  throw Error(full ? std::string("the disk is full") : "cannot be written: " + code.message(),
              {to.string(), 0, {}}, full ? "make room, or write it elsewhere" : "");
}

}  // namespace loci::memory
