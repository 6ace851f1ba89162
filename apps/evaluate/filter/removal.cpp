#include "apps/evaluate/filter/removal.h"

#include <fmt/format.h>

#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/structure/normals.h"

namespace loci::apps::filter_evaluation {
namespace {

size_t measured(const cv::Mat& depth) {
  size_t count = 0;
  for (int i = 0; i < depth.rows * depth.cols; ++i) count += std::isnan(depth.ptr<float>()[i]) ? 0 : 1;
  return count;
}

}  // namespace

double Removal::removed() const {
  return points == 0 ? 0 : static_cast<double>(known + outside) / static_cast<double>(points);
}

Removal measure_removal(const std::filesystem::path& path, perception::KnownMap& map,
                        const perception::KnownStructureOptions& options, int threads, Progress& progress) {
  const auto recording = mapping::open_recording(path);
  const mapping::PinholeCamera camera = recording->info().camera.depth;
  const std::vector<perception::SupportSurface> surfaces = map.support_surfaces(options.regions);
  Removal removal;
  removal.name = path.lexically_normal().filename().string();
  for (size_t i = 0; i < recording->size(); ++i) {
    progress.check(static_cast<double>(i) / static_cast<double>(recording->size()), removal.name);
    const mapping::RgbdFrame frame = recording->frame(i);
    if (!frame.map_from_camera) continue;
    JointState joints;
    for (const auto& [name, position] : frame.joints)
      if (map.world.find_joint(name)) joints[name] = position;
    const perception::KnownStructure found =
        find_known_structure(perception::points_from_depth(frame.depth, camera), {}, camera,
                             *frame.map_from_camera, map, surfaces, joints, options, threads);
    ++removal.frames;
    removal.points += measured(frame.depth);
    removal.known += static_cast<size_t>(found.known);
    removal.outside += static_cast<size_t>(found.outside);
  }
  return removal;
}

std::string removal_text(const std::vector<Removal>& removals) {
  std::string text =
      "| recording | frames | points | known | in no region | left | removed "
      "|\n|---|---|---|---|---|---|---|\n";
  for (const Removal& r : removals)
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {:.1f} % |\n", r.name, r.frames, r.points, r.known,
                        r.outside, r.points - r.known - r.outside, 100 * r.removed());
  return text;
}

Json removal_json(const std::vector<Removal>& removals) {
  Json json = Json::array();
  for (const Removal& r : removals)
    json.push_back({{"recording", r.name},
                    {"frames", r.frames},
                    {"points", r.points},
                    {"known", r.known},
                    {"in_no_region", r.outside},
                    {"removed", r.removed()}});
  return json;
}

}  // namespace loci::apps::filter_evaluation
