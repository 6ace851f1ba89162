#include "mapping/simulation/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mapping/base/parallel.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/recording.h"
#include "mapping/render/render.h"
#include "mapping/simulation/play.h"
#include "mapping/world/urdf.h"
#include "mapping/world/world_triangles.h"

namespace loci::mapping {
namespace {

constexpr int kSamples = 2;  ///< per pixel and direction, for colour

/// The same camera with more pixels; pixel centres are at integers.
PinholeCamera finer(const PinholeCamera& camera, int factor) {
  const double shift = 0.5 * (factor - 1);
  return {camera.width * factor, camera.height * factor,     camera.fx * factor,
          camera.fy * factor,    camera.cx * factor + shift, camera.cy * factor + shift};
}

/// Light from above and a little from the camera, as in a room with a ceiling lamp and pale walls.
class Shader {
 public:
  explicit Shader(const Isometry3d& map_from_camera)
      : light_((map_from_camera.linear().transpose() * Vector3d(0.12, -0.10, 1).normalized()).cast<float>()) {
  }

  float shade(const cv::Vec3f& normal) const {
    const Eigen::Vector3f n(normal[0], normal[1], normal[2]);
    if (n.isZero()) return 1;
    return 0.60F + 0.38F * std::max(0.0F, n.dot(light_)) + 0.16F * std::max(0.0F, -n.z());
  }

 private:
  Eigen::Vector3f light_;
};

void shrink_row(const RenderedView& fine, const Shader& shader, int v, cv::Mat& image) {
  const cv::Vec3f nothing(230, 228, 224);
  for (int u = 0; u < image.cols; ++u) {
    cv::Vec3f sum(0, 0, 0);
    for (int y = v * kSamples; y < (v + 1) * kSamples; ++y) {
      for (int x = u * kSamples; x < (u + 1) * kSamples; ++x) {
        const cv::Vec3b& color = fine.color.at<cv::Vec3b>(y, x);
        sum += fine.link.at<int>(y, x) < 0
                   ? nothing
                   : cv::Vec3f(color[0], color[1], color[2]) * shader.shade(fine.normal.at<cv::Vec3f>(y, x));
      }
    }
    for (int k = 0; k < 3; ++k)
      image.at<cv::Vec3b>(v, u)[k] = cv::saturate_cast<uint8_t>(sum[k] / (kSamples * kSamples));
  }
}

std::string appearance_key(const std::string& name, const PlacedObject& object) {
  const Rgba accent = object.accent.value_or(Rgba(-1, -1, -1, -1));
  return fmt::format("{} {} {} {} {} {} {}", name, object.color.x(), object.color.y(), object.color.z(),
                     accent.x(), accent.y(), accent.z());
}

/// Extent of one object in one depth image.
struct SeenObject {
  int pixels = 0;
  int unhidden_pixels = 0;    ///< without occlusion by others
  int box[4] = {0, 0, 0, 0};  ///< first column, first row, last column, last row
};

/// Renders the scenes of a scenario: the world and its objects.
class ScenarioRenderer {
 public:
  ScenarioRenderer(const Scenario& scenario, const World& world, const MeshSearch& search,
                   const ScenarioPlay& play, Warnings& warnings);

  /// Moves joints and objects to their state.
  void arrange(const WorldState& state);

  /// Depth and normals without noise.
  RenderedView depth_view(const PinholeCamera& camera, const Isometry3d& map_from_camera, int threads) const;

  /// A lit image, smoothed at edges.
  cv::Mat color_image(const PinholeCamera& camera, const Isometry3d& map_from_camera, int threads) const;

  /// Counts the objects' pixels in a view that depth_view() made.
  std::map<std::string, SeenObject> seen_objects(const RenderedView& view, const PinholeCamera& camera,
                                                 const Isometry3d& map_from_camera, int threads);

 private:
  struct Part {
    size_t number = 0;  ///< in the scene
    int link = 0;       ///< id in images
  };
  const Part& part_for(const std::string& name, const PlacedObject& object);

