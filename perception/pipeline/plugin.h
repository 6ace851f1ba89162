#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "perception/cas/type_system.h"
#include "perception/pipeline/registry.h"
#include "perception/pipeline/version.h"

namespace loci::perception {

/// What a plugin says about itself. The layout up to `compiler` never changes, so that any version can be
/// read and refused; the rest is only looked at when all of that agrees.
struct PluginInfo {
  int format = 1;
  const char* version = LOCI_BUILD_VERSION;  ///< of loci, that it was built against
  const char* compiler = __VERSION__;
  const char* name = "";
  void (*add)(AnnotatorRegistry&) = nullptr;
  const std::vector<cas::TypeSource>& (*types)() = nullptr;  ///< its XML types; null = none
};

/// Makes a shared library a plugin:
///
///     LOCI_PLUGIN("warmth", add_annotators, warmth::type_sources)
///
/// with void add_annotators(loci::perception::AnnotatorRegistry&), and the generated type_sources or nullptr.
#define LOCI_PLUGIN(plugin_name, add_function, types_function)   \
  extern "C" const loci::perception::PluginInfo* loci_plugin() { \
    static loci::perception::PluginInfo info;                    \
    info.name = plugin_name;                                     \
    info.add = add_function;                                     \
    info.types = types_function;                                 \
    return &info;                                                \
  }

struct LoadedPlugin {
  std::filesystem::path path;
  std::string name;
  std::vector<cas::TypeSource> types;
};

/// Loads a plugin and adds its annotators; it stays loaded until the program ends. Throws Error when it is no
/// plugin, or was built against another version of loci or with another compiler: both are named.
LoadedPlugin load_plugin(const std::filesystem::path& path, AnnotatorRegistry& registry);

/// Our types with those of the plugins.
std::shared_ptr<const cas::TypeSystem> type_system_with_plugins(const std::vector<LoadedPlugin>& plugins);

}  // namespace loci::perception
