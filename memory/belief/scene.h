#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"

namespace loci::memory::belief {

/// Axis-aligned box in its frame, metres.
struct AxisBox {
  Vector3d centre = Vector3d::Zero();
  Vector3d size = Vector3d::Zero();

  Vector3d low() const { return centre - size / 2; }
  Vector3d high() const { return centre + size / 2; }
  double volume() const { return size.prod(); }
};

/// Volume of the intersection, m³.
double shared_volume(const AxisBox& a, const AxisBox& b);
/// Bounding box of both.
AxisBox join(const AxisBox& a, const AxisBox& b);

/// Numbers of one annotation that describe appearance. Two descriptors are comparable when kind and length
/// agree.
struct Descriptor {
  std::string kind;  ///< e.g. "color_histogram"; selects the metric (similarity.h)
  std::vector<float> values;
  std::vector<std::string> names = {};  ///< per value, e.g. "mug"; empty = the index identifies the value
};

/// A key point on the surface of an object with its descriptor: RootSIFT (Arandjelovic and Zisserman, CVPR
/// 2012) in four bits per value, two values per byte.
struct SurfaceKeypoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m
  float diameter_m = 0;                                ///< of the neighbourhood that is described
  std::array<uint8_t, 64> descriptor{};
};
using Texture = std::vector<SurfaceKeypoint>;

/// One object hypothesis of a scene, as far as data association is concerned.
struct Observation {
  int64_t id = 0;                 ///< of the memory's row; 0 = not stored
  AxisBox box;                    ///< of the visible points, map frame
  bool has_size = true;           ///< false: only the centre was measured
  std::optional<double> sigma_m;  ///< of the centre per axis, where the detector reports it
  double range = 1;               ///< z-depth of the centre, metres
  bool partial = false;           ///< cut off by the image border or occluded: centre and size are biased
  int points = 0;
  std::string place;  ///< supporting place; empty = unknown
  std::vector<Descriptor> descriptors;
  Texture texture;  ///< positions in the map frame; empty without depth or print on the object
  /// Which object it is of where that is settled beforehand, by people or by an earlier decision; 0 = a false
  /// cluster, -1 = a new object. Of two observations with a number, equal ones are of one object and
  /// different ones are not.
  std::optional<int64_t> known_object = {};
  int64_t former_object = 0;  ///< number of an object that it founds, unless another has it; 0 = a new one
};

/// Observed part of a place.
struct ObservedPlace {
  std::string name;
  double fraction = 1;  ///< of its surface, in [0,1]
};

/// What the camera measured, and from where. Foreign detectors report no depth and often no camera: then the
/// observed places they report, or else the view frustum, define what was observed.
struct SceneView {
  bool has_camera = true;                              ///< camera and pose are known
  std::optional<std::vector<ObservedPlace>> observed;  ///< of a view without depth, where reported
  mapping::PinholeCamera camera;
  double sensor_pixels = 1;  ///< of the sensor per pixel of `camera`: a stored depth image is smaller
  Isometry3d map_from_camera = Isometry3d::Identity();
  cv::Mat depth;        ///< CV_32F, metres, NaN = no measurement
  cv::Mat map_depth;    ///< CV_32F, depth of the map alone (joints included), NaN = nothing; may be empty
  cv::Mat labels;       ///< CV_32S, index of the observation of each pixel, -1 = none; may be empty
  double near_m = 0.3;  ///< measuring range of the sensor
  double far_m = 5.0;
};

/// Current pose of a place. Objects in a drawer move with its joint, those on furniture with it.
struct PlacePose {
  std::string name;
  Isometry3d map_from_place = Isometry3d::Identity();
  bool known = true;  ///< false: it has been moved away from there, and nothing on it is observed
};

/// Identity for places that are not listed.
const Isometry3d& place_pose(const std::string& place, const std::vector<PlacePose>& places);
/// True for places that are not listed.
bool is_place_known(const std::string& place, const std::vector<PlacePose>& places);

/// Input of the belief: one moment.
struct Scene {
  TimeNs time = 0;
  std::optional<double> seconds_to_next;  ///< until the next scene of the recording, where known
  SceneView view;
  std::vector<Observation> observations;
  std::vector<PlacePose> places;  ///< places that are not listed are static in the map
};

}  // namespace loci::memory::belief
