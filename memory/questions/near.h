#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// What is near a point, or beside, on or under an object: near.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> near_questions();

/// Where an object is of what is asked about. `next_to` is near it without room for one of the two in
/// between; the nearest at its place in any case. `between` is beside the line from it to another. The last
/// four are quarters of the horizontal plane, as the camera saw it in the last scene that showed it.
enum class Relation { near, next_to, on, under, between, left, right, behind, in_front };

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
/// The point asked about: "(1.00, 2.00, 0.80)", or "(1.00, 2.00)" without a height.
std::string point_text(const NearAnswer& answer);
std::string to_text(const NearAnswer& answer, const TimeWriter& times);
void write_reply(const NearAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const NearAnswer& answer);

}  // namespace loci::memory
