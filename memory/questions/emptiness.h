#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/replies/reply.h"

namespace loci::memory {

// ---- empty: when a place was looked at, when with nothing on it, and when with most

struct EmptinessQuestion {
  std::string place = {};
  AsOf as_of = {};
  std::optional<TimeNs> from = {}, to = {};  ///< only looks in this period
};
struct PlaceEmptiness {
  PlaceRef place = {};
  std::vector<SceneRef> views = {};               ///< scenes that saw any of it, in order of time
  size_t looks = 0;                               ///< those of them that saw at least half of it
  std::vector<SceneRef> empty = {};               ///< the looks in which nothing was there
  std::optional<SceneRef> first = {}, last = {};  ///< of the looks
  std::optional<SceneRef> fullest = {};           ///< the first of them in which most objects were there
  size_t most = 0;                                ///< how many there were then
  /// Whether something is known to have been there from the first look to the last one.
  bool occupied_throughout = false;
};
struct EmptinessAnswer {
  std::string asked = {};
  std::vector<PlaceEmptiness> places = {};
};
/// Something is at a place from its first sighting there to the last one of the same stay. UnknownName for an
/// unknown place.
EmptinessAnswer ask(const Store& store, const EmptinessQuestion& question);
std::string to_text(const EmptinessAnswer& answer, const TimeWriter& times);
void write_reply(const EmptinessAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const EmptinessAnswer& answer);

std::vector<Question> emptiness_questions();

}  // namespace loci::memory
