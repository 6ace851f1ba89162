#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>

#include "mapping/base/error.h"
#include "memory/questions/names/class_verdict.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/names/taxonomy.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/store/place_motion.h"

namespace loci::memory {

/// Thrown when words mean nothing in this memory.
class UnknownName : public Error {
 public:
  enum class Kind { object, place };
  UnknownName(Kind kind, const std::string& what, const FileLocation& where, const std::string& hint)
      : Error(what, where, hint), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

struct EnvironmentPart;  // environment_parts.h

/// What the memory believes as of a valid time and a transaction time, with names in place of ids; of a past
/// moment by what was seen after it, too (smoothed_probability()). A consistent read of only what the
/// question needs. Not for several threads at once.
class Snapshot {
 public:
  Snapshot(const Store& store, const AsOf& as_of);

  const Store& store() const { return store_; }
  const AsOf& as_of() const { return as_of_; }
  // What was read goes with its snapshot.
  const std::vector<BeliefRow>& beliefs() const&;
  const std::vector<PlaceRow>& places() const& { return reads_->places; }
  const std::vector<FactRow>& facts() const& { return reads_->facts; }
  const PartNames& part_names() const&;
  /// As all_parts(), read once.
  const std::vector<EnvironmentPart>& parts() const&;
  /// Scenes up to `at`, known at `known_at`, in order of time.
  const std::vector<SceneRow>& scenes() const&;
  void beliefs() const&& = delete;
  void places() const&& = delete;
  void facts() const&& = delete;
  void part_names() const&& = delete;
  void parts() const&& = delete;
  void scenes() const&& = delete;
  const BeliefRow* belief(Id object) const;
  const SceneRow* scene(Id id) const;

  SceneRef scene_ref(const SceneRow& scene) const;
  std::optional<SceneRef> scene_ref(std::optional<Id> id) const;
  ObjectRef object_ref(Id object) const;
  /// What somebody stated last of an object: its "colour" (or "color"), "size", "material"; unset = nothing.
  std::optional<std::string> stated(Id object, const std::string& property) const;
  /// The colour that somebody stated, else the one that was seen.
  std::optional<std::string> color_of(const BeliefRow& belief) const;
  std::optional<PlaceRef> place_ref(std::optional<Id> place) const;
  /// What people call a joint of the map: by its own name, else by that of what it moves, else as the map
  /// does.
  std::string joint_name(const std::string& joint) const;
  /// Motion of a place from where its row has it to where it stood in a scene, joints aside.
  Isometry3d place_motion(const PlaceRow& place, const SceneRow& scene) const;
  ObjectBelief object_belief(Id object) const;
  ObjectBelief object_belief(const BeliefRow& belief) const;
  Change change(const EventRow& event) const;
  /// As memory::seen_colors(), of each object read once.
  const std::vector<std::string>& seen_colors(Id object) const;
  /// What all experts together make of the class of an object; unset when none says anything.
  const std::optional<ClassVerdict>& class_verdict(Id object) const {
    return experts().judgement(object).verdict;
  }

  /// Objects that X means, most probable first, then most recent. X: "object_12", an alias, words for colour,
  /// size, class (or another word or a wider kind of it, by the taxonomy), text, property, "Ada's" for an
  /// owner, "on PLACE", or several of these together; empty = all. UnknownName with the nearest names when it
  /// means nothing.
  std::vector<Id> find_objects(const std::string& subject) const;
  /// The object that one became which has no observation left: the two were found to be one, or are one by a
  /// correction. Unset for others.
  std::optional<Id> object_instead_of(Id id) const;
  /// Whether the name of an object, as find_objects() reads it, may mean another one that is `such`; one that
  /// has gone only where it has.
  bool has_namesake(const std::string& name, Id object,
                    const std::function<bool(const BeliefRow&)>& such) const;
  /// Places that a name means: those called so, else by its last word ("couch table" is any table).
  /// UnknownName with the nearest names when it means nothing.
  std::vector<PlaceRow> find_places(const std::string& name) const;
  /// As find_places(); empty where the name means nothing.
  std::vector<PlaceRow> places_meant(const std::string& name) const;
  /// A text with the names given by people that have an article in them as one word each: "where is my cup"
  /// is "where is my_cup" where something is called "my cup", so that it does not mean any cup.
  std::string with_names_joined(std::string text) const;
  /// Whether every word of a name means something by itself or with its neighbours.
  bool means_objects(const std::string& subject) const;
  /// A name without nouns that only say what its objects are for or in, and without sizes, where nothing is
  /// called by all its words: "jam jar", "jar of jam" → jam, "big red cooking pot" → red pot. Unset where
  /// there are none.
  std::optional<std::string> head_of(const std::string& subject) const;
  /// Places by name ("table_1", "table 1"), alias, the beginning of the name (drawer_3 for drawer_3_bottom),
  /// or class (table for table_1); empty when there are none.
  std::vector<PlaceRow> places_called(const std::string& name) const;
  /// Objects whose most probable place this is and that have not gone.
  std::vector<Id> objects_at(Id place) const;
  /// Objects that have not gone, in order.
  std::vector<Id> present_objects() const;
  /// All words for objects.
  std::vector<std::string> known_names() const;
  /// Names of this memory that a word is taken for: "fruit" → apple, banana. Empty for most names.
  std::vector<std::string> names_related_to(const std::string& word) const;

