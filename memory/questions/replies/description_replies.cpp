// The replies on which objects there are and what they look like: `objects` and `about`.

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "memory/questions/location.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/names.h"
#include "memory/questions/objects.h"
#include "memory/questions/presence.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"

namespace loci::memory {

using namespace format;
using namespace replies;

namespace {

/// "On counter_1 5 objects: cup, …": each object at its place.
void by_place(const std::vector<ObjectBelief>& there, const Names& names, Reply& reply) {
  std::vector<std::pair<PlaceRef, std::vector<std::string>>> places;
  for (const ObjectBelief& object : there) {
    if (!object.place) continue;
    auto at = std::ranges::find(places, object.place->id, [](const auto& one) { return one.first.id; });
    if (at == places.end()) at = places.insert(places.end(), {*object.place, {}});
    at->second.push_back(without_place(names.of(object.object)));
  }
  std::ranges::stable_sort(places, std::ranges::greater(), [](const auto& one) { return one.second.size(); });
  std::vector<std::string> counts;
  for (const auto& [place, objects] : places) {
    reply.places.push_back(place.name);
    counts.push_back(fmt::format("{} {}", objects.size(), in_words(place)));
    reply.evidence.push_back(fmt::format("{}: {}", in_words(place), list_in_words(objects, 12)));
  }
  reply.text = fmt::format("{}: {}.", counted(there.size(), "object"), list_in_words(counts, 6));
}

/// Where none is likely there: what has gone has, and the rest may still be there.
std::string none_in_words(const ObjectsAnswer& answer, const Names& names, const ReplyContext& context) {
  if (answer.objects.empty()) return trimmed(to_text(answer, context.times));
  std::vector<std::string> doubtful;
  for (const ObjectBelief& object : answer.objects)
    if (object.status != ObjectStatus::gone) doubtful.push_back(names.of(object.object));
  return doubtful.empty() ? fmt::format("None now: {} gone.", counted(answer.objects.size(), "object"))
                          : fmt::format("None surely; perhaps {}.", list_in_words(doubtful));
}

/// Whether there is a scene in the period of a query.
bool looked_then(const ReplyContext& context) {
  const TimeReader times(context.store);
  const std::string from = context.query.argument("from"), to = context.query.argument("to");
  const auto first = from.empty() ? std::nullopt : std::optional(times.read(from).first);
  const auto last = to.empty() ? std::nullopt : std::optional(times.read(to).last);
  return !context.store.scenes(context.as_of, first, last).empty();
}

/// Elsewhere than at a place, now or over a period.
std::string elsewhere_in_words(const std::vector<ObjectBelief>& there, const ReplyContext& context,
                               const Snapshot& snapshot, const std::string& list) {
  const std::string name = context.query.argument("not-at");
  const std::string place =
      (snapshot.find_places(name).front().container ? "in " : "on ") + name_in_words(name);
  const bool over = !context.query.argument("from").empty() || !context.query.argument("to").empty();
  if (there.empty()) return fmt::format("None that is known{}.", over ? ": each was seen there" : "");
  return fmt::format("{} {} {}: {}.", there.size(), over ? "not seen" : "not", place, list);
}

/// What the last look at its place missed has perhaps gone.
std::string missed_in_words(const std::vector<ObjectBelief>& missed, bool gone, Asks asks, const Names& names,
                            const std::string& list) {
  return fmt::format("{} {}, not seen at the last look.", gone ? "Perhaps" : "Probably",
                     asks == Asks::objects && missed.size() == 1
                         ? names.subject(missed[0].object)
                         : fmt::format("{}: {}", missed.size(), list));
}

/// Whether there are as many as asked for; what the last look missed is perhaps there.
void set_verdict(size_t there, size_t missed, const Query& query, Reply& reply) {
  const size_t wanted = std::max<size_t>(1, wanted_count(query));
  reply.verdict = there >= wanted            ? Verdict::yes
                  : there + missed >= wanted ? Verdict::not_observed
                                             : Verdict::no;
  reply.text = fmt::format("{}: {}",
                           *reply.verdict == Verdict::yes  ? "Yes"
                           : *reply.verdict == Verdict::no ? "No"
                                                           : "Not observed",
                           uncapitalised(reply.text));
}

}  // namespace

void write_reply(const ObjectsAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const auto given = [&](const char* name) { return context.query.arguments.contains(name); };
  const bool in_period = given("from") || given("to");
  const bool any_time = given("unseen-since") || given("state") || in_period;
  const std::string state = context.query.argument("state");
  const bool gone = state == "gone";
  std::vector<ObjectBelief> there, missed;
  for (const ObjectBelief& object : answer.objects)
    if (object.status == ObjectStatus::missed && (gone || (!any_time && object.probability >= kLikely)))
      missed.push_back(object);
    else if (any_time || is_there(object))
      there.push_back(object);
  for (const auto* list : {&there, &missed})
    if (gone || list == &there || there.empty())
      for (const ObjectBelief& object : *list) reply.objects.push_back(object.object.id);
  const auto names_in = [&](const std::vector<ObjectBelief>& objects) {
    std::vector<std::string> list;
    for (const ObjectBelief& object : objects) list.push_back(names.of(object.object));
    return list_in_words(list);
  };
  const Asks asks = context.query.asks;
  reply.number = there.size();
  reply.not_known = there.empty() && missed.empty() && in_period && !looked_then(context);
  if (reply.not_known) {
    reply.text = "Not observed: nobody looked then.";
  } else if (given("not-at")) {
    reply.text = elsewhere_in_words(there, context, snapshot, names_in(there));
  } else if (!there.empty()) {
    reply.text = asks == Asks::objects && there.size() == 1 && missed.empty()
                     ? names.subject(there[0].object) + "."
                     : fmt::format("{}: {}{}.", there.size(), names_in(there),
                                   gone && !missed.empty() ? "; perhaps also " + names_in(missed) : "");
  } else if (!missed.empty()) {
    reply.number = gone ? 0 : missed.size();
    reply.probability = missed.front().probability;
    reply.text = missed_in_words(missed, gone, asks, names, names_in(missed));
  } else {
    reply.text = any_time ? fmt::format("None{}.", state.empty() ? " seen then" : " is known to be " + state)
                          : none_in_words(answer, names, context);
  }
  if (asks == Asks::summary && !there.empty() && there.size() < answer.objects.size())
    reply.text = fmt::format("{} of {} {} likely where {} seen last: {}.", there.size(),
                             answer.objects.size(), there.size() == 1 ? "is" : "are",
                             there.size() == 1 ? "it was" : "they were", names_in(there));
  if (asks == Asks::number && !any_time && !there.empty())
    add_out_of_sight(static_cast<size_t>(std::ranges::count_if(answer.objects,
                                                               [](const ObjectBelief& object) {
                                                                 return !is_there(object) &&
                                                                        object.status != ObjectStatus::gone;
                                                               })),
                     reply);
  if ((asks == Asks::verdict || asks == Asks::exists) && !reply.not_known)
    set_verdict(there.size(), missed.size(), context.query, reply);
  if (asks == Asks::place && !there.empty()) return by_place(there, names, reply);
  add_sightings(there.empty() ? missed : there, names, context, reply);
}

namespace {

/// Whether extents are equal but for what the view changes.
bool are_of_one_size(Vector3d a, Vector3d b) {
  constexpr double kViewRatio = 1.3;
  std::ranges::sort(a);
  std::ranges::sort(b);
  return (a.array() <= kViewRatio * b.array()).all() && (b.array() <= kViewRatio * a.array()).all();
}

/// The colour that somebody stated, else the one that was seen, and a second one that light does not make of
/// it: "white and blue".
std::vector<std::string> colors_of(const ObjectRef& object, const ReplyContext& context) {
  std::vector<std::string> colors;
  if (object.color) colors.push_back(*object.color);
  const Snapshot snapshot(context.store, context.as_of);
  if (snapshot.stated(object.id, "colour")) return colors;
  for (const std::string& color : snapshot.seen_colors(object.id))
    if (colors.size() == 1 && color != colors[0] && !are_similar_colors(color, lower_case(colors[0])))
      colors.push_back(color);
  return colors;
}

/// "is red", "measures 6 x 4 x 25 cm"; unset where it is not known.
std::optional<std::string> look_in_words(const ObjectRef& object, const std::string& property,
                                         const ReplyContext& context) {
  const Snapshot snapshot(context.store, context.as_of);
  const std::optional<std::string> said = snapshot.stated(object.id, property);
  if (property == "material" && said) return "is made of " + *said;
  if (property == "size" && said)
    return (said->find_first_of("0123456789") == std::string::npos ? "is " : "measures ") + *said;
  if (property == "colour" && object.color) return "is " + list_in_words(colors_of(object, context), 2);
  if (property == "size" && object.size) return "measures " + size_text(*object.size);
  return {};
}

/// What was seen, where somebody stated something else.
void add_looks(const ObjectRef& object, const Snapshot& snapshot, const std::string& property, Reply& reply) {
  const BeliefRow* belief = snapshot.belief(object.id);
  if (belief == nullptr || !snapshot.stated(object.id, property)) return;
  if (property == "colour" && belief->color && belief->color != object.color)
    reply.evidence.push_back("seen: " + *belief->color);
  if (property == "size" && belief->size) reply.evidence.push_back("seen: " + size_text(*belief->size));
}

/// The colours or sizes of several objects, and whether they are the same.
void compare_looks(const std::vector<AboutObject>& objects, const std::string& property,
                   const ReplyContext& context, const Names& names, Reply& reply) {
  std::vector<std::string> list;
  std::vector<ObjectBelief> beliefs;
  const ObjectRef& first = objects.front().now.object;
  bool same = true;
  for (const AboutObject& one : objects) {
    const ObjectRef& object = one.now.object;
    reply.objects.push_back(object.id);
    beliefs.push_back(one.now);
    const std::optional<std::string> look = look_in_words(object, property, context);
    if (!look) continue;
    list.push_back(fmt::format("{} {}", names.subject(object), *look));
    if (property == "colour") same = same && object.color == first.color;
    if (property == "size") same = same && first.size && are_of_one_size(*object.size, *first.size);
  }
  reply.not_known = list.empty();
  reply.text = list.empty() ? "Not known." : list_in_words(list, 4) + ".";
  if (context.query.asks == Asks::together && list.size() == objects.size()) {
    reply.verdict = same ? Verdict::yes : Verdict::no;
    reply.text = fmt::format("{}: {}", same ? "Yes" : "No", reply.text);
  }
  add_sightings(beliefs, names, context, reply);
}

/// How often each of several was seen.
void all_sightings(const AboutAnswer& answer, const Names& names, const ReplyContext& context, Reply& reply) {
  std::vector<std::string> list;
  std::vector<ObjectBelief> beliefs;
  for (const AboutObject& one : answer.objects) {
    reply.objects.push_back(one.now.object.id);
    beliefs.push_back(one.now);
    list.push_back(
        fmt::format("{} in {}", names.subject(one.now.object), counted(one.now.sightings, "scene")));
  }
  reply.text = fmt::format("Seen: {}.", list_in_words(list, 3));
  add_sightings(beliefs, names, context, reply);
}

/// Whether all of them have the colour that is asked about, or whether their colours differ. What has gone
/// counts only where all have.
void judge_colour(const AboutAnswer& answer, const ReplyContext& context, const Names& names, Reply& reply) {
  std::vector<AboutObject> there;
  std::ranges::copy_if(answer.objects, std::back_inserter(there),
                       [](const AboutObject& one) { return one.now.status != ObjectStatus::gone; });
  const std::vector<AboutObject>& objects = there.empty() ? answer.objects : there;
  const std::string asked = context.query.argument("value");
  std::set<std::string> colours;
  bool known = true, all = true;
  for (const AboutObject& one : objects) {
    known = known && one.now.object.color;
    colours.insert(lower_case(one.now.object.color.value_or("")));
    all = all && std::ranges::any_of(colors_of(one.now.object, context),
                                     [&](const std::string& color) { return has_color(color, asked); });
  }
  compare_looks(objects, "colour", context, names, reply);
  const bool is = asked == "different" ? colours.size() > 1 : all;
  reply.not_known = !known;
  reply.verdict = !known ? Verdict::not_observed : is ? Verdict::yes : Verdict::no;
  reply.text = fmt::format("{}: {}", !known ? "Not known" : is ? "Yes" : "No", reply.text);
}

}  // namespace

void write_reply(const AboutAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  if (context.query.arguments.contains("value")) return judge_colour(answer, context, names, reply);
  const AboutObject& first = answer.objects.front();
  const ObjectRef& object = first.now.object;
  const std::string property = context.query.argument("property"), name = names.subject(object);
  if ((property == "colour" || property == "size") && answer.objects.size() > 1)
    return compare_looks(answer.objects, property, context, names, reply);
  if (property == "sightings" && answer.objects.size() > 1)
    return all_sightings(answer, names, context, reply);
  reply.objects = {object.id};
  if (property == "owner") {
    const auto owner = std::ranges::find(first.facts, "owner", &Fact::key);
    reply.not_known = owner == first.facts.end();
    reply.text = reply.not_known ? fmt::format("Not known: nobody stated who owns {}.", name)
                                 : fmt::format("{} owns {}.", owner->value, name);
  } else if (const std::optional<std::string> look = look_in_words(object, property, context)) {
    reply.text = fmt::format("{} {}.", name, *look);
  } else if (property == "sightings") {
    reply.number = first.now.sightings;
    reply.text = fmt::format("{} was seen in {}.", name, counted(first.now.sightings, "scene"));
  } else if (!property.empty()) {
    reply.not_known = true;
    reply.text = fmt::format("The {} of {} is not known.", property, name);
  } else {
    reply.text = fmt::format("{}: {}{}{}.", name, object.color.value_or("colour unknown"),
                             object.size ? ", " + size_text(*object.size) : "",
                             first.now.place ? ", " + in_words(*first.now.place) : "");
  }
  add_looks(object, snapshot, property, reply);
  for (const Fact& fact : first.facts)
    reply.evidence.push_back(fmt::format("{}: {} (said by {})", fact.key, fact.value, fact.source));
  add_sightings({first.now}, names, context, reply);
}

}  // namespace loci::memory
