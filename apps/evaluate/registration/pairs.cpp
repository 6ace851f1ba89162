#include "apps/evaluate/registration/pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/rotation_vector.h"
#include "mapping/base/math/shuffle.h"
#include "mapping/base/text/csv.h"
#include "mapping/fusion/fusion.h"
#include "mapping/recording/recording.h"
#include "mapping/simulation/laser_sweep.h"
#include "mapping/world/urdf.h"

namespace loci::apps::registration_evaluation {
namespace {

Isometry3d pose_of(const Vector3d& position, const Vector3d& rotation_vector) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = position;
  pose.linear() = rotation_from_vector(rotation_vector);
  return pose;
}

Isometry3d between(const mapping::Scan& target, const mapping::Scan& source) {
  return target.map_from_scan.inverse() * source.map_from_scan;
}

/// The floor is a thin box so that it is seen from above as any other object.
mapping::TriangleMesh floor_of(const Eigen::AlignedBox3d& bounds) {
  mapping::TriangleMesh mesh;
  const Eigen::Vector3f a = bounds.min().cast<float>(), b = bounds.max().cast<float>();
  mesh.vertices = {{a.x(), a.y(), 0}, {b.x(), a.y(), 0}, {b.x(), b.y(), 0}, {a.x(), b.y(), 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Whether a robot can stand there with walls around it.
bool inside(const mapping::RayScene& scene, const Vector2d& place) {
  int walls = 0;
  for (int i = 0; i < 8; ++i) {
    const auto angle = static_cast<float>(i * 45 * kDegree);
    const Eigen::Vector3f from(static_cast<float>(place.x()), static_cast<float>(place.y()), 1.25F);
    walls += scene.cast(from, {std::cos(angle), std::sin(angle), 0.F}, 9.F).link >= 0 ? 1 : 0;
  }
  return walls >= 6 && scene.link_in_cylinder(place, 0.3, 0.05, 1.3) < 0;
}

mapping::Scan scan_of_frame(const mapping::RgbdFrame& frame, int64_t index) {
  constexpr int step = 2;
  mapping::Scan scan;
  scan.name = fmt::format("frame_{}", index);
  scan.map_from_scan = *frame.map_from_camera;
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  cv::Mat depth = frame.depth.clone();
  mapping::drop_flying_pixels(depth);
  for (int v = 0; v < depth.rows; v += step)
    for (int u = 0; u < depth.cols; u += step) {
      const auto z = static_cast<double>(depth.at<float>(v, u));
      if (!(z > 0)) continue;
      mapping::ScanPoint point;
      point.position = frame.camera.depth.unproject(u, v, z).cast<float>();
      scan.points.push_back(point);
    }
  return scan;
}

}  // namespace

std::vector<mapping::Scan> simulated_scans(const SimulatedWorld& world, size_t count, const Random& random,
                                           int threads, Warnings& warnings) {
  mapping::RayScene scene;
  const mapping::World read = mapping::read_urdf(world.urdf);
  scene.add(read, {world.package_paths, world.urdf.parent_path()}, Isometry3d::Identity(), warnings);
  const Eigen::AlignedBox3d bounds = scene.bounds();
  if (read.find_link("floor") == nullptr) scene.add("floor", floor_of(bounds), Isometry3d::Identity());
  const mapping::LaserModel laser;
  Random places = random.fork(0);
  std::vector<mapping::Scan> scans;
  for (int attempt = 0; scans.size() < count && attempt < 10000; ++attempt) {
    const Vector2d place(places.uniform(bounds.min().x(), bounds.max().x()),
                         places.uniform(bounds.min().y(), bounds.max().y()));
    const double yaw = places.uniform(-kPi, kPi);
    if (!inside(scene, place)) continue;
    Isometry3d pose = pose_of({place.x(), place.y(), laser.height_m}, {0, 0, yaw});
    scans.push_back(simulate_sweep(scene, pose, laser, random.fork(1 + scans.size()), threads));
    scans.back().name = fmt::format("{}_{}", world.urdf.stem().string(), scans.size());
  }
  return scans;
}

PairSet pairs_among(std::string name, std::vector<mapping::Scan> scans, double min_overlap, size_t count,
                    const Random& random) {
  PairSet set;
  set.name = std::move(name);
  set.scans = std::move(scans);
  for (size_t i = 0; i < set.scans.size(); ++i)
    for (size_t j = 0; j < set.scans.size(); ++j) {
      if (i == j) continue;
      const mapping::Scan &target = set.scans[i], &source = set.scans[j];
      const Isometry3d truth = between(target, source);
      const double overlap = true_overlap(target, source, truth);
      if (overlap < min_overlap) continue;
      set.pairs.push_back({target.name + " <- " + source.name, &target, &source, truth, true, overlap});
    }
  Random draw = random;
  shuffle(set.pairs, draw);
  if (set.pairs.size() > count) set.pairs.resize(count);
  return set;
}

PairSet recording_pairs(const std::filesystem::path& folder, size_t count, size_t ahead) {
  PairSet set;
  set.name = folder.filename().string();
  set.planar = false;
  if (!std::filesystem::exists(folder)) return set;
  const auto recording = mapping::open_recording(folder);
  if (recording->size() <= ahead) return set;
  const size_t last = recording->size() - ahead;
  set.scans.reserve(2 * count);
  for (size_t k = 0; k < count; ++k) {
    const size_t first = k * last / count;
    for (const size_t i : {first, first + ahead})
      set.scans.push_back(scan_of_frame(recording->frame(i), recording->index_of(i)));
    const mapping::Scan &target = set.scans[2 * k], &source = set.scans[2 * k + 1];
    const Isometry3d truth = between(target, source);
    set.pairs.push_back({target.name + " <- " + source.name, &target, &source, truth, true,
                         true_overlap(target, source, truth)});
  }
  return set;
}

PairSet listed_pairs(const std::filesystem::path& file, const std::filesystem::path& clouds) {
  const CsvTable table = CsvTable::read(file);
  const size_t target_column = table.require_column("target"), source_column = table.require_column("source");
  std::array<size_t, 6> columns;
  const std::array<const char*, 6> names = {"x_m", "y_m", "z_m", "rx_deg", "ry_deg", "rz_deg"};
  for (size_t i = 0; i < 6; ++i) columns[i] = table.require_column(names[i]);
  PairSet set;
  set.name = file.stem().string();
  set.planar = false;
  set.scans.reserve(2 * table.rows());
  for (size_t row = 0; row < table.rows(); ++row) {
    for (const size_t column : {target_column, source_column}) {
      const mapping::ScanSet scans = mapping::read_scan_set(clouds / table.cell(row, column));
      if (scans.scans.empty()) throw Error("a listed cloud is empty", table.location(row));
      set.scans.push_back(scans.scans.front());
    }
    std::array<double, 6> v;
    for (size_t i = 0; i < 6; ++i) v[i] = table.number(row, columns[i]);
    const mapping::Scan &target = set.scans[set.scans.size() - 2], &source = set.scans.back();
    const Isometry3d truth = pose_of({v[0], v[1], v[2]}, Vector3d(v[3], v[4], v[5]) * kDegree);
    set.pairs.push_back({fmt::format("{} <- {}", target.name, source.name), &target, &source, truth, true,
                         true_overlap(target, source, truth)});
  }
  return set;
}

double true_overlap(const mapping::Scan& target, const mapping::Scan& source,
                    const Isometry3d& target_from_source) {
  constexpr double cell = 0.1;
  CellIndex own, other;
  for (const mapping::ScanPoint& point : target.points)
    if (point.returned) own.insert(cell_of(point.position, cell));
  for (const mapping::ScanPoint& point : source.points)
    if (point.returned) other.insert(cell_of(target_from_source * point.position.cast<double>(), cell));
  size_t common = 0;
  for (const Eigen::Vector3i& at : other.cells()) common += own.find(at) != CellIndex::kNone ? 1 : 0;
  const size_t smaller = std::min(own.size(), other.size());
  return smaller > 0 ? static_cast<double>(common) / static_cast<double>(smaller) : 0;
}

Isometry3d perturbed(const Isometry3d& pose, double shift, double turn_deg, bool planar, Random& random) {
  const auto direction = [&] {
    if (planar) {
      const double angle = random.uniform(-kPi, kPi);
      return Vector3d(std::cos(angle), std::sin(angle), 0);
    }
    return Vector3d(Vector3d(random.normal(), random.normal(), random.normal()).normalized());
  };
  const Vector3d axis = planar ? Vector3d(0, 0, random.uniform() < 0.5 ? -1 : 1) : direction();
  const Vector3d off = direction() * random.uniform(0, shift);
  return pose * pose_of(off, axis * random.uniform(0, turn_deg) * kDegree);
}

mapping::Scan thinned(const mapping::Scan& scan, double voxel) {
  mapping::Scan result;
  result.name = scan.name;
  result.map_from_scan = scan.map_from_scan;
  result.origins = scan.origins;
  CellIndex index;
  std::vector<std::pair<Vector3d, double>> sums;
  for (const mapping::ScanPoint& point : scan.points) {
    if (!point.returned) continue;
    const uint32_t number = index.insert(cell_of(point.position, voxel));
    if (number == sums.size()) {
      sums.emplace_back(Vector3d::Zero(), 0.0);
      result.points.push_back(point);
    }
    sums[number].first += point.position.cast<double>();
    sums[number].second += 1;
  }
  for (size_t i = 0; i < sums.size(); ++i)
    result.points[i].position = (sums[i].first / sums[i].second).cast<float>();
  return result;
}

}  // namespace loci::apps::registration_evaluation
