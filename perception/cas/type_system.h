#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::perception::cas {

class TypeSystem;
class Feature;

namespace detail {
struct TypeData;
struct FeatureData;
}  // namespace detail

/// How the values of a type are stored.
enum class Kind {
  kStructure,  ///< features, referred to by handle
  kArray,      ///< a feature structure that is an array of `Type::component_kind()`
  kBoolean,
  kByte,
  kShort,
  kInteger,
  kLong,
  kFloat,
  kDouble,
  kString,
};

/// Whether values of this kind live inside a feature structure (numbers, booleans, strings).
constexpr bool is_primitive(Kind kind) {
  return kind != Kind::kStructure && kind != Kind::kArray;
}
constexpr bool is_integer(Kind kind) {
  return kind == Kind::kByte || kind == Kind::kShort || kind == Kind::kInteger || kind == Kind::kLong;
}
constexpr bool is_floating(Kind kind) {
  return kind == Kind::kFloat || kind == Kind::kDouble;
}

/// A type of a TypeSystem: a small handle, valid as long as its type system. Default-constructed: no type.
class Type {
 public:
  Type() = default;
  explicit Type(const detail::TypeData* data) : data_(data) {}

  explicit operator bool() const { return data_ != nullptr; }
  bool operator==(const Type&) const = default;

  const std::string& name() const;  ///< with its name space: "loci.scene.Scene"
  std::string short_name() const;   ///< without: "Scene"
  const std::string& description() const;
  Type supertype() const;  ///< no type for uima.cas.TOP
  Kind kind() const;
  /// What an array holds; Kind::kStructure for an FSArray.
  Kind component_kind() const;
  bool is_builtin() const;
  /// Where it was declared first; no file for built-in types.
  const FileLocation& location() const;

  /// Own features last, inherited ones first.
  const std::vector<Feature>& features() const;
  /// Only those that this type adds.
  std::vector<Feature> own_features() const;
  std::optional<Feature> find_feature(std::string_view name) const;
  /// Throws Error that names the type and the nearest feature.
  Feature feature(std::string_view name) const;

  /// What a string subtype allows; empty for any other type.
  const std::vector<std::string>& allowed_values() const;

  /// Position in depth-first order of the hierarchy: subtypes of a type are [order(), last_order()].
  int order() const;
  int last_order() const;

 private:
  const detail::TypeData* data_ = nullptr;
};

/// Whether `type` is `super` or one of its subtypes.
inline bool is_a(Type type, Type super) {
  return type.order() >= super.order() && type.order() <= super.last_order();
}

/// A feature (a field) of a type.
class Feature {
 public:
  Feature() = default;
  explicit Feature(const detail::FeatureData* data) : data_(data) {}
  explicit operator bool() const { return data_ != nullptr; }
  bool operator==(const Feature&) const = default;

  const std::string& name() const;
  const std::string& description() const;
  Type range() const;
  /// What the elements of an FSArray or FSList must be; uima.cas.TOP when nothing was declared.
  Type element_type() const;
  /// Whether `elementType` was declared.
  bool has_element_type() const;
  bool multiple_references_allowed() const;
  Type owner() const;  ///< the type that declares it
  size_t slot() const;

 private:
  const detail::FeatureData* data_ = nullptr;
};

namespace detail {
struct FeatureData {
  std::string name;
  std::string description;
  const TypeData* range = nullptr;
  const TypeData* element = nullptr;
  bool has_element = false;
  bool multiple_references = false;
  const TypeData* owner = nullptr;
  size_t slot = 0;
};

struct TypeData {
  std::string name;
  std::string description;
  const TypeData* supertype = nullptr;
  Kind kind = Kind::kStructure;
  Kind component = Kind::kStructure;
  bool builtin = false;
  FileLocation place;
  std::vector<std::string> allowed_values;
  std::vector<std::unique_ptr<FeatureData>> own;
  std::vector<Feature> features;
  std::vector<std::pair<std::string_view, Feature>> by_name;  ///< sorted
  int order = 0;
  int last_order = 0;
};
}  // namespace detail

/// XML text with a name for messages.
struct TypeSource {
  std::string name;
  std::string text;
};

/// The types that feature structures can have: immutable, checked when it is made.
///
/// A type system is read from files in UIMA's `typeSystemDescription` format. A type that is declared twice,
/// also a built-in one, is merged when its supertype and the ranges of its features agree. Refused with file
/// and line: XML that is not well-formed or not a type system, unknown types, cycles, features that disagree,
/// subtypes of arrays and primitives (a subtype of String with allowed values excepted).
class TypeSystem {
 public:
  /// Loads files and everything that they import, each file once. Imports by location are relative to the
  /// importing file; imports by name are looked for under `path_dirs`, with dots as slashes.
  static std::shared_ptr<const TypeSystem> load(const std::vector<std::filesystem::path>& files,
                                                const std::vector<std::filesystem::path>& path_dirs = {});

  /// The same with XML texts that come first; files and texts may import texts by their name.
  static std::shared_ptr<const TypeSystem> load(const std::vector<TypeSource>& sources,
                                                const std::vector<std::filesystem::path>& files,
                                                const std::vector<std::filesystem::path>& path_dirs);

  /// Only what UIMA brings along.
  static std::shared_ptr<const TypeSystem> builtin();

  /// All types in depth-first order of the hierarchy, siblings by name.
  const std::vector<Type>& types() const { return types_; }
  std::optional<Type> find(std::string_view name) const;
  /// Throws Error that names the nearest type.
  Type type(std::string_view name) const;
  Type top() const { return types_.front(); }
  /// The array type that holds this kind, e.g. uima.cas.FloatArray.
  Type array_type(Kind component) const;
  /// The type and all that inherit from it.
  std::vector<Type> subtypes(Type type) const;

  /// Types of UIMA's lists, looked up once.
  struct ListTypes {
    Type list, empty, node;
  };
  const ListTypes& list_types(Kind component) const;
  /// Whether the type is one of UIMA's list types (uima.cas.FSList and so on), and of what.
  std::optional<Kind> list_component(Type type) const;

 private:
  friend class TypeSystemBuilder;
  TypeSystem() = default;

  std::vector<std::unique_ptr<detail::TypeData>> data_;
  std::vector<Type> types_;
  std::vector<std::pair<std::string_view, Type>> by_name_;  ///< sorted
  std::vector<Type> arrays_;                                ///< by Kind
  ListTypes fs_list_, string_list_, integer_list_, float_list_;
};

/// The declared types (not the built-in ones) with supertype, features, allowed values; for people.
std::string types_text(const TypeSystem& system);

/// The same for programs: {"types": n, "features": n, "type": [{"name", "supertype", "file", "line",
/// "description", "features": [{"name", "range", "element", "description", "inherited_from"}],
/// "allowed_values"}]}. Lists hold inherited features too; the counts those that were declared.
Json types_json(const TypeSystem& system);

}  // namespace loci::perception::cas
