#include "apps/evaluate/filter/joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/structure/articulated_fronts.h"
#include "perception/annotators/structure/normals.h"

namespace loci::apps::filter_evaluation {
namespace {

constexpr double kOpen = 0.03;   ///< metres of the farthest point: less is not told
constexpr double kRight = 0.02;  ///< metres by which an open one may be off
constexpr int kInView = 25;      ///< points of a front

double at_share(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

JointFits measure_joints(const std::filesystem::path& path, const perception::KnownMap& map, int threads,
                         Progress& progress) {
  const auto recording = mapping::open_recording(path);
  const mapping::PinholeCamera camera = recording->info().camera.depth;
  const perception::ArticulatedFronts fronts(map.world, map.meshes);
  JointFits fits;
  fits.name = path.lexically_normal().filename().string();
  for (size_t i = 0; i < recording->size(); ++i) {
    progress.check(static_cast<double>(i) / static_cast<double>(recording->size()), fits.name);
    const mapping::RgbdFrame frame = recording->frame(i);
    if (!frame.map_from_camera || frame.joints.empty()) continue;
    ++fits.frames;
    const cv::Mat points = perception::points_from_depth(frame.depth, camera);
    for (const perception::FrontState& state :
         fronts.estimate(points, camera, *frame.map_from_camera, {}, threads)) {
      const auto truth = frame.joints.find(state.joint);
      if (truth == frame.joints.end() || state.in_view < kInView) continue;
      ++fits.fronts;
      if (!state.determined) continue;
      ++fits.determined;
      const bool open = state.reach * std::abs(truth->second) >= kOpen;
      const double off = state.reach * std::abs(state.position - truth->second);
      fits.open += open ? 1 : 0;
      fits.found_open += open && off <= kRight ? 1 : 0;
      fits.false_open += !open && state.moved ? 1 : 0;
      if (open && state.moved) fits.off.push_back(off);
    }
  }
  std::sort(fits.off.begin(), fits.off.end());
  return fits;
}

std::string joints_text(const std::vector<JointFits>& fits) {
  std::string text =
      "| recording | frames | fronts in view | determined | truly open | told within 2 cm | shut, told open "
      "| off, median (95 %) |\n|---|---|---|---|---|---|---|---|\n";
  for (const JointFits& f : fits)
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {:.1f} mm ({:.1f} mm) |\n", f.name, f.frames,
                        f.fronts, f.determined, f.open, f.found_open, f.false_open,
                        1e3 * at_share(f.off, 0.5), 1e3 * at_share(f.off, 0.95));
  return text;
}

Json joints_json(const std::vector<JointFits>& fits) {
  Json json = Json::array();
  for (const JointFits& f : fits)
    json.push_back({{"recording", f.name},
                    {"frames", f.frames},
                    {"fronts", f.fronts},
                    {"determined", f.determined},
                    {"open", f.open},
                    {"found_open", f.found_open},
                    {"false_open", f.false_open},
                    {"off_median_m", at_share(f.off, 0.5)},
                    {"off_95_m", at_share(f.off, 0.95)}});
  return json;
}

}  // namespace loci::apps::filter_evaluation
