#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

// A question is a struct, an answer is a struct with its evidence; command line, browser, JSON and words are
// ways to write the same struct. Every question takes `as_of`: what held at a time, as known at a time.

// ---- What answers are made of.

struct SceneRef {
  Id scene = 0;
  TimeNs time = 0;
  std::optional<std::string> recording = {};
  std::optional<int64_t> frame = {};  ///< index in the recording
};

struct ObjectRef {
  Id id = 0;
  std::string name = {};  ///< "object_12"
  std::vector<std::string> aliases = {};
  std::optional<std::string> color = {};
  std::optional<Vector3d> size = {};  ///< metres
};

struct PlaceRef {
  Id id = 0;
  std::string name = {};
  bool container = false;  ///< things are in it rather than on it
};

/// Where an object may be instead: something there was taken for something else.
struct Alternative {
  double probability = 0;
  std::optional<PlaceRef> place = {};
  std::optional<Vector3d> position = {};
  SceneRef scene = {};
  std::optional<ObjectRef> taken_for = {};  ///< unset = for a false cluster
};

/// What is believed about an object.
struct ObjectState {
  ObjectRef object = {};
  std::string status = {};  ///< seen, missed, hidden, out_of_view, gone
  double probability = 0;   ///< that it is at this place
  std::optional<PlaceRef> place = {};
  std::optional<Vector3d> position = {};  ///< map frame
  std::optional<SceneRef> first_seen = {};
  std::optional<SceneRef> last_seen = {};
  size_t sightings = 0;
  // Scenes since it was last seen, by what they could tell about its place.
  size_t looks_out_of_view = 0;
  size_t looks_hidden = 0;
  size_t looks_missed = 0;
  std::optional<SceneRef> looked_for = {};  ///< the last of those that saw its place without it
  /// Since it was last seen, that scene included; where only `where` asks for them.
  std::vector<Alternative> alternatives = {};
};

/// Something that happened.
struct Change {
  std::string kind = {};  ///< appeared, moved, looks_different, gone, hidden, reappeared, joint_changed
  TimeNs time = 0;
  std::optional<TimeNs> since = {};  ///< it happened after this time and until `time`
  std::optional<ObjectRef> object = {};
  std::optional<PlaceRef> place = {};
  std::optional<PlaceRef> from_place = {};
  std::optional<Vector3d> position = {};
  std::optional<Vector3d> from_position = {};
  std::optional<std::string> joint = {};
  std::optional<double> joint_position = {};
  std::optional<double> from_joint_position = {};
  double probability = 1;
  std::optional<SceneRef> scene = {};
  std::string source = {};
};

enum class Verdict { yes, no, not_observed };
std::string verdict_name(Verdict verdict);  ///< "yes", "no", "not_observed"

// ---- Questions and answers.

struct WhereQuestion {
  std::string subject = {};
  AsOf as_of = {};
};
struct WhereAnswer {
  std::string asked = {};
  std::vector<ObjectState> objects = {};  ///< most probable first, then most recent
};

/// A time during which an object was seen at one spot.
struct Stay {
  std::optional<PlaceRef> place = {};
  std::optional<Vector3d> position = {};  ///< mean
  std::vector<SceneRef> scenes = {};      ///< in which it was seen there
  double probability = 1;                 ///< least probable of the sightings
};
struct HistoryQuestion {
  std::string subject = {};
  std::optional<TimeNs> from = {}, to = {};  ///< only stays and changes that reach into this time
  AsOf as_of = {};
};
struct ObjectHistory {
  ObjectState now = {};
  std::vector<Stay> stays = {};
  std::vector<Change> changes = {};
};
struct HistoryAnswer {
  std::string asked = {};
  std::vector<ObjectHistory> objects = {};
};

