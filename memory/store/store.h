#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/base/time_zone.h"
#include "memory/store/rows/rows.h"

namespace loci::memory {

struct RetentionRules;
struct RetentionResult;
struct MemoryFormat;
/// Ending of the file beside the local copy of a memory in a database that has the URL of that.
inline constexpr const char* kReplicaOf = ".replica_of";
extern const MemoryFormat kMemoryFormat;  ///< of this program: memory/store/schema.sql

/// Valid time and transaction time that a read refers to. Unset = up to the end.
struct AsOf {
  std::optional<TimeNs> at = {};        ///< valid time: rows that begin later are left out
  std::optional<TimeNs> known_at = {};  ///< transaction time: as the memory knew it then
};

struct WriteOptions {
  std::optional<TimeNs> now = {};     ///< known time of what is added; unset = the machine's clock
  bool keep_before_migration = true;  ///< keep a copy beside of a file that is migrated
  /// In which people mean times in a memory that is made, as TimeZone::named() takes it. Empty = that of the
  /// recording it is made from, else UTC.
  std::string time_zone = {};
};

/// The result of Store::verify().
struct VerifyReport {
  std::vector<std::string> problems = {};                    ///< one line each
  std::vector<std::string> derived_problems = {};            ///< those of them that Store::derive() repairs
  std::vector<std::pair<std::string, int64_t>> counts = {};  ///< rows per table
  int major = 0, minor = 0;                                  ///< of the file
};

/// What to forget: an object, what people stated about a place, or everything between two times.
struct ForgetRequest {
  std::optional<Id> object = {};
  std::optional<Id> place = {};
  std::optional<TimeNs> from = {}, to = {};
};

/// An image region by its content: mean colours of 8 x 8 fields, row by row, blue, green, red.
struct ImageSignature {
  int width = 0, height = 0;       ///< of the whole image, pixels
  std::array<int, 4> region = {};  ///< x, y, width, height, pixels
  std::array<uint8_t, 192> means = {};
};

/// What must not be found in a file from which something was forgotten.
struct ForgottenTokens {
  std::vector<std::string> texts = {};   ///< that nothing else in the memory says
  std::vector<std::string> hashes = {};  ///< SHA-256 of the stored bytes
  std::vector<double> numbers = {};      ///< coordinates of observations
  std::vector<ImageSignature> images = {};
};

struct ForgetResult {
  int64_t objects = 0, observations = 0;
  int64_t scenes = 0;                          ///< with regions or whole images removed
  std::map<std::string, int64_t> erased = {};  ///< rows by table, and "image region"
  ForgottenTokens tokens = {};
  std::set<Id> object_ids = {};
  std::set<Id> observation_ids = {};
};

/// What is erased from a scene whose reasoning stays.
struct ErasedFromScene {
  std::vector<Id> observations = {};  ///< that the scene had, by number; in all
  std::set<Id> erased = {};           ///< of them
  std::set<Id> objects = {};
};
/// Rewrites the stored reasoning of a scene without what is erased; unset = delete all of it.
using ReasoningFilter =
    std::function<std::optional<std::string>(const std::string& bytes, const ErasedFromScene& scene)>;

/// A request to forget that was carried out. Of an object nothing else remains.
struct ForgottenRow {
  Id id = 0;                                             ///< random
  std::optional<TimeNs> valid_from = {}, valid_to = {};  ///< of an interval
  TimeNs known_from = 0;
};

/// Whether a time lies in an interval that was forgotten.
bool was_forgotten(const std::vector<ForgottenRow>& rows, TimeNs time);

/// One memory file. Errors of the database become a one-line loci::Error with the name of the file. A Store
/// is used by one thread at a time; several Stores may read a file while one writes.
class Store {
 public:
  struct Connection;

