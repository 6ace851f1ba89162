#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/text/text.h"
#include "perception/cas/type_system.h"

namespace loci::perception::cas {
namespace {

using detail::FeatureData;
using detail::TypeData;
using tinyxml2::XMLElement;

const std::map<std::string, Kind> kPrimitives = {
    {"uima.cas.Boolean", Kind::kBoolean}, {"uima.cas.Byte", Kind::kByte},
    {"uima.cas.Short", Kind::kShort},     {"uima.cas.Integer", Kind::kInteger},
    {"uima.cas.Long", Kind::kLong},       {"uima.cas.Float", Kind::kFloat},
    {"uima.cas.Double", Kind::kDouble},   {"uima.cas.String", Kind::kString},
};

const std::map<std::string, Kind> kArrays = {
    {"uima.cas.FSArray", Kind::kStructure},    {"uima.cas.BooleanArray", Kind::kBoolean},
    {"uima.cas.ByteArray", Kind::kByte},       {"uima.cas.ShortArray", Kind::kShort},
    {"uima.cas.IntegerArray", Kind::kInteger}, {"uima.cas.LongArray", Kind::kLong},
    {"uima.cas.FloatArray", Kind::kFloat},     {"uima.cas.DoubleArray", Kind::kDouble},
    {"uima.cas.StringArray", Kind::kString},
};

constexpr int kMaxDepth = 1000;  // levels of inheritance; recursion follows them

std::string at(const FileLocation& place) {
  return place.file.empty() ? "the built-in types" : place.text();
}

FileLocation place_of(const XMLElement& element, const std::string& file) {
  return {file, element.GetLineNum(), {}};
}

std::string child_text(const XMLElement& element, const char* name) {
  const XMLElement* child = element.FirstChildElement(name);
  return child == nullptr || child->GetText() == nullptr ? "" : trimmed(child->GetText());
}

std::string required_text(const XMLElement& element, const char* name, const std::string& file) {
  std::string text = child_text(element, name);
  if (text.empty())
    throw Error(std::string("<") + element.Name() + "> without <" + name + ">", place_of(element, file),
                "add it");
  return text;
}

/// Refuses elements that the format does not have: a misspelt one would be lost without a word.
void check_children(const XMLElement& element, const std::vector<std::string>& known,
                    const std::string& file) {
  for (auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    if (std::find(known.begin(), known.end(), child->Name()) == known.end())
      throw Error(std::string("unexpected <") + child->Name() + "> in <" + element.Name() + ">",
                  place_of(*child, file), did_you_mean(child->Name(), known));
}

/// UIMA's names are identifiers, which XMI writes as names of elements and attributes.
void require_identifier(const std::string& name, const std::string& what, const FileLocation& place) {
  const auto is_letter = [](char c) {  // of any script: a part of its UTF-8
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
  };
  const auto continues = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); };
  if (name.empty() || !is_letter(name.front()) || !std::ranges::all_of(name, continues))
    throw Error(fmt::format("'{}' in {} is not a name that XML can carry", name, what), place,
                "a letter, then letters, digits and _");
}

template <typename Visit>
void for_each_child(const XMLElement& parent, const char* list, const char* item, const std::string& file,
                    Visit visit) {
  for (auto* group = parent.FirstChildElement(list); group != nullptr;
       group = group->NextSiblingElement(list)) {
    check_children(*group, {item}, file);
    for (auto* child = group->FirstChildElement(item); child != nullptr;
         child = child->NextSiblingElement(item))
      visit(*child);
  }
}

}  // namespace

/// Collects declarations from built-in types, texts and files, merges them, and makes a TypeSystem. Names are
/// resolved at the end, so the order of files does not matter.
class TypeSystemBuilder {
 public:
  TypeSystemBuilder(const std::vector<loci::perception::cas::TypeSource>& sources,
                    std::vector<std::filesystem::path> path_dirs);

  void add_file(const std::filesystem::path& path, const FileLocation& from = {});
  void add_source(const loci::perception::cas::TypeSource& source);
  std::shared_ptr<const loci::perception::cas::TypeSystem> finish();

