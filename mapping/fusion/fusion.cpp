#include "mapping/fusion/fusion.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <opencv2/core.hpp>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"

namespace loci::mapping {
namespace {

/// Rays without return within the range are thinned to cells of this size, metres: enough for free space.
constexpr double kFreeRayCell = 0.1;

struct Voxel {
  Vector3d sum = Vector3d::Zero();
  Vector3d color = Vector3d::Zero();
  double weight = 0;
  double color_weight = 0;
  double best_weight = 0;
  int last_frame = -1;
  int frames = 0;
  uint16_t best_origin = 0;
};

/// Accumulates the voxels of one scan in the map frame.
class ScanBuilder {
 public:
  explicit ScanBuilder(const FusionOptions& options)
      : options_(options), index_(1U << 17U), free_(1U << 10U) {}

  void add(const RgbdFrame& frame) {
    const auto origin = static_cast<uint16_t>(origins_.size());
    const Isometry3d& pose = *frame.map_from_camera;
    origins_.push_back(pose);
    const cv::Mat color = color_in_depth(frame);
    for (int v = 0; v < frame.depth.rows; ++v) {
      const auto* row = frame.depth.ptr<float>(v);
      for (int u = 0; u < frame.depth.cols; ++u) {
        const auto z = static_cast<double>(row[u]);
        if (!(z > 0)) continue;
        const Vector3d ray = frame.camera.depth.unproject(u, v, z);
        if (z > options_.range_max_m)
          add_free(pose * (ray * (options_.range_max_m / z)), origin);
        else
          add_point(pose * ray, z, color.at<cv::Vec3b>(v, u), origin);
      }
    }
  }

  /// The scan in the frame of its middle camera; counts voxels with too few observations.
  Scan finish(size_t number, size_t& seldom_seen) const {
    Scan scan;
    scan.name = fmt::format("scan_{:03d}", number);
    scan.map_from_scan = origins_[origins_.size() / 2];
    const Isometry3d scan_from_map = scan.map_from_scan.inverse();
    for (const Isometry3d& origin : origins_)
      scan.origins.emplace_back((scan_from_map * origin.translation()).cast<float>());
    const int wanted = std::min(options_.min_observations, static_cast<int>(origins_.size()));
    for (const Voxel& voxel : voxels_) {
      if (voxel.frames < wanted)
        ++seldom_seen;
      else
        scan.points.push_back(point_of(voxel, scan_from_map));
    }
    for (const auto& [position, origin] : free_ends_) {
      ScanPoint point;
      point.position = (scan_from_map * position).cast<float>();
      point.origin_index = origin;
      point.returned = false;
      scan.points.push_back(point);
    }
    return scan;
  }

 private:
  void add_point(const Vector3d& point, double z, const cv::Vec3b& color, uint16_t origin) {
    const uint32_t number = index_.insert(cell_of(point, options_.voxel_m));
    if (number == voxels_.size()) voxels_.emplace_back();
    Voxel& voxel = voxels_[number];
    const double weight = 1 / (z * z * z * z);  // disparity noise gives a depth variance that grows with z^4
    voxel.sum += weight * point;
    voxel.weight += weight;
    if (color != cv::Vec3b(0, 0, 0)) {
      voxel.color += weight * Vector3d(color[2], color[1], color[0]);
      voxel.color_weight += weight;
    }
    if (voxel.last_frame != origin) ++voxel.frames;
    voxel.last_frame = origin;
    if (weight > voxel.best_weight) {
      voxel.best_weight = weight;
      voxel.best_origin = origin;
    }
  }

  void add_free(const Vector3d& end, uint16_t origin) {
    const size_t before = free_.size();
    if (free_.insert(cell_of(end, kFreeRayCell)) == before) free_ends_.emplace_back(end, origin);
  }

  static ScanPoint point_of(const Voxel& voxel, const Isometry3d& scan_from_map) {
    ScanPoint point;
    point.position = (scan_from_map * Vector3d(voxel.sum / voxel.weight)).cast<float>();
    point.origin_index = voxel.best_origin;
    if (voxel.color_weight > 0) {
      const Vector3d color = voxel.color / voxel.color_weight;
      point.r = static_cast<uint8_t>(std::lround(color.x()));
      point.g = static_cast<uint8_t>(std::lround(color.y()));
      point.b = static_cast<uint8_t>(std::lround(color.z()));
    }
    return point;
  }

