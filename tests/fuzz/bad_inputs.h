#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace loci::fuzz {

/// One line of the table of bad inputs.
struct BadInput {
  std::string target;  ///< of fuzz::targets()
  std::string name;    ///< "seed.urdf: cut at 3/8"
  std::string bytes;
};

/// The table: for every seed below `seeds`/TARGET the same systematic mistakes (cut off, parts removed,
/// doubled and exchanged, bytes and numbers replaced), and by hand what each reader is most likely to trip
/// over.
std::vector<BadInput> bad_inputs(const std::filesystem::path& seeds);

}  // namespace loci::fuzz
