#pragma once

#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/scan.h"

namespace loci::apps::occupancy_claim {

struct InsertionOptions {
  int repeats = 5;
  mapping::OccupancyOptions occupancy;

  void declare(OptionTable& table);
};

/// Scans inserted one after the other by one of the ways.
struct Insertion {
  std::string name;
  int threads = 1;
  double seconds = 0;      ///< of a scan, wall time, the best repeat
  double cpu_seconds = 0;  ///< likewise, of all threads
  size_t nodes = 0;        ///< of the tree in the end
  bool identical = false;  ///< the tree, as OctoMap's .ot stream, is OctoMap's own byte for byte
};

struct SetResult {
  std::string name;
  size_t scans = 0, points = 0;
  std::vector<Insertion> ways;  ///< OctoMap's first
};

/// Inserts the same scans with OctoMap's insertPointCloud and with ours on one and on two threads, in turns
/// in the same process. Points without return nearer than the map's range are left out of all: OctoMap has no
/// word for them. Error for a scan with several origins, for the same reason.
SetResult measure(const std::string& name, const mapping::ScanSet& scans, const InsertionOptions& options,
                  Progress& progress);

std::string table_text(const std::vector<SetResult>& results);
Json table_json(const std::vector<SetResult>& results);

}  // namespace loci::apps::occupancy_claim
