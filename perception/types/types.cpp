#include "perception/types/types.h"

namespace loci::perception::types {

const std::shared_ptr<const cas::TypeSystem>& type_system() {
  static const std::shared_ptr<const cas::TypeSystem> system = type_system_with({});
  return system;
}

std::shared_ptr<const cas::TypeSystem> type_system_with(const std::vector<std::filesystem::path>& files,
                                                        const std::vector<std::filesystem::path>& path_dirs) {
  return cas::TypeSystem::load(type_sources(), files, path_dirs);
}

}  // namespace loci::perception::types
