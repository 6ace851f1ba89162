#include "memory/questions/contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

Verdict verdict_of(const std::vector<PlaceContents>& places, size_t wanted) {
  size_t there = 0;
  for (const PlaceContents& contents : places)
    for (const ObjectBelief& object : contents.there) there += object.probability >= 0.5 ? 1 : 0;
  if (there > 0) return there >= wanted ? Verdict::yes : Verdict::no;
  const bool seen_empty = std::ranges::all_of(places, [](const PlaceContents& contents) {
    return contents.there.empty() && contents.fraction.value_or(0) >= kMinSeenFraction;
  });
  return seen_empty ? Verdict::no : Verdict::not_observed;
}

bool more_probable(const ObjectBelief& a, const ObjectBelief& b) {
  return a.probability != b.probability ? a.probability > b.probability : a.object.id < b.object.id;
}

/// `meant`: the objects asked about; unset = all.
PlaceContents contents_of(const Snapshot& snapshot, const PlaceRow& place,
                          const std::optional<std::set<Id>>& meant, size_t max_gone) {
  const Store& store = snapshot.store();
  PlaceContents contents{.place = {place.id, place.name, place.container}};
  for (const Id object : snapshot.objects_at(place.id))
    if (!meant || meant->contains(object)) contents.there.push_back(snapshot.object_belief(object));
  Store::Gone gone = store.objects_gone_from(place.id, meant ? std::numeric_limits<size_t>::max() : max_gone,
                                             snapshot.as_of());
  std::erase_if(gone.objects, [&](Id object) { return meant && !meant->contains(object); });
  contents.gone_in_all = meant ? gone.objects.size() : gone.in_all;
  gone.objects.resize(std::min(gone.objects.size(), max_gone));
  for (const Id object : gone.objects) contents.gone.push_back(snapshot.object_belief(object));
  for (auto* list : {&contents.there, &contents.gone}) std::ranges::sort(*list, more_probable);
  if (const std::optional<VisibilityRow> view = store.last_visibility(place.id, snapshot.as_of())) {
    contents.last_view = snapshot.scene_ref(view->scene);
    contents.fraction = view->fraction;
  }
  return contents;
}

std::string view_text(const PlaceContents& contents, const TimeWriter& times) {
  if (!contents.last_view) return "never looked at";
  return fmt::format("last looked at {} ({}{})", times.text(contents.last_view->time),
                     scene_text(*contents.last_view),
                     contents.fraction ? fmt::format(", {:.0f} % of it", 100 * *contents.fraction) : "");
}

const Record<PlaceContents>& place_contents_record() {
  static const auto record =
      Record<PlaceContents>("PlaceContents")
          .value("place", &PlaceContents::place)
          .value("container", [](const PlaceContents& contents) { return contents.place.container; })
          .record("objects", &PlaceContents::there, belief_record())
          .record("gone", &PlaceContents::gone, belief_record())
          .value("gone_in_all",
                 [](const PlaceContents& contents) {
                   return contents.gone_in_all > contents.gone.size() ? std::optional(contents.gone_in_all)
                                                                      : std::nullopt;
                 })
          .record("last_look", &PlaceContents::last_view, scene_record())
          .value("fraction", &PlaceContents::fraction);
  return record;
}