  const Scenario& scenario_;
  const ScenarioPlay& play_;
  RenderScene scene_;
  std::vector<size_t> background_;       ///< parts that are not objects
  std::map<std::string, Part> parts_;    ///< by object and its colours
  std::map<std::string, Part> visible_;  ///< by object, as arranged
};

ScenarioRenderer::ScenarioRenderer(const Scenario& scenario, const World& world, const MeshSearch& search,
                                   const ScenarioPlay& play, Warnings& warnings)
    : scenario_(scenario), play_(play) {
  background_.push_back(scene_.add(world, search, Isometry3d::Identity(), warnings));
  if (scenario.floor)
    background_.push_back(scene_.add("scenario_floor", floor_mesh(*scenario.floor), Isometry3d::Identity()));
}

const ScenarioRenderer::Part& ScenarioRenderer::part_for(const std::string& name,
                                                         const PlacedObject& object) {
  const std::string key = appearance_key(name, object);
  if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
  ObjectSpec spec = scenario_.objects.at(name);
  spec.color = object.color;
  spec.accent = object.accent;
  Part part;
  part.number = scene_.add(name, build_object(spec).mesh, Isometry3d::Identity());
  part.link = static_cast<int>(scene_.link_names().size()) - 1;
  return parts_.emplace(key, part).first->second;
}

void ScenarioRenderer::arrange(const WorldState& state) {
  scene_.set_joints(background_.front(), state.joints);
  visible_.clear();
  for (const auto& [name, object] : state.objects) visible_[name] = part_for(name, object);
  for (const auto& [key, part] : parts_) scene_.set_visible(part.number, false);
  const auto poses = play_.map_from_objects(state);
  for (const auto& [name, part] : visible_) {
    scene_.set_pose(part.number, poses.at(name));
    scene_.set_visible(part.number, true);
  }
}

RenderedView ScenarioRenderer::depth_view(const PinholeCamera& camera, const Isometry3d& map_from_camera,
                                          int threads) const {
  RenderOptions options;
  options.normals = true;
  return scene_.render(camera, map_from_camera, options, threads);
}

cv::Mat ScenarioRenderer::color_image(const PinholeCamera& camera, const Isometry3d& map_from_camera,
                                      int threads) const {
  RenderOptions options;
  options.normals = options.colors = true;
  const RenderedView fine = scene_.render(finer(camera, kSamples), map_from_camera, options, threads);
  const Shader shader(map_from_camera);
  cv::Mat image(camera.height, camera.width, CV_8UC3);
  parallel_for(static_cast<size_t>(camera.height), threads, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) shrink_row(fine, shader, static_cast<int>(v), image);
  });
  return image;
}

std::map<std::string, SeenObject> ScenarioRenderer::seen_objects(const RenderedView& view,
                                                                 const PinholeCamera& camera,
                                                                 const Isometry3d& map_from_camera,
                                                                 int threads) {
  std::map<int, SeenObject> by_link;
  for (int v = 0; v < view.link.rows; ++v) {
    for (int u = 0; u < view.link.cols; ++u) {
      const int link = view.link.at<int>(v, u);
      if (link < 0) continue;
      SeenObject& seen = by_link[link];
      if (seen.pixels++ == 0) {
        seen.box[0] = seen.box[2] = u;
        seen.box[1] = v;
      }
      seen.box[0] = std::min(seen.box[0], u);
      seen.box[2] = std::max(seen.box[2], u);
      seen.box[3] = v;
    }
  }
  for (const size_t part : background_) scene_.set_visible(part, false);
  for (const auto& [name, part] : visible_) scene_.set_visible(part.number, false);
  std::map<std::string, SeenObject> seen;
  for (const auto& [name, part] : visible_) {
    scene_.set_visible(part.number, true);
    const RenderedView alone = scene_.render(camera, map_from_camera, {}, threads);
    scene_.set_visible(part.number, false);
    seen[name] = by_link[part.link];
    for (int v = 0; v < alone.link.rows; ++v)
      seen[name].unhidden_pixels += static_cast<int>(
          std::count(alone.link.ptr<int>(v), alone.link.ptr<int>(v) + alone.link.cols, part.link));
  }
  for (const size_t part : background_) scene_.set_visible(part, true);
  for (const auto& [name, part] : visible_) scene_.set_visible(part.number, true);
  return seen;
}

