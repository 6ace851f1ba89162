#include "apps/evaluate/occupancy/insertion.h"

#include <fmt/format.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "mapping/base/error.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"

namespace loci::apps::occupancy_claim {
namespace {

/// A scan as both ways get it.
struct Cloud {
  mapping::Scan scan;
  octomap::Pointcloud points;
  octomap::point3d origin;
};

Cloud cloud_of(const mapping::Scan& scan, double range_max) {
  if (scan.origins.size() != 1)
    throw Error("scan " + scan.name + " has several origins", {}, "OctoMap inserts clouds with one");
  const auto in_map = [&](const Eigen::Vector3f& position) {
    const Eigen::Vector3f p = (scan.map_from_scan * position.cast<double>()).cast<float>();
    return octomap::point3d(p.x(), p.y(), p.z());
  };
  Cloud cloud{scan, {}, in_map(scan.origins[0])};
  std::erase_if(cloud.scan.points, [&](const mapping::ScanPoint& point) {
    if (!point.position.allFinite()) return true;
    return !point.returned && (in_map(point.position) - cloud.origin).norm() <= range_max;
  });
  for (const mapping::ScanPoint& point : cloud.scan.points) cloud.points.push_back(in_map(point.position));
  return cloud;
}

std::string stream_of(const octomap::OcTree& tree) {
  std::ostringstream stream;
  tree.write(stream);
  return stream.str();
}

/// Times the insertion of all scans and keeps it when it is the best so far.
void time_insertion(Insertion& way, size_t scans, const std::function<void()>& insert_all) {
  const Stopwatch watch;
  insert_all();
  const double count = static_cast<double>(scans);
  const double seconds = watch.seconds() / count, processor = watch.cpu_seconds() / count;
  way.seconds = way.seconds == 0 ? seconds : std::min(way.seconds, seconds);
  way.cpu_seconds = way.cpu_seconds == 0 ? processor : std::min(way.cpu_seconds, processor);
}

}  // namespace

void InsertionOptions::declare(OptionTable& table) {
  table.integer("repeats", repeats, "", "Insertions of each kind, in turns; the best counts.", 1, 100);
  occupancy.declare(table);
}

SetResult measure(const std::string& name, const mapping::ScanSet& scans, const InsertionOptions& options,
                  Progress& progress) {
  const double range = options.occupancy.range_max_m;
  std::vector<Cloud> clouds;
  for (const mapping::Scan& scan : scans.scans) clouds.push_back(cloud_of(scan, range));
  if (clouds.empty()) throw Error("there is no scan in " + name);
  SetResult result;
  result.name = name;
  result.scans = clouds.size();
  for (const Cloud& cloud : clouds) result.points += cloud.scan.points.size();
  result.ways = {{"OctoMap insertPointCloud", 1}, {"ours", 1}, {"ours", 2}};
  for (int i = 0; i < options.repeats; ++i) {
    progress.check(static_cast<double>(i) / options.repeats, name);
    octomap::OcTree peer(options.occupancy.resolution_m);
    time_insertion(result.ways[0], clouds.size(), [&] {
      for (const Cloud& cloud : clouds) peer.insertPointCloud(cloud.points, cloud.origin, range);
    });
    const std::string expected = i == 0 ? stream_of(peer) : std::string();
    result.ways[0].nodes = peer.size();
    result.ways[0].identical = true;
    for (size_t k = 1; k < result.ways.size(); ++k) {
      Insertion& way = result.ways[k];
      mapping::OccupancyOptions occupancy = options.occupancy;
      occupancy.threads = way.threads;
      mapping::OccupancyMap map(occupancy);
      time_insertion(way, clouds.size(), [&] {
        for (const Cloud& cloud : clouds) map.insert(cloud.scan);
      });
      way.nodes = map.tree().size();
      if (i == 0) way.identical = stream_of(map.tree()) == expected;
    }
  }
  return result;
}

std::string table_text(const std::vector<SetResult>& results) {
  std::string text =
      "| scans | by | threads | a scan | its CPU time | times as fast | same tree |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const SetResult& result : results)
    for (const Insertion& way : result.ways)
      text += fmt::format("| {}, {} × {} points | {} | {} | {:.0f} ms | {:.0f} ms | {:.2f} | {} |\n",
                          result.name, result.scans, result.points / result.scans, way.name, way.threads,
                          1e3 * way.seconds, 1e3 * way.cpu_seconds, result.ways[0].seconds / way.seconds,
                          way.identical ? "yes" : "NO");
  return text;
}

Json table_json(const std::vector<SetResult>& results) {
  Json json = Json::array();
  for (const SetResult& result : results) {
    Json set = {{"scans", result.name}, {"count", result.scans}, {"points", result.points}};
    for (const Insertion& way : result.ways)
      set["ways"].push_back({{"by", way.name},
                             {"threads", way.threads},
                             {"seconds_per_scan", way.seconds},
                             {"cpu_seconds_per_scan", way.cpu_seconds},
                             {"ratio", result.ways[0].seconds / way.seconds},
                             {"nodes", way.nodes},
                             {"identical", way.identical}});
    json.push_back(set);
  }
  return json;
}

}  // namespace loci::apps::occupancy_claim
