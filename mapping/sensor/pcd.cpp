#include "mapping/sensor/pcd.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/output_file.h"

namespace loci::mapping {
namespace {

template <class T>
T value_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <class T>
void append_value(std::string& data, T value) {
  data.append(reinterpret_cast<const char*>(&value), sizeof value);
}

struct Header {
  PcdCloud cloud;
  std::string encoding;
  size_t body = 0;  ///< where the points begin
  int lines = 0;
};

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

class HeaderParser {
 public:
  HeaderParser(const std::string& bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  Header parse() {
    while (header_.encoding.empty()) {
      const size_t end = bytes_.find('\n', header_.body);
      if (end == std::string::npos || header_.lines > 100)
        throw Error("not a PCD file, or one without its DATA line", location());
      const std::string line = bytes_.substr(header_.body, end - header_.body);
      header_.body = end + 1;
      ++header_.lines;
      take(words_of(line));
    }
    finish();
    return std::move(header_);
  }

 private:
  FileLocation location() const { return {file_, header_.lines, {}}; }

  size_t number(const std::string& word) const {
    size_t value = 0;
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size())
      throw Error(fmt::format("'{}' is not a whole number", word), location());
    return value;
  }

  void take(const std::vector<std::string>& words) {
    if (words.empty() || words[0].starts_with('#')) return;
    auto& fields = header_.cloud.fields;
    const std::string& key = words[0];
    const size_t count = words.size() - 1;
    if (key == "FIELDS" || key == "COLUMNS") {
      for (size_t i = 1; i < words.size(); ++i) fields.push_back({words[i], 'F', 4, 1, 0});
      return;
    }
    const bool per_field = key == "SIZE" || key == "TYPE" || key == "COUNT";
    if (per_field && count != fields.size())
      throw Error(fmt::format("{} has {} entries for {} fields", key, count, fields.size()), location());
    if (!per_field && key != "VIEWPOINT" && key != "VERSION" && count != 1)
      throw Error(fmt::format("'{}' is not a line of a PCD header", key.substr(0, 20)), location());
    for (size_t i = 0; per_field && i < count; ++i) {
      if (key == "SIZE") fields[i].size = static_cast<int>(number(words[i + 1]));
      if (key == "TYPE") fields[i].type = words[i + 1][0];
      if (key == "COUNT") fields[i].count = static_cast<int>(number(words[i + 1]));
    }
    if (key == "WIDTH") header_.cloud.width = number(words[1]);
    if (key == "HEIGHT") header_.cloud.height = number(words[1]);
    if (key == "POINTS") points_ = number(words[1]);
    if (key == "DATA") header_.encoding = words[1];
  }

  void finish() {
    PcdCloud& cloud = header_.cloud;
    for (PcdField& field : cloud.fields) {
      const bool sized = field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
      const bool typed = field.type == 'I' || field.type == 'U' || (field.type == 'F' && field.size >= 4);
      if (!sized || !typed || field.count < 1 || field.count > 65536)
        throw Error(fmt::format("the field '{}' has an unknown type", field.name), location());
      field.offset = cloud.point_size;
      cloud.point_size += static_cast<size_t>(field.size) * static_cast<size_t>(field.count);
    }
    if (cloud.fields.empty()) throw Error("the PCD file has no fields", location());
    if (cloud.width == 0) cloud.width = points_;
    constexpr size_t limit = size_t{1} << 40;
    if (cloud.height > limit || cloud.width > limit / std::max<size_t>(cloud.height, 1) / cloud.point_size)
      throw Error("the PCD file claims an impossible number of points", location());
    if (points_ != 0 && points_ != cloud.size())
      throw Error(fmt::format("POINTS is {}, WIDTH · HEIGHT is {}", points_, cloud.size()), location());
  }

