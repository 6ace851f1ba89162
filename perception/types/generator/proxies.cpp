#include "perception/types/generator/proxies.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "mapping/base/files.h"
#include "perception/cas/type_system.h"

namespace loci::perception::generator {

using cas::Feature;
using cas::Kind;
using cas::Type;
using cas::TypeSystem;

namespace {

std::string cpp_type(Kind kind) {
  switch (kind) {
    case Kind::kBoolean:
      return "bool";
    case Kind::kByte:
      return "int8_t";
    case Kind::kShort:
      return "int16_t";
    case Kind::kInteger:
      return "int32_t";
    case Kind::kLong:
      return "int64_t";
    case Kind::kFloat:
      return "float";
    case Kind::kDouble:
      return "double";
    default:
      return "std::string";
  }
}

/// Comments end at the line, whatever a description holds.
std::string comment(const std::string& text) {
  std::string line;
  for (const char c : text) line += c == '\n' || c == '\r' || c == '\\' ? ' ' : c;
  return line;
}

/// An equal file stays, so that what includes it is not compiled again.
void write_when_changed(const std::filesystem::path& path, const std::string& text) {
  if (!std::filesystem::exists(path) || read_file(path) != text) write_file_atomically(path, text);
}

class Generator {
 public:
  Generator(ProxyTarget target, const std::vector<std::filesystem::path>& files,
            const std::vector<std::filesystem::path>& path_dirs)
      : target_(std::move(target)), files_(files), system_(TypeSystem::load(files, path_dirs)) {
    std::set<std::string> names;
    for (const auto& file : files) names.insert(file.string());
    std::map<std::string, std::string> short_names;
    for (const Type& type : system_->types()) {
      if (type.is_builtin() || !names.contains(type.location().file) || cas::is_primitive(type.kind()))
        continue;
      const auto [other, is_new] = short_names.emplace(type.short_name(), type.name());
      if (!is_new)
        throw Error(type.name() + " and " + other->second + " would be one class", type.location());
      own_.push_back(type);
      own_names_.insert(type.name());
    }
  }

  std::string header() const {
    std::string text = "// Generated from type systems in XML: change those, not this.\n#pragma once\n\n";
    text += "#include \"perception/types/proxy.h\"\n";
    if (target_.include_folder != "perception/types") text += "#include \"perception/types/types.h\"\n";
    text += fmt::format("\nnamespace {} {{\n\n", target_.name_space);
    if (!target_.name_space.starts_with("loci::perception"))
      text += "namespace cas = loci::perception::cas;\n";
    if (target_.name_space != "loci::perception::types")
      text +=
          "using loci::perception::types::ArrayFeature;\nusing loci::perception::types::ListFeature;\nusing "
          "loci::perception::types::PrimitiveFeature;\n"
          "using loci::perception::types::ReferenceFeature;\nusing "
          "loci::perception::types::ValueListFeature;\n\n";
    for (const Type& type : own_) text += fmt::format("class {};\n", type.short_name());
    for (const Type& type : own_) text += class_text(type);  // supertypes come first
    text +=
        "\n/// The XML texts that these classes were made from.\nconst std::vector<cas::TypeSource>& "
        "type_sources();\n";
    return text + fmt::format("\n}}  // namespace {}\n", target_.name_space);
  }

  std::string source() const {
    std::string text = "// Generated from type systems in XML: change those, not this.\n";
    text += fmt::format("#include \"{}/generated.h\"\n\nnamespace {} {{\n\n", target_.include_folder,
                        target_.name_space);
    text += "const std::vector<cas::TypeSource>& type_sources() {\n";
    text += "  static const std::vector<cas::TypeSource> sources = {\n";
    for (const auto& file : files_) {
      text += fmt::format("    {{\"loci/{}\", ", file.filename().string());
      const std::string xml = read_file(file);
      for (size_t begin = 0; begin < xml.size(); begin += 8000)  // compilers limit the length of a literal
        text += fmt::format("R\"~~~({})~~~\" ", xml.substr(begin, 8000));
      text += "},\n";
    }
    return text + fmt::format("  }};\n  return sources;\n}}\n\n}}  // namespace {}\n", target_.name_space);
  }

 private:
  std::string class_name(Type type) const {
    if (own_names_.contains(type.name())) return type.short_name();
    if (type.name().starts_with("loci.")) return "loci::perception::types::" + type.short_name();
    return "loci::perception::types::Top";
  }

  std::string feature_type(const Feature& feature) const {
    const Type range = feature.range();
    if (cas::is_primitive(range.kind())) return fmt::format("PrimitiveFeature<{}>", cpp_type(range.kind()));
    if (range.kind() == Kind::kArray && range.component_kind() != Kind::kStructure)
      return fmt::format("ArrayFeature<{}>", range.component_kind() == Kind::kByte
                                                 ? "uint8_t"
                                                 : cpp_type(range.component_kind()));
    if (range.kind() == Kind::kArray)
      return fmt::format("ListFeature<{}>", class_name(feature.element_type()));
    if (const auto component = system_->list_component(range))
      return *component == Kind::kStructure
                 ? fmt::format("ListFeature<{}>", class_name(feature.element_type()))
                 : fmt::format("ValueListFeature<{}>", cpp_type(*component));
    return fmt::format("ReferenceFeature<{}>", class_name(range));
  }

  /// Features of built-in supertypes have no proxy class to stand in.
  static std::vector<Feature> features_of(Type type) {
    std::vector<Feature> features;
    for (Type super = type.supertype(); super && super.is_builtin(); super = super.supertype()) {
      const auto own = super.own_features();
      features.insert(features.begin(), own.begin(), own.end());
    }
    const auto own = type.own_features();
    features.insert(features.end(), own.begin(), own.end());
    return features;
  }

  std::string class_text(Type type) const {
    const std::string name = type.short_name();
    const std::string base = class_name(type.supertype());
    std::string text =
        fmt::format("\n/// {}\nclass {} : public {} {{\n public:\n", comment(type.description()), name, base);
    text += fmt::format("  static constexpr std::string_view kTypeName = \"{}\";\n", type.name());
    text += fmt::format("  {}() = default;\n", name);
    text += fmt::format("  explicit {}(const cas::FeatureStructure& structure) : {}(structure) {{}}\n", name,
                        base);
    text +=
        fmt::format("  static {0} create(cas::Cas& cas) {{ return {0}(cas.create(kTypeName)); }}\n", name);
    for (const Feature& feature : features_of(type)) {
      text += fmt::format("\n  /// {}\n", comment(feature.description()));
      text += fmt::format("  {} {}{{structure(), \"{}\"}};\n", feature_type(feature), feature.name(),
                          feature.name());
    }
    return text + "};\n";
  }

  ProxyTarget target_;
  std::vector<std::filesystem::path> files_;
  std::shared_ptr<const TypeSystem> system_;
  std::vector<Type> own_;
  std::set<std::string> own_names_;
};

}  // namespace

void write_proxies(const ProxyTarget& target, const std::vector<std::filesystem::path>& files,
                   const std::vector<std::filesystem::path>& path_dirs) {
  const Generator generator(target, files, path_dirs);
  const auto folder = target.output / target.include_folder;
  make_folder(folder);
  write_when_changed(folder / "generated.h", generator.header());
  write_when_changed(folder / "generated.cpp", generator.source());
}

}  // namespace loci::perception::generator
