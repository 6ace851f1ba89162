#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/recording/recording.h"

namespace loci::mapping {

/// A recording with other poses than it brings along, one per frame (unset = unknown).
std::unique_ptr<Recording> with_poses(std::unique_ptr<Recording> recording,
                                      std::vector<std::optional<Isometry3d>> map_from_camera,
                                      std::string map_frame, bool is_levelled);

/// A recording whose poses, if it has any, are moved to another frame; `guess` is added to its info.
std::unique_ptr<Recording> in_frame(std::unique_ptr<Recording> recording, const Isometry3d& frame_from_map,
                                    std::string frame, const std::string& guess = {});

/// A recording in whose poses `up` is up, turned so that it is z.
std::unique_ptr<Recording> turned_upright(std::unique_ptr<Recording> recording, const Vector3d& up,
                                          std::string frame, const std::string& guess = {});

/// A recording whose stamps were made up, with its frames so far apart. Error where they were not.
std::unique_ptr<Recording> seconds_apart(std::unique_ptr<Recording> recording, double seconds);

/// A recording whose stamps were made up, begun at `start`: the made-up times between its frames stay. Error
/// where they were not made up.
std::unique_ptr<Recording> started_at(std::unique_ptr<Recording> recording, TimeNs start);

/// A recording of which is not known that z is up.
std::unique_ptr<Recording> not_levelled(std::unique_ptr<Recording> recording);

/// A recording without poses of which is known what is up in its first frame's camera.
std::unique_ptr<Recording> with_up(std::unique_ptr<Recording> recording, const Vector3d& up_in_camera);

/// A recording without the fixed error of its depth camera: what it measures minus the true inverse depth
/// (CV_32F, 1/m), over the depth image at any resolution.
std::unique_ptr<Recording> without_depth_error(std::unique_ptr<Recording> recording,
                                               const cv::Mat& inverse_depth_error);

/// Poses of a recording's frames from a file, recognised by its content; of the depth camera but for COLMAP:
///   TUM        stamp (s) x y z qx qy qz qw, taken at the time of a frame
///   KITTI      12 numbers (3 x 4, row by row) per frame
///   g2o        VERTEX_SE3:QUAT index x y z qx qy qz qw
///   COLMAP     images.txt, by name or number of the image; poses of the colour camera, without known scale
///   Redwood    trajectory.log: a line of numbers and a 4 x 4 matrix per frame
/// Error when the file is of another kind, a line is malformed, or no frame gets a pose.
std::vector<std::optional<Isometry3d>> read_poses_for(const Recording& recording,
                                                      const std::filesystem::path& file);

/// In the frame of a map that was made from poses of their frame and levelled, as its `map_from_input` says;
/// unchanged where the poses are in the frame of the map already, or there is nothing to move.
std::unique_ptr<Recording> in_map(std::unique_ptr<Recording> recording,
                                  const std::optional<Isometry3d>& map_from_input,
                                  const std::string& map_frame);

}  // namespace loci::mapping
