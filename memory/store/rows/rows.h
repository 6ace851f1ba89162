#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "memory/identity/states.h"

namespace loci::memory {

/// Row id in the memory. Object 12 is "object_12" for people.
using Id = int64_t;

// The rows of memory/store/schema.sql, which defines units and meanings. An unset optional is NULL. The store
// fills in `id`, `known_from`, `known_to` and `run` when a row is added.
//
// `kTable` is the table or view from which rows are read. All fields have initializers, so that a row can be
// written as {.scene = 3, .status = ObjectStatus::seen}.

struct RunRow {
  static constexpr const char* kTable = "run";
  Id id = 0;
  std::string program = {};
  std::string version = {};
  std::string configuration = "{}";  ///< JSON
  TimeNs started = 0;
  std::optional<TimeNs> finished = {};
};

struct RecordingRow {
  static constexpr const char* kTable = "recording";
  Id id = 0;
  std::string fingerprint = {};  ///< content_hash() of its list of frames
  std::string name = {};
  std::string kind = {};
  bool time_assumed = false;
  std::optional<int64_t> frames = {};
};

struct MapRow {
  static constexpr const char* kTable = "map";
  Id id = 0;
  std::string hash = {};
  std::string name = {};
  Id urdf = 0;                     ///< blob
  std::optional<Id> sidecar = {};  ///< blob
};

struct PlaceRow {
  static constexpr const char* kTable = "place";
  Id id = 0;
  std::string name = {};
  std::string class_name = {};
  std::optional<Id> map = {};
  std::optional<double> height = {};
  std::vector<Vector2d> outline = {};  ///< map frame; empty = unknown
  std::optional<Isometry3d> map_from_place = {};
  bool container = false;  ///< objects are in it rather than on it
  std::optional<std::string> joint = {};
};

struct SceneCamera {
  int width = 0, height = 0;  ///< pixels, depth camera
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::optional<double> range_min = {}, range_max = {};
};

struct SceneRow {
  static constexpr const char* kTable = "scene";
  Id id = 0;
  std::optional<Id> recording = {};
  std::optional<int64_t> frame_index = {};
  TimeNs time = 0;
  std::optional<Id> map = {};
  std::optional<SceneCamera> camera = {};
  std::optional<Isometry3d> map_from_camera = {};
  std::optional<Id> depth = {};  ///< blob, see DepthThumbnail
  int depth_width = 0, depth_height = 0;
  std::optional<Id> pixel_kinds = {};  ///< blob, see PixelKindImage
  std::optional<Id> image = {};        ///< blob: JPEG or PNG
  std::map<std::string, double> joints = {};
  TimeNs known_from = 0;
  Id run = 0;
};

struct HsvColor {
  double hue = 0;         ///< 0 to 360
  double saturation = 0;  ///< 0 to 1
  double value = 0;       ///< 0 to 1
};

struct ObservationRow {
  static constexpr const char* kTable = "observation";
  Id id = 0;
  Id scene = 0;
  int64_t number = 0;  ///< within the scene, from 0
  std::optional<Id> place = {};
  std::optional<Vector3d> position = {};  ///< centre, map frame
  std::optional<Isometry3d> map_from_box = {};
  std::optional<Vector3d> size = {};  ///< of the box, along its axes
  std::optional<HsvColor> hsv = {};
  std::optional<std::string> color = {};  ///< name
  std::optional<int64_t> points = {};
  std::optional<Id> crop = {};                 ///< blob
  std::optional<Id> mask = {};                 ///< blob
  std::optional<std::array<int, 4>> roi = {};  ///< x, y, width, height in the depth image
  std::optional<std::string> location = {};    ///< in words
  std::optional<Id> cloud = {};                ///< blob, see ClusterPoints
};

/// A line of the log of a scene.
struct LogRow {
  static constexpr const char* kTable = "scene_log";
  Id scene = 0;
  int64_t number = 0;  ///< within the scene, from 0
  std::string annotator = {};
  std::string level = "info";
  std::string text = {};  ///< empty = only the time
  std::optional<double> milliseconds = {};
};

/// Type of the annotations with which people label observations. Of an observation the newest holds; an empty
/// one says that it has none.
inline constexpr const char* kLabelType = "loci.Label";

struct AnnotationRow {
  static constexpr const char* kTable = "annotation_value";
  Id id = 0;
  Id scene = 0;
  std::optional<Id> observation = {};
  std::string type = {};
  std::string value = {};
  std::optional<double> confidence = {};
  std::optional<Id> feature_structure = {};
};

/// Valid time and transaction time of a row, and its source.
struct Bitemporal {
  TimeNs valid_from = 0;
  std::optional<TimeNs> valid_to = {};
  TimeNs known_from = 0;
  std::optional<TimeNs> known_to = {};  ///< when read: the effective end, by the row that supersedes it
  std::optional<Id> supersedes = {};    ///< id of the row of the same table that this one replaces
  Id run = 0;
  std::string source = "perceive";
};

struct ObjectRow {
  static constexpr const char* kTable = "object";
  Id id = 0;
  Bitemporal clock = {};  ///< valid_from = first seen
};

struct AssociationRow {
  static constexpr const char* kTable = "association";
  Id id = 0;
  Id scene = 0;
  std::optional<Id> observation = {};  ///< unset = the object was not matched
  std::optional<Id> object = {};       ///< unset = false detection
  Explanation explanation = Explanation::stay;
  double probability = 0;
  bool chosen = false;  ///< part of the MAP hypothesis
  Bitemporal clock = {};
};

struct EventRow {
  static constexpr const char* kTable = "event";
  Id id = 0;
  std::optional<Id> scene = {};
  EventKind kind = EventKind::appeared;
  std::optional<Id> object = {};
  std::optional<Id> observation = {};
  std::optional<Id> place = {};       ///< after it
  std::optional<Id> from_place = {};  ///< before it
  std::optional<Vector3d> position = {};
  std::optional<Vector3d> from_position = {};
  std::optional<std::string> joint = {};
  std::optional<double> joint_position = {};
  std::optional<double> from_joint_position = {};
  double probability = 1;
  /// It happened after this time and until clock.valid_from: since the object was seen last, or, where it
  /// came up, since its spot was seen without it.
  std::optional<TimeNs> since = {};
  Bitemporal clock = {};
};

struct BeliefRow {
  static constexpr const char* kTable = "belief";
  Id id = 0;
  Id object = 0;
  std::optional<Id> scene = {};
  ObjectStatus status = ObjectStatus::seen;
  double probability = 1;  ///< that it still is at this place
  std::optional<Id> place = {};
  std::optional<Vector3d> position = {};
  std::optional<double> sigma = {};  ///< standard deviation of the position, metres
  std::optional<Id> last_scene = {};
  std::optional<Id> last_observation = {};
  std::optional<HsvColor> hsv = {};
  std::optional<std::string> color = {};
  std::optional<Vector3d> size = {};  ///< its extents by all views; the last observation has its turn
  /// Without observations, the probability fades to this share within about this time; unset = it does not.
  std::optional<double> fade_s = {}, fade_to = {};
  std::optional<double> elsewhere = {};  ///< probability that it is elsewhere in the home if it is not here
  Bitemporal clock = {};
  // When read: `probability`, `status` and the last observation are as of the time asked about, else of the
  // latest scene, extrapolated from these.
  double probability_then = 1;  ///< at the time of the row or of the last observation after it
  TimeNs then = 0;
};

/// Extents in the order of the horizontal axes of another measurement of the same object.
Vector3d turned_as(Vector3d extents, const Vector3d& other);

/// The probability at a time, without an observation since `then`.
double faded(const BeliefRow& row, TimeNs time);

struct VisibilityRow {
  static constexpr const char* kTable = "visibility";
  Id id = 0;
  Id scene = 0;
  std::optional<Id> object = {};  ///< exactly one of object and place is set
  std::optional<Id> place = {};
  ObjectStatus status = ObjectStatus::seen;  ///< never gone
  std::optional<double> probability = {};    ///< object: that the status is right
  std::optional<double> fraction = {};       ///< place: observed part of its surface
  TimeNs time = 0;                           ///< of the scene
};

struct FactRow {
  static constexpr const char* kTable = "fact";
  Id id = 0;
  std::optional<Id> object = {};  ///< exactly one of object and place is set
  std::optional<Id> place = {};
  std::string key = {};                   ///< alias, owner, state, class, text, ...
  std::optional<std::string> value = {};  ///< unset = retracted
  std::optional<double> probability = {};
  Bitemporal clock = {};
};

/// A feature structure with everything that it refers to.
struct FeatureStructureRow {
  Id id = 0;
  std::optional<Id> scene = {};
  std::optional<Id> observation = {};
  std::string type = {};
  Id type_system = 0;
  std::string json = {};       ///< canonical
  std::vector<Id> blobs = {};  ///< that the JSON refers to by hash
};

struct BlobRow {
  Id id = 0;
  std::string hash = {};
  std::string media = {};
  std::string bytes = {};
};

/// An observation of an object by the MAP hypothesis.
struct ObjectObservation {
  AssociationRow association = {};
  ObservationRow observation = {};
  TimeNs time = 0;
  std::optional<Id> recording = {};
  std::optional<int64_t> frame_index = {};
};

}  // namespace loci::memory
