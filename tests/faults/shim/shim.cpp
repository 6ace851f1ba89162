// Preloaded into a program: from its n-th change of a file in a folder on, nothing there can be written any
// more, as on a lost network mount or a full disk; and the clock of the day may be behind.
//
//   LOCI_FAULT_FOLDER   the folder
//   LOCI_FAULT_AFTER    n; 0 = never
//   LOCI_FAULT_ERROR    number of the error, EIO or ENOSPC
//   LOCI_FAULT_COUNT    file that gets the number of changes at the end
//   LOCI_FAULT_CLOCK_S  seconds by which the clock is behind

#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>
#include <ctime>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> changes{0};

long number_of(const char* variable) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? 0 : std::atol(text);
}

bool is_concerned(int descriptor) {
  static const char* const folder = std::getenv("LOCI_FAULT_FOLDER");
  if (folder == nullptr) return false;
  char link[64], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = ::readlink(link, path, sizeof path);
  const size_t prefix = std::strlen(folder);
  return length >= static_cast<ssize_t>(prefix) && std::memcmp(path, folder, prefix) == 0;
}

/// Whether this change fails; errno is set then.
bool fails(int descriptor) {
  static const long after = number_of("LOCI_FAULT_AFTER"), error = number_of("LOCI_FAULT_ERROR");
  const int before = errno;
  const bool concerned = is_concerned(descriptor);
  errno = before;
  if (!concerned || ++changes < after || after == 0) return false;
  errno = static_cast<int>(error);
  return true;
}

/// The function that this one stands before.
template <class Function>
Function* real(Function*, const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

struct Counter {
  ~Counter() {
    const char* const path = std::getenv("LOCI_FAULT_COUNT");
    std::FILE* const file = path == nullptr ? nullptr : std::fopen(path, "w");
    if (file == nullptr) return;
    std::fprintf(file, "%ld\n", changes.load());
    std::fclose(file);
  }
} counter;

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t size) {
  static auto* const function = real(&write, "write");
  return fails(descriptor) ? -1 : function(descriptor, bytes, size);
}

ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t at) {
  static auto* const function = real(&pwrite, "pwrite");
  return fails(descriptor) ? -1 : function(descriptor, bytes, size, at);
}

ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off64_t at) {
  static auto* const function = real(&pwrite64, "pwrite64");
  return fails(descriptor) ? -1 : function(descriptor, bytes, size, at);
}

int fsync(int descriptor) {
  static auto* const function = real(&fsync, "fsync");
  return fails(descriptor) ? -1 : function(descriptor);
}

int fdatasync(int descriptor) {
  static auto* const function = real(&fdatasync, "fdatasync");
  return fails(descriptor) ? -1 : function(descriptor);
}

int ftruncate(int descriptor, off_t size) {
  static auto* const function = real(&ftruncate, "ftruncate");
  return fails(descriptor) ? -1 : function(descriptor, size);
}

int ftruncate64(int descriptor, off64_t size) {
  static auto* const function = real(&ftruncate64, "ftruncate64");
  return fails(descriptor) ? -1 : function(descriptor, size);
}

int clock_gettime(clockid_t clock, timespec* time) {
  static auto* const function = real(&clock_gettime, "clock_gettime");
  static const long behind = number_of("LOCI_FAULT_CLOCK_S");
  const int result = function(clock, time);
  if (result == 0 && clock == CLOCK_REALTIME) time->tv_sec -= behind;
  return result;
}

}  // extern "C"
