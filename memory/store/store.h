#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/json_fwd.h"
#include "mapping/base/progress.h"
#include "memory/store/rows.h"

namespace loci::memory {

/// Which part of the two clocks a read sees. Unset = everything up to the end.
struct AsOf {
  std::optional<TimeNs> at = {};        ///< what held at this time (rows that begin later are left out)
  std::optional<TimeNs> known_at = {};  ///< as the memory knew it at this time
};

struct WriteOptions {
  std::optional<TimeNs> now = {};  ///< known time of what is added; unset = the machine's clock
};

/// What Store::verify() found.
struct VerifyReport {
  std::vector<std::string> problems = {};                    ///< empty = all is well; one line each
  std::vector<std::string> derived_problems = {};            ///< those of them that Store::derive() repairs
  std::vector<std::pair<std::string, int64_t>> counts = {};  ///< rows per table
  int major = 0, minor = 0;                                  ///< of the file
};

/// What is to be forgotten: an object, or everything of a time.
struct ForgetRequest {
  std::optional<Id> object = {};
  std::optional<TimeNs> from = {}, to = {};
};
struct ForgetResult {
  int64_t objects = 0, observations = 0;
  int64_t scenes = 0;  ///< whose images are gone
};
struct ForgottenRow {
  std::optional<Id> object = {};
  std::optional<TimeNs> valid_from = {}, valid_to = {};
  TimeNs known_from = 0;
};

/// One memory file. Errors of the database come out as one-line loci::Error with the file's name. A Store is
/// used by one thread at a time; several Stores may read one file while one writes.
class Store {
 public:
  struct Implementation;

  /// Opens for reading; changes nothing. Error when it is missing, no memory, truncated, or of a newer major
  /// version (which is named).
  static Store open_read(const std::filesystem::path& path);
  /// Opens for writing: creates what is missing, migrates older versions, keeps other writers out until it is
  /// closed. Error also for a newer minor version and while another writer has it.
  static Store open_write(const std::filesystem::path& path, const WriteOptions& options = {});

  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();  ///< a clean close leaves the one file that can be copied

  /// While it lives, everything that is read is of one moment, whatever a writer adds meanwhile; it is also
  /// quicker than to ask for each row's moment anew. (The writer's own Store always sees the last of its
  /// changes.)
  class ReadTransaction {
   public:
    explicit ReadTransaction(const Store& store);
    ~ReadTransaction();
    ReadTransaction(const ReadTransaction&) = delete;
    ReadTransaction& operator=(const ReadTransaction&) = delete;

   private:
    Implementation& store_;
  };

  const std::filesystem::path& path() const;
  bool writable() const;
  int major() const;
  int minor() const;

  // Writing outside a scene; each call is one transaction.
  Id begin_run(const std::string& program, const std::string& configuration_json);
  void finish_run(Id run);
  /// The recording of this fingerprint, added when it is new.
  Id add_recording(const RecordingRow& row);
  /// The map of this content, added when it is new. `sidecar` may be empty.
  Id add_map(const std::string& name, std::string_view urdf, std::string_view sidecar);
  /// The place of this name, added when it is new (its geometry is that of the first time).
  Id add_place(const PlaceRow& row, Id run);
  Id add_fact(const FactRow& row, Id run);
  /// Removes an object with everything that was seen of it, or everything of a time, from the file for good:
  /// rows, words, crops, whole images that show it, its pixels of depth thumbnails. That it was
  /// forgotten stays known.
  ForgetResult forget(const ForgetRequest& request, Id run);
  std::vector<ForgottenRow> forgotten() const;
  /// Makes what follows from other rows anew: stays, words of objects, marks of sightings, full text.
  void derive();
  void set_meta(const std::string& key, const std::string& value);

