#include "mapping/occupancy/scan_rays.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include "mapping/base/parallel.h"

namespace loci::mapping::occupancy {
namespace {

using octomap::OcTreeKey;
using octomap::point3d;

/// Smallest and largest keys.
struct KeyRange {
  Eigen::Array3i low = Eigen::Array3i::Constant(std::numeric_limits<int>::max());
  Eigen::Array3i high = Eigen::Array3i::Constant(std::numeric_limits<int>::min());

  void add(const OcTreeKey& key) {
    const Eigen::Array3i k(key[0], key[1], key[2]);
    low = low.min(k);
    high = high.max(k);
  }
  void add(const KeyRange& other) {
    low = low.min(other.low);
    high = high.max(other.high);
  }
};

point3d in_map(const Isometry3d& map_from_scan, const Eigen::Vector3f& position) {
  const Eigen::Vector3f p = (map_from_scan * position.cast<double>()).cast<float>();
  return {p.x(), p.y(), p.z()};
}

/// The box of a range of keys with a margin: rounding may carry a ray one cell past its end.
KeyBox box_of(const KeyRange& range) {
  KeyBox box;
  if ((range.low > range.high).any()) return box;
  for (int i = 0; i < 3; ++i) {
    const int low = std::max(range.low[i] - 2, 0) / kBrick * kBrick;
    box.low[i] = low;
    box.size[i] = (range.high[i] + 2 - low) / kBrick * kBrick + kBrick;
  }
  return box;
}

Ray ray_of(const ScanPoint& point, const Isometry3d& map_from_scan, const point3d& origin, double range_max) {
  Ray ray;
  ray.end = in_map(map_from_scan, point.position);
  ray.origin = point.origin_index;
  ray.hit = point.returned;
  if (!((ray.end - origin).norm() <= range_max)) {
    ray.hit = false;
    ray.end = origin + (ray.end - origin).normalized() * static_cast<float>(range_max);
  }
  return ray;
}

}  // namespace

ScanRays scan_rays(const Scan& scan, const octomap::OcTree& tree, double range_max, int threads) {
  ScanRays result;
  std::vector<OcTreeKey> origin_keys;
  std::vector<bool> inside;
  for (const Eigen::Vector3f& origin : scan.origins) {
    result.origins.push_back(in_map(scan.map_from_scan, origin));
    OcTreeKey key(0, 0, 0);
    inside.push_back(origin.allFinite() && tree.coordToKeyChecked(result.origins.back(), key));
    origin_keys.push_back(key);
  }
  result.rays.resize(scan.points.size());
  KeyRange range;
  std::mutex mutex;
  parallel_for(scan.points.size(), threads, [&](size_t begin, size_t end) {
    KeyRange mine;
    for (size_t i = begin; i < end; ++i) {
      const ScanPoint& point = scan.points[i];
      if (!point.position.allFinite() || point.origin_index >= result.origins.size()) continue;
      Ray ray = ray_of(point, scan.map_from_scan, result.origins[point.origin_index], range_max);
      OcTreeKey key(0, 0, 0);
      if (!tree.coordToKeyChecked(ray.end, key)) continue;
      ray.cast = inside[point.origin_index];
      if (ray.cast) mine.add(origin_keys[point.origin_index]);
      if (ray.cast || ray.hit) mine.add(key);
      result.rays[i] = ray;
    }
    const std::lock_guard lock(mutex);
    range.add(mine);
  });
  result.box = box_of(range);
  return result;
}

namespace {

constexpr int kLanes = 4;
// Vectors of the compiler: two registers each with SSE2, and every other machine has them as well.
using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using Masks = int64_t __attribute__((vector_size(kLanes * sizeof(int64_t))));
using Addresses = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));

/// Rays that are walked side by side. Addresses are doubles (exact): they are added and compared with the
/// rest of the state, without leaving the vector unit.
struct Lanes {
  Doubles next[3];   ///< ray length at which the next cell border of an axis is crossed
  Doubles delta[3];  ///< ray length between borders
  Doubles step[3];   ///< what crossing adds to the address
  Doubles address;
  Doubles end;
  Doubles length;
};

