#pragma once

#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// A day in one answer: digest.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> digest_questions();

struct DigestQuestion {
  std::string day = {};  ///< "yesterday", "2026-05-01", or any time of it; empty = that of the last scene
  AsOf as_of = {};
};
struct MisplacedObject {
  ObjectBelief now = {};
  PlaceRef usual = {};   ///< where at least half of its sightings were
  size_t sightings = 0;  ///< there
  double share = 0;      ///< of all its sightings at places
};
/// What is believed to be elsewhere than where at least half of its sightings were, three or more.
std::vector<MisplacedObject> misplaced_objects(const Store& store, const AsOf& as_of);

/// What a day left behind, as of its end or of the last scene.
struct DigestAnswer {
  TimeNs from = 0, to = 0;  ///< a day in the memory's zone
  std::string day = {};     ///< "2026-05-01"
  size_t scenes = 0;
  std::vector<Change> changes = {};
  std::vector<MisplacedObject> misplaced = {};
  std::vector<ObjectBelief> missing = {};  ///< gone, and seen in the week before; last seen first
};
/// Error when the day is not a time, or the memory has no scenes.
DigestAnswer ask(const Store& store, const DigestQuestion& question);
std::string to_text(const DigestAnswer& answer, const TimeWriter& times);
void write_reply(const DigestAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const DigestAnswer& answer);
/// "mug is on table_1, usually on counter_1 (80 % of its sightings)".
std::string to_text(const MisplacedObject& object);

}  // namespace loci::memory
