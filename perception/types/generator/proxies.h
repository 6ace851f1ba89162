#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace loci::perception::generator {

struct ProxyTarget {
  std::string name_space;        ///< of the classes: "loci::perception::types"
  std::string include_folder;    ///< of the header: "perception/types"
  std::filesystem::path output;  ///< folder that the include folder is made in
};

/// Writes generated.h (a class per type that the files declare) and generated.cpp (the texts of the files, so
/// that programs need none). Types that the files only import are taken from loci::perception::types when
/// their name begins with "loci."; imports by name are looked for under `path_dirs`. Throws loci::Error.
void write_proxies(const ProxyTarget& target, const std::vector<std::filesystem::path>& files,
                   const std::vector<std::filesystem::path>& path_dirs = {});

}  // namespace loci::perception::generator
