#include <cstring>
#include <type_traits>

#include "mapping/base/files.h"
#include "mapping/base/hash.h"
#include "mapping/base/json.h"
#include "perception/recognition/product_index.h"

namespace loci::perception {
namespace {

// A line of text, the SHA-256 of all that follows in hexadecimal, then a JSON header (its length first, 8
// bytes) and the arrays as they lie in memory (little endian).
constexpr std::string_view kKind = "loci product index ";
constexpr std::string_view kVersion = "1";
constexpr size_t kHashLength = 64;

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Takes arrays off the front of bytes.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : bytes_(bytes) {}
  std::string_view take(size_t count) {
    if (count > bytes_.size()) throw Error("the file ends too early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  template <class T>
  std::vector<T> take_array(size_t count) {
    if (count > bytes_.size() / sizeof(T)) throw Error("the file ends too early");
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), take(count * sizeof(T)).data(), count * sizeof(T));
    return values;
  }
  bool empty() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

std::string_view checked_payload(std::string_view bytes) {
  if (!bytes.starts_with(kKind))
    throw Error("this is no product index", {}, "make one with `loci-perceive index`");
  const size_t line = bytes.find('\n');
  if (line == std::string_view::npos || line > 64) throw Error("this is no product index");
  const std::string_view version = bytes.substr(kKind.size(), line - kKind.size());
  if (version != kVersion)
    throw Error(
        "the index has version " + std::string(version) + ", this program reads " + std::string(kVersion), {},
        "make it anew with `loci-perceive index`");
  bytes.remove_prefix(line + 1);
  if (bytes.size() < kHashLength || content_hash(bytes.substr(kHashLength)) != bytes.substr(0, kHashLength))
    throw Error("the index is damaged", {}, "make it anew with `loci-perceive index`");
  return bytes.substr(kHashLength);
}

}  // namespace

void ProductIndex::save(const std::filesystem::path& path) const {
  Json header = {
      {"features", descriptors_.size()}, {"nodes", tree_.nodes().size()}, {"products", Json::array()}};
  for (size_t i = 0; i < products_.size(); ++i) {
    Json properties = Json::array();
    for (const auto& [key, value] : products_[i].properties) properties.push_back({key, value});
    header["products"].push_back({{"name", products_[i].name},
                                  {"image", products_[i].image.string()},
                                  {"size", {sizes_[i].width, sizes_[i].height}},
                                  {"cells", {chroma_[i].cols, chroma_[i].rows}},
                                  {"properties", properties}});
  }
  const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  const uint64_t length = text.size();
  std::string payload(reinterpret_cast<const char*>(&length), sizeof(length));
  payload += text;
  append(payload, keypoints_);
  append(payload, descriptors_);
  append(payload, owners_);
  append(payload, tree_.nodes());
  append(payload, tree_.numbers());
  for (const cv::Mat& chroma : chroma_)
    payload.append(reinterpret_cast<const char*>(chroma.data), chroma.total() * chroma.elemSize());
  write_file_atomically(path,
                        std::string(kKind) + std::string(kVersion) + "\n" + content_hash(payload) + payload);
}

ProductIndex ProductIndex::load(const std::filesystem::path& path) try {
  const std::string bytes = read_file(path);
  Taker payload(checked_payload(bytes));
  const uint64_t length = payload.take_array<uint64_t>(1)[0];
  const Json header = parse_json(payload.take(length), path.string());
  ProductIndex index;
  for (const Json& entry : header.at("products")) {
    Product product{entry.at("name"), {}, entry.at("image").get<std::string>()};
    for (const Json& property : entry.at("properties"))
      product.properties.emplace_back(property.at(0), property.at(1));
    index.products_.push_back(std::move(product));
    index.sizes_.emplace_back(entry.at("size").at(0).get<int>(), entry.at("size").at(1).get<int>());
    index.chroma_.emplace_back(entry.at("cells").at(1).get<int>(), entry.at("cells").at(0).get<int>(),
                               CV_8UC3);
  }
  const size_t features = header.at("features");
  index.keypoints_ = payload.take_array<Keypoint>(features);
  index.descriptors_ = payload.take_array<Descriptor>(features);
  index.owners_ = payload.take_array<uint32_t>(features);
  auto nodes = payload.take_array<VocabularyTree::Node>(header.at("nodes"));
  index.tree_ = VocabularyTree::restore(std::move(nodes), payload.take_array<uint32_t>(features));
  for (cv::Mat& chroma : index.chroma_) {
    const std::string_view cells = payload.take(chroma.total() * chroma.elemSize());
    std::memcpy(chroma.data, cells.data(), cells.size());
  }
  index.count_features();
  return index;
} catch (const Error& error) {
  if (!error.location().file.empty()) throw;
  throw Error(error.message(), {path.string(), 0, {}}, error.hint());
} catch (const nlohmann::json::exception&) {
  throw Error("the index contradicts itself", {path.string(), 0, {}},
              "make it anew with `loci-perceive index`");
}

}  // namespace loci::perception
