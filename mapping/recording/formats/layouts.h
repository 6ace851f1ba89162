#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/config.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/file_recording.h"
#include "mapping/recording/stamped_poses.h"

// One reader per layout of recordings, and what several layouts share.

namespace loci::mapping {

/// Reads our own layout: recording.yaml, frames.csv, and if they are there joints.csv and transforms.csv.
FileRecordingContent read_loci_layout(const std::filesystem::path& folder);

/// Fields of a pinhole camera from a map (width, height, fx, fy, cx, cy); the caller finishes the map.
PinholeCamera read_pinhole(const Config& config);

/// Whether a folder holds a sequence in the layout of 7-Scenes (*.depth.png, or of another kDepthEndings).
bool is_seven_scenes(const std::filesystem::path& folder);

/// Reads *.depth.*, *.color.*, *.pose.txt (4x4, camera to world); cameras.yaml and world_to_map.txt beside
/// them or one folder above. Without cameras.yaml the cameras are taken as a Kinect's.
FileRecordingContent read_seven_scenes(const std::filesystem::path& folder);

/// Whether a folder has the lists of the TUM RGB-D benchmark: depth.txt, and rgb.txt or groundtruth.txt; or
/// associations.txt.
bool is_tum(const std::filesystem::path& folder);

/// Reads the TUM RGB-D layout: `depth.txt` and `rgb.txt` (stamp, file), `groundtruth.txt` (stamp, x y z qx qy
/// qz qw of the colour camera, with which depth is registered). Each depth image takes the nearest colour
/// image and the pose at its time.
FileRecordingContent read_tum(const std::filesystem::path& folder, double color_delay_s = 0);

/// Lines of stamp, x y z qx qy qz qw, ascending in time; lost poses are left out.
std::vector<StampedPose> read_tum_poses(const std::filesystem::path& path);

/// "the poses go from … to …, " for messages; empty without any.
std::string range_of(const std::vector<StampedPose>& poses);
inline constexpr const char* kNoPoseHere = "no frame of the recording has a pose here";

/// A pose with the number of its frame as it stands before it, -1 = none; unset for a lost frame.
struct NumberedPose {
  int64_t number = -1;
  std::optional<Isometry3d> pose;
};

/// Poses of a trajectory.log as Redwood and Open3D write it, camera to world.
std::vector<NumberedPose> read_trajectory_log(const std::filesystem::path& path);

/// Poses of `count` frames: as many in their order, or fewer, whose numbers count the frames. Unset when they
/// are neither.
std::optional<std::vector<std::optional<Isometry3d>>> poses_in_order(
    const std::vector<NumberedPose>& numbered, size_t count);

/// Whether a path is a point cloud, or a folder with clouds and no scan set.
bool is_pcd_series(const std::filesystem::path& path);

/// Organised point clouds (width x height, x y z, optionally rgb or rgba), one file per frame in order of
/// name, seen by one camera whose pinhole is fitted to the first cloud. Clouds with z backwards and y up are
/// turned into the optical frame. Stamps are seconds, or nanoseconds, in the names ("1305031102.160407.pcd"),
/// otherwise made up. A pose is read from NAME.pose.txt (4 x 4); VIEWPOINT is none: recorders leave it at
/// whatever they like.
class PcdSeries : public FrameListRecording {
 public:
  explicit PcdSeries(const std::filesystem::path& path);

  RgbdFrame frame(size_t i) const override;

 private:
  void find_frames(const std::filesystem::path& path);
  void fit_camera();
  /// Depth of a cloud, and its colours where it has some.
  cv::Mat images_of(const FrameFiles& from, cv::Mat& color) const;

