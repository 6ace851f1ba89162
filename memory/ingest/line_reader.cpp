#include "memory/ingest/line_reader.h"

#include <algorithm>

#include "mapping/base/error.h"

namespace loci::memory {

LineReader::LineReader(const std::filesystem::path& path, size_t limit) : path_(path), limit_(limit) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code))
    throw Error("is a folder, a file was expected", {path.string(), 0, {}});
  file_.open(path, std::ios::binary);
  if (!file_) throw Error("cannot be read", {path.string(), 0, {}}, "give a file of detections, *.jsonl");
  size_ = std::filesystem::file_size(path, code);
  if (code) size_ = 0;  // a pipe
}

bool LineReader::fill() {
  buffer_.resize(size_t{1} << 16);
  file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_.resize(static_cast<size_t>(file_.gcount()));
  if (file_.bad()) throw Error("cannot be read to its end", {path_.string(), static_cast<int>(number_), {}});
  read_ += buffer_.size();
  at_ = 0;
  return !buffer_.empty();
}

LineReader::Status LineReader::next(std::string& line) {
  line.clear();
  bool any = false, too_long = false;
  while (at_ < buffer_.size() || fill()) {
    if (!any) ++number_;
    any = true;
    const size_t end = std::min(buffer_.find('\n', at_), buffer_.size());
    if (!too_long && line.size() + (end - at_) > limit_) {
      too_long = true;
      std::string().swap(line);
    }
    if (!too_long) line.append(buffer_, at_, end - at_);
    at_ = end + 1;
    if (end < buffer_.size()) break;
  }
  if (!any) return Status::end;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return too_long ? Status::too_long : Status::line;
}

double LineReader::fraction() const {
  return size_ == 0 ? 0.0 : std::min(1.0, static_cast<double>(read_) / static_cast<double>(size_));
}

}  // namespace loci::memory
