#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/recording/frame_names.h"
#include "mapping/recording/recording.h"
#include "mapping/recording/rectification.h"
#include "mapping/recording/video.h"

namespace loci::mapping {

/// Where the parts of one frame are.
struct FrameFiles {
  int64_t index = 0;
  TimeNs time_ns = 0;
  std::filesystem::path depth;
  std::filesystem::path color;        ///< empty = none
  std::optional<size_t> video_frame;  ///< `color` is a video, this its frame
  std::filesystem::path confidence;   ///< 8-bit image of depth's size; empty = none
  std::optional<Isometry3d> map_from_camera;
  std::optional<RgbdCamera> lens;  ///< of this frame alone (autofocus): its images become those of the camera
  JointState joints;
  FileLocation location;  ///< row that names the frame, for messages
};

/// What a reader of a layout of single images fills in; the rest is the same for all of them.
struct FileRecordingContent {
  RecordingInfo info;                    ///< format, path, map_frame, camera, time_assumed, guesses, problems
  bool camera_assumed = false;           ///< nothing describes the cameras
  double depth_scale = 0.001;            ///< metres per unit of 16-bit depth
  double float_depth_scale = 1;          ///< metres per unit of floating-point depth
  bool depth_along_rays = false;         ///< depth is the distance from the camera, not z
  std::vector<int> invalid_depth = {0};  ///< raw values that are no measurement
  std::shared_ptr<const Video> video;    ///< of frames with video_frame
  int min_confidence = 0;                ///< depth of less does not count as measured
  Distortion depth_distortion, color_distortion;
  std::vector<FrameFiles> frames;
};

/// A recording whose frames are listed when it is opened.
class FrameListRecording : public Recording {
 public:
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return frames_.size(); }
  TimeNs time_of(size_t i) const override { return frames_.at(i).time_ns; }
  int64_t index_of(size_t i) const override { return frames_.at(i).index; }
  std::optional<Isometry3d> pose_of(size_t i) const override { return frames_.at(i).map_from_camera; }

 protected:
  RecordingInfo info_;
  std::vector<FrameFiles> frames_;
};

/// Of a folder whose poses are in a frame "world" of which nothing is known.
FileRecordingContent content_in_world(const std::string& format, const std::filesystem::path& folder,
                                      bool time_assumed);

/// Sorts frames by time and fills in what can be told from them: counts, times, what is odd.
void complete_info(RecordingInfo& info, std::vector<FrameFiles>& frames);

/// A recording of single image files.
class FileRecording : public Recording {
 public:
  /// Sorts by time, checks heads, tails and sizes of all images, and completes info.
  explicit FileRecording(FileRecordingContent content);

  const RecordingInfo& info() const override { return content_.info; }
  size_t size() const override { return content_.frames.size(); }
  RgbdFrame frame(size_t i) const override;
  TimeNs time_of(size_t i) const override { return files(i).time_ns; }
  int64_t index_of(size_t i) const override { return files(i).index; }
  std::optional<Isometry3d> pose_of(size_t i) const override { return files(i).map_from_camera; }
  std::string name_of(size_t i) const override { return frame_name(files(i).depth); }
  std::string color_name_of(size_t i) const override {
    return files(i).color.empty() || files(i).video_frame ? name_of(i) : frame_name(files(i).color);
  }

 private:
  const FrameFiles& files(size_t i) const;
  void check_images();
  cv::Mat depth_of(const FrameFiles& from) const;
  void set_correction();
  ImageCorrection correction_of(const FrameFiles& from) const;
  /// Of the first image that can be read.
  std::optional<cv::Mat> first_depth() const;

  FileRecordingContent content_;
  std::vector<float> metres_from_raw_;  ///< by raw value, NaN = no measurement
  ImageCorrection correction_;
};

/// Reads the images of a frame whose camera is set; what cannot be read becomes its damage.
void read_images(RgbdFrame& frame, const std::function<cv::Mat()>& depth,
                 const std::function<cv::Mat()>& color);

/// A line for RecordingInfo::problems where no room looks like this depth image (metres): its unit is
/// probably another one. Empty otherwise.
std::string implausible_because(const cv::Mat& depth);

/// Depth in metres as 16-bit values of `unit_m`; 0 where there is none, or more than 16 bits hold.
cv::Mat raw_from_depth(const cv::Mat& depth, double unit_m);

}  // namespace loci::mapping
