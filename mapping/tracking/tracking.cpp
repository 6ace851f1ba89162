#include "mapping/tracking/tracking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math/pose.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/gravity.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/tracking/depth_calibration.h"
#include "mapping/tracking/noise_estimate.h"
#include "mapping/tracking/tracker.h"

namespace loci::mapping {
namespace {

using namespace tracking;

PreparedFrame prepared(const Recording& recording, size_t number, bool refine, const cv::Mat& offsets) {
  const RgbdFrame frame = recording.frame(number);
  PreparedFrame result{number, frame.time_ns, frame_images(frame, offsets), {}, {}};
  result.features = features_of(result.images);
  result.is_damaged = !frame.damage.empty() && !has_depth(frame);
  if (refine) result.given = frame.map_from_camera;
  return result;
}

/// Frames are prepared ahead on the other threads while one tracks those before.
std::vector<FrameResult> follow(const Recording& recording, const std::vector<size_t>& numbers,
                                const TrackingOptions& options, const cv::Mat& offsets, Tracker& tracker,
                                Progress& progress) {
  const auto batch = static_cast<size_t>(2 * thread_count(options.threads));
  std::vector<FrameResult> results(numbers.size());
  std::vector<PreparedFrame> ready;
  for (size_t begin = 0; begin < numbers.size() + batch; begin += batch) {
    std::vector<PreparedFrame> next(begin < numbers.size() ? std::min(batch, numbers.size() - begin) : 0);
    progress.check(static_cast<double>(std::min(begin, numbers.size())) / static_cast<double>(numbers.size()),
                   fmt::format("tracking frame {} of {}", std::min(begin, numbers.size()), numbers.size()));
    parallel_each(next.size() + 1, options.threads, [&](size_t task) {
      if (task > 0) {
        next[task - 1] = prepared(recording, numbers[begin + task - 1], options.refine, offsets);
        return;
      }
      for (size_t i = 0; i < ready.size(); ++i) results[begin - batch + i] = tracker.add(std::move(ready[i]));
    });
    ready = std::move(next);
  }
  return results;
}

/// A first pass over the beginning, to learn what is wrong with the depth.
DepthCalibration calibrated(const Recording& recording, const std::vector<size_t>& all,
                            const TrackingOptions& options, Progress& progress) {
  constexpr size_t kMaxFrames = 300;
  constexpr TimeNs kInterval = kSecond / 16;
  std::vector<size_t> numbers;
  for (const size_t number : all)
    if (numbers.size() < kMaxFrames &&
        (numbers.empty() || recording.time_of(number) - recording.time_of(numbers.back()) >= kInterval))
      numbers.push_back(number);
  Tracker tracker;
  const std::vector<FrameResult> followed = follow(recording, numbers, options, {}, tracker, progress);
  std::vector<CalibrationView> views;
  for (size_t i = 0; i < numbers.size(); ++i)
    if (followed[i].keyframe && followed[i].objection.empty())
      views.push_back({numbers[i], tracker.map_from_keyframes()[*followed[i].keyframe] *
                                       followed[i].keyframe_from_camera});
  return calibrate_depth(recording, views, options.threads);
}

bool stands_still(const std::vector<TrackedFrame>& frames) {
  const auto first =
      std::find_if(frames.begin(), frames.end(), [](const TrackedFrame& f) { return f.map_from_camera; });
  return std::all_of(first, frames.end(), [&](const TrackedFrame& frame) {
    if (!frame.map_from_camera) return true;
    const Isometry3d motion = first->map_from_camera->inverse() * *frame.map_from_camera;
    return motion.translation().norm() < kStill.max_shift &&
           Eigen::AngleAxisd(motion.linear()).angle() < kStill.max_turn;
  });
}

double median_interval_s(const std::vector<TrackedFrame>& frames) {
  std::vector<TimeNs> intervals;
  for (size_t i = 1; i < frames.size(); ++i) intervals.push_back(frames[i].time_ns - frames[i - 1].time_ns);
  if (intervals.empty()) return 0;
  std::ranges::nth_element(intervals, intervals.begin() + static_cast<ptrdiff_t>(intervals.size() / 2));
  return in_seconds(intervals[intervals.size() / 2]);
}

/// What may help against what most frames were lost for.
std::string advice_for(const TrackingResult& result) {
  size_t no_depth = 0, undetermined = 0, lost = 0;
  for (const TrackedFrame& frame : result.frames) {
    if (frame.map_from_camera) continue;
    ++lost;
    if (frame.objection == kHardlyAnyDepth) ++no_depth;
    if (frame.objection == kUndetermined) ++undetermined;
  }
  if (2 * no_depth > lost) return "keep 0.5 to 4 m from surfaces, and check depth_scale";
  if (result.too_noisy())
    return "the noise of the depth is the likely cause: come nearer to the surfaces, as it grows with the "
           "square of the distance, use the camera's filters or a higher resolution, or give poses (--poses)";
  if (2 * undetermined > lost)
    return "keep surfaces with corners or texture in view, or give poses (--poses)";
  if (const double interval = median_interval_s(result.frames); interval >= kMaxGap)
    return fmt::format(
        "frames are {:.3g} s apart: images of one room must overlap by half, at a few per second, or have "
        "poses (--poses); images of different scenes do not make a map, but loci-perceive run takes them "
        "with --fixed-camera",
        interval);
  return "move more slowly, keep 0.5 to 4 m from surfaces with corners or texture, or give poses (--poses)";
}

}  // namespace

void TrackingOptions::declare(OptionTable& table) {
  table.integer("every", every, "frames", "Tracks every n-th frame.", 1, 100000);
  table.flag("refine", refine, "Starts from the poses that the recording has, and stays in their frame.");
}

TrackingResult track(const Recording& recording, const TrackingOptions& options, Progress& progress) {
  const Stopwatch watch;
  TrackingOptions checked = options;
  table_of(checked).validate({"", 0, "track"});
  const RecordingInfo& info = recording.info();
  if (recording.size() == 0) throw Error("the recording has no frames", {info.path, 0, ""});
  if (options.refine && info.frames_with_pose == 0)
    throw Error("the recording has no poses to refine", {info.path, 0, ""}, "track it without --refine");
  std::vector<size_t> numbers;
  for (size_t i = 0; i < recording.size(); i += static_cast<size_t>(options.every)) numbers.push_back(i);
  const DepthCalibration calibration = calibrated(recording, numbers, options, progress);
  Tracker tracker;
  const std::vector<FrameResult> followed =
      follow(recording, numbers, options, calibration.offsets, tracker, progress);
  if (tracker.map_from_keyframes().empty())
    throw Error("no frame has enough depth to be tracked", {info.path, 0, ""},
                "check depth_scale and the range");

  TrackingResult result;
  const std::vector<bool> in_main_part = tracker.in_main_part();
  for (size_t i = 0; i < numbers.size(); ++i) {
    TrackedFrame frame{numbers[i], recording.index_of(numbers[i]), recording.time_of(numbers[i]), {}, {}, {}};
    frame.covariance = followed[i].covariance;
    frame.objection = followed[i].objection;
    if (frame.objection.empty() && !in_main_part[*followed[i].keyframe])
      frame.objection = "nothing connects it well enough with the largest part of the path";
    if (frame.objection.empty())
      frame.map_from_camera =
          tracker.map_from_keyframes()[*followed[i].keyframe] * followed[i].keyframe_from_camera;
    result.frames.push_back(std::move(frame));
  }
  result.map_frame = options.refine ? info.map_frame : kFirstCamera;
  result.keyframes = tracker.map_from_keyframes().size();
  result.loops = tracker.loops();
  // A constant turns planes into planes: pairs of views hardly tell it from motion.
  if (!calibration.offsets.empty())
    result.depth_offsets = calibration.offsets - cv::mean(calibration.offsets)[0];
  result.depth_offset = calibration.rms;
  if (2 * result.good() < result.frames.size())
    result.depth_noise = depth_noise_per_z2(recording).value_or(0);
  result.still = stands_still(result.frames);
  if (result.still)
    for (TrackedFrame& frame : result.frames)
      if (frame.map_from_camera) frame.map_from_camera = tracker.map_from_keyframes().front();
  result.seconds = watch.seconds();
  result.cpu_seconds = watch.cpu_seconds();
  return result;
}

void require_usable(const TrackingResult& result, const std::string& path) {
  // The first frame of a part defines its frame: alone it is placed relative to nothing.
  const size_t needed = std::min<size_t>(2, result.frames.size());
  if (result.good() >= needed && 10 * result.good() >= result.frames.size()) return;
  throw Error("the camera cannot be tracked: " + result.summary(), {path, 0, ""}, advice_for(result));
}

std::unique_ptr<Recording> with_tracked_poses(std::unique_ptr<Recording> recording,
                                              const TrackingResult& result, bool refined,
                                              Warnings& warnings) {
  // An IMU says what is up in the first frame.
  std::optional<Vector3d> up = recording->info().up_in_camera;
  if (up && result.frames.front().map_from_camera)
    up = result.frames.front().map_from_camera->linear() * *up;
  else
    up.reset();
  const bool is_levelled = refined && recording->info().levelled;
  if (!result.depth_offsets.empty())
    recording = without_depth_error(std::move(recording), result.depth_offsets);
  auto poses = result.poses(recording->size());
  recording = with_poses(std::move(recording), std::move(poses), result.map_frame, is_levelled);
  if (refined) return recording;
  if (!up) up = find_up(*recording);
  if (!up) {
    warnings.add("which way is up is not known: the map frame is the first camera's; choose with --up",
                 {recording->info().path, 0, {}});
    return recording;
  }
  return turned_upright(std::move(recording), *up, "odom");
}

std::vector<std::optional<Isometry3d>> TrackingResult::poses(size_t recording_size) const {
  std::vector<std::optional<Isometry3d>> all(recording_size);
  for (const TrackedFrame& frame : frames) all.at(frame.number) = frame.map_from_camera;
  return all;
}

bool TrackingResult::too_noisy() const {
  return depth_noise > kVerdict.max_noise;
}

size_t TrackingResult::good() const {
  return static_cast<size_t>(std::count_if(
      frames.begin(), frames.end(), [](const TrackedFrame& f) { return f.map_from_camera.has_value(); }));
}

std::string TrackingResult::summary() const {
  std::string text = fmt::format("{} of {} frames tracked", good(), frames.size());
  if (still && good() > 1)  // One frame shows neither motion nor rest.
    text += "; the camera stands still";
  else if (!still)
    text += fmt::format(", {}, {}", counted(keyframes, "keyframe"), counted(loops, "loop"));
  if (depth_offset > 0)
    text += fmt::format("; the depth camera's own error of {:.0f} mm at 2 m was found and left out",
                        4e3 * depth_offset);
  std::map<std::string, size_t> objections;
  for (const TrackedFrame& frame : frames)
    if (!frame.map_from_camera) ++objections[frame.objection];
  for (const auto& [objection, count] : objections) text += fmt::format("; {} lost: {}", count, objection);
  if (too_noisy())
    text += fmt::format("; the depth is noisy: {:.0f} mm at 2 m, tracking needs {:.0f} mm or less",
                        4e3 * depth_noise, 4e3 * kVerdict.max_noise);
  return text;
}

Json TrackingResult::report() const {
  Json list = Json::array();
  for (const TrackedFrame& frame : frames) {
    Json entry = {{"frame", frame.index}, {"verdict", frame.map_from_camera ? "good" : "lost"}};
    if (frame.map_from_camera) {
      entry["position_sigma_m"] = std::sqrt(frame.covariance.topLeftCorner<3, 3>().trace());
      entry["rotation_sigma_deg"] = std::sqrt(frame.covariance.bottomRightCorner<3, 3>().trace()) / kDegree;
    } else {
      entry["reason"] = frame.objection;
    }
    list.push_back(std::move(entry));
  }
  return {{"frames", frames.size()},
          {"good", good()},
          {"keyframes", keyframes},
          {"loops", loops},
          {"depth_offset_per_m", depth_offset},
          {"depth_noise_per_m", depth_noise > 0 ? Json(depth_noise) : Json(nullptr)},
          {"still", still},
          {"seconds", seconds},
          {"tracked", list}};
}

}  // namespace loci::mapping
