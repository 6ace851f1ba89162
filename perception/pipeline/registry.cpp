#include "perception/pipeline/registry.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"
#include "perception/pipeline/plugin.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

template <class Map>
auto maker_from(const Map& map, const std::string& name, const FileLocation& place, const char* kind) {
  const auto it = map.find(name);
  if (it != map.end()) return it->second;
  const std::vector<std::string> known = names_of(map);
  std::string hint = did_you_mean(name, known);
  if (hint.empty()) hint = fmt::format("known are {}", fmt::join(known, ", "));
  throw Error(fmt::format("there is no {} '{}'", kind, name), place, hint);
}

std::string kind_of(const Option& option) {
  static const char* const kKinds[] = {"flag", "whole number", "number", "text", "list of texts"};
  return kKinds[option.value.index()];
}

std::string bounds_of(const Option& option) {
  if (!option.choices.empty()) return fmt::format("one of {}", fmt::join(option.choices, ", "));
  const bool number = option.value.index() == 1 || option.value.index() == 2;
  if (number && std::isfinite(option.min) && std::isfinite(option.max))
    return fmt::format("{} to {}", option.min, option.max);
  return {};
}

}  // namespace

void AnnotatorRegistry::merge(const AnnotatorRegistry& more, const FileLocation& place) {
  const auto merge_map = [&](auto& own, const auto& others) {
    for (const auto& [name, make] : others)
      if (!own.emplace(name, make).second)
        throw Error("there is an annotator '" + name + "' already", place, "give this one another name");
  };
  merge_map(annotators_, more.annotators_);
  merge_map(readers_, more.readers_);
  merge_map(multipliers_, more.multipliers_);
}

std::vector<std::string> AnnotatorRegistry::annotators() const {
  return names_of(annotators_);
}

std::vector<std::string> AnnotatorRegistry::readers() const {
  return names_of(readers_);
}

std::vector<std::string> AnnotatorRegistry::multipliers() const {
  return names_of(multipliers_);
}

std::unique_ptr<CasMultiplier> AnnotatorRegistry::make_multiplier(const std::string& name,
                                                                  const FileLocation& place) const {
  return maker_from(multipliers_, name, place, "CAS multiplier")();
}

std::unique_ptr<Annotator> AnnotatorRegistry::make(const std::string& name, const FileLocation& place) const {
  return maker(name, place)();
}

std::function<std::unique_ptr<Annotator>()> AnnotatorRegistry::maker(const std::string& name,
                                                                     const FileLocation& place) const {
  return maker_from(annotators_, name, place, "annotator");
}

std::unique_ptr<Reader> AnnotatorRegistry::make_reader(const std::string& name,
                                                       const FileLocation& place) const {
  return maker_from(readers_, name, place, "reader")();
}

std::vector<std::string> AnnotatorRegistry::producers_of(const std::string& product) const {
  std::vector<std::string> makers;
  const auto check = [&](const std::string& name, const AnnotatorDescriptor& descriptor) {
    const auto has = [&](const std::vector<std::string>& list) {
      return std::find(list.begin(), list.end(), product) != list.end();
    };
    if (has(descriptor.outputs) && !has(descriptor.inputs)) makers.push_back(name);
  };
  for (const auto& [name, make] : annotators_) check(name, make()->descriptor());
  for (const auto& [name, make] : readers_) check(name, make()->descriptor());
  return makers;
}

Json describe(const AnnotatorDescriptor& descriptor, const OptionTable& options) {
  Json json = {{"name", descriptor.name},
               {"description", descriptor.description},
               {"inputs", descriptor.inputs},
               {"outputs", descriptor.outputs},
               {"optional_inputs", descriptor.optional_inputs},
               {"modifies", descriptor.modifies},
               {"options", Json::array()}};
  const Json defaults = options.to_json();
  for (const Option& option : options.options()) {
    Json entry = {{"name", option.name},
                  {"kind", kind_of(option)},
                  {"unit", option.unit},
                  {"default", defaults[option.name]},
                  {"description", option.description}};
    if (const std::string bounds = bounds_of(option); !bounds.empty()) entry["allowed"] = bounds;
    json["options"].push_back(std::move(entry));
  }
  return json;
}

std::string description_text(const AnnotatorDescriptor& descriptor, const OptionTable& options) {
  const auto list = [](const std::vector<std::string>& items) {
    return items.empty() ? std::string("none") : fmt::format("{}", fmt::join(items, ", "));
  };
  std::string text = fmt::format("{}\n  {}\n  inputs: {}\n  outputs: {}\n", descriptor.name,
                                 descriptor.description, list(descriptor.inputs), list(descriptor.outputs));
  if (descriptor.optional_inputs == std::vector<std::string>{"*"})
    text += "  optional inputs: everything\n";
  else if (!descriptor.optional_inputs.empty())
    text += fmt::format("  optional inputs: {}\n", list(descriptor.optional_inputs));
  if (!descriptor.modifies.empty()) text += fmt::format("  modifies: {}\n", list(descriptor.modifies));
  for (const Option& option : options.options()) {
    const std::string unit = option.unit.empty() ? "" : " " + option.unit;
    const std::string bounds = bounds_of(option);
    text += fmt::format("  {}: {}{}\n      {}{}\n", option.name, option_text(option), unit,
                        option.description, bounds.empty() ? "" : " (" + bounds + ")");
  }
  return text;
}

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
