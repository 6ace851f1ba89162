#include "memory/questions/near.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "mapping/base/math/polygon.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

constexpr std::array<std::pair<const char*, Relation>, 9> kRelations = {{{"near", Relation::near},
                                                                         {"next-to", Relation::next_to},
                                                                         {"between", Relation::between},
                                                                         {"on", Relation::on},
                                                                         {"under", Relation::under},
                                                                         {"left", Relation::left},
                                                                         {"right", Relation::right},
                                                                         {"behind", Relation::behind},
                                                                         {"in-front", Relation::in_front}}};

Relation relation_called(const std::string& name) {
  const auto found = std::ranges::find(kRelations, name, [](const auto& one) { return one.first; });
  return found == kRelations.end() ? Relation::near : found->second;
}

std::string name_of(Relation relation) {
  return std::ranges::find(kRelations, relation, [](const auto& one) { return one.second; })->first;
}

bool depends_on_view(Relation relation) {
  return relation == Relation::left || relation == Relation::right || relation == Relation::behind ||
         relation == Relation::in_front;
}

/// What the point may be, one answer for each: of objects that are called so those that have not gone, else
/// one that has.
std::vector<NearAnswer> located(const Snapshot& snapshot, const std::string& subject, NearAnswer answer) {
  if (const auto numbers = read_point(subject); !numbers.empty()) {
    answer.level = numbers.size() == 2;
    answer.point = {numbers[0], numbers[1], answer.level ? 0 : numbers[2]};
    if (!snapshot.scenes().empty()) answer.seen = snapshot.scene_ref(snapshot.scenes().back());
    return {answer};
  }
  if (subject.find(',') != std::string::npos &&
      subject.find_first_not_of("0123456789+-.,eExX ") == std::string::npos)
    throw Error(fmt::format("'{}' is no point", subject), {}, "write x,y or x,y,z in metres, e.g. 1.0,0.5");
  const std::vector<PlaceRow> places = snapshot.places_called(subject);
  if (answer.relation == Relation::on && !places.empty())
    throw UnknownName(UnknownName::Kind::object, fmt::format("'{}' is a place, not an object", subject), {},
                      "");
  if (!places.empty()) {
    const std::optional<Vector3d> centre = centre_of(places[0]);
    if (!centre) throw Error(fmt::format("the position of {} is not known", places[0].name));
    answer.around = places[0].name;
    answer.point = *centre;
    answer.level = true;
    if (const auto view = snapshot.store().last_visibility(places[0].id, snapshot.as_of()))
      answer.seen = snapshot.scene_ref(view->scene);
    return {answer};
  }
  std::vector<NearAnswer> answers;
  const std::vector<Id> objects = snapshot.find_objects(subject);
  for (const bool gone : {false, true})
    for (const Id object : objects) {
      const BeliefRow& belief = *snapshot.belief(object);
      if (!belief.position || (belief.status == ObjectStatus::gone) != gone) continue;
      answer.around = object_name(object);
      answer.point = *belief.position;
      answer.seen = snapshot.scene_ref(belief.last_scene);
      if (!gone || answers.empty()) answers.push_back(answer);
    }
  if (answers.empty()) throw Error(fmt::format("the position of '{}' is not known", subject));
  return answers;
}

/// Over the footprint of the lower one, and higher.
bool stands_on(const BeliefRow& upper, const BeliefRow& lower) {
  const Vector3d offset = *upper.position - *lower.position;
  return lower.size && lower.place == upper.place && offset.z() > 0 &&
         offset.head<2>().norm() <= lower.size->head<2>().maxCoeff() / 2;
}

/// What an object takes up of its place, map frame; its centre where nothing says more.
Polygon footprint(const Store& store, const BeliefRow& belief) {
  const std::optional<ObservationRow> seen =
      belief.last_observation ? std::optional(store.observation(*belief.last_observation)) : std::nullopt;
  const BelievedBox box = *believed_box(belief, seen ? &*seen : nullptr);
  const Vector3d half = box.size.value_or(Vector3d::Zero()) / 2;
  Polygon corners;
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
    corners.push_back((box.map_from_box * Vector3d(x * half.x(), y * half.y(), 0)).head<2>());
  return corners;
}

