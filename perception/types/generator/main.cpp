// Writes typed C++ proxies, or a page of documentation, from type systems in UIMA's XML. Run by the build.

#include <fmt/format.h>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/files.h"
#include "perception/cas/type_system.h"

namespace loci::perception::generator {
namespace {

using cas::Feature;
using cas::Kind;
using cas::Type;
using cas::TypeSystem;

struct ProxyTarget {
  std::string name_space;        ///< of the classes: "loci::perception::types"
  std::string include_folder;    ///< of the header: "perception/types"
  std::filesystem::path output;  ///< folder that the include folder is made in
};

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
    if (target_.include_folder != "perception/types") text += "#include \"perception/types/generated.h\"\n";
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

/// Writes generated.h (a class per type that the files declare) and generated.cpp (the texts of the files, so
/// that programs need none). Types that the files only import are taken from loci::perception::types when
/// their name begins with "loci."; imports by name are looked for under `path_dirs`. Throws loci::Error.
void write_proxies(const ProxyTarget& target, const std::vector<std::filesystem::path>& files,
                   const std::vector<std::filesystem::path>& path_dirs) {
  const Generator generator(target, files, path_dirs);
  const auto folder = target.output / target.include_folder;
  make_folder(folder);
  write_when_changed(folder / "generated.h", generator.header());
  write_when_changed(folder / "generated.cpp", generator.source());
}

const char* const kIntroduction = R"(# Type system

Types of the feature structures that annotators read and write. They are declared in perception/types/*.xml, in UIMA's format; this page is generated from
them by `ninja -C build/release type_system_docs`. Metres, radians, nanoseconds since 1970 (UTC); `map_from_x` takes
coordinates of x to the map.

**Typed access.** The build turns the files into C++ proxies (`loci::perception::types`), so that code has no string identifiers:

```cpp
cas::Cas cas(types::type_system());
types::Scene scene = types::SceneCas(cas).create_scene();
scene.timestamp.set(time);
for (types::Cluster cluster : scene.clusters)
  for (types::LocationAnnotation at : cluster.annotations.filter<types::LocationAnnotation>()) ...
types::Mat mat = types::to(cas, image);          // perception/conversions: OpenCV, PCL, cameras, Eigen
cv::Mat same = types::from<cv::Mat>(mat);        // on the same memory
```

**Extending proxies.** A proxy is a handle; a class derived from it adds functions without touching generated files:

```cpp
class Thermometer : public Temperature {
 public:
  using Temperature::Temperature;
  double fahrenheit() const { return degrees.get() * 9 / 5 + 32; }
};
Thermometer thermometer = types::as<Thermometer>(feature_structure);   // checked
```

**Types of your own** need no code: `types::type_system_with({"climate.xml"})` merges them with ours (they may inherit from
`loci.core.Annotation`, refer to any type, or add features to it by declaring it again), and everything works by name:
`fs.set("degrees", 21.5)`, JSON and the memory included. `loci-perceive types climate.xml --with-loci` checks them. For
proxies of your own: `loci_generate_types(FOLDER NAMESPACE climate.xml)` in CMake.
)";

/// Bars would end a cell.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string range_text(const Feature& feature) {
  if (feature.has_element_type())
    return fmt::format("{} of {}", feature.range().short_name(), feature.element_type().short_name());
  return feature.range().short_name();
}

std::string type_text(Type type) {
  std::string text = fmt::format("\n### {}\n\n`{}` : {}. {}\n", type.short_name(), type.name(),
                                 type.supertype().short_name(), type.description());
  if (!type.allowed_values().empty()) {
    std::string values;
    for (const std::string& value : type.allowed_values())
      values += (values.empty() ? "`" : ", `") + value + "`";
    text += "\nAllowed: " + values + "\n";
  }
  const auto features = type.own_features();
  if (features.empty()) return text;
  text += "\n| feature | holds | meaning |\n|---|---|---|\n";
  for (const Feature& feature : features)
    text +=
        fmt::format("| {} | {} | {} |\n", feature.name(), range_text(feature), cell(feature.description()));
  return text;
}

/// Writes a page (Markdown) that lists the types of the files with their features. Throws loci::Error.
void write_docs(const std::filesystem::path& output, const std::vector<std::filesystem::path>& files) {
  const auto system = cas::TypeSystem::load(files);
  std::string text = kIntroduction;
  for (const auto& file : files) {
    text += fmt::format("\n## {}\n", file.stem().string());
    for (const Type& type : system->types())
      if (type.location().file == file.string()) text += type_text(type);
  }
  write_file_atomically(output, text);
}

}  // namespace

}  // namespace loci::perception::generator

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  try {
    if (arguments.size() >= 5 && arguments[0] == "proxies") {
      const bool paths = arguments[4] == "--path" && arguments.size() >= 7;
      std::vector<std::filesystem::path> path_dirs;
      if (paths) path_dirs.emplace_back(arguments[5]);
      loci::perception::generator::write_proxies({arguments[1], arguments[2], arguments[3]},
                                                 {arguments.begin() + (paths ? 6 : 4), arguments.end()},
                                                 path_dirs);
      return 0;
    }
    if (arguments.size() >= 3 && arguments[0] == "docs") {
      loci::perception::generator::write_docs(arguments[1], {arguments.begin() + 2, arguments.end()});
      return 0;
    }
  } catch (const loci::Error& error) {
    std::fprintf(stderr, "loci_generate_types: %s\n", error.what());
    return 1;
  }
  std::fprintf(
      stderr,
      "usage: loci_generate_types proxies NAMESPACE INCLUDE_FOLDER OUTPUT_FOLDER [--path DIR] FILE.xml...\n"
      "       loci_generate_types docs OUTPUT.md FILE.xml...\n");
  return 2;
}
