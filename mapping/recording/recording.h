#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/sensor/frame.h"

namespace loci::mapping {

/// What a reader found and what it had to guess.
struct RecordingInfo {
  std::string format;  ///< "loci", "7-scenes", "tum", "rosbag", "rosbag2", "pcd"
  std::string path;
  std::string map_frame;  ///< frame of the poses; "" when there are none
  RgbdCamera camera;
  /// Names of all depth cameras of a bag, the one that is read first; a recording is of one camera. Empty for
  /// layouts that hold only one.
  std::vector<std::string> camera_names = {};
  bool levelled = true;                                ///< z of the map frame is known to be up
  Isometry3d map_from_input = Isometry3d::Identity();  ///< what moved the poses after they were read
  std::optional<Vector3d> up_in_camera;  ///< unit, in the first frame's camera, measured by an IMU
  size_t frames = 0;
  size_t frames_with_pose = 0;
  double depth_unit_m = 0.001;  ///< resolution of depth as it is stored
  TimeNs first_time = 0;
  TimeNs last_time = 0;
  bool time_assumed = false;          ///< the stamps were made up
  std::string time_zone;              ///< of the clocks where it was recorded; "" when it does not say
  std::vector<std::string> guesses;   ///< e.g. "no cameras.yaml: Kinect intrinsics assumed"
  std::vector<std::string> problems;  ///< what is odd but can be lived with, with the row or file
};

Json to_json(const RecordingInfo& info);

/// What a recording does not say about itself. The defaults suit most.
struct RecordingOptions {
  std::string camera;
  std::string topics;
  std::string poses;
  std::string up = "auto";
  double color_delay_s = 0;
  double seconds_apart = 0;
  std::string start;

  void declare(OptionTable& table);
};

/// Posed RGB-D frames in order of time, whatever the files look like. Opening checks what can be checked
/// without reading images; a frame is read when it is asked for.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual const RecordingInfo& info() const = 0;
  virtual size_t size() const = 0;
  /// Frame number `i` in [0, size()), not its index in the recording. An image that is missing or broken is
  /// left out, and RgbdFrame::damage says why: one of thousands does not end a run.
  virtual RgbdFrame frame(size_t i) const = 0;
  /// Time and index without reading images.
  virtual TimeNs time_of(size_t i) const = 0;
  virtual int64_t index_of(size_t i) const = 0;
  /// RgbdFrame::map_from_camera, where possible without reading images.
  virtual std::optional<Isometry3d> pose_of(size_t i) const { return frame(i).map_from_camera; }
  /// RgbdFrame::name, where possible without reading images.
  virtual std::string name_of(size_t i) const { return frame(i).name; }
  /// The same of its colour image, where that has a name of its own.
  virtual std::string color_name_of(size_t i) const { return name_of(i); }
};

/// Opens a folder or file of any known layout, guessed from what is there. Error that says what was looked
/// for when nothing fits. `progress`, where there is one, is of unpacking a bag that is compressed as a
/// whole.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path,
                                          const RecordingOptions& options = {}, Progress* progress = nullptr);

struct RecordingWriterOptions {
  bool time_assumed = false;   ///< the stamps were made up
  std::string time_zone = {};  ///< of the clocks where it was recorded, TimeZone::named; empty = unknown
  double depth_unit_m = 0.001;
  std::vector<std::filesystem::path> inputs = {};  ///< what the same command reads; never replaced
  bool force = false;                              ///< may replace a recording that loci did not write
};

/// Writes our own layout. Everything goes to a private neighbour of the folder, which takes the folder's name
/// at finish(): until then, and when finish() is never reached, what was there before stays.
class RecordingWriter {
 public:
  /// Error when the folder is or contains an input, or holds anything but what a RecordingWriter wrote (an
  /// older recording is replaced; by force any folder with a recording.yaml).
  RecordingWriter(const std::filesystem::path& folder, const RgbdCamera& camera, std::string map_frame,
                  RecordingWriterOptions options = {});
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Depth is stored as 16-bit PNG; colour, if there is any, as PNG. Frames come in order of time.
  void add(const RgbdFrame& frame);
  /// A further file of the recording, e.g. truth.jsonl; folders in its name are made.
  void add_file(const std::string& name, std::string_view bytes);
  void finish();

 private:
  void replace_folder();

  std::filesystem::path folder_;
  std::filesystem::path partial_;
  RgbdCamera camera_;
  std::string map_frame_;
  RecordingWriterOptions options_;
  std::vector<std::string> files_;  ///< written so far, relative to the folder
  std::string frames_csv_;
  std::string joints_csv_;
  JointState joints_;
};

}  // namespace loci::mapping