  bool backwards_ = false;  ///< z points backwards and y up
};

/// A folder with images in color/ (or image/, rgb/) and depth/: Open3D and Redwood (camera_intrinsic.json,
/// trajectory.log), exports of ScanNet (intrinsic/, pose/). Depth is registered with colour, in millimetres.
bool is_redwood(const std::filesystem::path& folder);
FileRecordingContent read_redwood(const std::filesystem::path& folder);

/// Replica as NICE-SLAM renders it: results/frame*.jpg, results/depth*.png, traj.txt, cam_params.json.
bool is_replica(const std::filesystem::path& folder);
FileRecordingContent read_replica(const std::filesystem::path& folder);

/// transforms.json of nerfstudio, with depth_file_path: exports of Polycam and Record3D through
/// ns-process-data. Depth may be smaller than colour.
bool is_nerfstudio(const std::filesystem::path& folder);
FileRecordingContent read_nerfstudio(const std::filesystem::path& folder);

/// An export of Stray Scanner on an iPhone: rgb.mp4, depth/, confidence/, odometry.csv, camera_matrix.csv.
bool is_stray_scanner(const std::filesystem::path& folder);
FileRecordingContent read_stray_scanner(const std::filesystem::path& folder);

/// Error with the command that converts it, for a file of a format that is known and not read.
void refuse_foreign_format(const std::filesystem::path& file);

/// Whether sizes and focal lengths are positive and finite, sides at most 32768 and pixels at most 2^26.
bool is_usable(const PinholeCamera& camera);

/// The camera if it is usable, else Error.
PinholeCamera checked_camera(const PinholeCamera& camera, const FileLocation& location);

/// A JSON number; NaN when it is none.
double number_of(const Json& json);

/// The value of a key; null where there is none, or `json` is no object.
Json member_of(const Json& json, const char* key);

/// A number of pixels; 0, which checked_camera() refuses, for what is none.
int pixels_of(double number);

/// All numbers of a text file, between blanks or commas. Error when there are other words, or fewer than
/// `min_count` numbers.
std::vector<double> numbers_in(const std::filesystem::path& path, size_t min_count);

/// A pose; unset for that of a frame that was lost: values that are not finite, or a rotation of zeros. Error
/// for any other matrix or vector that does not describe a pose.
std::optional<Isometry3d> pose_unless_lost(const std::array<double, 7>& values, const FileLocation& location);
std::optional<Isometry3d> pose_unless_lost(const Eigen::Matrix4d& matrix, const FileLocation& location);

/// The same from the 16 numbers of a 4 x 4 matrix, row by row.
std::optional<Isometry3d> pose_from_rows(const std::vector<double>& rows, const FileLocation& location);

/// Files of depth images in a folder whose names begin so, by number. Of several kinds the one is taken of
/// which there are `count` files, or the most; of equally many the first of kDepthEndings.
std::vector<std::filesystem::path> depth_images_in(const std::filesystem::path& folder, size_t count,
                                                   const std::string& begin = {});

/// Metres per unit of floating-point depth: the value of a key, or 1.
double float_scale_of(const Config& config, const char* key);

/// A file beside the images or one folder above; empty when there is none.
std::filesystem::path beside_or_above(const std::filesystem::path& folder, const char* name);

/// A 4 x 4 matrix of 16 numbers; unset for a lost frame. Error when they are no pose.
std::optional<Isometry3d> read_pose_file(const std::filesystem::path& path);

/// The camera of the same lens for images of another size.
PinholeCamera scaled_camera(const PinholeCamera& camera, int width, int height);

/// Cameras that were assumed, or described for colour only, for images of another size and the same aspect.
void fit_cameras_to_images(FileRecordingContent& content);

/// cameras.yaml: `depth` with size, f, c (unless the layout knows a camera that is to be kept) and optionally
/// `unit_m`, `float_unit_m` and `invalid`, optional `color` and `color_from_depth` (R, t). Fills cameras,
/// depth scale and invalid values. Returns whether it describes the camera.
bool read_cameras(const std::filesystem::path& path, FileRecordingContent& content);

}  // namespace loci::mapping
