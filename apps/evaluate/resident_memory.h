#pragma once

#include <unistd.h>

#include <fstream>

namespace loci::apps {

/// Memory of this process that is in RAM.
inline double resident_megabytes() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace loci::apps
