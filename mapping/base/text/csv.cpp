#include "mapping/base/text/csv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "mapping/base/text/text_file.h"

namespace loci {
namespace {

/// Reads one record from `text` at `at`, counting lines; returns false at the end.
bool next_record(std::string_view text, size_t& at, int& line, std::vector<std::string>& cells) {
  cells.clear();
  if (at >= text.size()) return false;
  std::string cell;
  bool quoted = false;
  while (at < text.size()) {
    const char c = text[at++];
    if (c == '\n') ++line;
    if (quoted) {
      if (c != '"')
        cell += c;
      else if (at < text.size() && text[at] == '"')
        cell += text[at++];
      else
        quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      cells.push_back(std::move(cell));
      cell.clear();
    } else if (c == '\n') {
      break;
    } else if (c != '\r') {
      cell += c;
    }
  }
  cells.push_back(std::move(cell));
  return true;
}

template <class T>
T parse_number(const std::string& text, const FileLocation& location, const char* kind) {
  T value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end)
    throw Error(fmt::format("'{}' is not a {}", text, kind), location);
  return value;
}

}  // namespace

CsvTable CsvTable::read(const std::filesystem::path& path) {
  return parse(read_text(path), path.string());
}

CsvTable CsvTable::parse(std::string_view text, const std::string& file) {
  CsvTable table;
  table.file_ = file;
  size_t at = 0;
  int line = 1;
  if (!next_record(text, at, line, table.header_)) throw Error("the file is empty", {file, 0, {}});
  std::vector<std::string> cells;
  for (int start = line; next_record(text, at, line, cells); start = line) {
    if (cells.size() == 1 && cells[0].empty()) continue;
    if (cells.size() != table.header_.size())
      throw Error(fmt::format("this row has {} cells, the header has {}", cells.size(), table.header_.size()),
                  {file, start, {}});
    table.cells_.push_back(cells);
    table.lines_.push_back(start);
  }
  return table;
}

int CsvTable::column(const std::string& name) const {
  for (size_t i = 0; i < header_.size(); ++i)
    if (header_[i] == name) return static_cast<int>(i);
  return -1;
}

size_t CsvTable::require_column(const std::string& name) const {
  const int index = column(name);
  if (index < 0)
    throw Error(fmt::format("the column '{}' is missing", name), {file_, 1, {}}, did_you_mean(name, header_));
  return static_cast<size_t>(index);
}

double CsvTable::number(size_t row, size_t column) const {
  const auto value = parse_number<double>(cell(row, column), location(row, header_[column]), "number");
  if (!std::isfinite(value)) throw Error("this number is not finite", location(row, header_[column]));
  return value;
}

int64_t CsvTable::integer(size_t row, size_t column) const {
  return parse_number<int64_t>(cell(row, column), location(row, header_[column]), "whole number");
}

FileLocation CsvTable::location(size_t row, const std::string& key) const {
  return {file_, lines_[row], key};
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace loci