/// Whether the gap between two objects at one place is smaller than the smaller of them: nothing like it fits
/// in between.
bool are_side_by_side(const Store& store, const BeliefRow& one, const BeliefRow& other) {
  if (one.place != other.place) return false;
  const Polygon a = footprint(store, one), b = footprint(store, other);
  if (shared_area(a, b) > 0) return true;
  double gap = std::numeric_limits<double>::infinity();
  for (const Vector2d& corner : a) gap = std::min(gap, distance_to_edge(b, corner));
  for (const Vector2d& corner : b) gap = std::min(gap, distance_to_edge(a, corner));
  const auto width = [](const Polygon& box) {
    return std::max((box[1] - box[0]).norm(), (box[2] - box[1]).norm());
  };
  return gap <= std::min(width(a), width(b));
}

/// Relations to the point of an answer.
class RelationTest {
 public:
  /// Error where the view decides and is not known.
  RelationTest(const Snapshot& snapshot, const NearAnswer& answer)
      : store_(snapshot.store()), relation_(answer.relation) {
    if (const auto around = object_id(answer.around)) around_ = snapshot.belief(*around);
    if (const auto with = object_id(answer.with)) with_ = snapshot.belief(*with);
    if (!depends_on_view(relation_)) return;
    const SceneRow* scene = answer.seen ? snapshot.scene(answer.seen->scene) : nullptr;
    if (scene == nullptr || !scene->map_from_camera)
      throw Error(fmt::format("from where '{}' was seen is not known", answer.asked), {},
                  "ask what is near it");
    forward_ = (answer.point - scene->map_from_camera->translation()).normalized().head<2>();
    // To a camera that looks down, what is further up in the image is behind.
    constexpr double kSteep = 0.35;  // horizontal part of a view 70 degrees down
    if (forward_.norm() < kSteep) forward_ = -scene->map_from_camera->linear().col(1).head<2>();
  }

  bool is_at_place(const BeliefRow& belief) const {
    return around_ == nullptr || around_->place == belief.place;
  }
  bool holds(const BeliefRow& belief, const Vector3d& offset) const {
    if (relation_ == Relation::near) return true;
    if (relation_ == Relation::next_to)
      return around_ == nullptr || are_side_by_side(store_, *around_, belief);
    if (relation_ == Relation::between) return is_between(belief, offset);
    if (relation_ == Relation::on) return around_ != nullptr && stands_on(belief, *around_);
    if (relation_ == Relation::under) return around_ != nullptr && stands_on(*around_, belief);
    if (!is_at_place(belief)) return false;
    const double back = forward_.dot(offset.head<2>());
    const double left = forward_.x() * offset.y() - forward_.y() * offset.x();
    if (std::abs(back) >= std::abs(left))
      return relation_ == (back > 0 ? Relation::behind : Relation::in_front);
    return relation_ == (left > 0 ? Relation::left : Relation::right);
  }

 private:
  /// Over the line between the two, or beside it.
  bool is_between(const BeliefRow& belief, const Vector3d& offset) const {
    constexpr double kBeside = 0.2;
    if (around_ == nullptr || with_ == nullptr || &belief == with_ || belief.object == with_->object ||
        belief.place != around_->place)
      return false;
    const Vector2d line = (*with_->position - *around_->position).head<2>();
    const double along = offset.head<2>().dot(line) / line.squaredNorm();
    return along > 0 && along < 1 && (offset.head<2>() - along * line).norm() <= kBeside;
  }

  const Store& store_;
  Relation relation_;
  const BeliefRow *around_ = nullptr, *with_ = nullptr;
  Vector2d forward_ = Vector2d::Zero();  ///< from the camera, over the floor
};

/// The objects that the answer may name; unset = all.
std::optional<std::set<Id>> meant_by(const Snapshot& snapshot, const NearQuestion& question) {
  if (question.only.empty() && question.place.empty()) return std::nullopt;
  const std::vector<Id> objects =
      question.only.empty() ? snapshot.present_objects() : snapshot.find_objects(question.only);
  std::set<Id> meant(objects.begin(), objects.end());
  if (question.place.empty()) return meant;
  std::set<Id> there;
  for (const PlaceRow& place : snapshot.find_places(question.place))
    for (const Id object : snapshot.objects_at(place.id))
      if (meant.contains(object)) there.insert(object);
  return there;
}