  /// Opens for reading; changes nothing. Error when the file is missing, not a memory, truncated, or of a
  /// newer major version. `format` is only given in tests of migrations.
  static Store open_read(const std::filesystem::path& path, const MemoryFormat& format = kMemoryFormat);
  /// Opens for writing: creates a missing file, migrates an older minor version, and keeps other writers out
  /// until it is closed. Error also for a newer minor version and while another writer has the file.
  static Store open_write(const std::filesystem::path& path, const WriteOptions& options = {},
                          const MemoryFormat& format = kMemoryFormat);

  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();  ///< a clean close leaves one file, which can be copied

  /// While it lives, all reads see the same state, whatever a writer adds meanwhile. Reading is also faster.
  /// (The writer's own Store always sees its last changes.)
  class ReadTransaction {
   public:
    explicit ReadTransaction(const Store& store);
    ~ReadTransaction();
    ReadTransaction(const ReadTransaction&) = delete;
    ReadTransaction& operator=(const ReadTransaction&) = delete;

   private:
    Connection& db_;
  };

  const std::filesystem::path& path() const;
  /// For messages: the file, or of a copy of a memory in a database the URL of that.
  std::string name() const;
  bool writable() const;
  /// The copy that was kept of the file before open_write() migrated it; empty when nothing was migrated.
  const std::filesystem::path& kept_before_migration() const;
  int major() const;  ///< of the format
  int minor() const;
  /// An Error about this file.
  Error error(const std::string& what, const std::string& hint = {}) const;

  // ---- Writing outside a scene; each call is one transaction.
  Id begin_run(const std::string& program, const std::string& configuration_json);
  void finish_run(Id run);
  /// The recording with this fingerprint, added when it is new.
  Id add_recording(const RecordingRow& row);
  /// The map with this content, added when it is new. `sidecar` may be empty.
  Id add_map(const std::string& name, std::string_view urdf, std::string_view sidecar);
  /// A map as people have corrected it: from then on it stands for `map` in map_at().
  Id add_correction(const MapRow& map, const std::string& urdf);
  /// The place with this name, added when it is new; an existing one keeps its geometry.
  Id add_place(const PlaceRow& row, Id run);
  Id add_fact(const FactRow& row, Id run);
  /// Erases what a request names, and what superseded rows say about it: rows, terms, crops, labels, texts of
  /// edits, its region of every image that shows it. An object takes along those that were merged into it.
  /// Only a tombstone remains. Without `filter`, all reasoning since the object was first seen is deleted.
  ForgetResult forget(const ForgetRequest& request, Id run, const ReasoningFilter& filter = {});
  /// Erases what was forgotten in `other`, of which this may be an older copy: intervals by their times,
  /// objects and facts by their signatures. An object is the forgotten one if most of its observations in
  /// scenes that both memories have are; of another one only these observations go. Writes no tombstone.
  ForgetResult honour_tombstones(const Store& other);
  /// After forget() and reasoning anew as `run`: events, beliefs and visibility that rows of the run replace
  /// were computed from what was forgotten. They go, and those of the run stand in their place, as if known
  /// since then.
  void replace_forgotten(Id run);
  /// Takes over the tombstones of a memory whose observations this one has, as rows of `run`.
  void add_tombstones(const Store& other, Id run);
  /// Discards images, crops and reasoning by age; what was observed, believed and decided remains.
  RetentionResult retain(const RetentionRules& rules);
  std::vector<ForgottenRow> forgotten() const;
  /// Derives the tables again that follow from others: stays, visits, ranks, terms of objects, full text,
  /// counts.
  void derive();
  void set_meta(const std::string& key, const std::string& value);

  // ---- Runs, recordings, maps, places.
  std::optional<std::string> meta(const std::string& key) const;
  /// In which people's times are meant. Error when this machine does not know it.
  TimeZone time_zone() const;
  std::vector<RunRow> runs() const;
  std::vector<RecordingRow> recordings() const;
  std::optional<RecordingRow> recording(const std::string& fingerprint) const;
  /// Frame indexes of a recording that are in the memory.
  std::set<int64_t> frames(Id recording) const;
  std::vector<MapRow> maps() const;
  /// The map of the room as of a time: that of the latest scene, as people have corrected it; unset without a
  /// map.
  std::optional<MapRow> map_at(const AsOf& as_of = {}) const;
  std::vector<PlaceRow> places() const;

