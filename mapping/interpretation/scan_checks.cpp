#include "mapping/interpretation/scan_checks.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

constexpr float kLevel = 0.94F;   // cosine; of horizontal surfaces
constexpr float kLowest = 0.25F;  // m; floors and ceilings look the same upside down
constexpr float kHighest = 2.3F;
constexpr size_t kManyMore = 5;  // times as many undersides as tops
constexpr size_t kMin = 1500;    // undersides; less may be one hanging cabinet

struct Counts {
  size_t returns = 0;
  size_t tops = 0, undersides = 0;  ///< points of furniture

  bool upside_down() const { return undersides > kMin && undersides > kManyMore * tops; }
};

std::vector<Counts> counts_of(const Surface& surface) {
  std::vector<Counts> counts(surface.scans);
  for (const SurfacePoint& point : surface.points) {
    Counts& scan = counts[point.scan];
    ++scan.returns;
    if (point.position.z() < kLowest || point.position.z() > kHighest) continue;
    scan.tops += point.normal.z() > kLevel;
    scan.undersides += point.normal.z() < -kLevel;
  }
  return counts;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void leave_out_bad_scans(const ScanSet& scans, Surface& surface, std::vector<std::string>& notes) {
  const std::vector<Counts> counts = counts_of(surface);
  std::vector<std::string> empty, upside_down;
  std::vector<bool> bad(counts.size(), false);
  for (size_t i = 0; i < counts.size(); ++i) {
    const std::string name = scans.scans[i].name.empty() ? fmt::format("scan {}", i) : scans.scans[i].name;
    if (counts[i].returns == 0) empty.push_back(name);
    if (counts[i].upside_down()) upside_down.push_back(name);
    bad[i] = counts[i].upside_down();
  }
  if (!empty.empty()) notes.push_back("without returns and of no use: " + listed(empty));
  if (upside_down.empty()) return;
  if (2 * upside_down.size() > counts.size() - empty.size())
    throw Error(fmt::format("the scans are upside down: furniture shows undersides, not tops ({})",
                            listed(upside_down)),
                {}, "turn the scans, or correct the poses in scans.yaml");
  notes.push_back("upside down (furniture shows undersides, not tops), left out: " + listed(upside_down));
  std::erase_if(surface.points, [&](const SurfacePoint& point) { return bad[point.scan]; });
  std::erase_if(surface.free_ends, [&](const auto& ray) { return bad[surface.scan_of_origin[ray.second]]; });
}

}  // namespace loci::mapping
