#include "mapping/simulation/record.h"

#include <fmt/format.h>

#include <set>

#include "mapping/base/json.h"
#include "mapping/recording/recording.h"
#include "mapping/simulation/play.h"
#include "mapping/simulation/studio.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

/// The line of a frame in truth.jsonl.
Json truth_of(const RgbdFrame& frame, size_t scene, const WorldState& state, const ScenarioPlay& play,
              const Scenario& scenario, const std::map<std::string, SeenObject>& seen) {
  const auto poses = play.map_from_objects(state);
  Json objects = Json::array();
  for (const auto& [name, object] : state.objects) {
    const ObjectModel& model = play.models().at(name);
    const SeenObject& look = seen.at(name);
    const Vector3d size = model.high - model.low;
    Json entry;
    entry["id"] = name;
    entry["model"] = scenario.objects.at(name).model;
    entry["support"] = object.support;
    entry["pose"] = values_from_pose(poses.at(name));
    entry["size"] = {size.x(), size.y(), size.z()};
    entry["color"] = {object.color.x(), object.color.y(), object.color.z()};
    entry["pixels"] = look.pixels;
    entry["visible"] = look.unhidden_pixels > 0
                           ? Json(static_cast<double>(look.pixels) / look.unhidden_pixels)
                           : Json(nullptr);
    entry["box"] = look.pixels > 0 ? Json{look.box[0], look.box[1], look.box[2], look.box[3]} : Json(nullptr);
    objects.push_back(std::move(entry));
  }
  Json line;
  line["frame"] = frame.index;
  line["scene"] = scene;
  line["time_ns"] = frame.time_ns;
  line["time"] = format_time(frame.time_ns);
  line["camera"] = values_from_pose(*frame.map_from_camera);
  line["joints"] = frame.joints;
  line["objects"] = std::move(objects);
  return line;
}

Json made_by(const Scenario& scenario, const RecordOptions& options) {
  KinectModel sensor = scenario.sensor;
  return {{"scenario", scenario.file.filename().string()},
          {"world", scenario.world.filename().string()},
          {"seed", options.seed},
          {"noise", options.noise},
          {"camera", table_of(sensor).to_json()}};
}

}  // namespace

void RecordOptions::declare(OptionTable& table) {
  table.integer("seed", seed, "", "Seed of the noise; the same seed gives the same bytes.", 0, 1 << 30);
  table.text("noise", noise, "Noise of the sensor.", {"kinect", "none"});
}

std::string RecordResult::summary() const {
  return fmt::format("{}: {} scenes, {} frames, {} objects", folder, scenes, frames, objects);
}

Json RecordResult::report() const {
  return {{"folder", folder}, {"scenes", scenes}, {"frames", frames}, {"objects", objects}};
}

RecordResult record(const Scenario& scenario, const std::filesystem::path& folder,
                    const RecordOptions& options, Progress& progress, Warnings& warnings) {
  RecordOptions checked = options;
  table_of(checked).validate();
  const World world = read_urdf(scenario.world);
  const MeshSearch search{options.package_paths, scenario.world.parent_path()};
  const ScenarioPlay play(scenario, world, search);
  RecordingWriter writer(folder, scenario.camera, "map");
  Studio studio(scenario, world, search, play, warnings);

  size_t total = 0;
  for (const SceneSpec& scene : scenario.scenes) total += scene.map_from_camera.size();
  const Random random(static_cast<uint64_t>(options.seed));
  std::string truth;
  std::set<std::string> seen_names;
  RecordResult result;
  result.folder = folder.string();
  for (size_t i = 0; i < scenario.scenes.size(); ++i) {
    const WorldState& state = play.states()[i];
    studio.arrange(state);
    RgbdFrame frame;
    frame.camera = scenario.camera;
    frame.time_ns = scenario.scenes[i].time_ns;
    frame.joints = state.joints;
    for (const Isometry3d& map_from_camera : scenario.scenes[i].map_from_camera) {
      progress.check(static_cast<double>(result.frames) / static_cast<double>(total),
                     fmt::format("frame {} of {}", result.frames + 1, total));
      frame.index = static_cast<int64_t>(result.frames);
      frame.map_from_camera = map_from_camera;
      const RenderedView view = studio.depth_view(frame.camera.depth, map_from_camera, options.threads);
      frame.color = studio.color_image(frame.camera.color, map_from_camera * frame.camera.depth_from_color,
                                       options.threads);
      frame.depth = view.depth;
      if (options.noise == "kinect") {
        const Random draws = random.fork(result.frames);
        frame.depth = measured_by_kinect(view.depth, view.normal, frame.camera.depth, scenario.sensor,
                                         draws.fork(0), options.threads);
        add_color_noise(frame.color, scenario.sensor, draws.fork(1), options.threads);
      }
      writer.add(frame);
      const auto seen = studio.seen_objects(view, frame.camera.depth, map_from_camera, options.threads);
      for (const auto& [name, look] : seen)
        if (look.pixels > 0) seen_names.insert(name);
      truth += truth_of(frame, i, state, play, scenario, seen).dump() + '\n';
      frame.time_ns += scenario.frame_interval;
      ++result.frames;
    }
    ++result.scenes;
  }
  writer.add_file("truth.jsonl", truth);
  writer.add_file("simulation.json", made_by(scenario, options).dump(2) + '\n');
  writer.finish();
  result.objects = seen_names.size();
  return result;
}

}  // namespace loci::mapping
