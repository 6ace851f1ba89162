#pragma once

#include <map>

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// The furniture and what opens: room, opens. From the map's links, what scenes saw of them, and the objects
// there.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> environment_questions();

// ---- room

struct RoomQuestion {
  std::string part = {};  ///< link, place, alias, appliance or class; empty = all
  AsOf as_of = {};
  std::string state = {};  ///< "empty" or "in use": only places that were looked at and are so; empty = all
};
struct RoomAnswer {
  std::string asked = {}, state = {};
  std::string map = {};                        ///< its file name; empty = no map, only places that were found
  std::map<std::string, size_t> classes = {};  ///< number of parts
  std::vector<EnvironmentPart> parts = {};     ///< in the order of their names
};
/// UnknownName with the nearest names for an unknown part; so for opens.
RoomAnswer ask(const Store& store, const RoomQuestion& question);
std::string to_text(const RoomAnswer& answer, const TimeWriter& times);
void write_reply(const RoomAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const RoomAnswer& answer);

// ---- opens

struct OpensQuestion {
  std::string part = {};  ///< as for the room
  /// "open" or "closed": only those; "unopened": only those that did not open in the period; empty = all
  std::string state = {};
  AsOf as_of = {};
  std::optional<TimeNs> from = {}, to = {};
};
struct OpensAnswer {
  std::string asked = {};
  std::string state = {};
  std::vector<EnvironmentPart> parts = {};
  // With a state: those that are not so, and those of which no look shows whether they are.
  std::vector<EnvironmentPart> others = {}, not_observed = {};
};
OpensAnswer ask(const Store& store, const OpensQuestion& question);
std::string to_text(const OpensAnswer& answer, const TimeWriter& times);
void write_reply(const OpensAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const OpensAnswer& answer);

}  // namespace loci::memory