  // Reading.
  std::optional<std::string> meta(const std::string& key) const;
  /// Minutes east of UTC in which people's times are meant; 0 when nobody said.
  int time_zone_minutes() const;
  std::vector<RunRow> runs() const;
  std::vector<RecordingRow> recordings() const;
  std::optional<RecordingRow> recording(const std::string& fingerprint) const;
  /// Frame indexes of a recording that are in the memory, for resuming.
  std::set<int64_t> frames(Id recording) const;
  std::vector<MapRow> maps() const;
  std::vector<PlaceRow> places() const;

  /// Scenes with from <= time <= to, in order of time.
  std::vector<SceneRow> scenes(const AsOf& as_of = {}, std::optional<TimeNs> from = {},
                               std::optional<TimeNs> to = {}) const;
  SceneRow scene(Id id) const;
  /// The scene added last, and the time of the latest; unset in an empty memory.
  std::optional<SceneRow> last_scene() const;
  std::optional<TimeNs> last_scene_time() const;
  /// The last scene up to `at`, as known at `known_at`.
  std::optional<SceneRow> latest_scene(const AsOf& as_of) const;
  std::vector<ObservationRow> observations(Id scene) const;
  ObservationRow observation(Id id) const;
  Id max_observation_id() const;  ///< the highest number given; 0 = none
  Id max_object_id() const;       ///< likewise
  std::vector<AnnotationRow> annotations(Id scene) const;
  /// What annotators did in a scene and how long each took, in the order in which they were done.
  std::vector<LogRow> log(Id scene) const;

  std::vector<ObjectRow> objects(const AsOf& as_of = {}) const;
  /// The belief that holds per object as of the last scene (see `belief` in the schema), in order of object;
  /// objects without one are left out.
  std::vector<BeliefRow> beliefs(const AsOf& as_of = {}) const;
  std::optional<BeliefRow> belief(Id object, const AsOf& as_of = {}) const;
  /// Objects that had gone from a place at the asked time, those that had gone last first, `most` of them at
  /// most; and how many there are.
  struct Gone {
    std::vector<Id> objects = {};
    size_t in_all = 0;
  };
  Gone objects_gone_from(Id place, size_t most, const AsOf& as_of = {}) const;
  /// Objects that were believed to be on a place, or within `radius` metres of a point, at the asked time: in
  /// order of object, without a look at their probability. By the R*Tree of stays.
  std::vector<Id> objects_at(Id place, const AsOf& as_of = {}) const;
  std::vector<Id> objects_near(const Vector3d& point, double radius, const AsOf& as_of = {}) const;
  /// The rows of belief of one object up to `at`, as they are stored, in order of time.
  /// With `since`, only from the one on that held then.
  std::vector<BeliefRow> belief_history(Id object, const AsOf& as_of = {},
                                        std::optional<TimeNs> since = {}) const;
  /// When the chosen story saw an object, in order of time; with from <= time <= to.
  std::vector<ObjectObservation> observations_of(Id object, const AsOf& as_of = {},
                                                 std::optional<TimeNs> from = {},
                                                 std::optional<TimeNs> to = {}) const;
  /// The last sighting before a time, or the first after it, on one of the places (empty = anywhere).
  std::optional<ObjectObservation> last_observation_before(Id object, TimeNs time,
                                                           const std::vector<Id>& places,
                                                           const AsOf& as_of = {}) const;
  std::optional<ObjectObservation> first_observation_after(Id object, TimeNs time,
                                                           const std::vector<Id>& places,
                                                           const AsOf& as_of = {}) const;
  /// How often the chosen story saw an object, and in which scene first.
  struct ObservationCount {
    size_t count = 0;
    std::optional<Id> first_scene = {};
  };
  ObservationCount count_observations(Id object, const AsOf& as_of = {}) const;
  /// What was taken for something else, or for a false cluster, but may be the object with a probability of
  /// at least `least`: in scenes from `from` on, the last `scenes` of them, most probable first.
  std::vector<ObjectObservation> alternative_observations(Id object, TimeNs from, const AsOf& as_of = {},
                                                          double least = 0.05, size_t scenes = 20) const;
  /// What the scenes after `after` and up to `until` could tell about an object that none of them saw.
  struct VisibilityCounts {
    size_t out_of_view = 0, hidden = 0, missed = 0;
    std::optional<Id> last_missed = {};  ///< scene
  };
  VisibilityCounts visibility_since(Id object, TimeNs after, std::optional<TimeNs> until,
                                    const AsOf& as_of = {}) const;
  /// Everything that was considered in a scene.
  std::vector<AssociationRow> associations(Id scene, const AsOf& as_of = {}) const;
  /// Events with from <= valid_from <= to, in order of time; those taken back (probability 0) are left out.
  std::vector<EventRow> events(const AsOf& as_of = {}, std::optional<TimeNs> from = {},
                               std::optional<TimeNs> to = {}) const;
  std::vector<VisibilityRow> visibility(Id scene) const;
  /// In order of time; with from <= time <= to.
  std::vector<VisibilityRow> visibility_of_object(Id object, std::optional<TimeNs> from = {},
                                                  std::optional<TimeNs> to = {}) const;
  std::vector<VisibilityRow> visibility_of_place(Id place, std::optional<TimeNs> from = {},
                                                 std::optional<TimeNs> to = {}) const;
  /// The last look that saw any of a place.
  std::optional<VisibilityRow> last_visibility(Id place, const AsOf& as_of = {}) const;
  /// Facts that hold at `at`; those taken back are left out.
  std::vector<FactRow> facts(const AsOf& as_of = {}) const;

