#include "mapping/base/files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/output_file.h"

namespace loci {

void require_regular_file(const std::filesystem::path& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) throw Error("no such file", {path.string(), 0, {}});
  if (std::filesystem::is_directory(status))
    throw Error("is a folder, a file was expected", {path.string(), 0, {}});
  if (!std::filesystem::is_regular_file(status))
    throw Error("is not a regular file", {path.string(), 0, {}}, "write what it holds into a file first");
}

std::string read_file(const std::filesystem::path& path) {
  require_regular_file(path);
  constexpr uint64_t kMaxBytes = uint64_t{1} << 35;  // more is not read into memory at once
  const auto refuse_size = [&] {
    throw Error(fmt::format("is larger than {} GiB", kMaxBytes >> 30), {path.string(), 0, {}});
  };
  std::error_code code;
  if (const auto size = std::filesystem::file_size(path, code); !code && size > kMaxBytes) refuse_size();
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr)
    throw Error(std::string("cannot be read: ") + std::strerror(errno), {path.string(), 0, {}});
  std::string bytes;
  char buffer[1 << 16];
  size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file)) > 0) {
    bytes.append(buffer, count);
    if (bytes.size() > kMaxBytes) break;  // it grows
  }
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  if (bytes.size() > kMaxBytes) refuse_size();
  if (failed) throw Error("reading failed", {path.string(), 0, {}});
  return bytes;
}

void make_folder(const std::filesystem::path& path) {
  std::error_code code;
  std::filesystem::create_directories(path, code);
  if (code || !std::filesystem::is_directory(path))
    throw Error("cannot create this folder: " + (code ? code.message() : std::string("a file is in the way")),
                {path.string(), 0, {}});
}

void check_folder_name(const std::filesystem::path& path) {
  static const std::set<std::string> endings = {".bag",  ".csv",  ".db3",  ".gif",  ".glb", ".gz",  ".html",
                                                ".jpg",  ".json", ".loci", ".mcap", ".obj", ".pcd", ".pdf",
                                                ".pgm",  ".ply",  ".png",  ".sdf",  ".svg", ".tar", ".txt",
                                                ".urdf", ".xml",  ".yaml", ".yml",  ".zip"};
  const std::string ending = path.extension().string();
  std::error_code none;
  if (!endings.contains(ending) || std::filesystem::exists(path, none)) return;
  throw Error(fmt::format("what is written is a folder, its name ends in {} as a file's", ending),
              {path.string(), 0, {}}, "name a folder");
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  write_output(path, bytes, {.replace = Replace::anything});
}

}  // namespace loci