 private:
  /// The only place that a joint moves, also where a scene did not show it; unset where there are several.
  std::optional<PlaceRef> place_moved_by(const std::string& joint) const;
  /// Gives a row its probability by what was seen later, too.
  void smooth(BeliefRow& row) const;
  FileLocation file() const { return {store_.name(), 0, {}}; }
  /// The product that most of the latest observations of an object are annotated with, else its
  /// class_verdict().
  std::optional<std::string> annotated_name(Id object) const;
  const ClassExperts& experts() const;
  bool has_gone(Id object) const;
  std::vector<Id> find_at_place(const std::string& name) const;
  /// As means_objects() and find_objects(), by all words of the name.
  bool is_known_as(const std::string& subject) const;
  std::vector<Id> find_exactly(const std::string& subject) const;
  /// The words of a name in lower case, without those that mean any object.
  std::vector<std::string> significant_words(const std::string& subject) const;
  /// Whether an object is called so, and not only of that colour: an orange.
  bool is_labelled(Id object, const std::string& name) const;
  /// Whether a word names objects: a colour does only where something is called so.
  bool is_noun(const std::string& name) const;
  /// What is called so, and what is related to it in meaning.
  std::vector<Id> find_by_word(const std::string& word) const;
  const std::vector<Id>& find_named(const std::string& word) const;
  /// Of which objects a search is; of a long history most have gone.
  enum class Among { all, present };
  /// An object that may be called so: where a class is given, if its class_verdict() calls it that.
  struct Candidate {
    Id object = 0;
    std::string class_name = {};
  };
  const std::vector<Candidate>& candidates_named(const std::string& word, Among among = Among::all) const;
  std::vector<Candidate> search_named(const std::string& word, Among among) const;
  /// The object of a number, "object_12". Error where it was forgotten.
  std::vector<Candidate> of_number(Id id) const;
  /// Those whose stated fact "is so", by key and value in lower case.
  std::vector<Candidate> with_fact(
      const std::function<bool(const std::string& key, const std::string& value)>& is_so) const;
  std::vector<Candidate> of_looks(const std::string& word, Among among) const;
  /// `meanings`: of the word, in the taxonomy.
  std::vector<Candidate> of_class(const std::string& word, const std::set<std::string>& meanings,
                                  Among among) const;
  bool is_named(const Candidate& candidate) const;
  /// Whether one that is named has the word for its name: a can that some views take for a cup is meant by
  /// "cup" only where nothing is called so.
  bool is_by_verdict(const Candidate& candidate, const std::string& word) const;
  bool is_by_verdict(Id object, const std::string& word) const;
  const std::vector<Id>& present_candidates() const;
  std::vector<std::string> names_related_to(const std::string& word, bool known) const;
  /// The one that "biggest red" means; unset when no word is a superlative.
  std::optional<Id> find_superlative(const std::vector<std::string>& words) const;
  /// "red tea cup": the objects of the longest name that begins at words[next]; moves `next` past it.
  std::vector<Id> find_longest_name(const std::vector<std::string>& words, size_t& next) const;
  /// What may be meant instead where words[unknown] means nothing.
  std::string hint_for(const std::vector<std::string>& words, size_t unknown) const;

  /// What was read, and what follows from it. Snapshots of one moment share it: a sentence asks many
  /// questions, and each would find out again what a name means.
  struct Reads {
    Reads(const Store& store, const AsOf& as_of);

    const Store& store;
    AsOf as_of;
    Store::ReadTransaction moment;
    std::vector<PlaceRow> places;
    std::vector<FactRow> facts;
    Taxonomy taxonomy;
    std::map<Id, std::string> recordings;
    PlaceMotions motions;
    // Read when first asked for.
    std::optional<std::vector<BeliefRow>> beliefs;
    std::unordered_map<Id, std::optional<BeliefRow>> belief_of;
    std::map<std::pair<Id, std::string>, std::string> stated;  ///< by object and key, "color" as "colour"
    std::optional<PartNames> part_names;
    std::shared_ptr<const std::vector<EnvironmentPart>> parts;
    std::optional<ClassExperts> experts;
    std::optional<std::set<std::string>> class_names;
    std::map<std::string, std::vector<std::string>> related_to;
    std::map<std::pair<std::string, Among>, std::vector<Candidate>> candidates;  ///< by candidates_named()
    std::map<std::string, std::vector<Id>> named;                                ///< by find_named()
    std::optional<std::vector<Id>> present_candidates;
    std::optional<std::vector<SceneRow>> scenes;
    std::unordered_map<Id, std::optional<SceneRow>> scene_of;
    std::unordered_map<Id, std::vector<std::string>> seen_colors;
  };
  static std::shared_ptr<Reads> reads_of(const Store& store, const AsOf& as_of);

  const Store& store_;
  AsOf as_of_;
  std::shared_ptr<Reads> reads_;
};

/// Fraction of a place that must have been seen to conclude that an object is not there.
inline constexpr double kMinSeenFraction = 0.5;

/// The centre of a place, map frame; unset when its shape and pose are unknown.
std::optional<Vector3d> centre_of(const PlaceRow& place);

bool is_believed_at(const BeliefRow& belief, Id place);

/// The box of an object as it is believed to stand, map frame.
struct BelievedBox {
  Isometry3d map_from_box = Isometry3d::Identity();
  std::optional<Vector3d> size = {};  ///< along its axes, metres
};
/// A belief is of a position and of the extents that all views support: how the box is turned is that of the
/// last observation, `seen` (nullptr = none). Unset when nothing says where it is.
std::optional<BelievedBox> believed_box(const BeliefRow& belief, const ObservationRow* seen);

}  // namespace loci::memory
