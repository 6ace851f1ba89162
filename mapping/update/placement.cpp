#include "mapping/update/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/math.h"
#include "mapping/fusion/fusion.h"
#include "mapping/recording/gravity.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/registration/pair.h"
#include "mapping/tracking/known_poses.h"
#include "mapping/update/epoch.h"
#include "mapping/update/parameters.h"

namespace loci::mapping {
namespace {

constexpr double kCell = 0.05;
constexpr double kHeightBin = 0.02;
constexpr double kMaxHeight = 4;        // m between the origins of the frames
constexpr size_t kHeights = 3;          // candidates
constexpr double kHeightsApart = 0.12;  // m; nearer ones lead to the same pose
constexpr double kMargin = 0.04;        // part of the surface by which the best place fits better

RegistrationOptions placement_options(int dof) {
  RegistrationOptions options;
  options.voxel_m = kCell;
  options.dof = dof;
  options.min_overlap = 0.6;
  options.max_conflict = 0.1;  // Objects, chairs and doors.
  options.ambiguity_margin = kMargin;
  return options;
}

/// Area of surfaces that face up, by height.
std::vector<double> heights_of(const registration::Surfels& surface, double lowest, size_t bins) {
  std::vector<double> area(bins);
  for (size_t i = 0; i < surface.size(); ++i) {
    if (surface.normal[i].z() < 0.95F) continue;
    const double bin = (static_cast<double>(surface.position[i].z()) - lowest) / kHeightBin;
    if (bin >= 0 && bin < static_cast<double>(bins)) area[static_cast<size_t>(bin)] += 1;
  }
  // Large ones do not count for all: a floor is on every height of another one.
  for (double& a : area) a = std::sqrt(a);
  return area;
}

/// Shifts along z that bring most horizontal surfaces together, best first.
std::vector<double> promising_heights(const registration::Surfels& map, const registration::Surfels& scans) {
  const auto bins = static_cast<size_t>(4 * kMaxHeight / kHeightBin);
  const std::vector<double> own = heights_of(map, -2 * kMaxHeight, bins),
                            other = heights_of(scans, -2 * kMaxHeight, bins);
  std::vector<std::pair<double, int>> scored;
  const int reach = static_cast<int>(kMaxHeight / kHeightBin);
  for (int shift = -reach; shift <= reach; ++shift) {
    double sum = 0;
    for (int i = 0; i < static_cast<int>(bins); ++i) {
      if (other[static_cast<size_t>(i)] <= 0) continue;
      for (int near = -2; near <= 2; ++near) {
        const int j = i + shift + near;
        if (j >= 0 && j < static_cast<int>(bins))
          sum += own[static_cast<size_t>(j)] * other[static_cast<size_t>(i)] / (1 + std::abs(near));
      }
    }
    scored.emplace_back(-sum, shift);
  }
  std::stable_sort(scored.begin(), scored.end());
  std::vector<double> chosen;
  for (const auto& [score, shift] : scored) {
    const double height = shift * kHeightBin;
    if (chosen.size() == kHeights) break;
    if (score < 0 && std::all_of(chosen.begin(), chosen.end(), [&, h = height](double other_height) {
          return std::abs(other_height - h) >= kHeightsApart;
        }))
      chosen.push_back(height);
  }
  return chosen;
}

/// The middle of a surface, and how far it reaches from there.
std::pair<Vector3d, double> extent_of(const registration::Surfels& surface) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& position : surface.position) box.extend(position);
  return {box.center().cast<double>(), static_cast<double>(box.diagonal().head<2>().norm()) / 2};
}

double score_of(const PairAlignment& pair) {
  return registration::Agreement{pair.overlap, pair.conflict}.score();
}

}  // namespace