 private:
  struct FeatureDeclaration {
    std::string name, description, range, element;
    std::optional<bool> multiple_references;
    FileLocation place;
  };
  struct TypeDeclaration {
    std::string name, description, supertype;
    std::vector<FeatureDeclaration> features;
    std::vector<std::string> allowed_values;
    bool has_allowed_values = false;
    bool builtin = false;
    FileLocation place;
    int state = 0;   ///< 0 new, 1 being built, 2 built
    int levels = 0;  ///< of supertypes above it
    loci::perception::cas::detail::TypeData* data = nullptr;
  };

  void add_builtin_types();
  void add_text(const std::string& text, const std::string& file, const std::filesystem::path& folder);
  void add_import(const tinyxml2::XMLElement& element, const std::string& file,
                  const std::filesystem::path& folder);
  TypeDeclaration read_type(const tinyxml2::XMLElement& element, const std::string& file) const;
  FeatureDeclaration read_feature(const tinyxml2::XMLElement& element, const std::string& file) const;
  void declare(TypeDeclaration declaration);
  void declare_builtin(const std::string& name, const std::string& supertype,
                       const std::vector<std::pair<std::string, std::string>>& features = {});
  static void merge(TypeDeclaration& known, const TypeDeclaration& again);
  static void merge_feature(const std::string& type, FeatureDeclaration& known,
                            const FeatureDeclaration& again);

  TypeDeclaration& resolve(const std::string& name, const FileLocation& place, const std::string& what);
  void build_hierarchy(loci::perception::cas::TypeSystem& system);
  void build_type(loci::perception::cas::TypeSystem& system, TypeDeclaration& declaration, int depth = 0);
  void build_order(loci::perception::cas::TypeSystem& system);
  void build_features(loci::perception::cas::TypeSystem& system);
  void add_feature(loci::perception::cas::detail::TypeData& type, const FeatureDeclaration& declaration);
  static void index_types(loci::perception::cas::TypeSystem& system);

  std::map<std::string, std::string> sources_;
  std::vector<std::filesystem::path> path_dirs_;
  std::set<std::string> read_;
  std::map<std::string, TypeDeclaration> declarations_;
};

void TypeSystemBuilder::declare_builtin(const std::string& name, const std::string& supertype,
                                        const std::vector<std::pair<std::string, std::string>>& features) {
  TypeDeclaration type;
  type.name = name;
  type.supertype = supertype;
  type.builtin = true;
  for (const auto& [feature, range] : features) {
    FeatureDeclaration declaration;
    declaration.name = feature;
    declaration.range = range;
    type.features.push_back(std::move(declaration));
  }
  declarations_.emplace(name, std::move(type));
}

void TypeSystemBuilder::add_builtin_types() {
  declare_builtin("uima.cas.TOP", "");
  for (const auto& [name, kind] : kPrimitives) declare_builtin(name, "uima.cas.TOP");
  declare_builtin("uima.cas.ArrayBase", "uima.cas.TOP");
  for (const auto& [name, kind] : kArrays) declare_builtin(name, "uima.cas.ArrayBase");
  declare_builtin("uima.cas.ListBase", "uima.cas.TOP");
  for (const auto& [list, head] :
       {std::pair{"FS", "uima.cas.TOP"}, std::pair{"String", "uima.cas.String"},
        std::pair{"Integer", "uima.cas.Integer"}, std::pair{"Float", "uima.cas.Float"}}) {
    const std::string base = std::string("uima.cas.") + list + "List";
    declare_builtin(base, "uima.cas.ListBase");
    declare_builtin(std::string("uima.cas.Empty") + list + "List", base);
    declare_builtin(std::string("uima.cas.NonEmpty") + list + "List", base, {{"head", head}, {"tail", base}});
  }
  declare_builtin("uima.cas.Sofa", "uima.cas.TOP",
                  {{"sofaNum", "uima.cas.Integer"},
                   {"sofaID", "uima.cas.String"},
                   {"mimeType", "uima.cas.String"},
                   {"sofaArray", "uima.cas.TOP"},
                   {"sofaString", "uima.cas.String"},
                   {"sofaURI", "uima.cas.String"}});
  declare_builtin("uima.cas.AnnotationBase", "uima.cas.TOP", {{"sofa", "uima.cas.Sofa"}});
  declare_builtin("uima.tcas.Annotation", "uima.cas.AnnotationBase",
                  {{"begin", "uima.cas.Integer"}, {"end", "uima.cas.Integer"}});
  declare_builtin("uima.tcas.DocumentAnnotation", "uima.tcas.Annotation", {{"language", "uima.cas.String"}});
}

