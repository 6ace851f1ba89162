#include "nbv/inspection.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "nbv/ray_casting.h"

namespace loci::nbv {
namespace {

constexpr double kPatch = 0.15;       ///< m
constexpr double kMinHeight = 0.1;    ///< m: nothing is pulled nearer to the floor
constexpr double kWallMargin = 0.15;  ///< m over all furniture, from which a surface is a wall's
constexpr size_t kMinPoints = 10;     ///< on a patch, to know how it stands
constexpr double kRoughness = 0.02;   ///< m rms off its plane: more is no surface
constexpr double kPlaceStep = 0.2;    ///< m between places that are compared
constexpr double kMinRaise = 1;       ///< patches that a height must show beyond those before it
/// Of the points wanted on faces, those wanted on tops, which are seen at grazing angles: a point per 8 cm²,
/// as the raster in which supports are sought closes wider gaps.
constexpr double kTopPoints = 0.125;
/// More oblique views of faces count half: bars hide there what is behind them.
constexpr double kOblique = 50 * kDegree;
constexpr double kEnough = 0.5;        ///< part of the wanted points: the rest is not worth the way
constexpr double kMinTopHeight = 0.2;  ///< m over the floor: nothing lower is a support
constexpr int kMinTopNeighbours = 5;   ///< of eight: more than the edge of a face or a handle has

using Key = std::array<int, 3>;

struct Moments {
  size_t count = 0;
  Vector3d sum = Vector3d::Zero(), origins = Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  void add(const Vector3d& p, const Vector3d& origin) {
    ++count;
    sum += p;
    origins += origin;
    squares += p * p.transpose();
  }
};

std::map<Key, Moments> gather(const ScanRefs& scans, double top) {
  std::map<Key, Moments> cells;
  for (const mapping::Scan& scan : scans)
    for (const mapping::ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      const Vector3d p = scan.map_from_scan * point.position.cast<double>();
      if (p.z() < kMinHeight || p.z() > top) continue;
      const Vector3d cell = (p / kPatch).array().floor();
      cells[{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}].add(
          p, scan.map_from_scan * scan.origins[point.origin_index].cast<double>());
    }
  return cells;
}

/// A vertical patch, if these points make one; its normal looks to where it was seen from.
std::optional<InspectedPatch> patch_of(const Moments& cell) {
  if (cell.count < kMinPoints) return std::nullopt;
  const double count = static_cast<double>(cell.count);
  const Vector3d mean = cell.sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      Eigen::Matrix3d(cell.squares / count - mean * mean.transpose()));
  Vector3d normal = solver.eigenvectors().col(0);
  if (solver.eigenvalues()[0] > kRoughness * kRoughness || std::abs(normal.z()) > 0.3 ||
      solver.eigenvalues()[1] < kRoughness * kRoughness)  // A post, or an edge.
    return std::nullopt;
  normal.z() = 0;
  normal.normalize();
  if (normal.dot(cell.origins / count - mean) < 0) normal = -normal;
  return InspectedPatch{mean, normal, 0, kPatch * kPatch};
}

/// The yaw in which most of what a place shows is in the sector, and how much that is.
ViewSample best_yaw(const Vector3d& from, const std::vector<std::pair<Vector3d, double>>& shown,
                    const PlannerOptions& planner, const mapping::LaserModel& laser) {
  ViewSample best;
  for (int i = 0; i < planner.orientations; ++i) {
    const double yaw = std::remainder(2 * kPi * i / planner.orientations, 2 * kPi);
    double sum = 0;
    for (const auto& [centre, area] : shown)
      if (in_sector(from, centre, yaw, laser)) sum += area;
    if (sum > best.score + 1e-9) {
      best.pose = {from.x(), from.y(), yaw};
      best.score = sum;
    }
  }
  return best;
}

/// Points per cm² that a sweep from a place puts on a patch; 0 = too oblique, beyond its tilts, or hidden.
class Sharpness {
 public:
  Sharpness(const mapping::Voxels& voxels, const mapping::LaserModel& laser, const InspectionOptions& options)
      : sight_(voxels, laser), laser_(laser), options_(options) {}

  double density(const Vector3d& from, const InspectedPatch& patch) const {
    const Vector3d ray = patch.centre - from;
    const double distance = ray.norm(), cosine = -ray.dot(patch.normal) / distance;
    if ((!patch.top() && cosine < std::cos(options_.max_incidence_deg * kDegree)) ||
        !sight_.sees(from, patch.centre, patch.normal))
      return 0;
    // Lines of a tilting scanner stand closer the steeper they are; that is left out.
    const double spacing_m = distance * laser_.azimuth_step_deg * kDegree,
                 line_spacing_m = distance * laser_.tilt_step_deg * kDegree;
    const double share = patch.top() || cosine >= std::cos(kOblique) ? 1 : 0.5;
    return share * cosine / (spacing_m * line_spacing_m) * 1e-4;
  }