  const FusionOptions& options_;
  CellIndex index_;
  std::vector<Voxel> voxels_;
  CellIndex free_;
  std::vector<std::pair<Vector3d, uint16_t>> free_ends_;
  std::vector<Isometry3d> origins_;
};

/// One scan and its counts.
struct Part {
  Scan scan;
  Tally frames, without_color;
  size_t at_edges = 0, seldom = 0;
};

/// Why a frame cannot be fused.
std::optional<Reason> unusable_because(const RgbdFrame& frame) {
  if (!frame.map_from_camera) return Reason::no_pose;
  if (!has_depth(frame)) return frame.damage.empty() ? Reason::no_depth : Reason::damaged;
  return std::nullopt;
}

FusionResult collect(std::vector<Part>& parts, const RecordingInfo& info, const FusionOptions& options) {
  FusionResult result;
  for (Part& part : parts) {
    result.frames.add(part.frames);
    result.without_color.add(part.without_color);
    result.pixels_at_edges += part.at_edges;
    result.voxels_seldom_seen += part.seldom;
    if (!part.scan.points.empty()) result.scans.scans.push_back(std::move(part.scan));
  }
  if (result.frames.used() == 0)
    throw Error("no frame can be fused: " + result.frames.reasons(), {info.path, 0, ""},
                result.frames.hint());
  if (result.points() == 0)
    throw Error(fmt::format("nothing within {} m was seen by {} frames of a scan", options.range_max_m,
                            options.min_observations),
                {info.path, 0, ""}, "check --range-max-m, --min-observations, and the poses");
  result.scans.sensor = kDepthCameraSensor;
  result.scans.levelled = info.map_frame == "map" && info.levelled;
  result.scans.range_max = options.range_max_m;
  result.scans.resolution = options.voxel_m;
  result.scans.free_space = true;
  return result;
}

/// Depth beyond which two neighbours do not lie on one surface: noise and quantisation grow with z².
float jump_at(float z) {
  return 0.02F + 0.006F * z * z;
}

}  // namespace

size_t drop_flying_pixels(cv::Mat& depth) {
  static constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  const cv::Mat source = depth.clone();
  size_t dropped = 0;
  for (int v = 1; v + 1 < source.rows; ++v) {
    for (int u = 1; u + 1 < source.cols; ++u) {
      const float z = source.at<float>(v, u);
      if (std::isnan(z)) continue;
      const float jump = jump_at(z);
      int near = 0;
      bool between = false;
      for (const auto& [du, dv] : kSteps) {
        const float before = source.at<float>(v - dv, u - du) - z;
        const float after = source.at<float>(v + dv, u + du) - z;
        near += (std::abs(before) <= jump ? 1 : 0) + (std::abs(after) <= jump ? 1 : 0);
        between = between || (before > jump && after < -jump) || (before < -jump && after > jump);
      }
      if (!between && near >= 3) continue;
      depth.at<float>(v, u) = std::numeric_limits<float>::quiet_NaN();
      ++dropped;
    }
  }
  return dropped;
}

void FusionOptions::declare(OptionTable& table) {
  table.integer("every", every, "frames", "Takes every n-th frame.", 1, 100000);
  table.number("voxel_m", voxel_m, "m", "Points are thinned to one per cube of this size and scan.", 0.001,
               0.5);
  table.number("range_max_m", range_max_m, "m",
               "Farther measurements only mark free space (a step of a Kinect's disparity is 4.5 cm at 4 m).",
               0.5, 100);
  table.integer("min_observations", min_observations, "frames",
                "A voxel seen by fewer frames of its scan is left out as noise.", 1, 1000);
  table.integer("frames_per_scan", frames_per_scan, "frames", "So many consecutive frames become one scan.",
                1, 65535);
  table.flag("edge_filter", edge_filter, "Leaves out flying pixels at depth edges.");
}

FusionResult fuse(const Recording& recording, const FusionOptions& options, Progress& progress) {
  const Stopwatch watch;
  FusionOptions checked = options;
  table_of(checked).validate({"", 0, "fuse"});
  const RecordingInfo& info = recording.info();
  if (recording.size() == 0) throw Error("the recording has no frames", {info.path, 0, ""});

  // A scan consists of consecutive frames; frames without pose are skipped.
  const size_t taken =
      (recording.size() + static_cast<size_t>(options.every) - 1) / static_cast<size_t>(options.every);
  const auto per_scan = static_cast<size_t>(options.frames_per_scan);
  const size_t count = (taken + per_scan - 1) / per_scan;
  std::vector<Part> parts(count);
  std::atomic<size_t> done = 0;
  std::mutex mutex;
  progress.check(0, "fusing frames");
  const auto build = [&](size_t number) {
    Part& part = parts[number];
    ScanBuilder builder(options);
    for (size_t i = number * per_scan; i < std::min(taken, (number + 1) * per_scan); ++i) {
      RgbdFrame frame = recording.frame(i * static_cast<size_t>(options.every));
      if (const auto reason = unusable_because(frame)) {
        part.frames.add(*reason, frame.damage);
      } else {
        if (options.edge_filter) part.at_edges += drop_flying_pixels(frame.depth);
        builder.add(frame);
        part.frames.add_used();
        if (!frame.damage.empty()) part.without_color.add(Reason::damaged, frame.damage);
      }
      const size_t now_done = ++done;
      const std::lock_guard lock(mutex);
      progress.check(static_cast<double>(now_done) / static_cast<double>(taken),
                     fmt::format("fused {} of {} frames", now_done, taken));
    }
    if (part.frames.used() > 0) part.scan = builder.finish(number, part.seldom);
  };
  parallel_for(count, options.threads, [&](size_t begin, size_t end) {
    for (size_t number = begin; number < end; ++number) build(number);
  });

  FusionResult result = collect(parts, info, options);
  result.seconds = watch.seconds();
  return result;
}

size_t FusionResult::points() const {
  size_t count = 0;
  for (const Scan& scan : scans.scans)
    for (const ScanPoint& point : scan.points) count += point.returned ? 1 : 0;
  return count;
}

std::string FusionResult::summary() const {
  return fmt::format("{} became {} with {} points", counted(frames.used(), "frame"),
                     counted(scans.scans.size(), "scan"), points());
}

Json FusionResult::report() const {
  return {{"frames", frames.report()},
          {"scans", scans.scans.size()},
          {"points", points()},
          {"pixels_at_edges", pixels_at_edges},
          {"voxels_seldom_seen", voxels_seldom_seen},
          {"levelled", scans.levelled},
          {"seconds", seconds}};
}

}  // namespace loci::mapping
