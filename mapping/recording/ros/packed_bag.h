#pragma once

#include <filesystem>
#include <string>

#include "mapping/base/progress.h"

namespace loci::mapping {

/// Whether a file is a bag that is compressed as a whole, by its name (NAME.mcap, NAME.db3 or NAME.bag with
/// .zstd, .zst, .gz or .bz2 behind it) and its first bytes.
bool is_packed_bag(const std::filesystem::path& path);

/// A bag unpacked into a file of the system's temporary folder, where nobody else may read it. While it is
/// written it has no name where the file system allows that; its name goes away with this object, its content
/// when the last reader closes it. Bytes before damage are kept. Error when it has no valid bytes, there is
/// no room for it, or it grows to 64 GiB or more than a thousand times the size of the packed file.
class UnpackedBag {
 public:
  UnpackedBag(const std::filesystem::path& packed, Progress& progress);
  ~UnpackedBag();
  UnpackedBag(const UnpackedBag&) = delete;
  UnpackedBag& operator=(const UnpackedBag&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Where it is damaged; empty when it is whole.
  const std::string& problem() const { return problem_; }

 private:
  void create(const std::filesystem::path& folder);
  void unpack(const std::filesystem::path& packed, const std::filesystem::path& folder, Progress& progress);
  void give_name(const std::filesystem::path& folder);
  void remove();

  int file_ = -1;
  std::filesystem::path path_;  ///< empty = it has no name
  std::string problem_;
};

}  // namespace loci::mapping