/// The line of a frame in truth.jsonl.
Json truth_of(const RgbdFrame& frame, size_t scene, const WorldState& state, const ScenarioPlay& play,
              const Scenario& scenario, const std::map<std::string, SeenObject>& seen) {
  const auto poses = play.map_from_objects(state);
  Json objects = Json::array();
  for (const auto& [name, object] : state.objects) {
    const ObjectModel& model = play.models().at(name);
    const SeenObject& visible = seen.at(name);
    const Vector3d size = model.high - model.low;
    Json entry;
    entry["id"] = name;
    entry["model"] = scenario.objects.at(name).model;
    entry["support"] = object.support;
    entry["pose"] = values_from_pose(poses.at(name));
    entry["size"] = {size.x(), size.y(), size.z()};
    entry["color"] = {object.color.x(), object.color.y(), object.color.z()};
    entry["pixels"] = visible.pixels;
    entry["visible"] = visible.unhidden_pixels > 0
                           ? Json(static_cast<double>(visible.pixels) / visible.unhidden_pixels)
                           : Json(nullptr);
    entry["box"] = visible.pixels > 0 ? Json{visible.box[0], visible.box[1], visible.box[2], visible.box[3]}
                                      : Json(nullptr);
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

Json configuration_of(const Scenario& scenario, const RecordOptions& options) {
  KinectModel sensor = scenario.sensor;
  return {{"scenario", scenario.file.filename().string()},
          {"world", scenario.world.filename().string()},
          {"seed", options.seed},
          {"noise", options.noise},
          {"camera", table_of(sensor).to_json()}};
}

/// What the world's frame is called: a "map" has its floor at z = 0.
std::string frame_of(const Scenario& scenario, const World& world, const MeshSearch& search) {
  Warnings later;  // The renderer reads the meshes again.
  const double floor =
      scenario.floor.value_or(floor_height(world, triangles_of(world, search, later)).value_or(0));
  return is_at_zero(floor) ? "map" : "world";
}

}  // namespace

TriangleMesh floor_mesh(double height) {
  constexpr float reach = 20;
  const auto z = static_cast<float>(height);
  TriangleMesh mesh;
  mesh.vertices = {{-reach, -reach, z}, {reach, -reach, z}, {reach, reach, z}, {-reach, reach, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.colors.assign(2, Rgba(0.55F, 0.5F, 0.45F, 1));
  return mesh;
}

void RecordOptions::declare(OptionTable& table) {
  table.integer("seed", seed, "", "Seed of the noise; the same seed gives the same bytes.", 0, 1 << 30);
  table.text("noise", noise, "Noise of the sensor.", {"kinect", "none"});
}

std::string RecordResult::summary() const {
  return fmt::format("{}: {}, {}, {}", folder, counted(scenes, "scene"), counted(frames, "frame"),
                     counted(objects, "object"));
}

Json RecordResult::report() const {
  return {{"folder", folder}, {"scenes", scenes}, {"frames", frames}, {"objects", objects}};
}

RecordResult record(const Scenario& scenario, const std::filesystem::path& folder,
                    const RecordOptions& options, Progress& progress, Warnings& warnings) {
  RecordOptions checked = options;
  table_of(checked).validate();
  const World world = read_urdf(scenario.world, warnings);
  const MeshSearch search{options.package_paths, scenario.world.parent_path()};
  const ScenarioPlay play(scenario, world, search);
  RecordingWriter writer(folder, scenario.camera, frame_of(scenario, world, search),
                         {.time_zone = scenario.time_zone, .force = options.force});
  ScenarioRenderer renderer(scenario, world, search, play, warnings);

  size_t total = 0;
  for (const SceneSpec& scene : scenario.scenes) total += scene.map_from_camera.size();
  const Random random(static_cast<uint64_t>(options.seed));
  std::string truth;
  std::set<std::string> seen_names;
  RecordResult result;
  result.folder = folder.string();
  for (size_t i = 0; i < scenario.scenes.size(); ++i) {
    const WorldState& state = play.states()[i];
    renderer.arrange(state);
    RgbdFrame frame;
    frame.camera = scenario.camera;
    frame.time_ns = scenario.scenes[i].time_ns;
    frame.joints = state.joints;
    for (const Isometry3d& map_from_camera : scenario.scenes[i].map_from_camera) {
      progress.check(static_cast<double>(result.frames) / static_cast<double>(total),
                     fmt::format("frame {} of {}", result.frames + 1, total));
      frame.index = static_cast<int64_t>(result.frames);
      frame.map_from_camera = map_from_camera;
      const RenderedView view = renderer.depth_view(frame.camera.depth, map_from_camera, options.threads);
      frame.color = renderer.color_image(frame.camera.color, map_from_camera * frame.camera.depth_from_color,
                                         options.threads);
      frame.depth = view.depth;
      if (options.noise == "kinect") {
        const Random draws = random.fork(result.frames);
        frame.depth = measured_by_kinect(view.depth, view.normal, frame.camera.depth, scenario.sensor,
                                         draws.fork(0), options.threads);
        add_color_noise(frame.color, scenario.sensor, draws.fork(1), options.threads);
      }
      writer.add(frame);
      const auto seen = renderer.seen_objects(view, frame.camera.depth, map_from_camera, options.threads);
      for (const auto& [name, visible] : seen)
        if (visible.pixels > 0) seen_names.insert(name);
      truth += truth_of(frame, i, state, play, scenario, seen).dump() + '\n';
      frame.time_ns += scenario.frame_interval;
      ++result.frames;
    }
    ++result.scenes;
  }
  writer.add_file("truth.jsonl", truth);
  writer.add_file("simulation.json", configuration_of(scenario, options).dump(2) + '\n');
  writer.finish();
  result.objects = seen_names.size();
  return result;
}

}  // namespace loci::mapping
