// Arrays of NumPy (.npy): a magic, a version, a Python dictionary as text, and the numbers.

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/depth/codecs.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxNpyHeader = 4096;  ///< bytes; NumPy pads to 64 and writes some 80
constexpr size_t kMaxDimensions = 8;
constexpr const char* kNpyHint =
    "write depth in metres: numpy.save(\"NAME.npy\", numpy.ascontiguousarray(depth, \"<f4\"))";

/// What the dictionary says.
struct NpyHeader {
  std::string descr;
  bool fortran_order = false;
  std::vector<uint64_t> shape;
};

/// Reads `{'descr': '<f4', 'fortran_order': False, 'shape': (480, 640), }`.
class NpyDictionary {
 public:
  NpyDictionary(std::string_view text, const fs::path& path) : text_(text), path_(path) {}

  NpyHeader read() {
    NpyHeader header;
    std::set<std::string> keys;
    expect('{');
    while (!take('}')) {
      const std::string key = quoted();
      expect(':');
      if (!keys.insert(key).second) throw damaged();
      if (key == "descr")
        header.descr = take_if_next('[') ? std::string("of several fields") : quoted();
      else if (key == "fortran_order")
        header.fortran_order = boolean();
      else if (key == "shape")
        header.shape = numbers();
      else
        throw damaged();
      if (header.descr.starts_with("of")) return header;  // It is refused, whatever follows.
      if (!take(',')) {
        expect('}');
        break;
      }
    }
    skip_blanks();
    if (!text_.empty() || keys.size() != 3) throw damaged();
    return header;
  }

 private:
  Error damaged() const { return Error("the head of this NumPy array is damaged", {path_.string(), 0, {}}); }
  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(" \n"), text_.size())); }
  bool take_if_next(char c) {
    skip_blanks();
    return text_.starts_with(c);
  }
  bool take(char c) {
    if (!take_if_next(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) throw damaged();
  }
  std::string quoted() {
    const char quote = take_if_next('"') ? '"' : '\'';
    expect(quote);
    const size_t end = text_.find(quote);
    if (end == std::string_view::npos) throw damaged();
    std::string value(text_.substr(0, end));
    text_.remove_prefix(end + 1);
    return value;
  }
  bool boolean() {
    skip_blanks();
    for (const bool value : {false, true}) {
      const std::string_view word = value ? "True" : "False";
      if (!text_.starts_with(word)) continue;
      text_.remove_prefix(word.size());
      return value;
    }
    throw damaged();
  }
  std::vector<uint64_t> numbers() {
    std::vector<uint64_t> values;
    expect('(');
    while (!take(')')) {
      skip_blanks();
      uint64_t value = 0;
      const auto end = std::from_chars(text_.data(), text_.data() + text_.size(), value);
      if (end.ec != std::errc() || values.size() == kMaxDimensions) throw damaged();
      text_.remove_prefix(static_cast<size_t>(end.ptr - text_.data()));
      values.push_back(value);
      if (!take(',')) {
        expect(')');
        break;
      }
    }
    return values;
  }

  std::string_view text_;
  fs::path path_;
};

/// OpenCV's type of an element; unset for those that are not read.
std::optional<int> type_of(const std::string& descr) {
  if (descr == "<u2") return CV_16UC1;
  if (descr == "<f2") return CV_16FC1;
  if (descr == "<f4") return CV_32FC1;
  if (descr == "<f8") return CV_64FC1;
  return std::nullopt;
}

/// Height and width: of (480, 640), (480, 640, 1) and (1, 480, 640).
std::pair<uint64_t, uint64_t> size_of(const std::vector<uint64_t>& shape, const fs::path& path) {
  if (shape.size() == 2 || (shape.size() == 3 && shape[2] == 1)) return {shape[0], shape[1]};
  if (shape.size() == 3 && shape[0] == 1) return {shape[1], shape[2]};
  throw Error(fmt::format("an array of shape ({}) is no depth image", fmt::join(shape, ", ")),
              {path.string(), 0, {}}, "it has height and width");
}

}  // namespace

DepthHeader decode_npy(const fs::path& path, cv::Mat* pixels) {
  const FileLocation location{path.string(), 0, {}};
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, 12> head{};
  file.read(reinterpret_cast<char*>(head.data()), head.size());
  if (file.gcount() < static_cast<std::streamsize>(head.size())) throw truncated_depth(path);
  const int version = head[6];
  if (version < 1 || version > 3 || head[7] != 0)
    throw Error(fmt::format("NumPy arrays of version {}.{} are not read", version, int{head[7]}), location);
  const bool is_short = version == 1;
  const size_t begin = is_short ? 10 : 12;
  const size_t length =
      is_short ? size_t{head[8]} | size_t{head[9]} << 8
               : size_t{head[8]} | size_t{head[9]} << 8 | size_t{head[10]} << 16 | size_t{head[11]} << 24;
  if (length > kMaxNpyHeader) throw Error("the head of this NumPy array is too long", location);
  std::string text(length, '\0');
  file.seekg(static_cast<std::streamoff>(begin));
  if (!file.read(text.data(), static_cast<std::streamsize>(length))) throw truncated_depth(path);
  const NpyHeader header = NpyDictionary(text, path).read();
  const std::optional<int> type = type_of(header.descr);
  if (!type)
    throw Error(fmt::format("a NumPy array of type '{}' is not read as depth", header.descr), location,
                kNpyHint);
  if (header.fortran_order) throw Error("a NumPy array in Fortran order is not read", location, kNpyHint);
  const auto [height, width] = size_of(header.shape, path);
  require_depth_size(width, height, path);
  const uint64_t bytes = width * height * CV_ELEM_SIZE(*type), there = fs::file_size(path) - begin - length;
  if (there < bytes) throw truncated_depth(path);
  if (there > bytes) throw Error("there is more data than the head of this NumPy array says", location);
  if (pixels != nullptr) {
    cv::Mat stored(static_cast<int>(height), static_cast<int>(width), *type);
    if (!file.read(reinterpret_cast<char*>(stored.data), static_cast<std::streamsize>(bytes)))
      throw Error("reading failed", location);
    if (*type == CV_16UC1)
      *pixels = stored;
    else
      stored.convertTo(*pixels, CV_32F);
  }
  return {static_cast<int>(width), static_cast<int>(height), *type != CV_16UC1};
}

}  // namespace loci::mapping
