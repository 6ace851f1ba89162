#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace loci {

/// The whole file as bytes. Throws Error when it does not exist or cannot be read.
std::string read_file(const std::filesystem::path& path);

/// Writes to a temporary file in the same folder, fsync, rename: the old file stays until the new one is
/// complete, also on a full disk.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Creates a folder and its parents; throws Error when that fails or a file is in the way.
void make_folder(const std::filesystem::path& path);

/// A file that is written in pieces and gets its name only at commit(). Without commit() the temporary file
/// is removed and an existing file stays.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace loci