void TypeSystemBuilder::declare(TypeDeclaration declaration) {
  const auto [position, is_new] = declarations_.try_emplace(declaration.name, declaration);
  if (!is_new) merge(position->second, declaration);
}

void TypeSystemBuilder::merge(TypeDeclaration& known, const TypeDeclaration& again) {
  if (known.supertype != again.supertype)
    throw Error("type " + again.name + " is declared with supertype " + again.supertype + ", but with " +
                    (known.supertype.empty() ? "none" : known.supertype) + " in " + at(known.place),
                again.place, "let both declarations agree");
  if (known.has_allowed_values != again.has_allowed_values || known.allowed_values != again.allowed_values)
    throw Error("type " + again.name + " is declared twice with different allowed values, first in " +
                    at(known.place),
                again.place, "let both declarations agree");
  if (known.description.empty()) known.description = again.description;
  for (const FeatureDeclaration& feature : again.features) {
    const auto same = std::find_if(known.features.begin(), known.features.end(),
                                   [&](const auto& each) { return each.name == feature.name; });
    if (same == known.features.end())
      known.features.push_back(feature);
    else
      merge_feature(known.name, *same, feature);
  }
}

void TypeSystemBuilder::merge_feature(const std::string& type, FeatureDeclaration& known,
                                      const FeatureDeclaration& again) {
  const auto refuse = [&](const std::string& what, const std::string& here, const std::string& there) {
    throw Error("feature '" + again.name + "' of type " + type + " has " + what + " " + here + " here and " +
                    there + " in " + at(known.place),
                again.place, "let both declarations agree");
  };
  if (known.range != again.range) refuse("range", again.range, known.range);
  if (!known.element.empty() && !again.element.empty() && known.element != again.element)
    refuse("elements of type", again.element, known.element);
  if (known.element.empty()) known.element = again.element;
  if (known.description.empty()) known.description = again.description;
  if (!known.multiple_references) known.multiple_references = again.multiple_references;
}

TypeSystemBuilder::TypeDeclaration& TypeSystemBuilder::resolve(const std::string& name,
                                                               const FileLocation& place,
                                                               const std::string& what) {
  const auto found = declarations_.find(name);
  if (found != declarations_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, declaration] : declarations_) names.push_back(known);
  const std::string hint = did_you_mean(name, names);
  throw Error("unknown type " + name + " as " + what, place,
              hint.empty() ? "declare it or import the file that does" : hint);
}

