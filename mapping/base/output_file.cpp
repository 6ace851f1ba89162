#include "mapping/base/output_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

#include "mapping/base/error.h"
#include "mapping/base/temporary_folder.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnchanged = "the old file, if there was one, is unchanged";

Error error_of(const fs::path& path, const std::string& what, const std::string& hint = {}) {
  return Error(what, {path.string(), 0, {}}, hint);
}

fs::path resolved(const fs::path& path) {
  std::error_code code;
  const fs::path result = fs::weakly_canonical(path, code);
  return code || result.empty() ? path : result;
}

bool contains(const fs::path& folder, const fs::path& path) {
  const fs::path relative = resolved(path).lexically_relative(resolved(folder));
  return !relative.empty() && *relative.begin() != "..";
}

/// Opens a new file NAME.tmpN. Nothing that exists is opened, a link neither.
std::FILE* create_beside(const fs::path& target, unsigned mode, fs::path& temporary) {
  constexpr int kMaxAttempts = 1000;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    temporary =
        target.string() + kTemporaryEnding + std::to_string(::getpid()) + "_" + std::to_string(attempt);
    const int descriptor = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor >= 0) {
      ::flock(descriptor, LOCK_EX | LOCK_NB);  // for remove_abandoned
      return ::fdopen(descriptor, "w+b");
    }
    if (errno != EEXIST) break;
  }
  return nullptr;
}

/// Renames; with `replace` unset only to a name that is free.
bool rename_to(const fs::path& from, const fs::path& to, bool replace) {
  if (replace) return ::rename(from.c_str(), to.c_str()) == 0;
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
  // The file system does not know this. A link never replaces a name.
  return ::link(from.c_str(), to.c_str()) == 0 && ::unlink(from.c_str()) == 0;
}

void sync_folder(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // The rename stands; only its durability is not confirmed.
  ::fsync(descriptor);
  ::close(descriptor);
}

constexpr const char* kMark = "user.loci.written";

std::string change_time(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return std::to_string(status.st_mtim.tv_sec) + "." + std::to_string(status.st_mtim.tv_nsec);
}

/// Without effect on a file system that has no extended attributes.
void mark(const fs::path& file) {
  const std::string time = change_time(file);
  ::setxattr(file.c_str(), kMark, time.data(), time.size(), 0);
}

/// Whether the program that made NAME.tmpPID_N is gone. `end` is the name after kTemporaryEnding.
bool is_abandoned(const fs::path& file, std::string_view end) {
  pid_t process = 0;
  const auto read = std::from_chars(end.data(), end.data() + end.size(), process);
  if (read.ec != std::errc() || read.ptr == end.data() + end.size() || *read.ptr != '_') return false;
  if (::kill(process, 0) == 0 || errno != ESRCH) return false;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool unlocked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;  // not by another machine either
  ::close(descriptor);
  return unlocked && (!fs::is_directory(file) || is_partial_folder(file));
}

}  // namespace

std::vector<fs::path> remove_abandoned(const fs::path& path) {
  const fs::path target = resolved(path);
  const std::string prefix = target.filename().string() + kTemporaryEnding;
  std::vector<fs::path> removed;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), none)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(prefix) && is_abandoned(entry.path(), name.substr(prefix.size())))
      removed.push_back(entry.path());
  }
  for (const fs::path& file : removed) fs::remove_all(file, none);
  return removed;
}

bool written_by_loci(const fs::path& file) {
  std::array<char, 4096> head;
  std::FILE* const stream = std::fopen(file.c_str(), "rb");
  if (stream == nullptr) return false;
  const size_t count = std::fread(head.data(), 1, head.size(), stream);
  std::fclose(stream);
  const std::string_view text(head.data(), count);
  if (text.starts_with("SQLite format 3")) return false;
  std::array<char, 64> time;
  const ssize_t length = ::getxattr(file.c_str(), kMark, time.data(), time.size());
  if (length < 0 && errno == ENOTSUP) return text.find("loci") != std::string_view::npos;
  return length > 0 && std::string_view(time.data(), static_cast<size_t>(length)) == change_time(file);
}

void refuse_inputs(const fs::path& output, const std::vector<fs::path>& inputs) {
  std::error_code none;
  if (!fs::exists(output, none)) return;
  for (const fs::path& input : inputs) {
    if (!fs::exists(input, none)) continue;
    if (fs::equivalent(output, input, none))
      throw error_of(output, "is an input of this command, it is not replaced", "write to another path");
    if (fs::is_directory(output, none) && contains(output, input))
      throw error_of(output, "contains an input of this command (" + input.string() + "), it is not replaced",
                     "write to another folder");
  }
}

void refuse_within(const fs::path& output, const std::vector<fs::path>& recordings) {
  std::error_code none;
  fs::path folder = resolved(fs::absolute(output, none));
  while (folder.has_relative_path()) {
    folder = folder.parent_path();
    const auto is_input = [&](const fs::path& recording) {
      return fs::is_directory(recording, none) && fs::equivalent(folder, recording, none);
    };
    if (fs::exists(folder / kRecordingManifest, none) || std::ranges::any_of(recordings, is_input))
      throw error_of(output, "lies within a recording (" + folder.string() + "), which is not changed",
                     "write to another path");
  }
}

void check_output(const fs::path& path, const OutputOptions& options) {
  std::error_code none;
  const fs::file_status status = fs::status(path, none);
  if (path.empty()) throw Error("an output without a name", {}, "give a path");
  if (!fs::exists(status)) return;
  if (fs::is_directory(status)) throw error_of(path, "is a folder, a file was expected");
  if (!fs::is_regular_file(status)) throw error_of(path, "is not a regular file", "write to another path");
  refuse_inputs(path, options.inputs);
  if (options.replace == Replace::nothing)
    throw error_of(path, "exists already", "move it away, or write to another path");
  if (options.replace == Replace::own && !written_by_loci(path))
    throw error_of(path, "exists already, and loci did not write it, or it was changed since",
                   "move it away, write to another path, or give --force");
}

OutputFile::OutputFile(fs::path path, OutputOptions options)
    : path_(std::move(path)), target_(resolved(path_)), options_(std::move(options)) {
  check_output(path_, options_);
  file_ = create_beside(target_, options_.mode, temporary_);
  if (file_ == nullptr)
    throw error_of(path_, std::string("cannot be written: ") +
                              (errno == ENOENT ? "the folder does not exist" : std::strerror(errno)));
  struct stat replaced {};
  if (::stat(target_.c_str(), &replaced) == 0) ::fchmod(::fileno(file_), replaced.st_mode & options_.mode);
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) discard();
}

void OutputFile::discard() {
  std::fclose(file_);
  file_ = nullptr;
  ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    throw error_of(path_, std::string("writing failed: ") + std::strerror(errno), kUnchanged);
}

void OutputFile::commit() {
  const bool replace = options_.replace != Replace::nothing;
  const bool written = std::fflush(file_) == 0;
  if (written) mark(temporary_);
  if (!written || ::fsync(::fileno(file_)) != 0 || !rename_to(temporary_, target_, replace)) {
    const int reason = errno;
    discard();
    throw error_of(path_, std::string("writing failed: ") + std::strerror(reason), kUnchanged);
  }
  std::fclose(file_);  // It is on the disk already: nothing is left that could fail.
  file_ = nullptr;
  sync_folder(target_);
}

void write_output(const fs::path& path, std::string_view bytes, const OutputOptions& options) {
  OutputFile file(path, options);
  file.write(bytes);
  file.commit();
}

}  // namespace loci