  // ---- Scenes.
  /// Scenes with from <= time <= to, in order of time.
  std::vector<SceneRow> scenes(const AsOf& as_of = {}, std::optional<TimeNs> from = {},
                               std::optional<TimeNs> to = {}) const;
  SceneRow scene(Id id) const;
  /// The scene that was added last, and the time of the latest; unset in an empty memory.
  std::optional<SceneRow> last_scene() const;
  std::optional<TimeNs> last_scene_time() const;
  /// Times of the first `count` and of the last `count` scenes, in order of time; of all where there are no
  /// more.
  std::vector<TimeNs> scene_times_at_ends(size_t count) const;
  /// The latest scene as of a time.
  std::optional<SceneRow> latest_scene(const AsOf& as_of) const;
  /// The latest scene that knows the position of a joint, of those added before `before` (unset = of all).
  std::optional<SceneRow> latest_scene_of_joint(const std::string& joint, const AsOf& as_of = {},
                                                std::optional<Id> before = {}) const;
  std::vector<ObservationRow> observations(Id scene) const;
  ObservationRow observation(Id id) const;
  Id max_observation_id() const;  ///< 0 = there is none
  Id max_object_id() const;       ///< likewise; forgotten ones count
  /// Of the labels that people gave an observation only the one that holds, if any.
  std::vector<AnnotationRow> annotations(Id scene, const AsOf& as_of = {}) const;
  /// The scenes from `from` to `to` with an annotation of a type, in order of time.
  std::vector<SceneRow> scenes_annotated(const std::string& type, TimeNs from, TimeNs to,
                                         const AsOf& as_of) const;
  /// The time of the last of them; unset = there is none.
  std::optional<TimeNs> last_annotated(const std::string& type, TimeNs from, TimeNs to,
                                       const AsOf& as_of = {}) const;
  /// The log of a scene in the order of its lines.
  std::vector<LogRow> log(Id scene) const;
  /// All associations that were considered in a scene.
  std::vector<AssociationRow> associations(Id scene, const AsOf& as_of = {}) const;
  std::vector<VisibilityRow> visibility(Id scene) const;
  /// Of an object or a place, with from <= time <= to, in order of time. Of an object a row with out_of_view
  /// means as much as none.
  std::vector<VisibilityRow> visibility_of_object(Id object, std::optional<TimeNs> from = {},
                                                  std::optional<TimeNs> to = {}) const;
  std::vector<VisibilityRow> visibility_of_place(Id place, std::optional<TimeNs> from = {},
                                                 std::optional<TimeNs> to = {}) const;
  /// The row of the same object and scene that held before one was added.
  std::optional<VisibilityRow> visibility_before(const VisibilityRow& row) const;
  /// The last scene that saw any of a place.
  std::optional<VisibilityRow> last_visibility(Id place, const AsOf& as_of = {}) const;