  const std::string& bytes_;
  std::string file_;
  Header header_;
  size_t points_ = 0;
};

Error truncated(const std::string& file, size_t points) {
  return Error(fmt::format("the PCD file is truncated ({} points were announced)", points), {file, 0, {}},
               "copy or write the file again");
}

void append_number(std::string& data, const PcdField& field, const std::string& word,
                   const FileLocation& location) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (end != word.c_str() + word.size()) throw Error(fmt::format("'{}' is not a number", word), location);
  if (field.type == 'F') {
    field.size == 8 ? append_value(data, value) : append_value(data, static_cast<float>(value));
    return;
  }
  const double bound = std::ldexp(1.0, 8 * std::min(field.size, 7));
  if (!(std::abs(value) < bound)) throw Error(fmt::format("'{}' does not fit its field", word), location);
  const auto whole = static_cast<int64_t>(value);
  data.append(reinterpret_cast<const char*>(&whole), static_cast<size_t>(field.size));  // Little endian.
}

void read_ascii(const std::string& bytes, Header& header, const std::string& file) {
  std::istringstream stream(bytes.substr(header.body));
  FileLocation location{file, header.lines, {}};
  std::string line;
  PcdCloud& cloud = header.cloud;
  for (size_t point = 0; point < cloud.size();) {
    if (!std::getline(stream, line)) throw truncated(file, cloud.size());
    ++location.line;
    const auto words = words_of(line);
    if (words.empty()) continue;
    size_t next = 0;
    for (const PcdField& field : cloud.fields) {
      for (int i = 0; i < field.count; ++i, ++next) {
        if (next >= words.size()) throw Error("this point has too few values", location);
        append_number(cloud.data, field, words[next], location);
      }
    }
    ++point;
  }
}

/// LZF as liblzf writes it: literal runs and back references.
std::string lzf_decompress(std::string_view input, size_t size, const std::string& file) {
  const Error damaged("the compressed points are damaged", {file, 0, {}});
  std::string output;
  output.reserve(size);
  const auto byte = [&](size_t at) -> size_t {
    if (at >= input.size()) throw damaged;
    return static_cast<uint8_t>(input[at]);
  };
  for (size_t at = 0; at < input.size();) {
    const size_t control = byte(at++);
    if (control < 32) {
      if (at + control + 1 > input.size()) throw damaged;
      output.append(input.substr(at, control + 1));
      at += control + 1;
    } else {
      size_t length = control >> 5;
      if (length == 7) length += byte(at++);
      const size_t back = ((control & 31) << 8 | byte(at++)) + 1;
      if (back > output.size()) throw damaged;
      for (size_t i = 0; i < length + 2; ++i) output += output[output.size() - back];
    }
    if (output.size() > size) throw damaged;
  }
  if (output.size() != size) throw damaged;
  return output;
}

/// Compressed files hold field after field, each for all points.
void read_compressed(const std::string& bytes, Header& header, const std::string& file) {
  PcdCloud& cloud = header.cloud;
  if (bytes.size() < header.body + 8) throw truncated(file, cloud.size());
  const size_t packed = value_at<uint32_t>(bytes.data() + header.body);
  const size_t unpacked = value_at<uint32_t>(bytes.data() + header.body + 4);
  if (bytes.size() < header.body + 8 + packed) throw truncated(file, cloud.size());
  if (unpacked != cloud.size() * cloud.point_size)
    throw Error("the compressed points do not have the announced size", {file, 0, {}});
  const std::string columns =
      lzf_decompress(std::string_view(bytes).substr(header.body + 8, packed), unpacked, file);
  cloud.data.resize(unpacked);
  size_t from = 0;
  for (const PcdField& field : cloud.fields) {
    const size_t size = static_cast<size_t>(field.size) * static_cast<size_t>(field.count);
    for (size_t point = 0; point < cloud.size(); ++point, from += size)
      std::memcpy(cloud.data.data() + point * cloud.point_size + field.offset, columns.data() + from, size);
  }
}

}  // namespace

const PcdField* PcdCloud::find(std::string_view name) const {
  for (const PcdField& field : fields)
    if (field.name == name) return &field;
  return nullptr;
}

double PcdCloud::number(size_t point, const PcdField& field) const {
  const char* at = data.data() + point * point_size + field.offset;
  if (field.type == 'F')
    return field.size == 8 ? value_at<double>(at) : static_cast<double>(value_at<float>(at));
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? value_at<int8_t>(at) : value_at<uint8_t>(at);
    case 2:
      return is_signed ? value_at<int16_t>(at) : value_at<uint16_t>(at);
    case 4:
      return is_signed ? value_at<int32_t>(at) : value_at<uint32_t>(at);
    default:
      return is_signed ? static_cast<double>(value_at<int64_t>(at))
                       : static_cast<double>(value_at<uint64_t>(at));
  }
}

uint32_t PcdCloud::bits(size_t point, const PcdField& field) const {
  return field.size == 4 ? value_at<uint32_t>(data.data() + point * point_size + field.offset) : 0;
}

void PcdCloud::add_field(std::string name, char type, int size) {
  fields.push_back({std::move(name), type, size, 1, point_size});
  point_size += static_cast<size_t>(size);
}

PcdCloud read_pcd(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  Header header = HeaderParser(bytes, path.string()).parse();
  PcdCloud& cloud = header.cloud;
  if (header.encoding == "ascii") {
    read_ascii(bytes, header, path.string());
  } else if (header.encoding == "binary_compressed") {
    read_compressed(bytes, header, path.string());
  } else if (header.encoding == "binary") {
    const size_t size = cloud.size() * cloud.point_size;
    if (bytes.size() - header.body < size) throw truncated(path.string(), cloud.size());
    cloud.data = bytes.substr(header.body, size);
  } else {
    throw Error(fmt::format("unknown PCD encoding '{}'", header.encoding), {path.string(), header.lines, {}},
                "ascii, binary and binary_compressed are read");
  }
  return std::move(cloud);
}

void write_pcd(const PcdCloud& cloud, const std::filesystem::path& path) {
  std::string names, sizes, types, counts;
  for (const PcdField& field : cloud.fields) {
    names += ' ' + field.name;
    sizes += fmt::format(" {}", field.size);
    types += fmt::format(" {}", field.type);
    counts += fmt::format(" {}", field.count);
  }
  OutputFile file(path, {.replace = Replace::anything});
  file.write(
      fmt::format("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\n"
                  "COUNT{}\nWIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                  names, sizes, types, counts, cloud.width, cloud.height, cloud.size()));
  file.write(cloud.data);
  file.commit();
}

}  // namespace loci::mapping