void TypeSystemBuilder::build_type(TypeSystem& system, TypeDeclaration& declaration, int depth) {
  if (declaration.state == 2) return;
  if (declaration.state == 1)
    throw Error("type " + declaration.name + " inherits from itself", declaration.place,
                "break the cycle of supertypes");
  if (depth > kMaxDepth)
    throw Error(
        "type " + declaration.name + " has more than " + std::to_string(kMaxDepth) + " levels below it",
        declaration.place, "flatten the hierarchy");
  declaration.state = 1;
  TypeDeclaration* super = nullptr;
  if (!declaration.supertype.empty()) {
    super = &resolve(declaration.supertype, declaration.place, "supertype of " + declaration.name);
    build_type(system, *super, depth + 1);
    declaration.levels = super->levels + 1;
  }
  // The recursion here ends at types that are built already; others go through all levels.
  if (declaration.levels > kMaxDepth)
    throw Error("type " + declaration.name + " has more than " + std::to_string(kMaxDepth) + " supertypes",
                declaration.place, "flatten the hierarchy");
  auto data = std::make_unique<TypeData>();
  data->name = declaration.name;
  data->description = declaration.description;
  data->builtin = declaration.builtin;
  data->place = declaration.place;
  data->allowed_values = declaration.allowed_values;
  if (const auto primitive = kPrimitives.find(declaration.name); primitive != kPrimitives.end())
    data->kind = primitive->second;
  if (const auto array = kArrays.find(declaration.name); array != kArrays.end()) {
    data->kind = Kind::kArray;
    data->component = array->second;
  }
  if (super != nullptr) {
    data->supertype = super->data;
    if (!declaration.builtin &&
        (super->data->kind != Kind::kStructure || super->name == "uima.cas.ArrayBase")) {
      if (super->name != "uima.cas.String")
        throw Error("type " + declaration.name + " cannot inherit from " + super->name, declaration.place,
                    super->data->kind == Kind::kString ? "inherit from uima.cas.String"
                                                       : "inherit from uima.cas.TOP");
      if (!declaration.features.empty())
        throw Error("the string type " + declaration.name + " cannot have features", declaration.place);
      data->kind = Kind::kString;
    }
  }
  if (declaration.has_allowed_values && (data->kind != Kind::kString || declaration.builtin))
    throw Error("allowed values of " + declaration.name + ", which is no subtype of uima.cas.String",
                declaration.place, "set supertypeName to uima.cas.String");
  declaration.data = data.get();
  declaration.state = 2;
  system.data_.push_back(std::move(data));
}

void TypeSystemBuilder::build_hierarchy(TypeSystem& system) {
  for (auto& [name, declaration] : declarations_) build_type(system, declaration);
}

void TypeSystemBuilder::build_order(TypeSystem& system) {
  std::map<const TypeData*, std::vector<TypeData*>> children;  // in order of name: declarations_ is sorted
  for (auto& [name, declaration] : declarations_)
    children[declaration.data->supertype].push_back(declaration.data);
  const std::function<void(TypeData*)> visit = [&](TypeData* type) {
    type->order = static_cast<int>(system.types_.size());
    system.types_.emplace_back(type);
    for (TypeData* child : children[type]) visit(child);
    type->last_order = static_cast<int>(system.types_.size()) - 1;
  };
  visit(declarations_.at("uima.cas.TOP").data);
}

void TypeSystemBuilder::add_feature(TypeData& type, const FeatureDeclaration& declaration) {
  const std::string what = "range of feature '" + declaration.name + "' of " + type.name;
  std::string range = declaration.range;
  std::string element = declaration.element;
  if (range.ends_with("[]")) {  // UIMA 3 writes a typed array as Element[]
    element = range.substr(0, range.size() - 2);
    range = "uima.cas.FSArray";
  } else if (element.ends_with("[]")) {
    element.resize(element.size() - 2);
  }
  auto data = std::make_unique<FeatureData>();
  data->name = declaration.name;
  data->description = declaration.description;
  data->range = resolve(range, declaration.place, what).data;
  data->has_element = !element.empty();
  data->element = resolve(element.empty() ? "uima.cas.TOP" : element, declaration.place,
                          "element type of feature '" + declaration.name + "' of " + type.name)
                      .data;
  data->multiple_references = declaration.multiple_references.value_or(false);
  data->owner = &type;

  const auto inherited = std::find_if(type.features.begin(), type.features.end(),
                                      [&](const Feature& each) { return each.name() == declaration.name; });
  if (inherited != type.features.end()) {
    if (inherited->range() != Type(data->range))
      throw Error("feature '" + declaration.name + "' of " + type.name + " has range " + range +
                      ", but inherits it from " + inherited->owner().name() + " with range " +
                      inherited->range().name(),
                  declaration.place, "give it another name");
    return;
  }
  data->slot = type.features.size();
  type.features.emplace_back(data.get());
  type.own.push_back(std::move(data));
}

