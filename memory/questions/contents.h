#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// What is at a place or near a point: on, in, near.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> contents_questions();

// ---- on, in

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

// ---- near

/// Where an object is of what is asked about. `between` is beside the line from it to another. The last four
/// are quarters of the horizontal plane, as the camera saw it in the last scene that showed it.
enum class Relation { near, on, under, between, left, right, behind, in_front };

struct NearQuestion {
  std::string subject = {};  ///< "1.2,0.4" or "1.2,0.4,0.9" (map frame, metres), an object or a place
  double radius_m = 0.5;
  AsOf as_of = {};
  std::string only = {};   ///< only these objects; empty = all
  std::string place = {};  ///< only at this place; empty = everywhere
  std::string with = {};   ///< of `between`: the other object
  Relation relation = Relation::near;
  size_t count = 0;       ///< only so many, the nearest; 0 = all
  bool farthest = false;  ///< only the one that is farthest away
};
struct NearObject {
  ObjectBelief object = {};
  double distance_m = 0;  ///< between centres; horizontal when the point has no height
};
struct NearAnswer {
  std::string asked = {};
  std::string around = {};  ///< what the point is: "object_3", "table_1" or "" for coordinates
  std::string with = {};    ///< of `between`: the other object, "object_4"
  Vector3d point = Vector3d::Zero();
  bool level = false;  ///< the point has no height
  double radius_m = 0;
  Relation relation = Relation::near;
  std::optional<SceneRef> seen = {};  ///< the scene whose camera says what is left, right, behind, in front
  std::vector<NearObject> objects = {};  ///< nearest first; gone objects are left out
};
NearAnswer ask(const Store& store, const NearQuestion& question);
std::string to_text(const NearAnswer& answer, const TimeWriter& times);
void write_reply(const NearAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const NearAnswer& answer);

}  // namespace loci::memory
