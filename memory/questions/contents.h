#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// What is at a place: on, in.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> contents_questions();

struct ContentsQuestion {
  std::string place = {};
  AsOf as_of = {};
  std::string subject = {};  ///< only these; empty = all objects
  size_t max_gone = 20;      ///< of the objects that are gone from it
  size_t count = 1;          ///< whether there are so many
};
struct PlaceContents {
  PlaceRef place = {};
  std::vector<ObjectBelief> there = {};    ///< believed to be there, most probable first
  std::vector<ObjectBelief> gone = {};     ///< were there last and were missed: the last to go
  size_t gone_in_all = 0;                  ///< of which those are the last ones
  std::optional<SceneRef> last_view = {};  ///< the last scene that saw any of it
  std::optional<double> fraction = {};     ///< of it that this scene saw
};
struct ContentsAnswer {
  std::string asked = {};
  std::string subject = {};  ///< empty = all objects
  /// Whether there is any, or as many as asked for: yes when so many are believed to be there, no when fewer
  /// are, or when none is and at least half of each place was seen, else not observed.
  Verdict verdict = Verdict::not_observed;
  std::vector<PlaceContents> places = {};
};
ContentsAnswer ask(const Store& store, const ContentsQuestion& question);
std::string to_text(const ContentsAnswer& answer, const TimeWriter& times);
void write_reply(const ContentsAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const ContentsAnswer& answer);

}  // namespace loci::memory
