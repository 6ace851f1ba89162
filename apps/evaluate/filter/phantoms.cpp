#include "apps/evaluate/filter/phantoms.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/scene_data.h"
#include "perception/pipeline/pipeline.h"
#include "perception/types/scene_cas.h"

namespace loci::apps::filter_evaluation {
namespace {

Vector3d random_direction(Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

/// A recording whose poses are wrong.
class Mislocated : public mapping::Recording {
 public:
  Mislocated(std::shared_ptr<const mapping::Recording> recording, const PoseError& error, int seed)
      : recording_(std::move(recording)), error_(error), seed_(seed) {}

  const mapping::RecordingInfo& info() const override { return recording_->info(); }
  size_t size() const override { return recording_->size(); }
  TimeNs time_of(size_t i) const override { return recording_->time_of(i); }
  int64_t index_of(size_t i) const override { return recording_->index_of(i); }
  mapping::RgbdFrame frame(size_t i) const override {
    mapping::RgbdFrame frame = recording_->frame(i);
    if (!frame.map_from_camera) return frame;
    Random random = Random(static_cast<uint64_t>(seed_)).fork(i);
    const Vector3d shift = error_.position_m * random_direction(random);
    const Eigen::AngleAxisd turn(error_.angle_deg * kPi / 180, random_direction(random));
    frame.map_from_camera->linear() = turn.toRotationMatrix() * frame.map_from_camera->linear();
    frame.map_from_camera->translation() += shift;
    return frame;
  }

 private:
  std::shared_ptr<const mapping::Recording> recording_;
  PoseError error_;
  int seed_;
};

/// What was found in a frame.
struct Found {
  cv::Mat objects;  ///< CV_8U: not 0 where a cluster is
  std::vector<std::vector<int32_t>> clusters;
  std::optional<Isometry3d> map_from_camera;
};

std::vector<Found> run(const std::shared_ptr<mapping::Recording>& recording,
                       const std::shared_ptr<perception::KnownMap>& map, bool refine, int threads,
                       Progress& progress, double& filter_seconds) {
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  perception::Pipeline pipeline = perception::Pipeline::parse(
      fmt::format("flow:\n  - NormalEstimator\n  - KnownStructureFilter: {{refine_pose: {}}}\n"
                  "  - PlaneClusterExtractor\n",
                  refine),
      "the pipeline of the evaluation", registry);
  perception::Resources resources;
  resources.put(recording);
  resources.put(map);
  Warnings warnings;
  perception::Context context{resources, warnings, threads, {}};
  std::vector<Found> found;
  const auto keep = [&](perception::cas::Cas& cas) {
    const perception::types::SceneCas scene(cas);
    const mapping::PinholeCamera& camera = recording->info().camera.depth;
    Found& frame = found.emplace_back();
    frame.objects = cv::Mat::zeros(camera.height, camera.width, CV_8U);
    for (const perception::types::Cluster& cluster : scene.scene().clusters) {
      auto& pixels = frame.clusters.emplace_back();
      for (const int32_t pixel : perception::cluster_indices(cluster)) {
        pixels.push_back(pixel);
        frame.objects.ptr<uint8_t>()[pixel] = 1;
      }
    }
    if (scene.scene().map_from_camera.is_set())
      frame.map_from_camera = perception::map_from_camera(scene.scene());
  };
  const perception::PipelineResult result =
      pipeline.run(context, perception::types::type_system(), progress, keep);
  for (const auto& [name, seconds] : result.seconds)
    if (name == "KnownStructureFilter") filter_seconds = seconds;
  return found;
}

/// How many clusters of one run have less than half of their pixels on objects of the other.
size_t uncovered(const Found& clusters, const Found& objects) {
  return static_cast<size_t>(std::ranges::count_if(clusters.clusters, [&](const auto& pixels) {
    const auto on = std::ranges::count_if(
        pixels, [&](int32_t pixel) { return objects.objects.template ptr<uint8_t>()[pixel] != 0; });
    return 2 * on < static_cast<ptrdiff_t>(pixels.size());
  }));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::nth_element(values, values.begin() + static_cast<ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

}  // namespace

std::vector<Phantoms> measure_phantoms(const std::filesystem::path& path,
                                       const std::shared_ptr<perception::KnownMap>& map,
                                       const std::vector<PoseError>& errors, int seed, int threads,
                                       Progress& progress) {
  const std::shared_ptr<mapping::Recording> recording = mapping::open_recording(path);
  if (recording->info().frames_with_pose == 0)
    throw Error("the recording has no poses to be put wrong", {path, 0, {}});
  NoProgress silent;
  double seconds = 0;
  const std::vector<Found> reference = run(recording, map, false, threads, silent, seconds);
  std::vector<Phantoms> rows;
  for (const PoseError& error : errors)
    for (const bool refined : {false, true}) {
      progress.check(static_cast<double>(rows.size()) / static_cast<double>(2 * errors.size()),
                     fmt::format("{:.0f} cm, {}°", 100 * error.position_m, error.angle_deg));
      const auto wrong = std::make_shared<Mislocated>(recording, error, seed);
      const std::vector<Found> found =
          run(std::static_pointer_cast<mapping::Recording>(wrong), map, refined, threads, silent, seconds);
      Phantoms row;
      row.error = error;
      row.refined = refined;
      row.frames = found.size();
      row.filter_ms = 1e3 * seconds / static_cast<double>(std::max<size_t>(1, found.size()));
      std::vector<double> shifts, turns;
      for (size_t i = 0; i < found.size(); ++i) {
        row.clusters += found[i].clusters.size();
        row.wanted += reference[i].clusters.size();
        row.phantoms += uncovered(found[i], reference[i]);
        row.lost += uncovered(reference[i], found[i]);
        if (!found[i].map_from_camera || !reference[i].map_from_camera) continue;
        const Isometry3d& a = *found[i].map_from_camera;
        const Isometry3d& b = *reference[i].map_from_camera;
        shifts.push_back((a.translation() - b.translation()).norm());
        turns.push_back(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / kPi);
      }
      row.position_m = median(shifts);
      row.angle_deg = median(turns);
      rows.push_back(row);
    }
  return rows;
}

std::string phantoms_text(const std::vector<Phantoms>& rows) {
  std::string text =
      "| error | refinement | frames | clusters | phantoms | lost | error left, median | filter |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const Phantoms& row : rows)
    text += fmt::format(
        "| {:.0f} cm, {:g}° | {} | {} | {} | {} | {} of {} | {:.1f} cm, {:.2f}° | {:.0f} ms |\n",
        100 * row.error.position_m, row.error.angle_deg, row.refined ? "on" : "off", row.frames, row.clusters,
        row.phantoms, row.lost, row.wanted, 100 * row.position_m, row.angle_deg, row.filter_ms);
  return text;
}

Json phantoms_json(const std::vector<Phantoms>& rows) {
  Json json = Json::array();
  for (const Phantoms& row : rows)
    json.push_back({{"error_m", row.error.position_m},
                    {"error_deg", row.error.angle_deg},
                    {"refined", row.refined},
                    {"frames", row.frames},
                    {"clusters", row.clusters},
                    {"phantoms", row.phantoms},
                    {"lost", row.lost},
                    {"wanted", row.wanted},
                    {"left_m", row.position_m},
                    {"left_deg", row.angle_deg},
                    {"filter_ms", row.filter_ms}});
  return json;
}

}  // namespace loci::apps::filter_evaluation