  /// Of all scans together.
  double density(const ScanRefs& scans, const InspectedPatch& patch) const {
    double sum = 0;
    for (const mapping::Scan& scan : scans) {
      const Vector3d from = scan.map_from_scan.translation();
      if (in_sector(from, patch.centre, mapping::planar(scan.map_from_scan).yaw, laser_))
        sum += density(from, patch);
    }
    return sum;
  }

  double wanted(const InspectedPatch& patch) const {
    return patch.top() ? kTopPoints * options_.points_per_cm2 : options_.points_per_cm2;
  }

  /// Area of a patch as area of faces: what is worth a scan is less of tops.
  double worth(const InspectedPatch& patch) const {
    return patch.top() ? patch.area * options_.min_gain_m2 / options_.min_top_m2 : patch.area;
  }

  /// The view from a place that shows most of what is seen too coarsely.
  ViewSample best_view(const Vector3d& from, const std::vector<InspectedPatch>& patches,
                       const PlannerOptions& planner) const {
    std::vector<std::pair<Vector3d, double>> shown;
    for (const InspectedPatch& patch : patches) {
      if ((patch.centre - from).head<2>().norm() > options_.max_distance_m) continue;
      const double part = std::min(density(from, patch) / (wanted(patch) - patch.density), 1.0);
      if (part > kEnough) shown.emplace_back(patch.centre, part * worth(patch));
    }
    return best_yaw(from, shown, planner, laser_);
  }

 private:
  LineOfSight sight_;
  const mapping::LaserModel& laser_;
  const InspectionOptions& options_;
};

/// Marks occupied voxels with free space above.
std::vector<uint8_t> top_voxels(const mapping::Voxels& voxels, double max_height) {
  std::vector<uint8_t> tops(voxels.states.size(), 0);
  for (int z = 0; z + 1 < voxels.size.z(); ++z) {
    const double height = voxels.center({0, 0, z}).z();
    if (height < kMinTopHeight || height > max_height) continue;
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x)
        tops[voxels.index({x, y, z})] = voxels.at({x, y, z}) == mapping::Occupancy::occupied &&
                                        voxels.at({x, y, z + 1}) == mapping::Occupancy::free;
  }
  return tops;
}

/// The best view of patches with the scanner at a height; its score is the area that it shows well.
ViewSample closest_look(const std::vector<InspectedPatch>& patches, const Sharpness& sharpness,
                        const mapping::FloorGrid& floor, const Reachability& reach, double height,
                        const PlannerOptions& planner) {
  const int stride = std::max(1, static_cast<int>(std::lround(kPlaceStep / floor.cell)));
  std::vector<ViewSample> samples(floor.cells());
  parallel_for(floor.cells(), planner.threads, [&](size_t begin, size_t end) {
    for (size_t cell = begin; cell < end; ++cell) {
      const int x = static_cast<int>(cell) % floor.width, y = static_cast<int>(cell) / floor.width;
      if (x % stride != 0 || y % stride != 0 || !reach.stands(floor, cell)) continue;
      const Vector2d place = floor.center(x, y);
      if (!avoided(place, planner))
        samples[cell] = sharpness.best_view({place.x(), place.y(), height}, patches, planner);
    }
  });
  const auto best =
      std::max_element(samples.begin(), samples.end(),
                       [](const ViewSample& a, const ViewSample& b) { return a.score < b.score; });
  return best == samples.end() ? ViewSample{} : *best;
}

}  // namespace

void InspectionOptions::declare(OptionTable& table) {
  table.number("inspect_points_per_cm2", points_per_cm2, "1/cm²",
               "Points wanted on faces of furniture; 0 = none are inspected.", 0, 100);
  table.number("inspect_max_incidence_deg", max_incidence_deg, "deg", "More oblique views do not count.", 10,
               85);
  table.number("inspect_max_distance_m", max_distance_m, "m", "From where faces are inspected at most.", 0.5,
               10);
  table.number("inspect_max_height_m", max_height_m, "m", "Height of furniture.", 0.5, 4);
  table.number("inspect_min_gain_m2", min_gain_m2, "m²", "Least area of faces that is worth a scan.", 0.01,
               100);
  table.number("inspect_min_top_m2", min_top_m2, "m²", "Least area of unseen tops that is worth a scan.",
               0.01, 100);
}

