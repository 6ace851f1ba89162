#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <unordered_map>

#include "mapping/base/base64.h"
#include "mapping/base/json.h"
#include "perception/cas/graph.h"
#include "perception/cas/json.h"

namespace loci::perception::cas {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

namespace {

constexpr size_t kInlineBytes = 256;

/// A double that prints with as few digits as bring the float back.
double shortest(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text - 1, value);
  *end.ptr = '\0';
  const double wide = std::strtod(text, nullptr);
  return static_cast<float>(wide) == value ? wide : static_cast<double>(value);
}

Json json_from_number(double value, bool is_float) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  return is_float ? shortest(static_cast<float>(value)) : value;
}

bool is_utf8(std::string_view text) {
  size_t i = 0;
  while (i < text.size()) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const size_t more = byte < 0x80                   ? 0
                        : byte >= 0xc2 && byte < 0xe0 ? 1
                        : byte >= 0xe0 && byte < 0xf0 ? 2
                        : byte >= 0xf0 && byte < 0xf5 ? 3
                                                      : 4;
    if (more == 4 || i + more >= text.size() + (more == 0)) return false;
    for (size_t k = 1; k <= more; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return false;
    const auto second = more > 0 ? static_cast<unsigned char>(text[i + 1]) : 0U;
    if ((byte == 0xe0 && second < 0xa0) || (byte == 0xed && second >= 0xa0) ||
        (byte == 0xf0 && second < 0x90) || (byte == 0xf4 && second >= 0x90))
      return false;
    i += more + 1;
  }
  return true;
}

Json json_from_text(const std::string& text) {
  if (is_utf8(text)) return text;
  return {{"base64", base64_from_bytes(text)}};
}

template <typename T>
Json json_from_elements(const RawBuffer& raw) {
  Json list = Json::array();
  for (const T& value : raw.as<T>()) {
    if constexpr (std::is_same_v<T, std::string>)
      list.push_back(json_from_text(value));
    else if constexpr (std::is_floating_point_v<T>)
      list.push_back(json_from_number(value, std::is_same_v<T, float>));
    else
      list.push_back(value);
  }
  return list;
}

Json json_list(Kind kind, const RawBuffer& raw) {
  switch (kind) {
    case Kind::kBoolean:
      return json_from_elements<bool>(raw);
    case Kind::kByte:
      return json_from_elements<uint8_t>(raw);
    case Kind::kShort:
      return json_from_elements<int16_t>(raw);
    case Kind::kInteger:
      return json_from_elements<int32_t>(raw);
    case Kind::kLong:
      return json_from_elements<int64_t>(raw);
    case Kind::kFloat:
      return json_from_elements<float>(raw);
    case Kind::kDouble:
      return json_from_elements<double>(raw);
    default:
      return json_from_elements<std::string>(raw);
  }
}

class Writer {
 public:
  Writer(std::vector<FeatureStructure> roots, BlobSink* sink) : sink_(sink) {
    for (const FeatureStructure& root : roots) ++references_[root.id()];
    for (const FeatureStructure& each : reachable_from(roots))
      for_each_reference(each, [&](Feature, const FeatureStructure& target) { ++references_[target.id()]; });
    // An inlined array has one reference and is no root; its elements are numbered in its place.
    for (const FeatureStructure& root : roots) number(root);
    for (size_t next = 0; next < numbered_.size(); ++next) {
      const FeatureStructure current = numbered_[next];
      number_references(current);
    }
  }

  Json structures() {
    Json list = Json::array();
    for (const FeatureStructure& each : numbered_) list.push_back(structure(each));
    return list;
  }

  Json reference(const FeatureStructure& target) const {
    if (target.is_null() || target.is_deleted()) return nullptr;
    return fmt::format("#{}", ids_.at(target.id()));
  }

 private:
  void number(const FeatureStructure& structure) {
    if (ids_.emplace(structure.id(), numbered_.size() + 1).second) numbered_.push_back(structure);
  }