constexpr std::array<std::pair<const char*, Relation>, 8> kRelations = {{{"near", Relation::near},
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

/// Relations to the point of an answer.
class RelationTest {
 public:
  /// Error where the view decides and is not known.
  RelationTest(const Snapshot& snapshot, const NearAnswer& answer) : relation_(answer.relation) {
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

  bool holds(const BeliefRow& belief, const Vector3d& offset) const {
    if (relation_ == Relation::near) return true;
    if (relation_ == Relation::between) return is_between(belief, offset);
    if (relation_ == Relation::on) return around_ != nullptr && stands_on(belief, *around_);
    if (relation_ == Relation::under) return around_ != nullptr && stands_on(*around_, belief);
    if (around_ != nullptr && around_->place != belief.place) return false;
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
  for (const Id object : snapshot.present_objects()) {
    if (meant && !meant->contains(object)) continue;
    const BeliefRow& belief = *snapshot.belief(object);
    if (!belief.position || object_name(object) == answer.around) continue;
    Vector3d offset = *belief.position - answer.point;
    if (answer.level) offset.z() = 0;
    if (offset.norm() <= answer.radius_m && relation.holds(belief, offset))
      answer.objects.push_back({snapshot.object_belief(belief), offset.norm()});
  }
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

ContentsAnswer ask(const Store& store, const ContentsQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ContentsAnswer answer{.asked = question.place, .subject = question.subject};
  const std::vector<PlaceRow> places = snapshot.find_places(question.place);
  std::optional<std::set<Id>> meant;
  if (!question.subject.empty()) {
    const std::vector<Id> objects = snapshot.find_objects(question.subject);
    meant.emplace(objects.begin(), objects.end());
  }
  for (const PlaceRow& place : places)
    answer.places.push_back(contents_of(snapshot, place, meant, question.max_gone));
  answer.verdict = verdict_of(answer.places, question.count);
  return answer;
}

std::string to_text(const ContentsAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const PlaceContents& contents : answer.places) {
    const std::string where = place_text(contents.place), view = view_text(contents, times);
    if (contents.there.empty() && !answer.subject.empty())
      lines.push_back(fmt::format("No '{}' is known to be {} ({}).", answer.subject, where, view));
    else if (contents.there.empty())
      lines.push_back(fmt::format("Nothing is known to be {} ({}).", where, view));
    else
      lines.push_back(fmt::format("{} {} {} ({}):", counted(contents.there.size(), "object"),
                                  contents.there.size() == 1 ? "is" : "are", where, view));
    for (const ObjectBelief& object : contents.there) lines.push_back("  " + belief_text(object, times));
    for (const ObjectBelief& object : contents.gone)
      lines.push_back("  no longer: " + belief_text(object, times));
    if (contents.gone_in_all > contents.gone.size())
      lines.push_back(fmt::format("  no longer: {} more", contents.gone_in_all - contents.gone.size()));
  }
  return lines_text(lines);
}

namespace {

const Record<ContentsAnswer>& contents_record() {
  static const auto record =
      Record<ContentsAnswer>("ContentsAnswer")
          .value("asked", &ContentsAnswer::asked)
          .value("verdict", &ContentsAnswer::verdict)
          .record("places", &ContentsAnswer::places, place_contents_record())
          .value("subject", [](const ContentsAnswer& answer) { return unless_empty(answer.subject); });
  return record;
}

}  // namespace

Json to_json(const ContentsAnswer& answer) {
  return contents_record().json(answer);
}

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

std::string to_text(const NearAnswer& answer, const TimeWriter& times) {
  const std::string around = answer.around.empty() ? point_text(answer.point) : answer.around;
  if (answer.objects.empty())
    return fmt::format("Nothing is believed to be within {:.2f} m of {}.\n", answer.radius_m, around);
  std::vector<std::string> lines = {fmt::format("Within {:.2f} m of {}:", answer.radius_m, around)};
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

/// The sentences of `on` and `in`, which differ in their preposition ($p).
std::vector<SentenceForm> contents_sentences(const std::string& preposition) {
  using enum Asks;
  const bool on = preposition == "on";
  const auto example = [on](const char* of_on, const char* of_in = "") {
    return std::string(on ? of_on : of_in);
  };
  const std::map<std::string, std::string> of_kind = {{"object", "{object} {kind}"}};
  std::vector<SentenceForm> forms = {
      {"bare: any thing $p<place> [leave|keep|put|else]", exists, ""},
      {"yes: thing $p<place> [leave|keep|put|else]", exists,
       example("Is there anything on the couch table?")},
      {"yes|bare: there|have|any|exist <object> $p<place> [leave|keep|put]", exists,
       example("Is there any cereal on the kitchen table?", "Do we have milk in the fridge?")},
      {"yes|bare: count<count> <object> $p<place> [leave|keep|put|have]", verdict,
       example("Are there two cups on the counter?")},
      {"yes|bare: every <object> $p<place> [keep|put|leave]", all, example("Are both cups on the counter?")},
      {"yes|bare: only|alone <object> $p<place> [thing|keep|leave|put]", only,
       example("Is the milk the only object on the table?")},
      {"yes|bare: back <object> $p<place> [come|put|bring|take|go|leave]", verdict,
       example("Is the tea back on the counter?")},
      {"yes|bare: <object> $p<place> [keep|put|leave|asusual]", verdict,
       example("Is the milk still on the table?")},
      {"yes|bare: nothing $p<place> [leave|else]", empty},
      {"yes|bare: nolonger <object> $p<place> [there|any|keep|put|leave]", empty,
       example("Is the milk no longer on the table?")},
      {"howsure: <object> $p<place> [keep|put|leave]", probability,
       example("How sure are you that the milk is on the table?")},
      {"why: <object> $p<place> [keep|put|leave]", reason,
       example("Why do you think that the milk is on the table?")},
      {"how: know|think|sure <object> $p<place>", reason},
      {"why: not <object> $p<place> [keep|put|leave]",
       why_not,
       example("Why is the plate not on the table?"),
       {},
       SentenceTime::at},
      {"howmany: thing $p<place> [leave|keep|last]", number, example("How many objects are on the counter?")},
      {"howmany: <object> $p<place> [leave|keep]", number, example("How many cups are on the table?")},
      {"what: $p<place> [thing|put|leave|content|else|everything|keep]", objects,
       example("What is on the table?", "What is in the first drawer?")},
      {"what: which<object> $p<place> [put|leave|else|keep]", objects,
       example("Which cup is on the counter?")},
      {"what: which<kind> $p<place> coloured<object> -was", objects, "", of_kind},
      {"what: $p<place> coloured<object> [thing] -was", objects},
      {"howmany: <kind> $p<place> coloured<object> -was", number, "", of_kind},
      {"order: show|list|name|tell|give|print|report|find|return|enumerate $p<place> "
       "[thing|everything|content|leave|keep|put]",
       objects, example("Show me everything on the shelf")},
      {"order: show|list|name|tell|print|report|return <object> $p<place> [everything]", objects},
      {"what|bare: content|list $p<place> [thing|everything]", objects},
      {"bare: thing|everything $p<place> [leave|last]", objects},
      {"when: look $p<place> [last]", last_time, example("When did you last look at the shelf?")},
      {"howlong: look $p<place> [ago|last|not]", ago, example("How long ago did you look at the shelf?")},
  };
  if (on)
    forms.insert(forms.end(), {{"yes|bare: empty <place> [every]", empty, "Is the table free?"},
                               {"yes: clean <place> -did|have|may|person", empty},
                               {"yes|bare: every|everything empty|clean|take|go|vanish|put|move|bring "
                                "from<place> [away]",
                                empty, "Has everything been cleared off the table?"},
                               {"yes|bare: everything from<place>", empty},
                               {"what: else there", objects, "", {{"place", "there"}}},
                               {"yes: full <place>", exists},
                               {"when: look|see <place> [last]", last_time},
                               {"when: look into<place> [last]", last_time},
                               {"howlong: look|see <place> [ago|last|not]", ago},
                               {"what: look like <place>", objects},
                               {"how: look <place>", objects}});
  else
    forms.insert(forms.end(), {{"what: contain <place> [thing|find]", objects},
                               {"yes: contain thing <place>", exists},
                               {"yes|bare: inside have thing <place>", exists},
                               {"yes|bare: inside have <place> <object>", exists},
                               {"what: inside have <place> [thing]", objects},
                               {"yes|bare: contain <place> <object>", exists},
                               {"bare|order|what: content <place> [show|list|name|give|tell|everything]",
                                objects, "Contents of the first drawer?"}});
  for (SentenceForm& form : forms)
    for (size_t at = form.form.find("$p"); at != std::string::npos; at = form.form.find("$p"))
      form.form.replace(at, 2, preposition);
  return forms;
}

/// "Which cup on the table is behind the milk?": what is asked for is at a place.
std::vector<SentenceForm> with_place(std::vector<SentenceForm> forms) {
  const std::string which = "what: ", object = "which<object> ";
  for (size_t i = 0, count = forms.size(); i < count; ++i) {
    const size_t named = forms[i].form.find(object);
    const bool nearest = forms[i].form.find("nearest") != std::string::npos;
    if (!forms[i].form.starts_with(which) || (named == std::string::npos && !nearest)) continue;
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
      {"what: else near<around> [thing|stand]", objects, "What else is there beside the red cup?"},
      {"order: show|list|name near<around> [thing|everything]", objects},
      {"what: which<object> near<around> [stand]", objects},
      {"what: within<radius> <around> [thing|stand]", objects, "What is within 50 cm of the red cup?"},
      {"what: within<radius> from<around> [thing|stand]", objects},
      {"what: within<radius> near<around> [thing|stand]", objects},
      {"yes|bare: thing near<around> [stand]", exists, "Is there anything next to the milk?"},
      {"yes|bare: <object> near<around> [stand|put|keep]", verdict, "Is the oil next to the pot?"},
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
  // "Is the cup behind something?" asks whether anything is in front of it.
  for (const auto& [word, inverse] : std::map<std::string, std::string>{{"behind", "in-front"},
                                                                        {"infront", "behind"},
                                                                        {"leftof", "right"},
                                                                        {"rightof", "left"},
                                                                        {"near", "near"},
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

Question contents_question(const char* name, const char* description, const std::string& example,
                           const std::string& preposition) {
  return {
      .name = name,
      .description = description,
      .parameters = {place_parameter(),
                     only_object_parameter(),
                     count_parameter(),
                     {.name = "except", .type = ParameterType::object, .help = "What the reply leaves out"}},
      .examples = {example, example + " --at 08:30"},
      .answer = format::schema_by<contents_record>,
      .run = [](const Arguments& given) -> Answer {
        ContentsQuestion question{given.text("place"), given.as_of(), given.text("object")};
        question.count = static_cast<size_t>(given.number("count").value_or(1));
        return ask(given.store(), question);
      },
      .time = SentenceTime::moment_or_period,
      .over_period = "contents-history",
      .sentences = contents_sentences(preposition)};
}

}  // namespace

std::vector<Question> contents_questions() {
  return {
      contents_question("on", "What is on a place", "table_1", "on"),
      contents_question("in", "What is in a place", "drawer_1", "in"),
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
             .help = "Only what stands on the object or under it, or is beside it as the camera saw it last",
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
