#include "perception/types/generator/docs.h"

#include <fmt/format.h>

#include "mapping/base/files.h"
#include "perception/cas/type_system.h"

namespace loci::perception::generator {

using cas::Feature;
using cas::Type;

namespace {

const char* const kIntroduction = R"(# Type system

What annotators can say. The types are declared in perception/types/*.xml, in UIMA's format; this page is generated from
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

**More than the XML says.** A proxy is a handle; a class derived from it adds functions without touching generated files:

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

}  // namespace

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

}  // namespace loci::perception::generator
