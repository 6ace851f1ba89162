#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gui/core/colored_cloud.h"
#include "gui/core/text.h"
#include "gui/data/question_answers.h"
#include "mapping/base/pose.h"
#include "mapping/base/progress.h"
#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/pixel_kind.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::gui {

/// One object as believed at one time.
struct BelievedObject {
  int64_t id = 0;
  std::string name;        ///< for people: "object_12", or what they called it
  std::string class_name;  ///< empty = unknown
  std::string owner;       ///< empty = unknown
  std::string color_name;  ///< empty = unknown
  std::string place;       ///< link of the map or plane; empty = unknown. Of a gone object: the last one
  Presence presence = Presence::seen;
  double probability = 1;                     ///< that it is there, in [0,1]
  std::optional<Isometry3d> map_from_object;  ///< centre and axes of the box
  Vector3d size = Vector3d::Zero();           ///< full extents along its axes, metres
  std::array<uint8_t, 3> rgb = {160, 160, 160};
  std::optional<TimeNs> last_seen;
};

/// Everything that is believed at one time.
struct BelievedScene {
  TimeNs time = 0;
  std::vector<BelievedObject> objects;
  JointState joints;

  const BelievedObject* find(int64_t object) const;
};

struct SceneEntry {
  int64_t id = 0;
  TimeNs time = 0;
  std::string name;
  std::optional<Isometry3d> map_from_camera;
};

/// Something that happened, for the time bar and the card.
struct EventEntry {
  TimeNs time = 0;
  std::string kind;    ///< appeared, moved, looks_different, gone, hidden, joint, …
  int64_t object = 0;  ///< 0 = of no object
  std::string text;    ///< for people
};

/// Something that happened to an object.
struct HistoryEntry {
  TimeNs from = 0;
  std::string place;
  std::string what;
  double probability = 1;
};

/// An object as it was found in an image.
struct ImageBox {
  int64_t object = 0;
  int64_t number = 0;  ///< of the observation within its scene
  std::string name;    ///< empty = of no object
  cv::Rect2d color;    ///< pixels of the colour image
  cv::Rect2d depth;    ///< pixels of the depth image
  /// Around what belongs to it, in pixels of either image; empty = no mask was kept.
  std::vector<std::vector<cv::Point2f>> color_outline = {}, depth_outline = {};
};

/// What was recorded of one scene.
struct SceneContent {
  SceneEntry scene;
  cv::Mat color;  ///< CV_8UC3, BGR; empty = not kept
  cv::Mat depth;  ///< CV_32F, metres, NaN = no measurement; may be smaller than the camera's image
  mapping::RgbdCamera camera;
  std::optional<Isometry3d> map_from_camera;
  cv::Mat kinds = {};  ///< CV_8U of depth's size, mapping::PixelKind; empty = not known
  std::vector<ImageBox> boxes;
};

/// Where an object was seen.
struct TracePoint {
  TimeNs time = 0;
  Vector3d position = Vector3d::Zero();  ///< of its centre, map frame
};

/// What one scene could tell about an object or a place.
enum class Look : uint8_t {
  nothing,  ///< not observed: out of view, or behind something
  seen,     ///< the object was seen; any of the place was
  missed    ///< the object's place was seen without it
};

/// What words mean.
struct FoundThings {
  std::vector<int64_t> objects;  ///< most probable first; empty when it is a place
  std::string place;
};

/// A place that is no link of a map.
struct PlaceOutline {
  std::string name;
  std::vector<Vector2d> outline;  ///< map frame
  double height = 0;              ///< metres
};

/// A moment at which the memory knew less than now, or otherwise: before a run added to it.
struct KnownState {
  TimeNs known_at = 0;
  std::string before = {};  ///< "before loci-memory edit (object_3 is object_2)"
};