Placement place_scans(const ScanSet& map_scans, const ScanSet& scans, int threads, Progress& progress) {
  progress.check(0, "placing the recording in the map");
  const Epoch map(map_scans, kCell, threads), seen(scans, kCell, threads);
  Placement result;
  if (map.surface().size() == 0 || seen.surface().size() == 0) {
    result.reason = "a scan set holds no surface";
    return result;
  }
  const auto [middle, reach] = extent_of(map.surface());
  const Vector3d centre = seen.prepared().centre.cast<double>();
  const std::vector<double> heights = promising_heights(map.surface(), seen.surface());
  std::vector<PairAlignment> found;
  for (const double height : heights) {
    progress.check(static_cast<double>(found.size()) / static_cast<double>(heights.size() + 1),
                   "placing the recording in the map");
    Isometry3d guess = Isometry3d::Identity();
    guess.translation() = Vector3d(middle.x() - centre.x(), middle.y() - centre.y(), height);
    const PairAlignment planar =
        align_pair(map.prepared(), seen.prepared(), guess, {reach, kPi}, placement_options(3));
    const PairAlignment fine = align_pair(map.prepared(), seen.prepared(), planar.target_from_source,
                                          {0.05, 2 * kDegree}, placement_options(6));
    found.push_back(fine);
    // Only the search over the room knows of other places.
    if (fine.trusted && planar.ambiguous) {
      found.back().trusted = false;
      found.back().reason = "another place in the map fits about as well";
    }
  }
  if (found.empty()) {
    result.reason = "no horizontal surface of the map is seen";
    return result;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return score_of(a) > score_of(b); });
  const PairAlignment& best = found.front();
  result = {best.target_from_source, best.overlap, best.conflict, best.rmse_m, best.trusted, best.reason};
  const auto is_other = [&](const PairAlignment& pair) {
    const Isometry3d motion = best.target_from_source.inverse() * pair.target_from_source;
    return (motion * centre - centre).norm() > 0.1 ||
           Eigen::AngleAxisd(motion.linear()).angle() > 3 * kDegree;
  };
  for (size_t i = 1; i < found.size() && result.trusted; ++i) {
    if (!is_other(found[i]) || score_of(found[i]) < score_of(best) - kMargin) continue;
    result.trusted = false;
    result.reason = "another height fits about as well";
  }
  return result;
}

ScanSet scans_to_place(const Recording& recording, int threads, Progress& progress) {
  constexpr size_t kFrames = 120;
  FusionOptions fusion;
  fusion.every = static_cast<int>(std::max<size_t>(1, recording.size() / kFrames));
  fusion.voxel_m = 0.02;
  fusion.threads = threads;
  return fuse(recording, fusion, progress).scans;
}

ScanSet read_scans_of_map(const std::filesystem::path& folder, const SemanticMap& map, Warnings& warnings) {
  ScanSet scans = read_registered_scans(folder, warnings);
  if (scans.levelled || !map.map_from_input) return scans;
  for (Scan& scan : scans.scans) scan.map_from_scan = *map.map_from_input * scan.map_from_scan;
  scans.levelled = true;
  return scans;
}

namespace {

/// The share of a sample of what a recording with poses shows that lies within about a decimetre of the scans
/// of a map; 1 where it shows nothing.
double share_on(const ScanSet& map, const Recording& recording) {
  constexpr size_t kFrames = 24;
  constexpr int kSamples = 60;       // pixels along the longer side of an image
  constexpr double kMaxDepth = 4.0;  // m; maps end there
  CellIndex cells;
  for (const Scan& scan : map.scans)
    for (const ScanPoint& point : scan.points)
      if (point.returned) cells.insert(cell_of(scan.map_from_scan * point.position.cast<double>(), kCell));
  const auto is_near = [&](const Eigen::Vector3i& cell) {
    for (int i = 0; i < 27; ++i)
      if (cells.find(cell + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) != CellIndex::kNone)
        return true;
    return false;
  };
  size_t total = 0, near = 0;
  const size_t stride = std::max<size_t>(1, recording.size() / kFrames);
  for (size_t i = 0; i < recording.size(); i += stride) {
    const RgbdFrame frame = recording.frame(i);
    const int step = std::max(1, std::max(frame.depth.cols, frame.depth.rows) / kSamples);
    for (int v = step / 2; frame.map_from_camera && v < frame.depth.rows; v += step)
      for (int u = step / 2; u < frame.depth.cols; u += step) {
        const auto depth = static_cast<double>(frame.depth.at<float>(v, u));
        if (!(depth > 0 && depth < kMaxDepth)) continue;
        ++total;
        near += is_near(cell_of(*frame.map_from_camera * frame.camera.depth.unproject(u, v, depth), kCell))
                    ? 1
                    : 0;
      }
  }
  return total == 0 ? 1 : static_cast<double>(near) / static_cast<double>(total);
}

void require_trusted(const Placement& placement, const std::string& path) {
  if (!placement.trusted)
    throw Error("the recording cannot be placed in the map: " + placement.reason, {path, 0, {}},
                "show more of the room, walls and corners with furniture, or give poses in the map's frame");
}

/// What to make of a recording that was tracked where the map has no scans: a camera that moved may have made
/// the map, one that stood still may be anywhere. `folder`: where scans were looked for.
std::unique_ptr<Recording> unplaced(std::unique_ptr<Recording> tracked, const std::filesystem::path& folder,
                                    Warnings& warnings) {
  const auto first = tracked->pose_of(0), last = tracked->pose_of(tracked->size() - 1);
  const bool stands = first && last && first->isApprox(*last, 0);
  const std::string text = "the map has no scans beside it to place the recording by";
  if (stands)
    throw Error(
        text, {folder.string(), 0, {}},
        "fuse what the map was made from to this folder, or give the recording poses in the map's frame");
  warnings.add(
      text +
          ": its poses fit the map only if it was made from the same frames; fuse them to this folder "
          "before you interpret them",
      {folder.string(), 0, {}});
  return tracked;
}

}  // namespace

