#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/kinect.h"
#include "mapping/simulation/models.h"

namespace loci::mapping {

/// One change of the world before a scene is recorded.
struct Action {
  enum class Kind { place, remove, open, recolor, turn };
  Kind kind = Kind::place;
  std::string subject;         ///< object; for open: joint, its link, or a drawer's name
  std::string support;         ///< place: a link or an object; "" = where it stands
  bool inside = false;         ///< place: support is a drawer's name and its inside is meant
  std::optional<Vector2d> at;  ///< place: metres in the frame of the support's top; unset = its middle
  std::optional<double> yaw;   ///< place: radians about the support's z; turn: by how much
  bool lying = false;          ///< place: on its side
  double position = 0;         ///< open: metres or radians
  std::optional<Rgba> color;   ///< recolor
  std::optional<Rgba> accent;  ///< recolor
  FileLocation location;       ///< in the file
};

/// One step of the scenario: its changes, then the views that are recorded.
struct SceneSpec {
  TimeNs time_ns = 0;
  std::vector<Action> actions;
  std::vector<Isometry3d> map_from_camera;  ///< one per frame
};

/// The input of `loci-simulate record`.
struct Scenario {
  std::filesystem::path file;
  std::filesystem::path world;
  KinectModel sensor;
  RgbdCamera camera;
  std::optional<double> floor;      ///< height of a floor to add to a world that has none
  std::string time_zone = "UTC";    ///< of the clocks in the room
  TimeNs frame_interval = kSecond;  ///< between the frames of one scene
  std::map<std::string, ObjectSpec> objects;
  std::vector<SceneSpec> scenes;
};

/// Reads a scenario strictly. Error with file, line and key for unknown keys, objects that are not declared,
/// times that go back, views that are missing.
Scenario read_scenario(const std::filesystem::path& path);

/// A camera at `from` that looks at `at`, both in the map frame, upright.
Isometry3d looking_at(const Vector3d& from, const Vector3d& at);

}  // namespace loci::mapping
