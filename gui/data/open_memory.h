#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "gui/core/colored_cloud.h"
#include "gui/data/memory_index.h"
#include "gui/data/question_answers.h"
#include "gui/data/scene_content.h"
#include "mapping/world/mesh.h"

namespace loci::gui {

struct ObjectDetails;
struct SceneDecisions;

/// A row of belief as of a time, with what its last observation adds.
struct BelievedObject : memory::BeliefRow {
  std::optional<Isometry3d> map_from_object;  ///< centre and axes of its box, as it is drawn
  std::optional<Vector3d> box_size;           ///< along these axes, metres
  std::optional<TimeNs> last_seen;
};
/// Red, green, blue; grey where the colour is unknown.
std::array<uint8_t, 3> rgb_of(const memory::BeliefRow& belief);

/// Everything that is believed at one time.
struct Belief {
  TimeNs time = 0;
  std::vector<BelievedObject> objects = {};  ///< by id
  JointState joints = {};
  std::shared_ptr<const mapping::World> world = {};                ///< the map at that time; null = none
  std::shared_ptr<const Names> names = std::make_shared<Names>();  ///< of the memory that it is from

  const BelievedObject* find(memory::Id object) const;
  std::string name_of(const BelievedObject& object) const { return names->object(object.object); }
  std::string place_of(const BelievedObject& object) const { return names->place(object.place); }
};

/// Where an object was seen.
struct TrajectoryPoint {
  TimeNs time = 0;
  Vector3d position = Vector3d::Zero();  ///< of its centre, map frame
};

/// What is known of a place beside what is on it.
struct PlaceDetails {
  std::optional<double> height = {};     ///< metres
  std::optional<TimeNs> last_look = {};  ///< the last scene until the time asked about that saw any of it
  double seen = 0;                       ///< the share that it saw
};

/// What a search text refers to.
struct SearchResult {
  std::vector<memory::Id> objects = {};  ///< most probable first; empty when it is a place
  std::string place = {};
};

/// One memory file, opened for reading. What stands before "Reading" is at hand; what stands after it takes
/// time, may be called from any thread and throws Error.
class OpenMemory {
 public:
  /// Error when the file is missing, broken or of a newer version, Interrupted when the progress says stop.
  static std::shared_ptr<const OpenMemory> open(const std::filesystem::path& path, Progress& progress);
  static std::shared_ptr<const OpenMemory> open(const std::filesystem::path& path);
  /// `before` (may be null) is the same file read earlier.
  OpenMemory(const std::filesystem::path& path, const MemoryIndex* before, Progress& progress);

  const MemoryInfo& info() const { return index_.info; }
  const Names& names() const { return *index_.names; }
  /// In order of time.
  const std::vector<memory::SceneRow>& scenes() const { return index_.scenes; }
  const std::vector<memory::Change>& events() const { return index_.events; }
  /// The map as of a time, else of the end; nullptr when the memory was made without one. The same one when
  /// the memory has only grown.
  const mapping::World* world(std::optional<TimeNs> time = {}) const;
  /// Where the map's meshes are looked for.
  mapping::MeshSearch mesh_search() const { return {{}, path_.parent_path()}; }
  /// Places with an outline that the map does not draw.
  const std::vector<memory::PlaceRow>& loose_places() const { return index_.loose_places; }
  /// The last scene at or before `time`, else the first; nullptr when there are none.
  const memory::SceneRow* scene_at(TimeNs time) const;

  // ---- Reading.

  /// The same memory after its file has changed: only what is new is read where that is possible. Interrupted
  /// when the progress says stop.
  std::shared_ptr<const OpenMemory> renewed(Progress& progress) const;
  /// What is believed of a time; with `known_at` as it was known then.
  Belief belief_at(TimeNs time, std::optional<TimeNs> known_at = {}) const;
  /// How identities were decided in a scene and up to `count` - 1 scenes before it, in order of time.
  std::vector<SceneDecisions> decisions(memory::Id scene, size_t count) const;
  ObjectDetails details(memory::Id object, TimeNs time) const;
  SceneContent scene(memory::Id id) const;
  /// What annotators found in parts of a scene's image.
  std::vector<ImageNote> notes(memory::Id scene) const;
  std::vector<memory::Change> history(memory::Id object) const;
  PlaceDetails place_details(const std::string& place, TimeNs time) const;
  /// Times at which the object was observed.
  std::vector<TimeNs> observations(memory::Id object) const;
  /// In order of time; where the object stayed, once.
  std::vector<TrajectoryPoint> trajectory(memory::Id object) const;
  /// The points of an object in the scene that saw it last at a time, map frame: as the depth camera measured
  /// them where they are stored, else coarser. Empty when there are none. With `known_at` of the scene that
  /// was known then to have seen it.
  ColoredCloud object_cloud(memory::Id object, TimeNs time, std::optional<TimeNs> known_at = {}) const;
  /// What each of scenes() from a number on showed of an object or a place, in their order.
  std::vector<memory::ObjectStatus> visibility_of_object(memory::Id object, size_t first_scene = 0) const;
  std::vector<memory::ObjectStatus> visibility_of_place(const std::string& place,
                                                        size_t first_scene = 0) const;
  /// The probability that what was seen last of an object, at a time at most, was this object; 1 where
  /// nothing was.
  double certainty_of_last_sighting(memory::Id object, TimeNs time, std::optional<TimeNs> known_at) const;
  /// The newest image of an object at or before a time (CV_8UC3, BGR); empty when there is none.
  cv::Mat image(memory::Id object, TimeNs time) const;

  /// A time as people write it: "2026-05-01 08:30", "08:30", "yesterday 9:00". Where it covers a while, its
  /// last scene. Error that shows what can be written.
  TimeNs time_of(const std::string& text) const;
  /// What a text refers to at a time: "object_12", an alias, "red", "on table_1", or a place. Error with the
  /// nearest names when it refers to nothing.
  SearchResult find(const std::string& text, TimeNs time) const;

  TypedAnswer answer(const TypedQuestion& question) const;
  /// Questions that this memory can answer: first about what is in it, then one of each form.
  std::vector<std::string> example_questions() const;
  /// Names that a question may be about: objects, their aliases, places, parts of the map.
  std::vector<std::string> known_words() const;

 private:
  std::shared_ptr<const mapping::World> shared_world(std::optional<TimeNs> time) const;
  BelievedObject believed(const memory::BeliefRow& row) const;
  const memory::ObservationRow& observation(memory::Id id) const;
  /// Calls `mark` with the number of each scene that is at or after the first one, counted from there.
  template <class Mark>
  void mark_scene(memory::Id scene, size_t first_scene, Mark mark) const {
    const auto found = index_.number_of_scene.find(scene);
    if (found != index_.number_of_scene.end() && found->second >= first_scene)
      mark(found->second - first_scene);
  }

  std::filesystem::path path_;
  mutable std::mutex mutex_;  ///< held while the store is read: it belongs to one thread at a time
  memory::Store store_;
  MemoryIndex index_;
  /// Read once, needed at every step in time.
  mutable std::unordered_map<memory::Id, memory::ObservationRow> observations_;
};

/// Opens a memory by path; throws Error, Interrupted when the progress says stop.
using MemoryOpener =
    std::function<std::shared_ptr<const OpenMemory>(const std::string& path, Progress& progress)>;

}  // namespace loci::gui