/// What is on or in a place.
struct ContentsQuestion {
  std::string place = {};
  AsOf as_of = {};
  std::string subject = {};  ///< only these; empty = everything
  size_t max_gone = 20;      ///< so many at most of what is gone from it
};
struct PlaceContents {
  PlaceRef place = {};
  std::vector<ObjectState> there = {};     ///< believed to be there, most probable first
  std::vector<ObjectState> gone = {};      ///< were there last, and were looked for in vain: the last to go
  size_t gone_in_all = 0;                  ///< of which those are the last ones
  std::optional<SceneRef> last_look = {};  ///< the last scene that saw any of it
  std::optional<double> fraction = {};     ///< how much of it that scene saw
};
struct ContentsAnswer {
  std::string asked = {};
  std::string subject = {};  ///< empty = everything
  /// Whether there is any: yes when one is believed to be there, no when none is and at least half of each
  /// place has been looked at, else not observed.
  Verdict verdict = Verdict::not_observed;
  std::vector<PlaceContents> places = {};
};

/// Was X there between two times?
struct WasQuestion {
  std::string subject = {};
  std::string place = {};  ///< empty = anywhere
  TimeNs from = 0;
  TimeNs to = 0;
  AsOf as_of = {};
};
/// What one scene of the time could tell.
struct PlaceLook {
  SceneRef scene = {};
  double fraction = 0;  ///< of the place that it saw
  std::string spot =
      {};  ///< seen, seen_empty, hidden, out_of_view, no_depth, unknown: where the object stood
};
struct WasObject {
  ObjectRef object = {};
  Verdict verdict = Verdict::not_observed;
  std::string reason = {};  ///< why not, in words
  std::vector<SceneRef> seen_there = {};
  std::vector<std::pair<SceneRef, std::string>> seen_elsewhere = {};  ///< with the place's name, or ""
  std::vector<PlaceLook> looks = {};                                  ///< that saw any of the place
  std::optional<SceneRef> before = {};                                ///< last time it was seen there before
  std::optional<SceneRef> after = {};                                 ///< first time it was seen there after
};
struct WasAnswer {
  std::string asked = {};
  std::string place = {};  ///< empty = anywhere
  bool container = false;  ///< things are in it rather than on it
  TimeNs from = 0, to = 0;
  Verdict verdict = Verdict::not_observed;  ///< yes if any is, no if all are not
  std::vector<WasObject> objects = {};
};

struct ChangesQuestion {
  std::optional<TimeNs> from = {}, to = {};
  std::string subject = {};  ///< empty = everything
  std::string place = {};    ///< empty = everywhere
  AsOf as_of = {};
};
struct ChangesAnswer {
  std::optional<TimeNs> from = {}, to = {};
  std::vector<Change> changes = {};
};

struct ObjectsQuestion {
  std::string subject = {};  ///< empty = all
  AsOf as_of = {};
};
struct ObjectsAnswer {
  std::vector<ObjectState> objects = {};
};

struct ScenesQuestion {
  std::optional<TimeNs> from = {}, to = {};
  AsOf as_of = {};
};
struct SceneSummary {
  SceneRef scene = {};
  size_t observations = 0;
  bool has_pose = false;
  std::vector<std::pair<std::string, double>> looked_at = {};  ///< places and how much of them it saw
  TimeNs known_from = 0;
};
struct ScenesAnswer {
  std::vector<SceneSummary> scenes = {};
};

struct TimelineQuestion {
  std::optional<TimeNs> from = {}, to = {};
  AsOf as_of = {};
};
struct TimelineEntry {
  SceneSummary scene = {};
  std::vector<ObjectRef> seen = {};
  std::vector<Change> changes = {};
};
struct TimelineAnswer {
  std::vector<TimelineEntry> entries = {};
};

// An X that nobody knows is an Error with the nearest names.
WhereAnswer ask(const Store& store, const WhereQuestion& question);
HistoryAnswer ask(const Store& store, const HistoryQuestion& question);
ContentsAnswer ask(const Store& store, const ContentsQuestion& question);
WasAnswer ask(const Store& store, const WasQuestion& question);
ChangesAnswer ask(const Store& store, const ChangesQuestion& question);
ObjectsAnswer ask(const Store& store, const ObjectsQuestion& question);
ScenesAnswer ask(const Store& store, const ScenesQuestion& question);
TimelineAnswer ask(const Store& store, const TimelineQuestion& question);

}  // namespace loci::memory
