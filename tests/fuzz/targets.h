#pragma once

#include <string_view>
#include <vector>

namespace loci::fuzz {

/// A reader of foreign data, fed with any bytes. What it refuses it must refuse with loci::Error; any other
/// exception leaves run(), and is as much a finding as a crash.
struct Target {
  const char* name;  ///< also the folder of its seeds below tests/data/fuzz
  void (*run)(std::string_view bytes);
};

const std::vector<Target>& targets();
/// nullptr when there is none of that name.
const Target* find_target(std::string_view name);

}  // namespace loci::fuzz
