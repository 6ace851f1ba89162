#include "mapping/recording/posed_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/pose.h"
#include "mapping/base/time_limits.h"

namespace loci::mapping {
namespace {

/// Another recording with other info, and a change to each frame.
class ChangedRecording : public Recording {
 public:
  using Change = std::function<void(RgbdFrame& frame, size_t number)>;

  ChangedRecording(std::unique_ptr<Recording> recording, RecordingInfo info, Change change,
                   std::vector<TimeNs> times = {})
      : recording_(std::move(recording)),
        info_(std::move(info)),
        change_(std::move(change)),
        times_(std::move(times)) {}

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return recording_->size(); }
  TimeNs time_of(size_t i) const override { return times_.empty() ? recording_->time_of(i) : times_.at(i); }
  int64_t index_of(size_t i) const override { return recording_->index_of(i); }
  std::optional<Isometry3d> pose_of(size_t i) const override {
    RgbdFrame frame;
    frame.map_from_camera = recording_->pose_of(i);
    change_(frame, i);
    return frame.map_from_camera;
  }
  std::string name_of(size_t i) const override { return recording_->name_of(i); }
  std::string color_name_of(size_t i) const override { return recording_->color_name_of(i); }
  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame = recording_->frame(i);
    change_(frame, i);
    return frame;
  }

 private:
  std::unique_ptr<Recording> recording_;
  RecordingInfo info_;
  Change change_;
  std::vector<TimeNs> times_;  ///< empty = those of the recording
};

/// With other times than those that were made up, as an option says.
std::unique_ptr<Recording> with_times(std::unique_ptr<Recording> recording, std::vector<TimeNs> times,
                                      const char* option, std::string guess) {
  RecordingInfo info = recording->info();
  if (!info.time_assumed)
    throw Error("the recording has time stamps", {info.path, 0, option}, "it is for images without any");
  info.first_time = times.front();
  info.last_time = times.back();
  if (!is_within_limits(info.first_time) || !is_within_limits(info.last_time))
    throw Error("the frames begin or end too far off", {info.path, 0, option});
  std::erase_if(info.guesses,
                [](const std::string& text) { return text.find("2000-01-01") != std::string::npos; });
  info.guesses.push_back(std::move(guess));
  return std::make_unique<ChangedRecording>(
      std::move(recording), std::move(info), [times](RgbdFrame& one, size_t i) { one.time_ns = times[i]; },
      times);
}

}  // namespace

std::unique_ptr<Recording> with_poses(std::unique_ptr<Recording> recording,
                                      std::vector<std::optional<Isometry3d>> map_from_camera,
                                      std::string map_frame, bool is_levelled) {
  RecordingInfo info = recording->info();
  if (map_from_camera.size() != recording->size())
    throw Error(fmt::format("{} poses for {} frames", map_from_camera.size(), recording->size()),
                {info.path, 0, {}});
  info.frames_with_pose = static_cast<size_t>(std::count_if(
      map_from_camera.begin(), map_from_camera.end(), [](const auto& pose) { return pose.has_value(); }));
  info.map_frame = std::move(map_frame);
  info.levelled = is_levelled;
  info.map_from_input.setIdentity();
  const auto about_poses = [](const std::string& text) {
    return text.starts_with("no poses") || text.find("have no pose") != std::string::npos;
  };
  std::erase_if(info.guesses, about_poses);
  std::erase_if(info.problems, about_poses);
  if (info.frames_with_pose < info.frames)
    info.problems.push_back(
        fmt::format("{} of {} frames have no pose", info.frames - info.frames_with_pose, info.frames));
  return std::make_unique<ChangedRecording>(
      std::move(recording), std::move(info),
      [poses = std::move(map_from_camera)](RgbdFrame& one, size_t i) { one.map_from_camera = poses[i]; });
}

std::unique_ptr<Recording> in_frame(std::unique_ptr<Recording> recording, const Isometry3d& frame_from_map,
                                    std::string frame, const std::string& guess) {
  RecordingInfo info = recording->info();
  info.levelled = true;
  info.map_from_input = frame_from_map * info.map_from_input;
  if (info.frames_with_pose > 0) info.map_frame = std::move(frame);
  if (!guess.empty()) info.guesses.push_back(guess);
  return std::make_unique<ChangedRecording>(std::move(recording), std::move(info),
                                            [frame_from_map](RgbdFrame& one, size_t) {
                                              if (one.map_from_camera)
                                                one.map_from_camera = frame_from_map * *one.map_from_camera;
                                            });
}

std::unique_ptr<Recording> turned_upright(std::unique_ptr<Recording> recording, const Vector3d& up,
                                          std::string frame, const std::string& guess) {
  Isometry3d level = Isometry3d::Identity();
  level.linear() = rotation_between(up, Vector3d::UnitZ());
  return in_frame(std::move(recording), level, std::move(frame), guess);
}

std::unique_ptr<Recording> seconds_apart(std::unique_ptr<Recording> recording, double seconds) {
  std::vector<TimeNs> times;
  for (size_t i = 0; i < recording->size(); ++i)
    times.push_back(recording->time_of(0) +
                    static_cast<TimeNs>(static_cast<double>(i) * seconds * static_cast<double>(kSecond)));
  return with_times(std::move(recording), std::move(times), "--seconds-apart",
                    fmt::format("frames are taken as {:g} s apart, as --seconds-apart says", seconds));
}

std::unique_ptr<Recording> started_at(std::unique_ptr<Recording> recording, TimeNs start) {
  std::vector<TimeNs> times;
  for (size_t i = 0; i < recording->size(); ++i)
    times.push_back(start + recording->time_of(i) - recording->time_of(0));
  return with_times(std::move(recording), std::move(times), "--start",
                    "the first frame is of the time that --start says");
}

std::unique_ptr<Recording> with_up(std::unique_ptr<Recording> recording, const Vector3d& up_in_camera) {
  RecordingInfo info = recording->info();
  info.up_in_camera = up_in_camera;
  return std::make_unique<ChangedRecording>(std::move(recording), std::move(info), [](RgbdFrame&, size_t) {});
}

std::unique_ptr<Recording> not_levelled(std::unique_ptr<Recording> recording) {
  RecordingInfo info = recording->info();
  info.levelled = false;
  return std::make_unique<ChangedRecording>(std::move(recording), std::move(info), [](RgbdFrame&, size_t) {});
}

std::unique_ptr<Recording> without_depth_error(std::unique_ptr<Recording> recording,
                                               const cv::Mat& inverse_depth_error) {
  RecordingInfo info = recording->info();
  cv::Mat error;
  cv::resize(inverse_depth_error, error, {info.camera.depth.width, info.camera.depth.height});
  return std::make_unique<ChangedRecording>(
      std::move(recording), std::move(info), [error](RgbdFrame& one, size_t) {
        if (one.depth.size() == error.size())
          cv::divide(one.depth, 1 - one.depth.mul(error), one.depth);  // No measurement, NaN, stays NaN.
      });
}

std::unique_ptr<Recording> in_map(std::unique_ptr<Recording> recording,
                                  const std::optional<Isometry3d>& map_from_input,
                                  const std::string& map_frame) {
  const RecordingInfo& info = recording->info();
  if (!map_from_input || info.frames_with_pose == 0 || info.map_frame == map_frame) return recording;
  return in_frame(std::move(recording), *map_from_input, map_frame);
}

}  // namespace loci::mapping