  /// What SceneTransaction::set_reasoning kept with a scene; unset = never kept, forgotten, or let go.
  std::optional<std::string> reasoning(Id scene) const;
  /// Whether it was let go by a rule of retention.
  bool reasoning_discarded(Id scene) const;
  /// What SceneTransaction::set_checkpoint kept, and after which scene.
  struct Checkpoint {
    std::optional<Id> scene = {};
    std::string bytes = {};
  };
  std::optional<Checkpoint> checkpoint(const std::string& name) const;
  /// All whose names begin so, by name.
  std::map<std::string, Checkpoint> checkpoints(const std::string& prefix) const;

  /// Objects of which an observation is annotated with this value (case does not matter), e.g. a class, a
  /// text.
  std::vector<Id> objects_annotated(const std::string& value, const AsOf& as_of = {}) const;
  /// Objects of which an observation is annotated with a text in which all these words are (FTS5).
  std::vector<Id> objects_with_text(const std::string& words, const AsOf& as_of = {}) const;
  /// All values of annotations of objects, each once.
  std::vector<std::string> annotation_values() const;

  BlobRow blob(Id id) const;
  std::optional<Id> find_blob(const std::string& hash) const;
  FeatureStructureRow feature_structure(Id id) const;
  /// Of a scene, in order of id; `type` empty = all.
  std::vector<FeatureStructureRow> feature_structures(Id scene, const std::string& type = {}) const;
  std::string type_system(Id id) const;

  /// Rows of every table, and the bytes of the file that it takes with its indexes, largest first. Bytes are
  /// only known by reading every page: without them it is quick.
  struct TableSize {
    std::string table = {};
    int64_t rows = 0, bytes = 0;
  };
  std::vector<TableSize> statistics(bool with_bytes = true) const;
  /// Hands over the rows of a view for people ("v_objects") as objects {column: value}.
  void read_view(const std::string& view, const std::function<void(const Json&)>& visitor) const;

  /// Integrity, references, hashes of blobs, agreement between tables.
  VerifyReport verify(Progress& progress) const;

 private:
  friend class SceneTransaction;
  explicit Store(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// "object_12".
std::string object_name(Id object);
/// The id in "object_12"; unset when it is no such name.
std::optional<Id> object_id(std::string_view name);

}  // namespace loci::memory
