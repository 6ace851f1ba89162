#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mapping/base/text/json.h"
#include "mapping/base/time.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/store/scene_images.h"

namespace loci::memory {

struct Fact;
struct Reply;
struct WasAnswer;

}  // namespace loci::memory

/// How answers are written as JSON. The fields of a struct are declared once: what to_json() writes, and what
/// programs are told of it (JSON Schema, from which the type stubs of Python are made), are one definition.
namespace loci::memory::format {

/// A time as JSON: ISO 8601.
struct TimeText {
  TimeNs time = 0;
};

/// The last enumerator of an enumeration that is written by its names; unset = it is none.
template <class T>
inline constexpr std::optional<T> kLast = {};
template <>
inline constexpr std::optional<Verdict> kLast<Verdict> = Verdict::not_observed;
template <>
inline constexpr std::optional<ObjectStatus> kLast<ObjectStatus> = ObjectStatus::gone;
template <>
inline constexpr std::optional<EventKind> kLast<EventKind> = EventKind::place_moved;
template <>
inline constexpr std::optional<SpotStatus> kLast<SpotStatus> = SpotStatus::seen_empty;

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsList : std::false_type {};
template <class T>
struct IsList<std::vector<T>> : std::true_type {};
/// A JSON object with any keys; a list of pairs is one in its order.
template <class T>
struct IsMap : std::false_type {};
template <class T>
struct IsMap<std::map<std::string, T>> : std::true_type {
  using Value = T;
};
template <class T>
struct IsMap<std::vector<std::pair<std::string, T>>> : std::true_type {
  using Value = T;
};

/// JSON Schema of a plain value.
template <class T>
Json schema_of() {
  if constexpr (std::is_enum_v<T>) {
    Json names = Json::array();
    for (int i = 0; i <= static_cast<int>(kLast<T>.value()); ++i) names.push_back(to_text(static_cast<T>(i)));
    return {{"enum", names}};
  } else if constexpr (IsMap<T>::value) {
    return {{"type", "object"}, {"additionalProperties", schema_of<typename IsMap<T>::Value>()}};
  } else if constexpr (IsList<T>::value) {
    return {{"type", "array"}, {"items", schema_of<typename T::value_type>()}};
  } else if constexpr (std::is_same_v<T, Vector3d>) {
    return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};
  } else if constexpr (std::is_same_v<T, TimeText>) {
    return {{"type", "string"}, {"format", "date-time"}};
  } else if constexpr (std::is_same_v<T, Json>) {
    return Json::object();
  } else {
    return {{"type", std::is_same_v<T, bool>       ? "boolean"
                     : std::is_integral_v<T>       ? "integer"
                     : std::is_floating_point_v<T> ? "number"
                                                   : "string"}};
  }
}

template <class T>
Json json_of(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return to_text(value);
  } else if constexpr (IsMap<T>::value) {
    Json json = Json::object();
    for (const auto& [key, each] : value) json[key] = json_of(each);
    return json;
  } else if constexpr (IsList<T>::value) {
    Json json = Json::array();
    for (const auto& each : value) json.push_back(json_of(each));
    return json;
  } else if constexpr (std::is_same_v<T, Vector3d>) {
    return {value.x(), value.y(), value.z()};
  } else if constexpr (std::is_same_v<T, TimeText>) {
    return format_time(value.time);
  } else if constexpr (std::is_same_v<T, PlaceRef>) {
    return value.name;
  } else {
    return value;
  }
}

/// What is left out unless it says something.
template <class T>
std::optional<T> unless_empty(const T& value) {
  return value.empty() ? std::nullopt : std::optional(value);
}
inline std::optional<bool> if_true(bool value) {
  return value ? std::optional(true) : std::nullopt;
}

/// What does not depend on the type of the struct.
class RecordSchema {
 public:
  explicit RecordSchema(std::string name);
  const std::string& name() const { return name_; }
  /// The schema of the record and of those that its fields have, by name.
  Json definitions() const;
  /// How a schema refers to it.
  Json reference() const { return {{"$ref", "#/$defs/" + name_}}; }

 protected:
  void declare(const std::string& key, const Json& schema, bool required);
  void refer_to(const RecordSchema& part);
  /// The fields of a part as fields of this record.
  void take_over(const RecordSchema& part, bool required);

 private:
  std::string name_;
  Json definition_, others_ = Json::object();
};

/// The fields of a struct in the order in which they are written. `get` is a member or a function of the
/// struct; what is optional is left out where it is unset.
template <class T>
class Record : public RecordSchema {
 public:
  using RecordSchema::RecordSchema;

  /// A plain value, or lists and maps of such.
  template <class Get>
  Record& value(const std::string& key, Get get) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, const T&>>;
    if constexpr (IsOptional<Value>::value)
      declare(key, schema_of<typename Value::value_type>(), false);
    else
      declare(key, schema_of<Value>(), true);
    add(key, get, [](const auto& value) { return json_of(value); });
    return *this;
  }
  template <class Get>
  Record& time(const std::string& key, Get get) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, const T&>>;
    declare(key, schema_of<TimeText>(), !IsOptional<Value>::value);
    add(key, get, [](TimeNs time) { return json_of(TimeText{time}); });
    return *this;
  }
  /// A record, or a list of them. `part` has to live on.
  template <class Get, class Part>
  Record& record(const std::string& key, Get get, const Record<Part>& part) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, const T&>>;
    refer_to(part);
    if constexpr (IsList<Value>::value) {
      declare(key, {{"type", "array"}, {"items", part.reference()}}, true);
      add(key, get, [&part](const auto& list) {
        Json json = Json::array();
        for (const Part& each : list) json.push_back(part.json(each));
        return json;
      });
    } else {
      declare(key, part.reference(), !IsOptional<Value>::value);
      add(key, get, [&part](const Part& each) { return part.json(each); });
    }
    return *this;
  }
  /// The fields of a part among these. `part` has to live on.
  template <class Get, class Part>
  Record& with(Get get, const Record<Part>& part) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, const T&>>;
    take_over(part, !IsOptional<Value>::value);
    writers_.push_back([get, &part](const T& whole, Json& json) {
      const auto& value = std::invoke(get, whole);
      if constexpr (!IsOptional<Value>::value)
        part.write(value, json);
      else if (value)
        part.write(*value, json);
    });
    return *this;
  }

  Json json(const T& value) const {
    Json json = Json::object();
    write(value, json);
    return json;
  }
  void write(const T& value, Json& json) const {
    for (const auto& writer : writers_) writer(value, json);
  }

 private:
  template <class Get, class Write>
  void add(const std::string& key, Get get, Write write_value) {
    writers_.push_back([key, get, write_value](const T& whole, Json& json) {
      const auto& value = std::invoke(get, whole);
      if constexpr (!IsOptional<std::remove_cvref_t<decltype(value)>>::value)
        json[key] = write_value(value);
      else if (value)
        json[key] = write_value(*value);
    });
  }

  std::vector<std::function<void(const T&, Json&)>> writers_;
};

// Records of what answers are composed of.
const Record<SceneRef>& scene_record();
const Record<ObjectRef>& object_record();
const Record<ObjectBelief>& belief_record();
const Record<Change>& change_record();
const Record<Fact>& fact_record();
const Record<Reply>& reply_record();
const Record<WasAnswer>& was_record();

/// For the declaration of a question: the record that its answer is written by.
template <auto record>
const RecordSchema& schema_by() {
  return record();
}

}  // namespace loci::memory::format
