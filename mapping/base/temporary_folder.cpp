#include "mapping/base/temporary_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/output_file.h"

namespace loci {

TemporaryFolder::TemporaryFolder(const std::string& name, const std::filesystem::path& parent) {
  make_folder(parent);
  std::string path = (parent / (name + "-XXXXXX")).string();
  if (::mkdtemp(path.data()) == nullptr)
    throw Error("no folder can be made in it", {parent.string(), 0, {}}, "it has to be writable");
  path_ = path;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kPartialMark = ".loci-partial";  ///< in the folder; names the machine

std::string machine() {
  std::string name(256, '\0');
  if (::gethostname(name.data(), name.size() - 1) != 0) return {};
  return name.substr(0, name.find('\0'));
}

fs::path without_trailing_slash(const fs::path& folder) {
  const fs::path normal = folder.lexically_normal();  // "REC/" and "REC" are the same folder.
  return normal.has_filename() ? normal : normal.parent_path();
}

/// A new folder beside `folder` that nobody else uses.
fs::path private_neighbour(const fs::path& folder) {
  constexpr int kMaxAttempts = 1000;
  if (folder.has_parent_path()) make_folder(folder.parent_path());
  std::error_code code;
  for (int attempt = 0; attempt < kMaxAttempts && !code; ++attempt) {
    fs::path name = folder;
    name += fmt::format("{}{}_{}", kTemporaryEnding, ::getpid(), attempt);
    if (fs::create_directory(name, code)) return name;
  }
  throw Error("cannot create a folder here: " + code.message(), {folder.string(), 0, {}});
}

}  // namespace

fs::path make_partial_folder(const fs::path& target) {
  const fs::path named = without_trailing_slash(target);
  remove_abandoned(named);
  fs::path partial = private_neighbour(named);
  try {
    write_file_atomically(partial / kPartialMark, machine());
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
  return partial;
}

bool is_partial_folder(const fs::path& folder) {
  std::error_code none;
  return fs::is_regular_file(folder / kPartialMark, none) && read_file(folder / kPartialMark) == machine();
}

void commit_partial_folder(const fs::path& partial, const fs::path& target) {
  const fs::path named = without_trailing_slash(target);
  std::error_code code;
  fs::path old;  // has no mark: should this program be killed now, it stays
  if (fs::exists(named)) {
    old = private_neighbour(named);
    fs::rename(named, old, code);  // Onto an empty folder.
  }
  if (!code) fs::remove(partial / kPartialMark, code);
  if (!code) {
    fs::rename(partial, named, code);
    std::error_code ignored;
    if (code && !old.empty()) fs::rename(old, named, ignored);
  }
  if (code)
    throw Error("the recording cannot be put in its place: " + code.message(), {named.string(), 0, {}},
                "what was there before is unchanged");
  if (!old.empty()) fs::remove_all(old, code);
}

}  // namespace loci
