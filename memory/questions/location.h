#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// Where objects are and were: where, history.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> location_questions();

// ---- where

struct WhereQuestion {
  std::string subject = {};
  AsOf as_of = {};
};
struct WhereAnswer {
  std::string asked = {};
  std::vector<ObjectBelief> objects = {};  ///< most probable first, then most recent
};
/// UnknownName with the nearest names where the subject means nothing in this memory; so for all questions.
WhereAnswer ask(const Store& store, const WhereQuestion& question);
std::string to_text(const WhereAnswer& answer, const TimeWriter& times);
void write_reply(const WhereAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const WhereAnswer& answer);

// ---- history

/// A period in which an object was seen at one spot.
struct Stay {
  std::optional<PlaceRef> place = {};
  std::optional<Vector3d> position = {};  ///< mean
  std::vector<SceneRef> scenes = {};      ///< in which it was seen there
  double probability = 1;                 ///< least probable of the observations
  bool moved_in = false;                  ///< since the stay before it was at another place, or away
};
struct HistoryQuestion {
  std::string subject = {};
  std::optional<TimeNs> from = {}, to = {};  ///< only stays and changes that reach into this period
  AsOf as_of = {};
  std::string place = {};  ///< only stays there; empty = everywhere
  /// Only the stay before, or after, the last one at this place ("here": where it was seen last); empty =
  /// all.
  std::string before = {}, after = {};
};
struct ObjectHistory {
  ObjectBelief now = {};
  std::vector<Stay> stays = {};
  std::vector<Change> changes = {};
};
struct HistoryAnswer {
  std::string asked = {};
  std::vector<ObjectHistory> objects = {};
};
HistoryAnswer ask(const Store& store, const HistoryQuestion& question);
/// From the first to the last sighting of each time that an object was at one place: a stay goes on while it
/// is there, whichever spot of the place that is.
std::vector<TimeSpan> spans_of(const std::vector<Stay>& stays);
std::string to_text(const HistoryAnswer& answer, const TimeWriter& times);
void write_reply(const HistoryAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const HistoryAnswer& answer);

}  // namespace loci::memory
