#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"

namespace loci::memory::belief {

/// A box along the axes of its frame, metres.
struct AxisBox {
  Vector3d centre = Vector3d::Zero();
  Vector3d size = Vector3d::Zero();

  Vector3d low() const { return centre - size / 2; }
  Vector3d high() const { return centre + size / 2; }
  double volume() const { return size.prod(); }

  template <class Archive>
  void archive(Archive& fields) {
    fields(centre, size);
  }
};

/// Volume that two boxes share, m³.
double shared_volume(const AxisBox& a, const AxisBox& b);
/// The smallest box around both.
AxisBox join(const AxisBox& a, const AxisBox& b);

/// What can be compared about how something looks: the numbers of one annotation, and of which kind they are.
/// Two descriptors are comparable when kind and length agree.
struct Descriptor {
  std::string kind;  ///< e.g. "color_histogram"; distances are looked up by it (similarity.h)
  std::vector<float> values;
  std::vector<std::string> names = {};  ///< what each value is about ("mug"); empty = its index says it

  template <class Archive>
  void archive(Archive& fields) {
    fields(kind, values, names);
  }
};

/// One object hypothesis of a scene, as far as identity is concerned.
struct Observation {
  int64_t id = 0;                 ///< of the memory's row; 0 = not stored
  AxisBox box;                    ///< of the visible points, map frame
  bool sized = true;              ///< the box has the thing's size; otherwise only its centre was measured
  std::optional<double> sigma_m;  ///< of the centre per axis, where the detector says it
  double range = 1;               ///< z-depth of the centre, metres
  bool partial = false;  ///< cut off by the image border or by something in front: centre and size are biased
  int points = 0;
  std::string place;  ///< what it stands on; empty = unknown
  std::vector<Descriptor> descriptors;

  template <class Archive>
  void archive(Archive& fields) {
    fields(id, box, sized, sigma_m, range, partial, points, place, descriptors);
  }
};

/// How much of a place somebody looked at.
struct ObservedPlace {
  std::string name;
  double fraction = 1;  ///< of its surface, in [0,1]

  template <class Archive>
  void archive(Archive& fields) {
    fields(name, fraction);
  }
};

/// What the camera measured and where it was. Other systems tell their detections without depth, often
/// without a camera too: then only what they say about places, or else the camera's view, tells where they
/// looked.
struct SceneView {
  bool has_camera = true;                              ///< camera and pose are known
  std::optional<std::vector<ObservedPlace>> observed;  ///< of a view without depth, where they said it
  mapping::PinholeCamera camera;
  Isometry3d map_from_camera = Isometry3d::Identity();
  cv::Mat depth;  ///< CV_32F, metres, NaN = no measurement
  cv::Mat
      map_depth;  ///< CV_32F, what the map alone would measure (joints included), NaN = nothing; may be empty
  cv::Mat labels;       ///< CV_32S, index of the observation that a pixel belongs to, -1 = none; may be empty
  double near_m = 0.3;  ///< what the sensor can measure at all
  double far_m = 5.0;
};

/// Where a place is now. A drawer's bottom moves with its joint, and what lies on it moves along.
struct PlacePose {
  std::string name;
  Isometry3d map_from_place = Isometry3d::Identity();

  template <class Archive>
  void archive(Archive& fields) {
    fields(name, map_from_place);
  }
};

/// Everything that the belief is told about one moment.
struct Scene {
  TimeNs time = 0;
  std::optional<double> seconds_to_next;  ///< until the next scene of the recording, where that is known
  SceneView view;
  std::vector<Observation> observations;
  std::vector<PlacePose> places;  ///< places that are not listed stand still in the map
};

}  // namespace loci::memory::belief