  // ---- Objects and their beliefs.
  std::vector<ObjectRow> objects(const AsOf& as_of = {}) const;
  /// The belief per object as of that time, else the latest scene (see `belief` in the schema), in order of
  /// object; objects without one are left out.
  std::vector<BeliefRow> beliefs(const AsOf& as_of = {}) const;
  std::optional<BeliefRow> belief(Id object, const AsOf& as_of = {}) const;
  /// The stored rows of belief of one object up to `at`, in order of time; with `since`, from the row on that
  /// held then.
  std::vector<BeliefRow> belief_history(Id object, const AsOf& as_of = {},
                                        std::optional<TimeNs> since = {}) const;
  /// Objects that were believed to be on a place, or within `radius` metres of a point, in order of object,
  /// whatever their probability.
  std::vector<Id> objects_at(Id place, const AsOf& as_of = {}) const;
  std::vector<Id> objects_near(const Vector3d& point, double radius, const AsOf& as_of = {}) const;
  /// Objects, in order, among which are all that had not gone; without `known_at` few others.
  std::vector<Id> present_candidates(const AsOf& as_of = {}) const;
  /// Objects that had gone from a place: the last `max_count`, the latest first, and how many there are.
  struct Gone {
    std::vector<Id> objects = {};
    size_t in_all = 0;
  };
  Gone objects_gone_from(Id place, size_t max_count, const AsOf& as_of = {}) const;
  /// Objects of which an observation is annotated with a value (in upper or lower case), e.g. a class or a
  /// text.
  std::vector<Id> objects_annotated(const std::string& value, const AsOf& as_of = {}) const;
  /// The same with annotations of a type alone, or of all others.
  std::vector<Id> objects_annotated(const std::string& value, const std::string& type, bool of_type,
                                    const AsOf& as_of = {}) const;
  /// The latest `count` observations of an object: their annotations of some types in order of id, each with
  /// the run that added its scene, and how many of these observations each run made.
  struct LatestObservations {
    struct Annotation {
      AnnotationRow row = {};
      Id run = 0;
      std::optional<Vector3d> towards_camera = {};  ///< unit vector, map frame; unset = unknown
    };
    std::vector<Annotation> annotations = {};
    std::map<Id, size_t> by_run = {};
  };
  LatestObservations latest_observations(Id object, size_t count, const std::vector<std::string>& types,
                                         const AsOf& as_of = {}) const;
  /// Objects of which an observation is annotated with a text that contains these words in this order (FTS5).
  std::vector<Id> objects_with_text(const std::string& words, const AsOf& as_of = {}) const;
  /// All values of annotations of objects, each once.
  std::vector<std::string> annotation_values() const;

  // ---- Observations of an object, by the MAP hypothesis.
  /// In order of time; with from <= time <= to.
  std::vector<ObjectObservation> observations_of(Id object, const AsOf& as_of = {},
                                                 std::optional<TimeNs> from = {},
                                                 std::optional<TimeNs> to = {}) const;
  /// The last before a time, or the first after it, on one of the places (empty = anywhere).
  std::optional<ObjectObservation> last_observation_before(Id object, TimeNs time,
                                                           const std::vector<Id>& places,
                                                           const AsOf& as_of = {}) const;
  std::optional<ObjectObservation> first_observation_after(Id object, TimeNs time,
                                                           const std::vector<Id>& places,
                                                           const AsOf& as_of = {}) const;
  /// The object that has most of what was observed as another one, which has no observation left; unset =
  /// none.
  std::optional<Id> object_instead_of(Id object) const;
  struct ObservationCount {
    size_t count = 0;
    std::optional<Id> first_scene = {};
  };
  ObservationCount count_observations(Id object, const AsOf& as_of = {}) const;
  /// Observations that were associated with another object or taken for clutter, but are of this object with
  /// a probability of at least `min_probability`: in the last `max_scenes` scenes from `from` on, most
  /// probable first.
  std::vector<ObjectObservation> alternative_observations(Id object, TimeNs from, const AsOf& as_of = {},
                                                          double min_probability = 0.05,
                                                          size_t max_scenes = 20) const;
  /// Scenes after `after` and up to `until`, by what they report about an object that none of them saw.
  struct VisibilityCounts {
    size_t out_of_view = 0, hidden = 0, missed = 0;
    std::optional<Id> last_missed = {};  ///< scene
  };
  VisibilityCounts visibility_since(Id object, TimeNs after, std::optional<TimeNs> until,
                                    const AsOf& as_of = {}) const;

