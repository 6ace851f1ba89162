#include "apps/evaluate/mesh/comparison.h"

#include <fmt/format.h>
#include <malloc.h>

#include <cmath>
#include <functional>
#include <limits>
#include <sstream>

#include "apps/evaluate/mesh/mesher.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/fusion/room_mesh.h"
#include "mapping/render/ray_scene.h"
#include "mapping/simulation/walk.h"
#include "mapping/world/urdf.h"

namespace loci::apps::mesh_claim {
namespace {

namespace fs = std::filesystem;

constexpr int kEvery = 2;              ///< frames; those between judge
constexpr int kPixelStep = 16;         ///< between the rays that judge
constexpr double kSame = 0.05;         ///< m; farther apart along a ray are two surfaces
constexpr double kFar = 0.02;          ///< m; of a vertex that is on no surface
constexpr size_t kMaxVertices = 8000;  ///< that are compared with the truth
constexpr double kTruncation = 4;      ///< voxels, of the peer: as many as ours

/// What the process takes more than at the beginning, at most. Linux counts the peak anew on request.
class PeakMemory {
 public:
  PeakMemory() {
    malloc_trim(0);
    write_file("5");
    start_ = kilobytes("VmRSS:");
  }
  double megabytes() const { return (kilobytes("VmHWM:") - start_) / 1024; }

 private:
  static void write_file(const char* text) {
    if (std::FILE* file = std::fopen("/proc/self/clear_refs", "w")) {
      std::fputs(text, file);
      std::fclose(file);
    }
  }
  static double kilobytes(const std::string& key) {
    std::istringstream status(read_file("/proc/self/status"));
    for (std::string line; std::getline(status, line);)
      if (line.starts_with(key)) return std::stod(line.substr(key.size()));
    return 0;
  }
  double start_ = 0;
};

/// A pixel's ray, and how far the surface is along it.
struct Ray {
  Eigen::Vector3f origin, direction;
  double range = 0;
};

class Comparison {
 public:
  Comparison(const mapping::Recording& recording, const mapping::RayScene* truth, const Settings& settings,
             Progress& progress)
      : recording_(recording), truth_(truth), settings_(settings), progress_(progress) {
    fusion_.every = kEvery;
    fusion_.threads = settings.threads;
    rays_ = judging_rays();
  }

  Row ours() const {
    mapping::MeshOptions options;
    options.mesh_voxel_m = settings_.voxel_m;
    return row_of("loci", [&] { return mesh_room(recording_, fusion_, options, progress_).mesh; });
  }

  Row peer(const std::string& method, const std::function<std::unique_ptr<Mesher>()>& create) const {
    return row_of(method, [&] {
      const auto mesher = create();
      for (size_t i = 0; i < recording_.size(); i += kEvery) {
        progress_.check(part(i), method);
        const mapping::RgbdFrame frame = recording_.frame(i);
        if (frame.map_from_camera) mesher->add(frame);
      }
      return mesher->mesh();
    });
  }

 private:
  double part(size_t i) const { return static_cast<double>(i) / static_cast<double>(recording_.size()); }

  std::vector<Ray> judging_rays() const {
    std::vector<Ray> rays;
    for (size_t i = 1; i < recording_.size(); i += kEvery) {
      mapping::RgbdFrame frame = recording_.frame(i);
      if (!frame.map_from_camera) continue;
      mapping::drop_flying_pixels(frame.depth);
      for (int v = kPixelStep / 2; v < frame.depth.rows; v += kPixelStep)
        for (int u = kPixelStep / 2; u < frame.depth.cols; u += kPixelStep) {
          const auto z = static_cast<double>(frame.depth.at<float>(v, u));
          if (!(z > 0 && z <= fusion_.range_max_m)) continue;
          const Vector3d point = frame.camera.depth.unproject(u, v, z);
          Ray ray{frame.map_from_camera->translation().cast<float>(),
                  (frame.map_from_camera->linear() * point.normalized()).cast<float>(), point.norm()};
          if (truth_ != nullptr) {
            const mapping::RayHit hit = truth_->cast(ray.origin, ray.direction, 10);
            ray.range = static_cast<double>(hit.distance);
            if (hit.link < 0 || ray.range * z / point.norm() > fusion_.range_max_m) continue;
          }
          rays.push_back(ray);
        }
    }
    return rays;
  }

