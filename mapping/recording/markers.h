#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/sensor/frame.h"

namespace loci::mapping {

/// What a viewer draws over a recording: one marker of visualization_msgs.
struct Marker {
  enum class Shape { box = 1, text = 9, triangles = 11 };  ///< numbers of visualization_msgs/Marker
  using Color = Eigen::Vector4f;                           ///< red, green, blue, alpha in [0,1]

  std::string group;  ///< namespace: viewers show and hide groups
  int id = 0;         ///< unique within the group
  Shape shape = Shape::box;
  Isometry3d map_from_marker = Isometry3d::Identity();
  Vector3d size = Vector3d::Ones();      ///< box: full extents; text: z is the height of a capital; metres
  Color color = {0.7F, 0.7F, 0.7F, 1};   ///< of box and text
  std::string text = {};                 ///< of a text
  std::vector<Vector3d> points = {};     ///< of triangles: three corners each, marker frame
  std::vector<Color> point_colors = {};  ///< of triangles: one per point
};

/// A topic of markers over a recording.
struct MarkerLayer {
  std::string topic;
  /// All markers at the time of a frame; unset when they are those of the frame before. Frames come in order.
  std::function<std::optional<std::vector<Marker>>(const RgbdFrame& frame)> at;
};

}  // namespace loci::mapping
