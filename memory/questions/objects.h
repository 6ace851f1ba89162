#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/facts.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// The objects and what is known of them: objects, about.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> object_questions();

enum class ObjectFilter {
  all,
  /// That have gone, or were missed where they should be; of a period that is over, those that were found to
  /// have gone in it.
  gone,
  unmoved,  ///< that are there and were not moved, in the period where there is one
};

struct ObjectsQuestion {
  std::string subject = {};  ///< empty = all
  AsOf as_of = {};
  std::optional<TimeNs> unseen_since =
      {};  ///< only those that no scene has seen since then, gone ones included
  std::optional<TimeNs> from = {}, to = {};  ///< only those that were seen in this period
  ObjectFilter filter = ObjectFilter::all;
  /// Only those that are elsewhere; of a period, those that were not seen at this place in it, whether they
  /// were seen at all or not.
  std::string not_at = {};
};
struct ObjectsAnswer {
  std::vector<ObjectBelief> objects = {};
  size_t unconfirmed = 0;  ///< observations, of a memory without objects: what was seen once may be a mistake
};
ObjectsAnswer ask(const Store& store, const ObjectsQuestion& question);
std::string to_text(const ObjectsAnswer& answer, const TimeWriter& times);
void write_reply(const ObjectsAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const ObjectsAnswer& answer);

struct AboutQuestion {
  std::string subject = {};
  AsOf as_of = {};
  size_t max_sightings = 500;  ///< the last ones are asked for evidence
};
struct AboutObject {
  ObjectBelief now = {};
  std::vector<Fact> facts = {};
  std::vector<AnnotationSupport> evidence = {};
  size_t sightings = 0;  ///< that the evidence is of
};
struct AboutAnswer {
  std::string asked = {};
  std::vector<AboutObject> objects = {};
};
AboutAnswer ask(const Store& store, const AboutQuestion& question);
std::string to_text(const AboutAnswer& answer, const TimeWriter& times);
void write_reply(const AboutAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const AboutAnswer& answer);
Json to_json(const AnnotationSupport& evidence);

}  // namespace loci::memory