void TypeSystemBuilder::build_features(TypeSystem& system) {
  for (const Type& each : system.types_) {  // supertypes come first
    TypeDeclaration& declaration = declarations_.at(each.name());
    TypeData& type = *declaration.data;
    if (type.supertype != nullptr) type.features = type.supertype->features;
    for (const FeatureDeclaration& feature : declaration.features) add_feature(type, feature);
    for (const Feature& feature : type.features) type.by_name.emplace_back(feature.name(), feature);
    std::sort(type.by_name.begin(), type.by_name.end(),
              [](const auto& one, const auto& two) { return one.first < two.first; });
  }
}

void TypeSystemBuilder::index_types(TypeSystem& system) {
  for (const Type& type : system.types_) system.by_name_.emplace_back(type.name(), type);
  std::sort(system.by_name_.begin(), system.by_name_.end(),
            [](const auto& one, const auto& two) { return one.first < two.first; });
  system.arrays_.resize(static_cast<size_t>(Kind::kString) + 1);
  for (const auto& [name, kind] : kArrays) system.arrays_[static_cast<size_t>(kind)] = system.type(name);
  const auto list = [&](const std::string& name) {
    return TypeSystem::ListTypes{system.type("uima.cas." + name + "List"),
                                 system.type("uima.cas.Empty" + name + "List"),
                                 system.type("uima.cas.NonEmpty" + name + "List")};
  };
  system.fs_list_ = list("FS");
  system.string_list_ = list("String");
  system.integer_list_ = list("Integer");
  system.float_list_ = list("Float");
}

std::shared_ptr<const TypeSystem> TypeSystemBuilder::finish() {
  std::shared_ptr<TypeSystem> system(new TypeSystem);
  build_hierarchy(*system);
  build_order(*system);
  build_features(*system);
  index_types(*system);
  return system;
}

std::shared_ptr<const TypeSystem> TypeSystem::load(const std::vector<std::filesystem::path>& files,
                                                   const std::vector<std::filesystem::path>& path_dirs) {
  return load({}, files, path_dirs);
}

std::shared_ptr<const TypeSystem> TypeSystem::load(const std::vector<TypeSource>& sources,
                                                   const std::vector<std::filesystem::path>& files,
                                                   const std::vector<std::filesystem::path>& path_dirs) {
  TypeSystemBuilder builder(sources, path_dirs);
  for (const TypeSource& source : sources) builder.add_source(source);
  for (const auto& file : files) builder.add_file(file);
  return builder.finish();
}

std::shared_ptr<const TypeSystem> TypeSystem::builtin() {
  static const std::shared_ptr<const TypeSystem> system = load({}, {}, {});
  return system;
}

TypeSystemBuilder::TypeSystemBuilder(const std::vector<TypeSource>& sources,
                                     std::vector<std::filesystem::path> path_dirs)
    : path_dirs_(std::move(path_dirs)) {
  for (const TypeSource& source : sources) sources_.emplace(source.name, source.text);
  add_builtin_types();
}

void TypeSystemBuilder::add_source(const TypeSource& source) {
  if (!read_.insert("text:" + source.name).second) return;
  add_text(source.text, source.name, std::filesystem::path(source.name).parent_path());
}

void TypeSystemBuilder::add_file(const std::filesystem::path& path, const FileLocation& from) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw Error(from.file.empty() ? "no such type system: " + path.string()
                                  : "imports " + path.string() + ", which does not exist",
                from,
                from.file.empty() ? "check the path" : "check the location, or give its folder with --path");
  const auto canonical = std::filesystem::weakly_canonical(path, error);
  if (!read_.insert((error ? path : canonical).string()).second) return;
  add_text(read_file(path), path.string(), path.parent_path());
}