  // ---- Events and facts.
  /// Events with from <= valid_from <= to, in order of time, those of joints first, then by object, without
  /// those that were taken back.
  std::vector<EventRow> events(const AsOf& as_of = {}, std::optional<TimeNs> from = {},
                               std::optional<TimeNs> to = {}) const;
  /// Those of one object.
  std::vector<EventRow> events_of(Id object, const AsOf& as_of = {}, std::optional<TimeNs> from = {},
                                  std::optional<TimeNs> to = {}) const;
  /// Facts that hold at `at`, without those that were taken back.
  std::vector<FactRow> facts(const AsOf& as_of = {}) const;

  // ---- Rows by run and id, whether they are still known or not. Row: AssociationRow, EventRow, BeliefRow,
  // FactRow.
  template <class Row>
  std::vector<Row> rows_of_run(Id run) const;
  template <class Row>
  Row row(Id id) const;
  /// Of a scene, as known now. Row: also VisibilityRow.
  template <class Row>
  std::vector<Row> known_rows(Id scene) const;
  /// The row that superseded a row, the one that superseded that, and so on to the one that is known.
  template <class Row>
  Id current_row(Id id) const;

  // ---- Stored bytes.
  /// What SceneTransaction::set_reasoning stored with a scene; unset = never stored, forgotten, or discarded.
  std::optional<std::string> reasoning(Id scene) const;
  /// Whether a rule of retention discarded it.
  bool reasoning_discarded(Id scene) const;
  /// How many scenes have none, though they were not forgotten.
  size_t scenes_without_reasoning() const;
  /// What SceneTransaction::set_checkpoint stored, and after which scene.
  struct Checkpoint {
    std::optional<Id> scene = {};
    std::string bytes = {};
  };
  std::optional<Checkpoint> checkpoint(const std::string& name) const;
  /// All with a prefix, by name.
  std::map<std::string, Checkpoint> checkpoints(const std::string& prefix) const;
  BlobRow blob(Id id) const;
  std::optional<Id> find_blob(const std::string& hash) const;
  FeatureStructureRow feature_structure(Id id) const;
  /// Of a scene, in order of id; `type` empty = all.
  std::vector<FeatureStructureRow> feature_structures(Id scene, const std::string& type = {}) const;
  std::string type_system(Id id) const;

  // ---- The file as a whole.
  /// Rows of every table, and the bytes of the file that it takes with its indexes, largest first. Counting
  /// bytes reads every page.
  struct TableSize {
    std::string table = {};
    int64_t rows = 0, bytes = 0;
  };
  std::vector<TableSize> statistics(bool with_bytes = true) const;
  /// The columns of a public view ("v_objects").
  std::vector<std::string> view_columns(const std::string& view) const;
  /// Passes the rows of a public view as objects {column: value}, in the order of its columns.
  void read_view(const std::string& view, const std::function<void(const Json&)>& visitor) const;
  /// Checks integrity, references, hashes of blobs, and agreement between tables.
  VerifyReport verify(Progress& progress) const;

 private:
  friend class ChangeTransaction;
  friend class SceneTransaction;
  friend void rewrite_memory(const std::filesystem::path&, const std::filesystem::path&,
                             const std::function<void(Store&)>&);
  explicit Store(std::unique_ptr<Connection> connection);
  std::unique_ptr<Connection> connection_;
};

/// "object_12".
std::string object_name(Id object);
/// The id in "object_12"; unset for any other text.
std::optional<Id> object_id(std::string_view name);

/// How far the observations of an object agree on what annotators of one type report.
struct AnnotationSupport {
  std::string type, value;
  size_t observations = 0;  ///< with this value
  double agreement = 0;     ///< their share of the observations with any value of this type
};
/// By type, the most frequent value first. Annotations of location and geometry are left out.
std::vector<AnnotationSupport> annotation_support(const Store& store,
                                                  const std::vector<ObjectObservation>& observations,
                                                  const AsOf& as_of = {});

}  // namespace loci::memory
