#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/replies/reply.h"

namespace loci::memory {

// ---- people

inline constexpr const char* kPersonType = "loci.annotation.PersonAnnotation";

/// When people were in view. Who they are is not recognised.
struct PeopleQuestion {
  std::optional<TimeNs> from = {}, to = {};
  AsOf as_of = {};
};
struct PeopleAnswer {
  std::vector<SceneRef> scenes = {};  ///< with a person, in order of time
};
PeopleAnswer ask(const Store& store, const PeopleQuestion& question);
std::string to_text(const PeopleAnswer& answer, const TimeWriter& times);
/// That nobody was recognised does not say that nobody was there: looks see a part of the room and of the
/// time.
void write_reply(const PeopleAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const PeopleAnswer& answer);

std::vector<Question> people_questions();

}  // namespace loci::memory
