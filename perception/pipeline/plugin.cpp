#include "perception/pipeline/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "perception/types/types.h"

namespace loci::perception {

LoadedPlugin load_plugin(const std::filesystem::path& path, AnnotatorRegistry& registry) {
  const FileLocation place{path.string(), 0, {}};
  if (!std::filesystem::exists(path)) throw Error("there is no such plugin", place);
  // An absolute path, or the loader would look elsewhere first.
  void* library = dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw Error(fmt::format("this plugin cannot be loaded ({})", dlerror()), place);
  using Entry = const PluginInfo* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library, "loci_plugin"));
  if (entry == nullptr)
    throw Error("this library is no plugin of loci", place,
                "it needs LOCI_PLUGIN(…), see docs/annotators.md");
  const PluginInfo& info = *entry();
  const PluginInfo ours;
  const std::string theirs = fmt::format("loci {} (compiler {})", info.version, info.compiler);
  const std::string mine = fmt::format("loci {} (compiler {})", ours.version, ours.compiler);
  if (info.format != ours.format || theirs != mine)
    throw Error(fmt::format("this plugin was built against {}, and this is {}", theirs, mine), place,
                "build it against the installed package of this version");
  AnnotatorRegistry own;
  info.add(own);
  registry.merge(own, place);
  LoadedPlugin loaded{path, info.name, {}};
  if (info.types != nullptr) loaded.types = info.types();
  return loaded;
}

std::shared_ptr<const cas::TypeSystem> type_system_with_plugins(const std::vector<LoadedPlugin>& plugins) {
  if (plugins.empty()) return types::type_system();
  std::vector<cas::TypeSource> sources = types::type_sources();
  for (const LoadedPlugin& plugin : plugins)
    sources.insert(sources.end(), plugin.types.begin(), plugin.types.end());
  return cas::TypeSystem::load(sources, {}, {});
}

}  // namespace loci::perception
