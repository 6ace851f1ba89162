#include "memory/questions/names/embeddings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numeric>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/names/structure_features.h"

namespace loci::memory {
namespace {

constexpr const char* kType = "loci.annotation.ImageFeatureAnnotation";
constexpr const char* kSource = "NetworkEmbedding";
constexpr size_t kLatestViews = 12;  // the latest
constexpr size_t kMaxLength = 16384;
constexpr uintmax_t kMaxFileBytes = uintmax_t{512} << 20;

/// Scaled to unit length; empty when that cannot be.
std::vector<float> normalised(std::vector<float> values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value) * static_cast<double>(value);
  if (!(sum > 0) || !std::isfinite(sum)) return {};
  for (float& value : values) value = static_cast<float>(static_cast<double>(value) / std::sqrt(sum));
  return values;
}

/// The numbers of an array in a feature structure, which are a blob where they are many.
std::vector<float> array_of(const Store& store, const Json& array) {
  std::vector<float> values;
  if (array.is_array() && array.size() <= kMaxLength)
    for (const Json& value : array) values.push_back(value.is_number() ? value.get<float>() : 0);
  if (!array.is_object() || !array.contains("blob") || !array["blob"].is_string()) return values;
  const auto blob = store.find_blob(array["blob"].get<std::string>());
  if (!blob) return values;
  const std::string bytes = store.blob(*blob).bytes;
  if (bytes.size() % sizeof(float) != 0 || bytes.size() / sizeof(float) > kMaxLength) return values;
  values.resize(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::optional<Embedding> embedding_of(const Store& store, const AnnotationRow& row) {
  for (const Json& features : features_of(store, row, kType)) {
    if (!features.contains("feature") || text_feature(features, "source") != kSource) continue;
    Embedding embedding{text_feature(features, "name"), normalised(array_of(store, features["feature"])),
                        row.scene};
    if (!embedding.values.empty()) return embedding;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Embedding> embeddings_of(const Snapshot& snapshot, Id object) {
  const Store& store = snapshot.store();
  std::vector<Embedding> embeddings;
  const auto latest = store.latest_observations(object, kLatestViews, {kType}, snapshot.as_of());
  for (const auto& annotation : latest.annotations)
    if (auto embedding = embedding_of(store, annotation.row)) embeddings.push_back(std::move(*embedding));
  return embeddings;
}

double embedding_similarity(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return 0;
  return std::clamp(std::inner_product(a.begin(), a.end(), b.begin(), 0.0), 0.0, 1.0);
}

WordVectors WordVectors::read(const std::filesystem::path& file) {
  std::error_code none;
  if (const uintmax_t size = std::filesystem::file_size(file, none); !none && size > kMaxFileBytes)
    throw Error(fmt::format("the file is larger than {} MB", kMaxFileBytes >> 20), {file.string(), 0, {}},
                "keep the words that you ask for");
  WordVectors result;
  result.file_ = file;
  size_t length = 0;
  int number = 0;
  for (const std::string& line : split(read_file(file), '\n')) {
    ++number;
    const FileLocation where{file.string(), number, {}};
    std::vector<std::string> parts = words_of(line);
    if (parts.empty()) continue;
    std::vector<float> values;
    while (parts.size() > 1 && (length == 0 || values.size() < length)) {
      const std::string& part = parts.back();
      float value = 0;
      const auto [end, code] = std::from_chars(part.data(), part.data() + part.size(), value);
      if (code != std::errc() || end != part.data() + part.size() || !std::isfinite(value)) break;
      values.insert(values.begin(), value);
      parts.pop_back();
    }
    if (length == 0) length = values.size();
    if (values.size() != length || length < 2 || length > kMaxLength)
      throw Error(fmt::format("a word has {} values instead of {}", values.size(), length), where,
                  "write a word and its values on each line");
    values = normalised(std::move(values));
    if (values.empty()) throw Error("the values are all zero", where);
    result.vectors_[lower_case(joined(parts, " "))] = std::move(values);
  }
  if (result.vectors_.empty()) throw Error("there are no words", {file.string(), 0, {}});
  return result;
}

std::vector<float> WordVectors::of(const std::string& text) const {
  const std::string words = lower_case(joined(words_of(text), " "));
  if (const auto whole = vectors_.find(words); whole != vectors_.end()) return whole->second;
  std::vector<float> sum;
  for (const std::string& word : words_of(words)) {
    const auto known = vectors_.find(word);
    if (known == vectors_.end()) continue;
    sum.resize(known->second.size());
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += known->second[i];
  }
  if (sum = normalised(std::move(sum)); sum.empty())
    throw Error(fmt::format("'{}' has no vector", text), {file_.string(), 0, {}},
                "export one with the text encoder");
  return sum;
}

}  // namespace loci::memory
