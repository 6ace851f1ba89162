#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "perception/cas/type_system.h"

namespace loci::perception::cas {

/// The kind of array that a C++ element type is kept in. Byte arrays hold images and blobs, hence unsigned.
template <typename T>
constexpr Kind kind_of() {
  if constexpr (std::is_same_v<T, bool>) return Kind::kBoolean;
  if constexpr (std::is_same_v<T, uint8_t>) return Kind::kByte;
  if constexpr (std::is_same_v<T, int16_t>) return Kind::kShort;
  if constexpr (std::is_same_v<T, int32_t>) return Kind::kInteger;
  if constexpr (std::is_same_v<T, int64_t>) return Kind::kLong;
  if constexpr (std::is_same_v<T, float>) return Kind::kFloat;
  if constexpr (std::is_same_v<T, double>) return Kind::kDouble;
  if constexpr (std::is_same_v<T, std::string>) return Kind::kString;
  return Kind::kStructure;
}

/// An immutable run of elements that shares the ownership of its memory: copying a buffer copies no elements.
template <typename T>
class Buffer {
 public:
  using value_type = T;
  using const_iterator = const T*;
  Buffer() = default;
  /// Memory of somebody else, kept alive through `owner`. Nobody may write to it any more.
  Buffer(std::shared_ptr<const void> owner, const T* data, size_t size)
      : owner_(std::move(owner)), data_(data), size_(size) {}
  /// Takes the vector over, without copying.
  explicit Buffer(std::vector<T>&& values) requires(!std::is_same_v<T, bool>) {
    const auto kept = std::make_shared<const std::vector<T>>(std::move(values));
    *this = Buffer(kept, kept->data(), kept->size());
  }
  static Buffer copy(std::span<const T> values) {
    const std::shared_ptr<T[]> kept(new T[values.size()]);
    std::copy(values.begin(), values.end(), kept.get());
    return Buffer(kept, kept.get(), values.size());
  }

  const T* data() const { return data_; }
  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  const T& operator[](size_t index) const { return data_[index]; }
  std::span<const T> span() const { return {data_, size_}; }
  const std::shared_ptr<const void>& owner() const { return owner_; }

 private:
  std::shared_ptr<const void> owner_;
  const T* data_ = nullptr;
  size_t size_ = 0;
};

/// A Buffer whose element type is known at run time.
struct RawBuffer {
  std::shared_ptr<const void> owner;
  const void* data = nullptr;
  size_t size = 0;  ///< elements

  template <typename T>
  RawBuffer(const Buffer<T>& buffer) : owner(buffer.owner()), data(buffer.data()), size(buffer.size()) {}
  RawBuffer() = default;
  template <typename T>
  Buffer<T> as() const {
    return {owner, static_cast<const T*>(data), size};
  }
};

/// Bytes per element of an array of numbers; 0 for strings and structures.
constexpr size_t element_bytes(Kind kind) {
  switch (kind) {
    case Kind::kBoolean:
    case Kind::kByte:
      return 1;
    case Kind::kShort:
      return 2;
    case Kind::kInteger:
    case Kind::kFloat:
      return 4;
    case Kind::kLong:
    case Kind::kDouble:
      return 8;
    default:
      return 0;
  }
}

class Cas;
class List;

/// A value inside a feature structure: unset, or what the feature's range says. Integers of all sizes are
/// kept as int64, floats as double; references as ids (0 = null).
struct Reference {
  uint32_t id = 0;
  bool operator==(const Reference&) const = default;
};
using Value = std::variant<std::monostate, bool, int64_t, double, std::string, Reference>;

/// A feature structure: a handle (CAS, id), cheap to copy, valid for the life of its CAS.
/// Default-constructed: null. Features are read and written by Feature or by name; what does not fit the type
/// system throws Error.
///
/// An unset number reads as 0, an unset string as "", an unset reference as null; `is_set` tells the
/// difference. Reading from several threads is safe while nobody writes to the CAS.
class FeatureStructure {
 public:
  FeatureStructure() = default;
  FeatureStructure(Cas* cas, uint32_t id) : cas_(id == 0 ? nullptr : cas), id_(id) {}

  bool is_null() const { return id_ == 0; }
  explicit operator bool() const { return id_ != 0; }
  bool operator==(const FeatureStructure&) const = default;
  bool is_deleted() const;
  Cas& cas() const;
  uint32_t id() const { return id_; }
  Type type() const;
  bool is_a(std::string_view type_name) const;
  Feature feature(std::string_view name) const { return type().feature(name); }

  bool is_set(Feature feature) const;
  bool is_set(std::string_view name) const { return is_set(feature(name)); }
  /// Unsets a feature.
  void clear(Feature feature) const;
  void clear(std::string_view name) const { clear(feature(name)); }

  /// T: bool, any signed integer (throws when the value does not fit), float, double, std::string,
  /// FeatureStructure. Numbers are read as wider ones, never as narrower ones that lose.
  template <typename T>
  T get(Feature feature) const;
  template <typename T>
  T get(std::string_view name) const {
    return get<T>(feature(name));
  }
  /// The text of a string feature without a copy; valid until it is set again.
  const std::string& text(Feature feature) const;

