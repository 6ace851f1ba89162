#include "apps/perceive/annotators.h"

#include "memory/annotators/memory_annotators.h"
#include "perception/annotators/annotators.h"

namespace loci::apps {

perception::AnnotatorRegistry all_annotators() {
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  memory::add_memory_annotators(registry);
  return registry;
}

void PluginOption::declare(ArgumentTable& table) {
  table.option("--plugin", &files, "Shared library with further annotators; can be given several times");
}

Experts PluginOption::load() const {
  Experts experts{all_annotators(), nullptr};
  std::vector<perception::LoadedPlugin> plugins;
  for (const std::string& file : files) plugins.push_back(load_plugin(file, experts.registry));
  experts.types = type_system_with_plugins(plugins);
  return experts;
}

void StatisticsTarget::declare(ArgumentTable& table) {
  table.option("--statistics", &file, "JSON file with the statistics of annotators",
               {.default_text = "the one beside the memory"});
}

std::filesystem::path StatisticsTarget::path(const std::string& memory) const {
  if (!file.empty()) return file;
  return memory.empty() ? std::filesystem::path() : perception::statistics_path(memory);
}

perception::StatisticsTable StatisticsTarget::read(const std::string& memory) const {
  const std::filesystem::path from = path(memory);
  return from.empty() ? perception::StatisticsTable() : perception::read_statistics(from);
}

perception::StatisticsTable StatisticsTarget::read_named(const std::string& memory) const {
  for (const std::string& named : {memory, file})
    if (!named.empty() && !std::filesystem::exists(named)) throw Error("no such file", {named, 0, {}});
  return read(memory);
}

}  // namespace loci::apps
