#include "perception/cas/json.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <unordered_map>

#include "mapping/base/text/base64.h"
#include "mapping/base/text/json.h"
#include "perception/cas/graph.h"

namespace loci::perception::cas {
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

class JsonWriter {
 public:
  JsonWriter(const std::vector<FeatureStructure>& roots, BlobSink* sink) : sink_(sink) {
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

[[noreturn]] void refuse(const std::string& what, const std::string& where) {
  throw Error(what, {{}, 0, where});
}

const Json& member(const Json& object, const char* key, const std::string& where) {
  if (!object.is_object() || !object.contains(key)) refuse(std::string("no \"") + key + "\"", where);
  return object.at(key);
}

std::string text_member(const Json& object, const char* key, const std::string& where) {
  const Json& value = member(object, key, where);
  if (!value.is_string()) refuse(std::string("\"") + key + "\" is no text", where);
  return value.get<std::string>();
}

void require_known(const Json& object, const std::vector<std::string>& known, const std::string& where) {
  for (const auto& [key, value] : object.items())
    if (std::ranges::find(known, key) == known.end())
      throw Error("unknown key '" + key + "'", {{}, 0, where}, did_you_mean(key, known));
}

double number_from_json(const Json& json, const std::string& where) {
  if (json.is_number()) return json.get<double>();
  if (json == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (json == "Infinity") return std::numeric_limits<double>::infinity();
  if (json == "-Infinity") return -std::numeric_limits<double>::infinity();
  refuse("not a number: " + json.dump(), where);
}

/// Only the texts are infinite: a number beyond the range of the type is not.
template <typename T>
T floating_from_json(const Json& json, const std::string& where) {
  const auto value = static_cast<T>(number_from_json(json, where));
  if (json.is_number() && !std::isfinite(value)) refuse(json.dump() + " does not fit", where);
  return value;
}

template <typename T>
T integer_from_json(const Json& json, const std::string& where) {
  if (!json.is_number_integer()) refuse("not an integer: " + json.dump(), where);
  const bool too_large =
      json.is_number_unsigned() && json.get<uint64_t>() > uint64_t{std::numeric_limits<T>::max()};
  const auto value = json.get<int64_t>();
  if (too_large || value < int64_t{std::numeric_limits<T>::min()} ||
      value > int64_t{std::numeric_limits<T>::max()})
    refuse(json.dump() + " does not fit", where);
  return static_cast<T>(value);
}

bool bool_from_json(const Json& json, const std::string& where) {
  if (!json.is_boolean()) refuse("neither true nor false: " + json.dump(), where);
  return json.get<bool>();
}

std::string decoded_base64(const Json& json, const std::string& where) {
  try {
    return bytes_from_base64(text_member(json, "base64", where));
  } catch (const Error& error) {
    refuse(error.message(), where);
  }
}

std::string text_from_json(const Json& json, const std::string& where) {
  if (json.is_object()) return decoded_base64(json, where);
  if (!json.is_string()) refuse("not a text: " + json.dump(), where);
  return json.get<std::string>();
}

template <typename T>
Buffer<T> buffer_from_list(const Json& json, const std::string& where) {
  const auto values =
      std::make_shared<std::vector<std::conditional_t<std::is_same_v<T, bool>, uint8_t, T>>>();
  values->reserve(json.size());
  for (const Json& each : json) {
    if constexpr (std::is_same_v<T, bool>)
      values->push_back(bool_from_json(each, where) ? 1 : 0);
    else if constexpr (std::is_same_v<T, std::string>)
      values->push_back(text_from_json(each, where));
    else if constexpr (std::is_floating_point_v<T>)
      values->push_back(floating_from_json<T>(each, where));
    else
      values->push_back(integer_from_json<T>(each, where));
  }
  return {values, reinterpret_cast<const T*>(values->data()), values->size()};
}

RawBuffer raw_from_list(Kind kind, const Json& json, const std::string& where) {
  switch (kind) {
    case Kind::kBoolean:
      return buffer_from_list<bool>(json, where);
    case Kind::kByte:
      return buffer_from_list<uint8_t>(json, where);
    case Kind::kShort:
      return buffer_from_list<int16_t>(json, where);
    case Kind::kInteger:
      return buffer_from_list<int32_t>(json, where);
    case Kind::kLong:
      return buffer_from_list<int64_t>(json, where);
    case Kind::kFloat:
      return buffer_from_list<float>(json, where);
    case Kind::kDouble:
      return buffer_from_list<double>(json, where);
    default:
      return buffer_from_list<std::string>(json, where);
  }
}

class JsonReader {
 public:
  JsonReader(Cas& cas, BlobSource* source) : cas_(cas), source_(source) {}

  void read_structures(const Json& list) {
    if (!list.is_array()) refuse("\"structures\" is no list", "structures");
    for (const Json& json : list) create(json);
    for (const Json& json : list) fill(json);
  }

  FeatureStructure reference(const Json& json, const std::string& where) const {
    if (json.is_null()) return {};
    const std::string text = json.is_string() ? json.get<std::string>() : json.dump();
    const auto found = text.starts_with('#') ? made_.find(text.substr(1)) : made_.end();
    if (found == made_.end()) refuse("refers to " + text + ", which is not there", where);
    return found->second;
  }

 private:
  static std::string id_of(const Json& json) {
    const Json& id = member(json, "id", "structures");
    if (!id.is_number_integer()) refuse("an \"id\" is no integer", "structures");
    return id.dump();
  }

  void create(const Json& json) {
    const std::string id = id_of(json);
    const std::string where = "#" + id;
    require_known(json, {"id", "type", "features", "elements"}, where);
    const auto type = cas_.type_system().find(text_member(json, "type", where));
    if (!type) refuse("unknown type " + text_member(json, "type", where), where);
    const bool is_buffer = type->kind() == Kind::kArray && type->component_kind() != Kind::kStructure;
    const FeatureStructure made =
        is_buffer ? array(*type, member(json, "elements", where), where) : cas_.create(*type);
    if (!made_.emplace(id, made).second) refuse("id " + id + " is used twice", where);
  }

  void fill(const Json& json) {
    const std::string id = id_of(json);
    const std::string where = "#" + id;
    const FeatureStructure structure = made_.at(id);
    if (structure.type().kind() == Kind::kArray) {
      if (structure.type().component_kind() == Kind::kStructure)
        structure.set_elements(references(member(json, "elements", where), where));
      return;
    }
    const Json& features = member(json, "features", where);
    if (!features.is_object()) refuse("\"features\" is no object", where);
    for (const auto& [name, value] : features.items()) {
      const std::string place = fmt::format("{}.{}", where, name);
      const auto feature = structure.type().find_feature(name);
      if (!feature) refuse("type " + structure.type().name() + " has no feature '" + name + "'", place);
      try {
        set(structure, *feature, value, place);
      } catch (const Error& error) {
        if (!error.location().key.empty()) throw;
        throw Error(error.message(), {{}, 0, place}, error.hint());
      }
    }
  }

  void set(const FeatureStructure& structure, Feature feature, const Json& value, const std::string& where) {
    const Type range = feature.range();
    if (value.is_null()) return;
    if (range.kind() == Kind::kBoolean) return structure.set(feature, bool_from_json(value, where));
    if (is_integer(range.kind())) return structure.set(feature, integer_from_json<int64_t>(value, where));
    if (range.kind() == Kind::kFloat) return structure.set(feature, floating_from_json<float>(value, where));
    if (range.kind() == Kind::kDouble)
      return structure.set(feature, floating_from_json<double>(value, where));
    if (range.kind() == Kind::kString) return structure.set(feature, text_from_json(value, where));
    structure.set(feature, value.is_string() ? reference(value, where) : array(range, value, where));
  }

  std::vector<FeatureStructure> references(const Json& list, const std::string& where) const {
    if (!list.is_array()) refuse("not a list of references: " + list.dump(), where);
    std::vector<FeatureStructure> found;
    for (const Json& each : list) found.push_back(reference(each, where));
    return found;
  }

  FeatureStructure array(Type type, const Json& json, const std::string& where) {
    if (type.kind() != Kind::kArray) refuse("not a reference: " + json.dump(), where);
    const Kind kind = type.component_kind();
    if (kind == Kind::kStructure) return cas_.create_array(references(json, where));
    if (json.is_array()) return cas_.create_array(kind, raw_from_list(kind, json, where));
    if (kind == Kind::kString) refuse("not a list of texts: " + json.dump(), where);
    return cas_.create_array(kind, raw_from_bytes(kind, bytes(json, where), where));
  }

  BlobSource::Bytes bytes(const Json& json, const std::string& where) {
    if (json.is_object() && json.contains("blob")) {
      if (source_ == nullptr)
        refuse("a large array is kept outside, but there is no place to read it from", where);
      return source_->get(text_member(json, "blob", where));
    }
    const auto decoded = std::make_shared<const std::string>(decoded_base64(json, where));
    return {decoded, *decoded};
  }

  /// Elements may alias the bytes when those are aligned; booleans are checked.
  static RawBuffer raw_from_bytes(Kind kind, const BlobSource::Bytes& bytes, const std::string& where) {
    const size_t width = element_bytes(kind);
    if (bytes.bytes.size() % width != 0)
      refuse(std::to_string(bytes.bytes.size()) + " bytes are no whole number of elements", where);
    if (kind == Kind::kBoolean)
      for (const char each : bytes.bytes)
        if (each != 0 && each != 1) refuse("a boolean is neither 0 nor 1", where);
    RawBuffer raw;
    raw.size = bytes.bytes.size() / width;
    raw.owner = bytes.owner;
    raw.data = bytes.bytes.data();
    if (bytes.owner == nullptr || reinterpret_cast<uintptr_t>(raw.data) % width != 0) {
      const std::shared_ptr<char[]> copy(new char[bytes.bytes.size()]);
      std::copy(bytes.bytes.begin(), bytes.bytes.end(), copy.get());
      raw.owner = copy;
      raw.data = copy.get();
    }
    return raw;
  }

  Cas& cas_;
  BlobSource* source_;
  std::map<std::string, FeatureStructure> made_;
};

}  // namespace

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

Json to_json(const FeatureStructure& root, BlobSink* sink) {
  if (root.is_null()) throw Error("a null feature structure cannot be written");
  root.type();  // throws when it was deleted
  JsonWriter writer({root}, sink);
  Json json;
  json["root"] = writer.reference(root);
  json["structures"] = writer.structures();
  return json;
}

Json elements_to_json(const FeatureStructure& array) {
  const Kind kind = array.type().component_kind();
  return json_list(kind, array.raw_elements(kind));
}

Json to_json(const Cas& cas, BlobSink* sink) {
  const std::vector<CanonicalView> views = canonical_views(cas);
  std::vector<FeatureStructure> roots;
  for (const CanonicalView& view : views) {
    if (view.sofa) roots.push_back(view.sofa);
    roots.insert(roots.end(), view.members.begin(), view.members.end());
  }
  JsonWriter writer(roots, sink);
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

FeatureStructure from_json(Cas& cas, const Json& json, BlobSource* source) {
  require_known(json, {"root", "structures", "views"}, "");
  JsonReader reader(cas, source);
  reader.read_structures(member(json, "structures", ""));
  if (json.contains("root")) return reader.reference(json.at("root"), "root");
  const Json& views = member(json, "views", "");
  if (!views.is_array()) refuse("\"views\" is no list", "views");
  for (const Json& entry : views) {
    const std::string name = text_member(entry, "name", "views");
    require_known(entry, {"name", "sofa", "index"}, "view " + name);
    View& view = cas.view(name);
    if (entry.contains("sofa")) view.adopt_sofa(reader.reference(entry.at("sofa"), "view " + name));
    const Json& index = member(entry, "index", "view " + name);
    if (!index.is_array()) refuse("\"index\" is no list", "view " + name);
    for (const Json& each : index) view.add_to_index(reader.reference(each, "view " + name));
  }
  return {};
}

}  // namespace loci::perception::cas
