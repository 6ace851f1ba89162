#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"

namespace loci {

/// A table from a CSV file with a header row (RFC 4180: quotes, commas in quotes; rows end in LF or CRLF).
class CsvTable {
 public:
  static CsvTable read(const std::filesystem::path& path);
  static CsvTable parse(std::string_view text, const std::string& file);

  size_t rows() const { return cells_.size(); }
  const std::vector<std::string>& header() const { return header_; }
  /// Column of a name, -1 when it is missing.
  int column(const std::string& name) const;
  /// Column of a name; Error when it is missing.
  size_t require_column(const std::string& name) const;

  const std::string& cell(size_t row, size_t column) const { return cells_[row][column]; }
  /// The cell as a finite number; Error with file and line otherwise.
  double number(size_t row, size_t column) const;
  int64_t integer(size_t row, size_t column) const;
  /// Location of a row in the file.
  FileLocation location(size_t row, const std::string& key = {}) const;

 private:
  std::string file_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> cells_;
  std::vector<int> lines_;
};

/// A cell, quoted if it needs to be.
std::string csv_cell(std::string_view text);

}  // namespace loci
