#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace loci::memory {

/// Reads a file line by line with bounded memory: lines that are too long are passed over, not held.
class LineReader {
 public:
  enum class Status { line, too_long, end };

  /// Error when the file cannot be read. `limit` in bytes.
  explicit LineReader(const std::filesystem::path& path, size_t limit = kDefaultLimit);

  /// The next line without its end.
  Status next(std::string& line);
  int64_t number() const { return number_; }  ///< of the line read last, from 1
  double fraction() const;                    ///< of the file that was read

  static constexpr size_t kDefaultLimit = size_t{16} << 20;

 private:
  bool fill();

  std::filesystem::path path_;
  std::ifstream file_;
  size_t limit_;
  std::string buffer_;
  size_t at_ = 0;
  int64_t number_ = 0;
  uint64_t read_ = 0, size_ = 0;
};

}  // namespace loci::memory