  Row row_of(const std::string& method, const std::function<mapping::ColoredMesh()>& make) const {
    Row row;
    row.method = method;
    row.frames = (recording_.size() + kEvery - 1) / kEvery;
    const PeakMemory memory;
    const Stopwatch watch;
    const mapping::ColoredMesh mesh = make();
    row.cpu_ms = 1e3 * watch.cpu_seconds() / static_cast<double>(row.frames);
    row.frames_per_second = static_cast<double>(row.frames) / watch.seconds();
    row.memory_mb = memory.megabytes();
    row.vertices = mesh.positions.size();
    row.triangles = mesh.triangles.size();
    if (truth_ != nullptr) row.vertex = vertex_errors(mesh);
    add_depth_errors(mesh, row);
    return row;
  }

  VertexErrors vertex_errors(const mapping::ColoredMesh& mesh) const {
    const size_t step = std::max<size_t>(1, mesh.positions.size() / kMaxVertices);
    std::vector<double> distances(mesh.positions.size() / step);
    parallel_each(distances.size(), settings_.threads, [&](size_t i) {
      const auto nearest = truth_->nearest(mesh.positions[i * step].cast<double>(), 0.2);
      distances[i] = nearest.link < 0 ? 0.2 : nearest.distance;
    });
    if (distances.empty()) return {};
    const auto far = std::count_if(distances.begin(), distances.end(), [](double d) { return d > kFar; });
    return {median(distances), quantile(distances, 0.95),
            static_cast<double>(far) / static_cast<double>(distances.size())};
  }

  void add_depth_errors(const mapping::ColoredMesh& mesh, Row& row) const {
    mapping::RayScene scene;
    scene.add("mesh", {mesh.positions, mesh.triangles, {}}, Isometry3d::Identity());
    std::vector<double> offsets(rays_.size());
    parallel_each(rays_.size(), settings_.threads, [&](size_t i) {
      const mapping::RayHit hit = scene.cast(rays_[i].origin, rays_[i].direction, 10);
      offsets[i] = hit.link < 0 ? std::numeric_limits<double>::infinity()
                                : static_cast<double>(hit.distance) - rays_[i].range;
    });
    std::vector<double> errors;
    size_t before = 0;
    for (const double offset : offsets) {
      if (std::abs(offset) < kSame) errors.push_back(std::abs(offset));
      if (offset <= -kSame) ++before;
    }
    const auto all = static_cast<double>(std::max<size_t>(1, offsets.size()));
    row.covered = static_cast<double>(errors.size()) / all;
    row.before = static_cast<double>(before) / all;
    if (errors.empty()) return;
    row.depth_median_m = median(errors);
    row.depth_q95_m = quantile(errors, 0.95);
  }