  void set(Feature feature, bool value) const;
  void set(Feature feature, std::signed_integral auto value) const { set_integer(feature, value); }
  void set(Feature feature, double value) const;
  void set(Feature feature, float value) const { set(feature, static_cast<double>(value)); }
  /// Throws Error when the range is a string subtype that does not allow the value.
  void set(Feature feature, std::string value) const;
  void set(Feature feature, const char* value) const { set(feature, std::string(value)); }
  void set(Feature feature, std::string_view value) const { set(feature, std::string(value)); }
  /// Null is allowed; otherwise the type must be the range or a subtype, and of the same CAS.
  void set(Feature feature, const FeatureStructure& value) const;
  template <typename T>
  void set(std::string_view name, const T& value) const {
    set(feature(name), value);
  }

  // An array feature holds a reference to an array, which is a feature structure of its own and may be
  // shared.

  /// The elements of an array feature without copying; empty when it is unset. T as in kind_of<T>().
  template <typename T>
  Buffer<T> array(Feature feature) const {
    const FeatureStructure array = get<FeatureStructure>(feature);
    return array ? array.elements<T>() : Buffer<T>();
  }
  template <typename T>
  Buffer<T> array(std::string_view name) const {
    return array<T>(feature(name));
  }
  /// Gives an array feature a new array that shares the buffer's memory.
  template <typename T>
  void set_array(Feature feature, const Buffer<T>& values) const {
    set(feature, new_array(kind_of<T>(), values));
  }
  template <typename T>
  void set_array(std::string_view name, const Buffer<T>& values) const {
    set_array(feature(name), values);
  }
  template <typename T>
  void set_array(std::string_view name, std::vector<T> values) const {
    set_array(feature(name), Buffer<T>(std::move(values)));
  }
  /// A list feature (FSArray, FSList, StringList, ...) as something like a std::vector.
  List list(Feature feature) const;
  List list(std::string_view name) const;

  // When this is an array itself.

  size_t array_size() const;
  template <typename T>
  Buffer<T> elements() const {
    return raw_elements(kind_of<T>()).template as<T>();
  }
  /// Elements of an array of numbers, booleans or strings, whose kind must be `component`.
  const RawBuffer& raw_elements(Kind component) const;
  FeatureStructure element(size_t index) const;      ///< of an FSArray
  std::vector<FeatureStructure> structures() const;  ///< of an FSArray
  void set_elements(const std::vector<FeatureStructure>& elements) const;
  void append(const FeatureStructure& element) const;

  /// Deletes it: it leaves all indexes, references to it remain but every access to it throws Error.
  void remove() const;
  void add_to_index(std::string_view view = "default") const;
  void remove_from_index(std::string_view view = "default") const;

  /// The stored value, for generic code such as serialisers.
  const Value& value(Feature feature) const;

 private:
  const Value& read(Feature feature) const;
  Value& write(Feature feature) const;
  void set_integer(Feature feature, int64_t value) const;
  int64_t get_integer(Feature feature, int64_t low, int64_t high) const;
  FeatureStructure new_array(Kind component, const RawBuffer& values) const;
  [[noreturn]] void wrong_kind(Feature feature, const char* asked) const;

  Cas* cas_ = nullptr;
  uint32_t id_ = 0;
};

template <typename T>
T FeatureStructure::get(Feature feature) const {
  if constexpr (std::is_same_v<T, bool>) {
    if (feature.range().kind() != Kind::kBoolean) wrong_kind(feature, "a Boolean");
    const bool* value = std::get_if<bool>(&read(feature));
    return value != nullptr && *value;
  } else if constexpr (std::signed_integral<T>) {
    return static_cast<T>(get_integer(feature, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
  } else if constexpr (std::floating_point<T>) {
    const Kind kind = feature.range().kind();
    if (kind != Kind::kFloat && (kind != Kind::kDouble || std::is_same_v<T, float>))
      wrong_kind(feature, std::is_same_v<T, float> ? "a Float" : "a Double");
    const double* value = std::get_if<double>(&read(feature));
    return static_cast<T>(value == nullptr ? 0.0 : *value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return text(feature);
  } else {
    static_assert(std::is_same_v<T, FeatureStructure>, "no feature holds this C++ type");
    if (is_primitive(feature.range().kind())) wrong_kind(feature, "a reference");
    const Reference* value = std::get_if<Reference>(&read(feature));
    return value == nullptr ? FeatureStructure() : FeatureStructure(cas_, value->id);
  }
}

/// A list feature with the interface of a vector, whether the type system made it an FSArray, an FSList, a
/// StringList, an IntegerList or a FloatList. Changes go to the array or list that the feature refers to;
/// where there is none, one is made.
class List {
 public:
  List(FeatureStructure owner, Feature feature);

  size_t size() const;
  bool empty() const { return size() == 0; }
  /// Elements of lists of feature structures, checked against the feature's element type when written.
  FeatureStructure at(size_t index) const;
  std::vector<FeatureStructure> structures() const;
  void push_back(const FeatureStructure& element) const;
  void assign(const std::vector<FeatureStructure>& elements) const;
  /// Takes an element out of the list (the feature structure itself stays); false when it was not in.
  bool erase(const FeatureStructure& element) const;
  void clear() const;

  /// Lists of strings, integers or floats. T: std::string, int32_t, float.
  template <typename T>
  std::vector<T> values() const;
  template <typename T>
  void assign_values(const std::vector<T>& values) const;
  template <typename T>
  void push_back_value(const T& value) const;

 private:
  void check(const FeatureStructure& element) const;
  void expect(Kind component) const;
  std::vector<FeatureStructure> nodes() const;
  void set_nodes(const std::vector<FeatureStructure>& nodes) const;
  FeatureStructure new_node() const;

  FeatureStructure owner_;
  Feature feature_;
  Kind component_ = Kind::kStructure;
  bool is_array_ = false;
};

}  // namespace loci::perception::cas