struct MemoryInfo {
  std::string path;
  std::string schema;    ///< "1.0"
  int zone_minutes = 0;  ///< east of UTC, for showing times
  bool time_assumed = false;
  std::string summary;  ///< one line: scenes, objects, time span
  size_t runs = 0;      ///< that wrote to it; while these are the same, it only grows at its end
  std::vector<KnownState> known = {};  ///< what can be gone back to, the oldest first
};

struct SceneDecisions;
struct ObjectDetails;
struct ImageNote;

/// What the browser shows, as plain values. The views know no database; tests may give them any memory.
/// What stands before "Reading" is at hand; what stands after it takes time, may be called from any thread
/// and throws Error.
class BrowserData {
 public:
  virtual ~BrowserData() = default;

  virtual const MemoryInfo& info() const = 0;
  /// In the order of time.
  virtual const std::vector<SceneEntry>& scenes() const = 0;
  /// In the order of time.
  virtual const std::vector<EventEntry>& events() const = 0;
  /// The map; nullptr when the memory was made without one. The same one when the memory has only grown.
  virtual const mapping::World* world() const = 0;
  /// Places that the map does not draw, or all where there is none.
  virtual const std::vector<PlaceOutline>& loose_places() const = 0;
  /// Where the map's meshes are looked for.
  virtual mapping::MeshSearch mesh_search() const { return {}; }
  /// The last scene at or before `time`, else the first; nullptr when there are none.
  const SceneEntry* scene_at(TimeNs time) const;

  // ---- Reading.

  /// The same memory after its file has changed; what is new is read, what is old is taken over. Interrupted
  /// when it is told to stop.
  virtual std::unique_ptr<BrowserData> renewed(Progress& progress) const = 0;
  /// What is believed of a time; with `known_at` as it was known then.
  virtual BelievedScene belief_at(TimeNs time, std::optional<TimeNs> known_at = {}) const = 0;
  /// How identities were decided in a scene and up to `count` - 1 scenes before it, in the order of time.
  virtual std::vector<SceneDecisions> decisions(int64_t scene, size_t count) const = 0;
  virtual ObjectDetails details(int64_t object, TimeNs time) const = 0;
  virtual SceneContent scene(int64_t id) const = 0;
  /// What annotators found in parts of a scene's image.
  virtual std::vector<ImageNote> notes(int64_t scene) const = 0;
  virtual std::vector<HistoryEntry> history(int64_t object) const = 0;
  /// Times at which the object was observed.
  virtual std::vector<TimeNs> observations(int64_t object) const = 0;
  /// Where the object was seen, in the order of time; where it stayed, once.
  virtual std::vector<TracePoint> trace(int64_t object) const = 0;
  /// The points of an object in the scene that saw it last at a time, map frame: as the depth camera measured
  /// them where the memory keeps them, else coarser. Empty when there are none. With `known_at` of the scene
  /// that was known then to have seen it.
  virtual ColoredCloud object_cloud(int64_t object, TimeNs time,
                                    std::optional<TimeNs> known_at = {}) const = 0;
  /// What each of scenes() from a number on could tell about an object, in their order.
  virtual std::vector<Look> looks_for_object(int64_t object, size_t first_scene = 0) const = 0;
  virtual std::vector<Look> looks_at_place(const std::string& place, size_t first_scene = 0) const = 0;
  /// The newest image of an object at or before a time (CV_8UC3, BGR); empty when there is none.
  virtual cv::Mat image(int64_t object, TimeNs time) const = 0;

  /// A time as people write it: "2026-05-01 08:30", "08:30", "yesterday 9:00". Where it covers a while, its
  /// last scene. Error that shows what can be written.
  virtual TimeNs time_of(const std::string& text) const = 0;
  /// What words mean at a time: "object_12", an alias, "red", "on table_1", or a place. Error with the
  /// nearest names when they mean nothing.
  virtual FoundThings find(const std::string& words, TimeNs time) const = 0;

  /// Questions in words.
  virtual TypedAnswer answer(const TypedQuestion& question) const = 0;
  virtual std::vector<std::string> example_questions() const = 0;
  virtual std::vector<std::string> known_words() const = 0;
};

}  // namespace loci::gui