/// Puts a ray into a lane as OctoMap's computeRayKeys begins it.
void start(Lanes& lanes, int lane, const point3d& origin, const point3d& end, const OcTreeKey& origin_key,
           const OcTreeKey& end_key, const KeyBox& box, const octomap::OcTree& tree) {
  point3d direction = end - origin;
  const float length = static_cast<float>(direction.norm());
  direction /= length;
  const double resolution = tree.getResolution();
  const Eigen::Vector3i strides = box.strides();
  for (unsigned i = 0; i < 3; ++i) {
    const int step = direction(i) > 0 ? 1 : direction(i) < 0 ? -1 : 0;
    lanes.step[i][lane] = step * strides[i];
    double next = std::numeric_limits<double>::max(), delta = next;
    if (step != 0) {
      const double border = tree.keyToCoord(origin_key[i]) + static_cast<float>(step * resolution * 0.5);
      next = (border - static_cast<double>(origin(i))) / static_cast<double>(direction(i));
      delta = resolution / static_cast<double>(std::fabs(direction(i)));
    }
    lanes.next[i][lane] = next;
    lanes.delta[i][lane] = delta;
  }
  lanes.address[lane] = box.address(origin_key);
  lanes.end[lane] = box.address(end_key);
  lanes.length[lane] = static_cast<double>(length);
}

/// Adds where the mask is set. By reference: vectors by value have no fixed calling convention.
inline void add_masked(Doubles& sum, const Doubles& values, const Masks& mask) {
  sum += reinterpret_cast<Doubles>(reinterpret_cast<Masks>(values) & mask);
}

/// Walks all lanes to their ends. Lanes that are done mark their first cell again.
void walk(const Lanes& lanes, uint8_t* cells) {
  Doubles t0 = lanes.next[0], t1 = lanes.next[1], t2 = lanes.next[2], address = lanes.address;
  Masks alive = address == address;
  Masks x_first = t0 < t1;
  Doubles nearer = x_first ? t0 : t1;
  Masks not_z = nearer < t2;
  for (int lane = 0; lane < kLanes; ++lane) cells[static_cast<size_t>(address[lane])] = kPassed;
  do {
    for (int unrolled = 0; unrolled < 8; ++unrolled) {
      const Masks x = x_first & not_z, y = ~x_first & not_z, z = ~not_z;
      add_masked(t0, lanes.delta[0], x);
      add_masked(t1, lanes.delta[1], y);
      add_masked(t2, lanes.delta[2], z);
      add_masked(address, lanes.step[0], x);
      add_masked(address, lanes.step[1], y);
      add_masked(address, lanes.step[2], z);
      x_first = t0 < t1;
      nearer = x_first ? t0 : t1;
      not_z = nearer < t2;
      const Doubles nearest = not_z ? nearer : t2;
      alive &= (address != lanes.end) & (nearest <= lanes.length);
      const Doubles marked = alive ? address : lanes.address;
      const Addresses at = __builtin_convertvector(marked, Addresses);
      for (int lane = 0; lane < kLanes; ++lane) cells[at[lane]] = kPassed;
    }
  } while ((alive[0] | alive[1] | alive[2] | alive[3]) != 0);
}

}  // namespace

void mark_passed(const ScanRays& rays, size_t begin, size_t end, const octomap::OcTree& tree,
                 uint8_t* cells) {
  Lanes lanes;
  int filled = 0;
  for (size_t i = begin; i < end; ++i) {
    const Ray& ray = rays.rays[i];
    if (!ray.cast) continue;
    const point3d& origin = rays.origins[ray.origin];
    const OcTreeKey origin_key = tree.coordToKey(origin), end_key = tree.coordToKey(ray.end);
    if (origin_key == end_key) continue;
    start(lanes, filled, origin, ray.end, origin_key, end_key, rays.box, tree);
    if (++filled < kLanes) continue;
    walk(lanes, cells);
    filled = 0;
  }
  if (filled == 0) return;
  for (int lane = filled; lane < kLanes; ++lane) {  // The rest of the last four: the first ray again.
    for (int i = 0; i < 3; ++i) {
      lanes.next[i][lane] = lanes.next[i][0];
      lanes.delta[i][lane] = lanes.delta[i][0];
      lanes.step[i][lane] = lanes.step[i][0];
    }
    lanes.address[lane] = lanes.address[0];
    lanes.end[lane] = lanes.end[0];
    lanes.length[lane] = lanes.length[0];
  }
  walk(lanes, cells);
}

void mark_hits(const ScanRays& rays, size_t begin, size_t end, const octomap::OcTree& tree, uint8_t* cells) {
  for (size_t i = begin; i < end; ++i)
    if (rays.rays[i].hit) cells[rays.box.address(tree.coordToKey(rays.rays[i].end))] |= kHit;
}

}  // namespace loci::mapping::occupancy