/// Adds what is near the point. `meant`: only these; unset = all.
void add_near(const Snapshot& snapshot, const NearQuestion& question,
              const std::optional<std::set<Id>>& meant, NearAnswer& answer) {
  const RelationTest relation(snapshot, answer);
  const auto is_meant = [&](Id object) { return !meant || meant->contains(object); };
  std::optional<NearObject> nearest;  // of all at the same place
  for (const Id object : snapshot.present_objects()) {
    const BeliefRow& belief = *snapshot.belief(object);
    if (!belief.position || object_name(object) == answer.around) continue;
    Vector3d offset = *belief.position - answer.point;
    if (answer.level) offset.z() = 0;
    if (offset.norm() > answer.radius_m) continue;
    const NearObject near{snapshot.object_belief(belief), offset.norm()};
    if (relation.is_at_place(belief) && (!nearest || near.distance_m < nearest->distance_m)) nearest = near;
    if (is_meant(object) && relation.holds(belief, offset)) answer.objects.push_back(near);
  }
  if (answer.relation == Relation::next_to && answer.objects.empty() && nearest &&
      is_meant(nearest->object.object.id))
    answer.objects.push_back(*nearest);
  std::ranges::stable_sort(answer.objects, {}, &NearObject::distance_m);
  if (question.farthest && answer.objects.size() > 1)
    answer.objects.erase(answer.objects.begin(), answer.objects.end() - 1);
  if (question.count > 0 && answer.objects.size() > question.count) answer.objects.resize(question.count);
}

/// Each with every other object that `with` means at the same place; Error where there is none.
std::vector<NearAnswer> with_others(const Snapshot& snapshot, const std::vector<NearAnswer>& answers,
                                    const std::string& with) {
  std::vector<NearAnswer> pairs;
  for (const NearAnswer& answer : answers) {
    const auto around = object_id(answer.around);
    for (const Id other : around ? snapshot.find_objects(with) : std::vector<Id>{}) {
      const BeliefRow &one = *snapshot.belief(*around), &two = *snapshot.belief(other);
      const bool there = one.status != ObjectStatus::gone && two.status != ObjectStatus::gone;
      if (other == *around || !there || !two.position || !one.place || one.place != two.place) continue;
      pairs.push_back(answer);
      pairs.back().with = object_name(other);
      pairs.back().radius_m = (*two.position - *one.position).norm();
    }
  }
  if (pairs.empty())
    throw Error(fmt::format("the {} and the {} are not known to be at one place",
                            answers.empty() ? "one" : answers.front().asked, with));
  return pairs;
}

}  // namespace

NearAnswer ask(const Store& store, const NearQuestion& question) {
  if (!(question.radius_m > 0) || !std::isfinite(question.radius_m))
    throw Error(fmt::format("a radius of {} m is not positive", question.radius_m), {},
                "give metres above 0");
  const Snapshot snapshot(store, question.as_of);
  const std::optional<std::set<Id>> meant = meant_by(snapshot, question);
  std::vector<NearAnswer> answers =
      located(snapshot, question.subject,
              {.asked = question.subject, .radius_m = question.radius_m, .relation = question.relation});
  const bool between = question.relation == Relation::between;
  if (between) answers = with_others(snapshot, answers, question.with);
  for (NearAnswer& answer : answers) {
    add_near(snapshot, question, meant, answer);
    // Of several boxes the one with something on it is meant.
    if (!answer.objects.empty()) return answer;
  }
  return answers.front();
}

std::string point_text(const NearAnswer& answer) {
  return answer.level ? fmt::format("({:.2f}, {:.2f})", answer.point.x(), answer.point.y())
                      : point_text(answer.point);
}

std::string to_text(const NearAnswer& answer, const TimeWriter& times) {
  const std::string around = answer.around.empty() ? point_text(answer) : answer.around;
  if (answer.objects.empty())
    return fmt::format("Nothing is believed to be within {:.2f} m of {}.\n", answer.radius_m, around);
  const std::string how = answer.relation == Relation::near ? "" : " (" + name_of(answer.relation) + ")";
  std::vector<std::string> lines = {fmt::format("Within {:.2f} m of {}{}:", answer.radius_m, around, how)};
  for (const NearObject& near : answer.objects)
    lines.push_back(fmt::format("  {:.2f} m: {}", near.distance_m, belief_text(near.object, times)));
  return lines_text(lines);
}

namespace {

const Record<NearObject>& near_object_record() {
  static const auto record = Record<NearObject>("NearObject")
                                 .with(&NearObject::object, belief_record())
                                 .value("distance", &NearObject::distance_m);
  return record;
}

const Record<NearAnswer>& near_record() {
  static const auto record =
      Record<NearAnswer>("NearAnswer")
          .value("asked", &NearAnswer::asked)
          .value("point", &NearAnswer::point)
          .value("radius", &NearAnswer::radius_m)
          .value("around", [](const NearAnswer& answer) { return unless_empty(answer.around); })
          .value("with", [](const NearAnswer& answer) { return unless_empty(answer.with); })
          .value("level", [](const NearAnswer& answer) { return if_true(answer.level); })
          .value("relation", [](const NearAnswer& answer) { return name_of(answer.relation); })
          .record(
              "seen",
              [](const NearAnswer& answer) {
                return depends_on_view(answer.relation) ? answer.seen : std::nullopt;
              },
              scene_record())
          .record("objects", &NearAnswer::objects, near_object_record());
  return record;
}

}  // namespace