std::vector<InspectedPatch> face_patches(const ScanRefs& scans, const mapping::Voxels& voxels,
                                         const mapping::LaserModel& laser, const InspectionOptions& options) {
  std::vector<InspectedPatch> patches;
  std::map<std::array<int, 2>, std::vector<InspectedPatch>> high;  // By cell of the floor.
  const double wall = options.max_height_m + kWallMargin;
  for (const auto& [key, cell] : gather(scans, wall + 3 * kPatch))
    if (const auto patch = patch_of(cell)) {
      if (patch->centre.z() > wall)
        high[{key[0], key[1]}].push_back(*patch);
      else if (patch->centre.z() < options.max_height_m)
        patches.push_back(*patch);
    }
  std::erase_if(patches, [&](const InspectedPatch& patch) {
    const int x = static_cast<int>(std::floor(patch.centre.x() / kPatch)),
              y = static_cast<int>(std::floor(patch.centre.y() / kPatch));
    for (int i = x - 1; i <= x + 1; ++i)
      for (int j = y - 1; j <= y + 1; ++j)
        if (const auto found = high.find({i, j}); found != high.end())
          for (const InspectedPatch& above : found->second)
            if (above.normal.dot(patch.normal) > 0.95 &&
                std::abs(patch.normal.dot(above.centre - patch.centre)) < 0.04)
              return true;
    return false;
  });
  const Sharpness sharpness(voxels, laser, options);
  for (InspectedPatch& patch : patches) patch.density = sharpness.density(scans, patch);
  return patches;
}

std::vector<InspectedPatch> unseen_tops(const ScanRefs& scans, const mapping::Voxels& voxels,
                                        const mapping::LaserModel& laser, const InspectionOptions& options) {
  const std::vector<uint8_t> tops = top_voxels(voxels, options.max_height_m);
  const Sharpness sharpness(voxels, laser, options);
  std::vector<InspectedPatch> unseen;
  for (int z = 0; z < voxels.size.z(); ++z)
    for (int y = 1; y + 1 < voxels.size.y(); ++y)
      for (int x = 1; x + 1 < voxels.size.x(); ++x) {
        if (tops[voxels.index({x, y, z})] == 0) continue;
        int neighbours = -1;
        for (int j = y - 1; j <= y + 1; ++j)
          for (int i = x - 1; i <= x + 1; ++i) neighbours += tops[voxels.index({i, j, z})];
        if (neighbours < kMinTopNeighbours) continue;
        InspectedPatch top{voxels.center({x, y, z}), Vector3d::UnitZ(), 0,
                           voxels.resolution * voxels.resolution};
        top.density = sharpness.density(scans, top);
        if (top.density < kEnough * sharpness.wanted(top)) unseen.push_back(top);
      }
  return unseen;
}

NextView inspection_view(const ScanRefs& scans, const mapping::OccupancyMap& map,
                         const mapping::PlanarPose& robot, const mapping::LaserModel& laser,
                         const PlannerOptions& planner, const InspectionOptions& options) {
  NextView view;
  const mapping::Voxels voxels = map.voxels();
  std::vector<InspectedPatch> patches = face_patches(scans, voxels, laser, options);
  const mapping::FloorRegion within(planner.within);
  std::erase_if(patches, [&](const InspectedPatch& patch) {
    return patch.density >= options.points_per_cm2 || !within.contains(patch.centre.head<2>());
  });
  for (const InspectedPatch& top : unseen_tops(scans, voxels, laser, options))
    if (within.contains(top.centre.head<2>())) patches.push_back(top);
  double most = 0;
  for (const double height : options.heights.empty() ? std::vector{laser.height_m} : options.heights) {
    mapping::LaserModel raised = laser;  // Where it is lowered, the robot is as high as before.
    raised.height_m = std::max(laser.height_m, height);
    const mapping::FloorGrid floor = drivable_floor(voxels, robot, raised, planner);
    const Reachability reach = reachability(floor, robot, planner);
    const ViewSample best = closest_look(patches, {voxels, laser, options}, floor, reach, height, planner);
    if (best.score <= most + kMinRaise * kPatch * kPatch) continue;
    most = best.score;
    view.pose = best.pose;
    view.height_m = height;
    view.path = path_to(floor, reach, best.pose);
  }
  if (most < options.min_gain_m2) {
    view = {};
    view.reason =
        fmt::format("no view shows {} m² of faces better (the best {:.2f})", options.min_gain_m2, most);
    return view;
  }
  view.expected_overlap = 1;
  view.expected_gain = most;
  view.reason = fmt::format(
      "looks at {:.2f} m² of faces (a top counts {:g}-fold) that were seen too coarsely or too obliquely",
      most, options.min_gain_m2 / options.min_top_m2);
  return view;
}

}  // namespace loci::nbv