  void number_references(const FeatureStructure& structure) {
    for_each_reference(structure, [&](Feature feature, const FeatureStructure& target) {
      if (is_inlined(feature, target))
        for_each_reference(target, [&](Feature, const FeatureStructure& element) { number(element); });
      else
        number(target);
    });
  }

  bool is_inlined(Feature feature, const FeatureStructure& target) const {
    const Type type = target.type();
    return feature && type.kind() == Kind::kArray && feature.range() == type &&
           references_.at(target.id()) == 1;
  }

  Json structure(const FeatureStructure& each) {
    const Type type = each.type();
    Json json = {{"id", ids_.at(each.id())}, {"type", type.name()}};
    if (type.kind() == Kind::kArray) {
      json["elements"] = elements(each);
      return json;
    }
    Json features = Json::object();
    for (const Feature& feature : type.features()) {
      Json value = feature_value(each, feature);
      if (!value.is_null()) features[feature.name()] = std::move(value);
    }
    json["features"] = std::move(features);
    return json;
  }

  Json feature_value(const FeatureStructure& each, Feature feature) {
    const Value& value = each.value(feature);
    if (const bool* flag = std::get_if<bool>(&value)) return *flag;
    if (const int64_t* number = std::get_if<int64_t>(&value)) return *number;
    if (const std::string* text = std::get_if<std::string>(&value)) return json_from_text(*text);
    if (const double* number = std::get_if<double>(&value))
      return json_from_number(*number, feature.range().kind() == Kind::kFloat);
    if (std::holds_alternative<std::monostate>(value)) return nullptr;
    const FeatureStructure target = each.get<FeatureStructure>(feature);
    if (target.is_deleted()) return nullptr;
    return is_inlined(feature, target) ? elements(target) : reference(target);
  }

  Json elements(const FeatureStructure& array) {
    const Kind kind = array.type().component_kind();
    if (kind == Kind::kStructure) {
      Json list = Json::array();
      for (const FeatureStructure& each : array.structures()) list.push_back(reference(each));
      return list;
    }
    const RawBuffer& raw = array.raw_elements(kind);
    const size_t bytes = raw.size * element_bytes(kind);
    const std::string_view memory(static_cast<const char*>(raw.data), bytes);
    if (kind != Kind::kString && sink_ != nullptr && bytes > sink_->threshold())
      return {{"blob", sink_->put(memory)}};
    if (kind != Kind::kString && bytes > kInlineBytes) return {{"base64", base64_from_bytes(memory)}};
    return json_list(kind, raw);
  }

  BlobSink* sink_;
  std::unordered_map<uint32_t, size_t> references_;
  std::unordered_map<uint32_t, size_t> ids_;
  std::vector<FeatureStructure> numbered_;
};

}  // namespace

Json to_json(const FeatureStructure& root, BlobSink* sink) {
  if (root.is_null()) throw Error("a null feature structure cannot be written");
  root.type();  // throws when it was deleted
  Writer writer({root}, sink);
  Json json;
  json["root"] = writer.reference(root);
  json["structures"] = writer.structures();
  return json;
}

Json to_json(const Cas& cas, BlobSink* sink) {
  const std::vector<CanonicalView> views = canonical_views(cas);
  std::vector<FeatureStructure> roots;
  for (const CanonicalView& view : views) {
    if (view.sofa) roots.push_back(view.sofa);
    roots.insert(roots.end(), view.members.begin(), view.members.end());
  }
  Writer writer(roots, sink);
  Json json;
  json["views"] = Json::array();
  for (const CanonicalView& view : views) {
    Json entry = {{"name", view.name}};
    if (view.sofa) entry["sofa"] = writer.reference(view.sofa);
    entry["index"] = Json::array();
    for (const FeatureStructure& member : view.members) entry["index"].push_back(writer.reference(member));
    json["views"].push_back(std::move(entry));
  }
  json["structures"] = writer.structures();
  return json;
}

}  // namespace loci::perception::cas
