#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "perception/classification/local_features.h"
#include "perception/classification/primitive_shape.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Which object each pixel of the depth image shows: 0 = none, n = the scene's n-th cluster (from 1), or
/// the number that `numbers` gives that cluster (0 = leave out).
cv::Mat label_image(const types::SceneCas& scene, const std::vector<int>& numbers = {});

/// The memory's numbers of the scene's clusters (from their TrackingAnnotation); 0 = not known to be an
/// object.
std::vector<int> tracked_numbers(const types::SceneCas& scene);

/// What the surest annotator takes the object for: "cup"; empty = nobody is sure.
std::string class_of(const types::Cluster& cluster);

/// Writes FOLDER/FRAME_label.png (16 bit), FRAME being the frame's name: "learn33" for learn33_depth.png.
void write_label_image(const types::SceneCas& scene, const std::filesystem::path& folder,
                       const std::vector<int>& numbers = {});

/// Writes FOLDER/FRAME.png: the colour image with the clusters in colours, their boxes and numbers.
void write_overlay(const types::SceneCas& scene, const std::filesystem::path& folder, bool keep_people);

/// Label images (FRAME_label.png) anywhere in a folder, by the names of their frames.
std::map<std::string, std::filesystem::path> find_label_images(const std::filesystem::path& folder);

/// CV_16U: 0 = not judged, 1 to 19 = the table, from 20 on label / 10 is the object. Error when it is no
/// image with one channel.
cv::Mat read_label_image(const std::filesystem::path& path);

/// The number at the end of a frame's name ("learn07", "frame-000012"), which tables call its scene; -1 =
/// none.
int64_t scene_number(const std::string& frame_name);

/// A cluster that was found, and what it is.
struct LabelledSurface {
  std::string frame;
  std::string label;
  int object = 0;  ///< its label, rounded down to tens
  ObjectView view;
  Ground ground;  ///< what it stands on, camera frame
};

/// A recording whose images are labelled.
struct LabelledRecording {
  std::shared_ptr<mapping::Recording> recording;
  /// The label image of a frame; empty = the frame has none.
  std::function<cv::Mat(const std::string& frame)> labels;
  /// Class of an object (label rounded down to tens) of a frame; "" = nobody knows.
  std::function<std::string(const std::string& frame, int object)> class_of;
};

/// A folder with a recording, label images and objects.csv with the columns scene (scene_number()),
/// label_group (label rounded down to tens), and class or object: what it is.
LabelledRecording open_labelled_recording(const std::filesystem::path& folder);

/// A folder with a recording, label images and scenes.csv (scene, category): all objects of a scene have the
/// class of its category, "" = they are left out.
LabelledRecording open_labelled_recording_by_scene(
    const std::filesystem::path& folder,
    const std::function<std::string(const std::string& category)>& class_of_category);

/// Objects of labelled frames whose class is known.
struct LabelledSurfaces {
  std::vector<LabelledSurface> found;  ///< those that the tabletop pipeline finds
  size_t objects = 0;                  ///< all
};

/// An object of an image whose class is known.
struct LabelledPart {
  std::string label;
  cv::Mat mask;  ///< CV_8U, 255 = the object
};

/// Those of a frame, in the order of their labels.
std::vector<LabelledPart> labelled_parts(const LabelledRecording& labelled, const std::string& frame);

/// The flow that finds objects on a table.
inline constexpr const char* kTabletopFlow = "[NormalEstimator, PlaneClusterExtractor]";
/// The same with what is too low to be separated by height, as in the default pipeline.
inline constexpr const char* kObjectFlow = "[NormalEstimator, PlaneClusterExtractor, FlatObjectExtractor]";

/// Runs a flow (without a map) and gives each cluster the class of the object with which it shares most
/// pixels, at least half of both together.
LabelledSurfaces labelled_surfaces(const LabelledRecording& labelled, Progress& progress, Warnings& warnings,
                                   const std::string& flow = kTabletopFlow);

}  // namespace loci::perception