std::unique_ptr<Recording> placed_in_map(std::unique_ptr<Recording> recording, bool is_tracked,
                                         const SemanticMap& map, const ScanSet& map_scans, int threads,
                                         Progress& progress, Warnings& warnings) {
  constexpr double kMinShare = 0.5;  // of a recording whose poses fit: the rest may be new
  const FileLocation location{recording->info().path, 0, {}};
  double share = 0;
  if (!is_tracked) {
    const std::string frame = recording->info().map_frame;
    share = share_on(map_scans, *recording);
    if (share >= kMinShare)  // As level as the map is.
      return in_frame(std::move(recording), Isometry3d::Identity(), frame);
    if (const auto up = find_up(*recording)) recording = turned_upright(std::move(recording), *up, frame);
  }
  const ScanSet scans = scans_to_place(*recording, threads, progress);
  const Placement placement = place_scans(map_scans, scans, threads, progress);
  if (!is_tracked && !placement.trusted) {
    warnings.add(
        Error(fmt::format("the poses do not fit the map: {:.0f} % of what is seen lies on its scans, "
                          "and no other place was found ({})",
                          100 * share, placement.reason),
              location, "if they are in another frame than the map, give poses in its frame")
            .what());
    return recording;
  }
  require_trusted(placement, location.file);
  const Vector3d at = placement.map_from_scans.translation();
  warnings.add(fmt::format("{}the recording was placed in the map: {} x {:.2f} y {:.2f} z {:.2f} m ({})",
                           is_tracked ? "" : "the poses are in another frame than the map: ",
                           is_tracked ? "it begins at" : "their origin is at", at.x(), at.y(), at.z(),
                           placement.reason),
               location);
  return in_frame(std::move(recording), placement.map_from_scans, map.frame);
}

std::unique_ptr<Recording> perceived_in_map(std::unique_ptr<Recording> recording,
                                            const std::filesystem::path& map, bool is_fixed, int threads,
                                            Progress& progress, Warnings& warnings) {
  const bool is_tracked = recording->info().frames_with_pose == 0;
  if (is_tracked)
    recording =
        is_fixed ? with_fixed_pose(std::move(recording), warnings)
                 : with_known_poses(std::move(recording), PosesFor::placement, threads, progress, warnings);
  const std::filesystem::path folder = map.parent_path() / "scans", sidecar = sidecar_path(map);
  const SemanticMap semantics = exists(sidecar) ? read_semantic_map(sidecar) : SemanticMap();
  if (!is_tracked) recording = in_map(std::move(recording), semantics.map_from_input, semantics.frame);
  if (!exists(folder / "scans.yaml") || !exists(sidecar))
    return is_tracked ? unplaced(std::move(recording), folder, warnings) : std::move(recording);
  return placed_in_map(std::move(recording), is_tracked, semantics,
                       read_scans_of_map(folder, semantics, warnings), threads, progress, warnings);
}

}  // namespace loci::mapping