void TypeSystemBuilder::add_text(const std::string& text, const std::string& file,
                                 const std::filesystem::path& folder) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw Error("not well-formed XML", {file, document.ErrorLineNum(), {}},
                "check the tags around this line");
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "typeSystemDescription")
    throw Error("not a type system: the root element is not <typeSystemDescription>",
                {file, root == nullptr ? 0 : root->GetLineNum(), {}});
  check_children(*root, {"name", "description", "version", "vendor", "imports", "types"}, file);
  for_each_child(*root, "imports", "import", file,
                 [&](const XMLElement& each) { add_import(each, file, folder); });
  for_each_child(*root, "types", "typeDescription", file,
                 [&](const XMLElement& each) { declare(read_type(each, file)); });
}

void TypeSystemBuilder::add_import(const XMLElement& element, const std::string& file,
                                   const std::filesystem::path& folder) {
  const FileLocation place = place_of(element, file);
  if (const char* location = element.Attribute("location")) {
    if (const auto source = sources_.find((folder / location).lexically_normal().string());
        source != sources_.end())
      return add_source({source->first, source->second});
    return add_file(folder / location, place);
  }
  const char* name = element.Attribute("name");
  if (name == nullptr) throw Error("<import> without location or name", place, "add one of them");
  std::string relative = name;
  std::replace(relative.begin(), relative.end(), '.', '/');
  relative += ".xml";
  if (const auto source = sources_.find(relative); source != sources_.end())
    return add_source({source->first, source->second});
  for (const auto& directory : path_dirs_)
    if (std::filesystem::exists(directory / relative)) return add_file(directory / relative, place);
  throw Error("imports '" + std::string(name) + "', but " + relative + " is in none of the given folders",
              place, "give the folder with --path");
}

TypeSystemBuilder::TypeDeclaration TypeSystemBuilder::read_type(const XMLElement& element,
                                                                const std::string& file) const {
  check_children(element, {"name", "description", "supertypeName", "features", "allowedValues"}, file);
  TypeDeclaration type;
  type.place = place_of(element, file);
  type.name = required_text(element, "name", file);
  for (const std::string& part : split(type.name, '.'))
    require_identifier(part, "type " + type.name, type.place);
  type.description = child_text(element, "description");
  type.supertype = child_text(element, "supertypeName");
  if (type.supertype.empty() && type.name != "uima.cas.TOP") type.supertype = "uima.cas.TOP";
  for_each_child(element, "features", "featureDescription", file, [&](const XMLElement& each) {
    FeatureDeclaration feature = read_feature(each, file);
    const auto same = std::find_if(type.features.begin(), type.features.end(),
                                   [&](const auto& other) { return other.name == feature.name; });
    if (same == type.features.end())
      type.features.push_back(std::move(feature));
    else
      merge_feature(type.name, *same, feature);
  });
  type.has_allowed_values = element.FirstChildElement("allowedValues") != nullptr;
  for_each_child(element, "allowedValues", "value", file, [&](const XMLElement& each) {
    check_children(each, {"string", "description"}, file);
    type.allowed_values.push_back(required_text(each, "string", file));
  });
  return type;
}

TypeSystemBuilder::FeatureDeclaration TypeSystemBuilder::read_feature(const XMLElement& element,
                                                                      const std::string& file) const {
  check_children(element,
                 {"name", "description", "rangeTypeName", "elementType", "multipleReferencesAllowed"}, file);
  FeatureDeclaration feature;
  feature.place = place_of(element, file);
  feature.name = required_text(element, "name", file);
  require_identifier(feature.name, "feature " + feature.name, feature.place);
  feature.description = child_text(element, "description");
  feature.range = required_text(element, "rangeTypeName", file);
  feature.element = child_text(element, "elementType");
  const std::string multiple = child_text(element, "multipleReferencesAllowed");
  if (multiple == "true" || multiple == "false")
    feature.multiple_references = multiple == "true";
  else if (!multiple.empty())
    throw Error("multipleReferencesAllowed is '" + multiple + "'", feature.place, "use true or false");
  return feature;
}

}  // namespace loci::perception::cas