  const mapping::Recording& recording_;
  const mapping::RayScene* truth_;
  const Settings& settings_;
  Progress& progress_;
  mapping::FusionOptions fusion_;
  std::vector<Ray> rays_;
};

/// The surfaces of a world, and a walk through it.
std::unique_ptr<mapping::Recording> walked(const fs::path& world, const Settings& settings,
                                           mapping::RayScene& truth, Progress& progress, Warnings& warnings) {
  const mapping::World read = mapping::read_urdf(world);
  const mapping::MeshSearch search{settings.package_paths, world.parent_path()};
  truth.add(read, search, Isometry3d::Identity(), warnings);
  if (read.find_link("floor") == nullptr) truth.add("floor", mapping::floor_mesh(0), Isometry3d::Identity());
  const fs::path folder =
      settings.folder / (world.parent_path().filename().string() + "_" + world.stem().string());
  if (!fs::exists(folder / "recording.yaml")) {
    mapping::RecordOptions options;
    options.seed = settings.seed;
    options.threads = settings.threads;
    options.package_paths = settings.package_paths;
    Random random(static_cast<uint64_t>(settings.seed));
    std::vector<Vector2d> places = standing_places(read, search, warnings);
    places.resize(std::min(places.size(), static_cast<size_t>(settings.places)));
    record_views(world, mapping::stroll(places, random), kSecond / 30, folder, options, progress, warnings);
  }
  return mapping::open_recording(folder);
}

}  // namespace

std::vector<Row> compare_meshes(const fs::path& recording_or_world, const Settings& settings,
                                Progress& progress, Warnings& warnings) {
  const bool simulated = recording_or_world.extension() == ".urdf";
  mapping::RayScene truth;
  const auto recording = simulated ? walked(recording_or_world, settings, truth, progress, warnings)
                                   : mapping::open_recording(recording_or_world);
  if (recording->info().frames_with_pose == 0)
    throw Error("the recording has no poses", {recording_or_world.string(), 0, {}},
                "track it first: loci-map track");
  const Comparison comparison(*recording, simulated ? &truth : nullptr, settings, progress);
  std::vector<Row> rows = {comparison.ours()};
  if (settings.open3d)
    rows.push_back(comparison.peer("Open3D ScalableTSDFVolume", [&] {
      return open3d_mesher(
          {settings.voxel_m, kTruncation * settings.voxel_m, mapping::FusionOptions().range_max_m});
    }));
  for (Row& row : rows) row.recording = recording_or_world.string();
  return rows;
}

std::string to_text(const std::vector<Row>& rows) {
  std::string text, recording;
  for (const Row& row : rows) {
    if (row.recording != recording)
      text += fmt::format("{}, {} frames\n  {:26} {:>9} {:>16} {:>8} {:>16} {:>8} {:>8} {:>8} {:>9} {:>7}\n",
                          row.recording, row.frames, "method", "vertices", "to truth, mm", "> 2 cm",
                          "along rays, mm", "covered", "before", "CPU ms", "frames/s", "MB");
    recording = row.recording;
    text += fmt::format(
        "  {:26} {:9} {:>16} {:>8} {:>16} {:7.2f}% {:7.2f}% {:8.1f} {:9.1f} {:7.0f}\n", row.method,
        row.vertices,
        row.vertex ? fmt::format("{:.1f}, {:.1f}", 1e3 * row.vertex->median_m, 1e3 * row.vertex->q95_m) : "-",
        row.vertex ? fmt::format("{:.2f}%", 100 * row.vertex->far) : "-",
        fmt::format("{:.1f}, {:.1f}", 1e3 * row.depth_median_m, 1e3 * row.depth_q95_m), 100 * row.covered,
        100 * row.before, row.cpu_ms, row.frames_per_second, row.memory_mb);
  }
  return text;
}

Json to_json(const std::vector<Row>& rows) {
  Json json = Json::array();
  for (const Row& row : rows) {
    Json entry = {{"recording", row.recording},
                  {"method", row.method},
                  {"frames", row.frames},
                  {"vertices", row.vertices},
                  {"triangles", row.triangles},
                  {"depth_median_m", row.depth_median_m},
                  {"depth_q95_m", row.depth_q95_m},
                  {"covered", row.covered},
                  {"before", row.before},
                  {"cpu_ms_per_frame", row.cpu_ms},
                  {"frames_per_second", row.frames_per_second},
                  {"memory_mb", row.memory_mb}};
    if (row.vertex) {
      entry["vertex_median_m"] = row.vertex->median_m;
      entry["vertex_q95_m"] = row.vertex->q95_m;
      entry["vertex_far"] = row.vertex->far;
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace loci::apps::mesh_claim