Json to_json(const NearAnswer& answer) {
  return near_record().json(answer);
}

namespace {

/// "Which cup on the table is behind the milk?", "What on the table is left of it?": what is asked for is at
/// a place.
std::vector<SentenceForm> with_place(std::vector<SentenceForm> forms) {
  const std::string which = "what: ", object = "which<object> ";
  for (size_t i = 0, count = forms.size(); i < count; ++i) {
    const size_t named = forms[i].form.find(object);
    const bool is_place =
        forms[i].form.find(" on<") != std::string::npos || forms[i].form.find(" in<") != std::string::npos;
    if (!forms[i].form.starts_with(which) || is_place) continue;
    SentenceForm at_place = forms[i];
    at_place.form.insert(named == std::string::npos ? which.size() : named + object.size(), "at<place> ");
    at_place.example.clear();
    forms.push_back(std::move(at_place));
  }
  return forms;
}

std::vector<SentenceForm> near_sentences() {
  using enum Asks;
  const std::map<std::string, std::string> on_top = {{"relation", "on"}}, between = {{"relation", "between"}};
  const std::map<std::string, std::string> one = {{"count", "1"}, {"radius", "10 m"}},
                                           farthest = {{"radius", "10 m"}, {"order", "farthest"}};
  std::vector<SentenceForm> forms = {
      {"what: nearest near<around> [thing]", objects, "Which object is nearest to the pot?", one},
      {"what: nearest <around> [thing]", objects, "", one},
      {"what: nearest to<around> [thing]", objects, "", one},
      {"what: nearest|nearer which<object> near<around>", objects, "", one},
      {"what: nearest|nearer which<object> to<around>", objects, "", one},
      {"what: farthest from<around> [thing|away]", objects, "Which object is farthest from the pot?",
       farthest},
      {"what: farthest which<object> from<around> [away]", objects, "", farthest},
      {"what: near<around> [thing|stand|else|put|leave|see|keep|find]", objects, "What is near the red cup?"},
      {"what: else near<around> [thing|stand]", objects},
      {"order: show|list|name near<around> [thing|everything]", objects},
      {"what: which<object> near<around> [stand]", objects},
      {"what: within<radius> <around> [thing|stand]", objects, "What is within 50 cm of the red cup?"},
      {"what: within<radius> from<around> [thing|stand]", objects},
      {"what: within<radius> near<around> [thing|stand]", objects},
      {"yes|bare: thing near<around> [stand]", exists},
      {"yes|bare: <object> near<around> [stand|put|keep]", verdict},
      {"yes|bare: there|any <object> near<around> [stand]", exists},
      {"what: between<around> and<with> [thing|stand]", objects, "What is between the cup and the pot?",
       between},
      {"yes|bare: thing between<around> and<with> [stand]", exists, "", between},
      {"yes|bare: there|any <object> between<around> and<with> [stand]", exists, "", between},
      {"yes|bare: <object> between<around> and<with> [stand]", verdict, "", between},
      {"what|yes|bare: pos<around> [thing|stand|see|find]", agent},
      {"yes|bare: <any> pos<around> [stand]", agent},
      {"what: which<any> pos<around> [stand]", agent},
  };
  // The neighbours of an object are fewer than what is near it.
  static const std::map<std::string, std::string> examples = {
      {"what: near<around>", "What is next to the red cup?"},
      {"what: else near<around>", "What else is there beside the red cup?"},
      {"yes|bare: thing near<around>", "Is there anything next to the milk?"},
      {"yes|bare: <object> near<around>", "Is the oil next to the pot?"}};
  for (size_t i = 0, count = forms.size(); i < count; ++i) {
    const size_t relation = forms[i].form.find("near<around>");
    if (relation == std::string::npos) continue;
    SentenceForm beside = forms[i];
    const auto example = examples.find(beside.form.substr(0, relation) + "near<around>");
    beside.example = example == examples.end() ? "" : example->second;
    beside.form.replace(relation, 4, "nextto");
    if (beside.arguments.empty() && beside.form.find("within") == std::string::npos)
      beside.arguments = {{"relation", "next-to"}};
    forms.push_back(std::move(beside));
  }
  // "Is the cup behind something?" asks whether anything is in front of it.
  for (const auto& [word, inverse] : std::map<std::string, std::string>{{"behind", "in-front"},
                                                                        {"infront", "behind"},
                                                                        {"leftof", "right"},
                                                                        {"rightof", "left"},
                                                                        {"near", "near"},
                                                                        {"nextto", "next-to"},
                                                                        {"on", "under"},
                                                                        {"under", "on"}})
    forms.push_back({fmt::format("yes: something <around> {}<any> [put|keep]", word),
                     exists,
                     "",
                     {{"relation", inverse}}});
  for (const auto& [word, relation] : std::map<std::string, std::string>{{"behind", "behind"},
                                                                         {"infront", "in-front"},
                                                                         {"leftof", "left"},
                                                                         {"rightof", "right"},
                                                                         {"under", "under"}}) {
    const std::map<std::string, std::string> so = {{"relation", relation}};
    const bool first = word == "behind";
    forms.push_back({"what: " + word + "<around> [thing|stand|see|find|put|keep]", objects,
                     first              ? "What is behind the milk?"
                     : word == "leftof" ? "What is to the left of the pot?"
                                        : "",
                     so});
    forms.push_back({"what: which<object> " + word + "<around> [stand|see]", objects, "", so});
    forms.push_back({"yes|bare: thing " + word + "<around> [stand|see]", exists, "", so});
    forms.push_back({"yes|bare: there|any <object> " + word + "<around> [stand|see]", exists, "", so});
    forms.push_back({"yes|bare: <object> " + word + "<around> [stand|put|keep]", verdict,
                     first ? "Is the oil behind the pot?" : "", so});
  }
  // On an object: places of these names come first.
  // What is in it is not recorded.
  for (const std::string at : {"on", "in"}) {
    const bool on = at == "on";
    forms.push_back(
        {"what: " + at + "<around> [thing|stand|else|put|see]", on ? objects : agent, "", on_top});
    forms.push_back({"yes|bare: thing " + at + "<around> [stand|see]", on ? exists : agent, "", on_top});
    forms.push_back({"yes|bare: <object> " + at + "<around> [stand|see|put]", on ? verdict : agent,
                     on ? "Is there an apple on the plate?" : "", on_top});
  }
  return with_place(std::move(forms));
}

std::vector<std::string> relation_names() {
  std::vector<std::string> names;
  for (const auto& [name, relation] : kRelations) names.emplace_back(name);
  return names;
}

}  // namespace

