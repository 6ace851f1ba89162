#include "mapping/base/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "mapping/base/error.h"

namespace loci {
namespace {

void sync_folder(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;  // The rename stands; only its durability is not confirmed.
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) throw Error("no such file", {path.string(), 0, {}});
  if (std::filesystem::is_directory(status))
    throw Error("is a folder, a file was expected", {path.string(), 0, {}});
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr)
    throw Error(std::string("cannot be read: ") + std::strerror(errno), {path.string(), 0, {}});
  std::string bytes;
  char buffer[1 << 16];
  size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file)) > 0) bytes.append(buffer, count);
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
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

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)), temporary_(path_) {
  temporary_ += ".tmp" + std::to_string(::getpid());
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr)
    throw Error(std::string("cannot be written: ") + std::strerror(errno), {path_.string(), 0, {}});
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    throw Error(std::string("writing failed: ") + std::strerror(errno), {path_.string(), 0, {}},
                "the old file, if there was one, is unchanged");
}

void AtomicFile::commit() {
  const bool written = std::fflush(file_) == 0 && ::fsync(::fileno(file_)) == 0;
  const int reason = errno;
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  std::error_code code;
  if (written && closed) std::filesystem::rename(temporary_, path_, code);
  if (!written || !closed || code) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    throw Error("writing failed: " + (code ? code.message() : std::string(std::strerror(reason))),
                {path_.string(), 0, {}}, "the old file, if there was one, is unchanged");
  }
  sync_folder(path_);
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace loci
