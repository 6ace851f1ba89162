#include <cmath>
#include <limits>
#include <map>

#include "mapping/base/base64.h"
#include "mapping/base/json.h"
#include "perception/cas/json.h"

namespace loci::perception::cas {

namespace {

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

double number_from_json(const Json& json, const std::string& where) {
  if (json.is_number()) return json.get<double>();
  if (json == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (json == "Infinity") return std::numeric_limits<double>::infinity();
  if (json == "-Infinity") return -std::numeric_limits<double>::infinity();
  refuse("not a number: " + json.dump(), where);
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
      values->push_back(static_cast<T>(number_from_json(each, where)));
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

class Reader {
 public:
  Reader(Cas& cas, BlobSource* source) : cas_(cas), source_(source) {}

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
      const std::string place = where + "." + name;
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
    if (is_floating(range.kind())) return structure.set(feature, number_from_json(value, where));
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

FeatureStructure from_json(Cas& cas, const Json& json, BlobSource* source) {
  Reader reader(cas, source);
  reader.read_structures(member(json, "structures", ""));
  if (json.contains("root")) return reader.reference(json.at("root"), "root");
  const Json& views = member(json, "views", "");
  if (!views.is_array()) refuse("\"views\" is no list", "views");
  for (const Json& entry : views) {
    const std::string name = text_member(entry, "name", "views");
    View& view = cas.view(name);
    if (entry.contains("sofa")) view.adopt_sofa(reader.reference(entry.at("sofa"), "view " + name));
    const Json& index = member(entry, "index", "view " + name);
    if (!index.is_array()) refuse("\"index\" is no list", "view " + name);
    for (const Json& each : index) view.add_to_index(reader.reference(each, "view " + name));
  }
  return {};
}

}  // namespace loci::perception::cas