std::vector<Question> near_questions() {
  return {
      {.name = "near",
       .description = "What is within a radius of a point, object or place",
       .parameters =
           {{.name = "around",
             .type = ParameterType::spot,
             .help = "x,y or x,y,z in the map, an object, or a place",
             .positional = true,
             .required = true},
            {.name = "radius",
             .type = ParameterType::length,
             .help = "Between centres: metres, or \"50 cm\"",
             .default_text = "0.5 m"},
            {.name = "relation",
             .help = "next-to: only its neighbours; else only what stands on the object or under it, or is "
                     "beside it as the camera saw it last",
             .default_text = "near",
             .choices = relation_names()},
            {.name = "count",
             .type = ParameterType::number,
             .help = "Only so many, the nearest",
             .default_text = "all",
             .min = 1},
            {.name = "order",
             .help = "farthest: only the one that is farthest away",
             .default_text = "nearest",
             .choices = {"nearest", "farthest"}},
            {.name = "with",
             .type = ParameterType::object,
             .help = "Of --relation between: the other object"},
            only_object_parameter(),
            only_place_parameter()},
       .examples = {"red --radius 0.4", "2.0,1.0,0.8 --radius 1 --json"},
       .answer = format::schema_by<near_record>,
       .run = [](const Arguments& given) -> Answer {
         NearQuestion question{.subject = given.text("around"), .as_of = given.as_of()};
         question.only = given.text("object");
         question.place = given.text("place");
         question.with = given.text("with");
         question.relation = relation_called(given.text("relation"));
         if (!question.with.empty() && question.relation != Relation::between)
           throw Error("--with names the other object of --relation between");
         // What is left of it does not end at half a metre.
         const bool anywhere = depends_on_view(question.relation);
         question.radius_m = given.length("radius").value_or(anywhere ? 10 : question.radius_m);
         question.count = static_cast<size_t>(given.number("count").value_or(0));
         question.farthest = given.text("order") == "farthest";
         return ask(given.store(), question);
       },
       .sentences = near_sentences()},
  };
}

}  // namespace loci::memory
