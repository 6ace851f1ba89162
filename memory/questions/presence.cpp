// An object that no scene of a period saw at a place is only a "no" where the looks of the period exclude
// that it was there all along: they saw it elsewhere, or the place without it, and in between there was
// hardly a chance that somebody put it there. What `where` says at the time of a look counts as well. Of a
// moment that no look shows, what `where` says of it decides.

#include "memory/questions/presence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "mapping/base/math/polygon.h"
#include "memory/questions/forgotten.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/smoothing.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

/// Points on the surface of a place; empty when its shape is unknown.
std::vector<Vector3d> points_on(const PlaceRow& place) {
  std::vector<Vector3d> points;
  if (place.outline.size() < 3 || !place.height) return points;
  Vector2d low = place.outline[0], high = place.outline[0];
  for (const Vector2d& corner : place.outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  constexpr int kSide = 24;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vector2d p(low.x() + (high.x() - low.x()) * (i + 0.5) / kSide,
                       low.y() + (high.y() - low.y()) * (j + 0.5) / kSide);
      if (contains(place.outline, p)) points.emplace_back(p.x(), p.y(), *place.height);
    }
  return points;
}

/// What a stored visibility of the object means for the spot where it stood.
SpotStatus spot_status_of(ObjectStatus status) {
  switch (status) {
    case ObjectStatus::seen:
      return SpotStatus::seen;
    case ObjectStatus::hidden:
      return SpotStatus::hidden;
    case ObjectStatus::missed:
      return SpotStatus::seen_empty;
    case ObjectStatus::out_of_view:
    case ObjectStatus::gone:
      break;
  }
  return SpotStatus::out_of_view;
}

/// What the scenes of the period saw of the places asked about, taken together.
class Coverage {
 public:
  Coverage(const Snapshot& snapshot, const std::vector<PlaceRow>& places, TimeNs from, TimeNs to)
      : snapshot_(snapshot),
        scenes_(snapshot.store().scenes(snapshot.as_of(), from, to)),
        from_(from),
        to_(to) {
    for (const PlaceRow& place : places) add(place);
  }

  const std::vector<SceneRow>& scenes() const { return scenes_; }
  bool has_places() const { return places_ > 0; }
  /// Fraction of the places that any of the scenes saw.
  double fraction() const { return places_ == 0 ? 0 : fraction_sum_ / static_cast<double>(places_); }
  /// Fraction that a scene saw of the place of which it saw most.
  double fraction_of(Id scene) const {
    const auto found = by_scene_.find(scene);
    return found == by_scene_.end() ? 0 : found->second;
  }

  const DepthThumbnail* thumbnail(const SceneRow& scene) {
    const auto [slot, fresh] = thumbnails_.try_emplace(scene.id);
    if (fresh) slot->second = DepthThumbnail::of(snapshot_.store(), scene);
    return slot->second ? &*slot->second : nullptr;
  }

 private:
  void add(const PlaceRow& place) {
    ++places_;
    std::map<Id, double> stored;
    for (const VisibilityRow& row : snapshot_.store().visibility_of_place(place.id, from_, to_))
      if (row.fraction) stored[row.scene] = *row.fraction;
    // The outline of a place that moves is that of the closed joint: only the stored fractions know its
    // joint.
    const std::vector<Vector3d> points = place.joint ? std::vector<Vector3d>() : points_on(place);
    std::vector<bool> seen(points.size(), false);
    double max_stored = 0;
    for (const SceneRow& scene : scenes_) {
      double fraction =
          points.empty() ? 0 : mark_seen(scene, snapshot_.place_motion(place, scene), points, seen);
      if (const auto found = stored.find(scene.id); found != stored.end()) {
        fraction = std::max(fraction, found->second);
        max_stored = std::max(max_stored, found->second);
      }
      by_scene_[scene.id] = std::max(by_scene_[scene.id], fraction);
    }
    const auto together = static_cast<double>(std::count(seen.begin(), seen.end(), true));
    fraction_sum_ +=
        std::max(max_stored, points.empty() ? 0.0 : together / static_cast<double>(points.size()));
  }

  /// Marks the points that a scene saw, moved with their place, and returns their fraction.
  double mark_seen(const SceneRow& scene, const Isometry3d& motion, const std::vector<Vector3d>& points,
                   std::vector<bool>& seen) {
    const DepthThumbnail* depth = thumbnail(scene);
    if (depth == nullptr) return 0;
    size_t count = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const SpotStatus status = depth->spot_status(motion * points[i]);
      if (status != SpotStatus::seen && status != SpotStatus::seen_empty) continue;
      seen[i] = true;
      ++count;
    }
    return static_cast<double>(count) / static_cast<double>(points.size());
  }

  const Snapshot& snapshot_;
  std::vector<SceneRow> scenes_;
  TimeNs from_, to_;
  std::map<Id, double> by_scene_;
  std::map<Id, std::optional<DepthThumbnail>> thumbnails_;
  size_t places_ = 0;
  double fraction_sum_ = 0;
};

/// A verdict of no leaves at most this chance that the object was there.
constexpr double kMaxChance = 0.2;
/// Of what is handled, the share that is put on a certain other place.
constexpr double kPutHere = 0.5;
/// So short a period is a moment.
constexpr TimeNs kMoment = 120 * kSecond;

/// What the belief says of an object at the places asked about, in the period and around it.
class PresenceChance {
 public:
  PresenceChance(const Store& store, Id object, const WasQuestion& question, const AsOf& as_of,
                 const std::vector<PlaceRow>& places)
      : store_(store),
        object_(object),
        from_(question.from),
        to_(std::min(question.to, as_of.at.value_or(question.to))),
        as_of_(as_of),
        places_(places),
        is_moment_(question.to - question.from <= kMoment) {
    AsOf then = as_of;
    then.at = to_;
    rows_ = store.belief_history(object, then, from_);
    if (rows_.empty()) rows_ = store.belief_history(object, as_of);
    for (const BeliefRow& row : rows_)
      if (row.fade_s && !fading_) fading_ = row;
    if (!fading_ && !rows_.empty())  // gone all the time
      for (const BeliefRow& row : store.belief_history(object, as_of))
        if (row.fade_s) fading_ = row;
    for (const ObjectObservation& other : store.alternative_observations(object, from_, then))
      if (other.observation.place && is_asked(*other.observation.place))
        mistaken_ = std::max(mistaken_, other.association.probability);
    if (const auto next = store.first_observation_after(object, to_, {}, as_of)) seen_next_ = next->time;
  }

  /// The probability with which `where` says that it is there.
  double believed_there(TimeNs time) const {
    const auto next =
        std::ranges::upper_bound(rows_, time, {}, [](const BeliefRow& row) { return row.clock.valid_from; });
    if (next == rows_.begin() || !is_there(*std::prev(next))) return 0;
    const std::optional<BeliefRow> then = belief(time);
    return then && is_there(*then) ? then->probability : 0;
  }

  /// The probability that it is not where `where` says that it is, or that this is not known yet.
  double unknown(TimeNs time) const {
    const auto next =
        std::ranges::upper_bound(rows_, time, {}, [](const BeliefRow& row) { return row.clock.valid_from; });
    if (next == rows_.begin()) return 1;
    const std::optional<BeliefRow> then = belief(time);
    return !then || then->status == ObjectStatus::gone ? 1 : 1 - then->probability;
  }

  /// The probability that it was there at some time of the period, although no look showed it; `absent`:
  /// looks that exclude it, in order of time; `before`, `after`: when it was seen there last before, and
  /// first after.
  double chance(const std::vector<TimeNs>& absent, const std::optional<SceneRef>& before,
                const std::optional<SceneRef>& after) const {
    if (absent.empty()) return std::max(believed_there(from_), believed_there(to_));
    double never = (1 - mistaken_) * (1 - at_first(absent.front(), before));
    for (size_t i = 1; i < absent.size(); ++i) never *= 1 - visit(absent[i] - absent[i - 1]);
    return 1 - never * (1 - at_last(absent.back(), after));
  }

  /// The longest part of the period without a look that excludes it.
  std::pair<TimeNs, TimeNs> longest_gap(const std::vector<TimeNs>& absent) const {
    std::pair<TimeNs, TimeNs> longest{from_, absent.front()};
    for (size_t i = 0; i < absent.size(); ++i) {
      const TimeNs end = i + 1 < absent.size() ? absent[i + 1] : to_;
      if (end - absent[i] > longest.second - longest.first) longest = {absent[i], end};
    }
    return longest;
  }

 private:
  /// Of a period its looks are the evidence, of a moment also what was seen afterwards.
  std::optional<BeliefRow> belief(TimeNs time) const {
    const AsOf then{time, as_of_.known_at};
    std::optional<BeliefRow> row = store_.belief(object_, then);
    if (row && is_moment_) row->probability = smoothed_probability(store_, *row, then);
    return row;
  }
  bool is_there(const BeliefRow& row) const {
    return row.status != ObjectStatus::gone && row.place && is_asked(*row.place);
  }
  bool is_asked(Id place) const {
    return std::ranges::any_of(places_, [&](const PlaceRow& row) { return row.id == place; });
  }

  /// The probability that somebody handles it within a time.
  double handled(TimeNs duration) const {
    if (duration <= 0) return 0;
    if (!fading_) return 0;  // nothing of it ever fades
    const double seconds = in_seconds(duration);
    return (1 - *fading_->fade_to) * (1 - std::exp(-seconds / *fading_->fade_s));
  }

  /// It was put there and taken away again.
  double visit(TimeNs duration) const { return kPutHere / 2 * handled(duration) * handled(duration); }

  /// Before the first look that excludes it.
  double at_first(TimeNs absent, const std::optional<SceneRef>& before) const {
    if (absent <= from_) return 0;
    const double believed = believed_there(from_);
    if (!before || believed < kMaxChance)
      return rows_.empty() || rows_.front().clock.valid_from > from_ ? kPutHere * handled(absent - from_)
                                                                     : visit(absent - from_);
    // It left between the two, whenever that was.
    return static_cast<double>(absent - from_) / static_cast<double>(absent - before->time);
  }

  /// After the last look that excludes it.
  double at_last(TimeNs absent, const std::optional<SceneRef>& after) const {
    if (absent >= to_) return 0;
    if (!seen_next_) return kPutHere * handled(to_ - absent);
    if (!after || after->time != *seen_next_) return visit(to_ - absent);
    return static_cast<double>(to_ - absent) / static_cast<double>(after->time - absent);
  }

  const Store& store_;
  Id object_;
  TimeNs from_, to_;
  AsOf as_of_;
  const std::vector<PlaceRow>& places_;
  const bool is_moment_;
  std::vector<BeliefRow> rows_;  ///< that hold in the period
  std::optional<BeliefRow> fading_;
  std::optional<TimeNs> seen_next_;  ///< anywhere, after the period
  double mistaken_ = 0;  ///< probability of being what was seen there and taken for another object
};

class Judge {
 public:
  Judge(const Snapshot& snapshot, const WasQuestion& question, const std::vector<PlaceRow>& places,
        Coverage& coverage)
      : snapshot_(snapshot), question_(question), places_(places), coverage_(coverage) {}

  WasObject judge(Id object) {
    WasObject result{.object = snapshot_.object_ref(object)};
    collect_sightings(object, result);
    collect_views(object, result);
    decide(object, result);
    return result;
  }

 private:
  bool is_asked(std::optional<Id> place) const {
    return places_.empty() ||
           (place && std::ranges::any_of(places_, [&](const PlaceRow& row) { return row.id == *place; }));
  }

  void collect_sightings(Id object, WasObject& result) {
    spot_.reset();
    const Store& store = snapshot_.store();
    std::vector<Id> asked;
    for (const PlaceRow& place : places_) asked.push_back(place.id);
    if (const auto before = store.last_observation_before(object, question_.from, asked, snapshot_.as_of())) {
      result.before = snapshot_.scene_ref(before->association.scene);
      spot_ = before->observation.position;
    }
    if (const auto after = store.first_observation_after(object, question_.to, asked, snapshot_.as_of())) {
      result.after = snapshot_.scene_ref(after->association.scene);
      if (!spot_) spot_ = after->observation.position;
    }
    // In the map, what is in a drawer stands elsewhere with each state of its joint, and what is on furniture
    // that was moved with each map.
    spot_moves_ = std::ranges::any_of(places_, [&](const PlaceRow& place) {
      return place.joint || std::ranges::any_of(coverage_.scenes(), [&](const SceneRow& scene) {
               return is_moved(snapshot_.place_motion(place, scene));
             });
    });
    for (const ObjectObservation& sighting :
         store.observations_of(object, snapshot_.as_of(), question_.from, question_.to)) {
      const auto ref = snapshot_.scene_ref(sighting.association.scene);
      if (is_asked(sighting.observation.place)) {
        result.seen_there.push_back(*ref);
      } else {
        const auto place = snapshot_.place_ref(sighting.observation.place);
        result.seen_elsewhere.emplace_back(*ref, place ? place->name : "");
      }
    }
  }

  /// What each scene saw of the place, and of the spot on it where the object is known to have stood.
  void collect_views(Id object, WasObject& result) {
    const std::map<Id, SpotStatus> stored = stored_visibility(object);
    for (const SceneRow& scene : coverage_.scenes()) {
      PlaceView view{.scene = snapshot_.scene_ref(scene),
                     .fraction = coverage_.fraction_of(scene.id),
                     .spot = SpotStatus::no_camera};
      if (spot_) {
        if (const DepthThumbnail* depth = spot_moves_ ? nullptr : coverage_.thumbnail(scene))
          view.spot = depth->spot_status(*spot_);
        // The belief used the full image. Where no place is asked about, it was about this very spot.
        const auto found = stored.find(scene.id);
        if ((view.spot == SpotStatus::no_camera || places_.empty()) && found != stored.end())
          view.spot = found->second;
      }
      if (view.fraction > 0 || (view.spot != SpotStatus::out_of_view && view.spot != SpotStatus::no_camera))
        result.views.push_back(view);
    }
  }

  /// The visibility that the belief stored with the scenes. A scene without a row had the object out of view,
  /// from its first sighting on and except while it was gone.
  std::map<Id, SpotStatus> stored_visibility(Id object) const {
    std::map<Id, SpotStatus> stored;
    if (coverage_.scenes().empty()) return stored;
    for (const VisibilityRow& row :
         snapshot_.store().visibility_of_object(object, question_.from, question_.to))
      stored[row.scene] = spot_status_of(row.status);
    std::map<TimeNs, bool> present;  // from this time on
    AsOf then = snapshot_.as_of();
    then.at = std::min(then.at.value_or(question_.to), question_.to);
    for (const BeliefRow& row : snapshot_.store().belief_history(object, then, question_.from))
      present[row.clock.valid_from] = row.status != ObjectStatus::gone;
    for (const SceneRow& scene : coverage_.scenes()) {
      const auto next = present.upper_bound(scene.time);
      if (next != present.begin() && std::prev(next)->second)
        stored.try_emplace(scene.id, SpotStatus::out_of_view);
    }
    return stored;
  }

  void decide(Id object, WasObject& result) const {
    if (!result.seen_there.empty()) {
      result.verdict = Verdict::yes;
      result.probability = 1;
      if (coverage_.has_places())
        result.absent = looks_without_it(
            PresenceChance(snapshot_.store(), object, question_, snapshot_.as_of(), places_), result);
    } else if (const auto part = forgotten_part(snapshot_.store(), {question_.from, question_.to})) {
      result.reason = forgotten_text(*part, TimeWriter(snapshot_.store()));
    } else {
      if (coverage_.scenes().empty())
        result.reason = "there is no scene in that time";
      else if (!coverage_.has_places())
        decide_anywhere(result);
      else
        decide_at_place(object, result);
      if (coverage_.has_places() && question_.to - question_.from <= kMoment)
        decide_by_belief(object, result);
    }
  }

  /// Of a moment: as `where` has it.
  void decide_by_belief(Id object, WasObject& result) const {
    const Store& store = snapshot_.store();
    const AsOf known{{}, snapshot_.as_of().known_at};
    const Snapshot moment(store, {question_.from, known.known_at});
    const BeliefRow* then = moment.belief(object);
    if (then == nullptr || !then->place) return;
    const bool there = is_asked(then->place);
    const double elsewhere = kPutHere * (1 - then->probability);
    if (there) result.probability = then->probability;
    if (then->status == ObjectStatus::gone || result.verdict != Verdict::not_observed) return;
    if (there ? then->probability < 0.5 : elsewhere > kMaxChance) return;
    const auto before = store.last_observation_before(object, question_.from, {}, known);
    if (!before || before->observation.place != then->place) return;
    if (!there) result.probability = elsewhere;
    result.verdict = there ? Verdict::yes : Verdict::no;
    result.unseen = {.place = *snapshot_.place_ref(then->place),
                     .there = there,
                     .probability = then->probability,
                     .before = before->time};
    const auto after = store.first_observation_after(object, question_.to, {}, known);
    if (after && after->observation.place == then->place) result.unseen->after = after->time;
  }

  static bool spot_was(const WasObject& result, SpotStatus status) {
    return std::ranges::any_of(result.views, [&](const PlaceView& view) { return view.spot == status; });
  }

  void decide_at_place(Id object, WasObject& result) const {
    const PresenceChance presence(snapshot_.store(), object, question_, snapshot_.as_of(), places_);
    const std::vector<TimeNs>& absent = result.absent = looks_without_it(presence, result);
    result.probability = presence.chance(absent, result.before, result.after);
    if (!absent.empty() && result.probability <= kMaxChance) {
      result.verdict = Verdict::no;
      result.reason = reason_of_no(absent, result);
    } else if (!absent.empty()) {
      result.reason = what_was_seen(presence, absent, result);
    } else {
      result.reason = reason_not_observed(presence, result);
    }
  }

  /// Times of the scenes that saw it elsewhere, or the place or its spot there without it.
  std::vector<TimeNs> looks_without_it(const PresenceChance& presence, const WasObject& result) const {
    std::set<TimeNs> times;
    for (const auto& [scene, place] : result.seen_elsewhere) times.insert(scene.time);
    const bool enough = coverage_.fraction() >= kMinSeenFraction;
    for (const PlaceView& view : result.views) {
      const bool place_seen =
          enough && view.fraction > 0 &&
          (!spot_ || view.spot == SpotStatus::seen || view.spot == SpotStatus::no_camera) &&
          (1 - coverage_.fraction()) * presence.unknown(view.scene.time) <= kMaxChance;
      if ((view.spot == SpotStatus::seen_empty || place_seen) &&
          presence.believed_there(view.scene.time) < kMaxChance)
        times.insert(view.scene.time);
    }
    return {times.begin(), times.end()};
  }

  std::string part_seen() const {
    return fmt::format("{:.0f} % of {}", 100 * coverage_.fraction(), question_.place);
  }

  std::string reason_of_no(const std::vector<TimeNs>& absent, const WasObject& result) const {
    const bool place_seen = coverage_.fraction() >= kMinSeenFraction;
    if (!result.seen_elsewhere.empty())
      return spot_was(result, SpotStatus::seen_empty) || place_seen
                 ? fmt::format("it was seen elsewhere, and {} was seen without it", part_seen())
                 : "it was seen elsewhere";
    return fmt::format("it was {}{}", looked_for_text(absent, "", TimeWriter(snapshot_.store())),
                       place_seen ? fmt::format(" ({} was seen)", part_seen()) : "");
  }

  /// "seen there at T1; not there at T2; not observed from T3 to T4".
  std::string what_was_seen(const PresenceChance& presence, const std::vector<TimeNs>& absent,
                            const WasObject& result) const {
    const TimeWriter times(snapshot_.store());
    std::string text;
    if (result.before) text = fmt::format("seen there at {}; ", times.text(result.before->time));
    const std::string first = times.text(absent.front()), last = times.text(absent.back());
    text += first == last ? "not there at " + first
                          : fmt::format("not there at {} looks from {} to {}", absent.size(), first, last);
    const auto [from, to] = presence.longest_gap(absent);
    if (times.text(from) != times.text(to))
      text += fmt::format("; not observed from {} to {}", times.text(from), times.text(to));
    if (result.after) text += fmt::format("; seen there again at {}", times.text(result.after->time));
    return text;
  }

  std::string reason_not_observed(const PresenceChance& presence, const WasObject& result) const {
    const double believed = presence.believed_there(question_.from), fraction = coverage_.fraction();
    const std::string still =
        believed >= 0.5 ? fmt::format("; it is believed to have been there ({})", percent(believed)) : "";
    if (spot_ && spot_was(result, SpotStatus::hidden))
      return "the spot where it stood was hidden behind something" + still;
    if (spot_ && fraction > 0)
      return fmt::format("only {} was seen, and not the spot where it stood", part_seen()) + still;
    if (fraction > 0) return fmt::format("only {} was seen", part_seen()) + still;
    const size_t count = coverage_.scenes().size();
    return fmt::format("nobody looked {}{}: it was out of view in the {} of that time",
                       places_[0].container ? "into " : "at ", question_.place,
                       count == 1 ? "one scene" : fmt::format("{} scenes", count)) +
           still;
  }

  void decide_anywhere(WasObject& result) const {
    // What lies flat hardly changes the depth of its spot: a view of the spot without it is enough.
    std::vector<TimeNs> looks;
    for (const PlaceView& view : result.views)
      if (view.spot == SpotStatus::seen_empty || view.spot == SpotStatus::seen)
        looks.push_back(view.scene.time);
    if (!looks.empty()) {
      result.verdict = Verdict::no;
      result.reason = fmt::format("it was {}, and it was seen nowhere else",
                                  looked_for_text(looks, "where it stood", TimeWriter(snapshot_.store())));
    } else {
      result.reason = "it was not seen, and where it stood was not looked at";
    }
  }

  const Snapshot& snapshot_;
  const WasQuestion& question_;
  const std::vector<PlaceRow>& places_;
  Coverage& coverage_;
  std::optional<Vector3d> spot_;  ///< where the object stood on the place asked about, before or after
  bool spot_moves_ = false;
};

/// Without the preposition, which answers write: "on table_1".
std::string place_named(const std::string& asked) {
  const std::string text = trimmed(asked);
  for (const std::string_view preposition : {"on ", "in ", "at "})
    if (lower_case(text).starts_with(preposition)) return trimmed(text.substr(preposition.size()));
  return text;
}

}  // namespace

double seen_fraction(const Snapshot& snapshot, const PlaceRow& place, TimeNs from, TimeNs to) {
  return Coverage(snapshot, {place}, from, to).fraction();
}

WasAnswer ask(const Store& store, const WasQuestion& question) {
  check_period(question.from, question.to);
  const Snapshot snapshot(store, question.as_of);
  std::vector<PlaceRow> places;
  if (!question.place.empty()) places = snapshot.find_places(question.place);
  WasAnswer answer{.asked = question.subject,
                   .place = place_named(question.place),
                   .container = !places.empty() && places[0].container,
                   .from = question.from,
                   .to = question.to};
  Coverage coverage(snapshot, places, question.from, question.to);
  Judge judge(snapshot, question, places, coverage);
  for (const Id object : snapshot.find_objects(question.subject))
    answer.objects.push_back(judge.judge(object));
  const auto any = [&](Verdict verdict) {
    return std::ranges::any_of(answer.objects,
                               [&](const WasObject& object) { return object.verdict == verdict; });
  };
  answer.verdict = any(Verdict::yes)            ? Verdict::yes
                   : any(Verdict::not_observed) ? Verdict::not_observed
                                                : Verdict::no;
  return answer;
}

namespace {

/// "red cup on table_1", "red cup table_1", "red cup".
void read_was(std::vector<std::string> words, Query& query) {
  const auto preposition =
      std::ranges::find_if(words, [](const std::string& w) { return w == "on" || w == "in"; });
  if (preposition != words.begin() && words.end() - preposition > 1) {
    query.arguments["place"] = fmt::format("{}", fmt::join(preposition + 1, words.end(), " "));
    words.erase(preposition, words.end());
  } else if (words.size() > 1) {
    query.arguments["place"] = words.back();
    words.pop_back();
  }
  query.arguments["object"] = fmt::format("{}", fmt::join(words, " "));
}

/// Without times: over all scenes. With `at`: at that moment, as looks before and afterwards show it.
Answer ask_was(const Arguments& given) {
  const auto scenes = given.store().scenes();
  AsOf as_of = given.as_of();
  const bool moment = !given.text("at").empty() && !given.from() && !given.to();
  WasQuestion question{.subject = given.text("object"), .place = given.text("place")};
  if (moment) {
    question.from = question.to = *std::exchange(as_of.at, std::nullopt);
  } else {
    question.from = given.from().value_or(scenes.empty() ? 0 : scenes.front().time);
    question.to = given.to().value_or(scenes.empty() ? 0 : scenes.back().time);
  }
  question.as_of = as_of;
  return ask(given.store(), question);
}

std::vector<SentenceForm> was_sentences() {
  using enum Asks;
  return {
      {"yes|bare: was|been|did|had <object> at<place> [leave|keep|before]", verdict,
       "Was the red cup on the table between nine and ten?"},
      {"yes|bare: was|been|did|had together <object> at<place> [every|leave|keep|put]", together,
       "Were the cup and the bowl ever on the table together?"},
      {"yes|bare: was|been|did|had together <object> and<with> at<place> [every|leave|keep|put]",
       together,
       "",
       {{"object", "{object} and {with}"}}},
      {"yes: have see <object> at<place>", verdict},
      {"yes|bare: throughout <object> at<place> [keep|leave|put|go]", throughout,
       "Was the milk on the table all day?"},
      {"yes|bare: stays <object> at<place> [keep|leave]", lasted, "Did the milk stay on the table?"},
      {"yes: see|find <object> time", verdict, "Did you see the milk this morning?"},
      {"yes: was see <object> -person", verdict},
      {"when: <object> at<place>", summary, "When was the red cup on the table?"},
      {"when: last <object> at<place>", last_time},
      {"bare: see last <object> at<place>", last_time},
      {"when: first <object> at<place> [stand|see|find]", first_time},
  };
}

}  // namespace

std::vector<Question> presence_questions() {
  Parameter place = place_parameter();
  place.required = false;
  place.default_text = "anywhere";
  return {
      {.name = "was",
       .description = "Whether an object was at a place in a period: yes, no, or not observed",
       .parameters = {object_parameter(), place},
       .period = true,
       .words_help = "OBJECT [on|in PLACE]",
       .read_words = read_was,
       .asks = Asks::verdict,
       .examples = {"red on table_1 --between 08:00 09:00",
                    "object_1 in drawer_1 --between 08:00 18:00 --json"},
       .answer = format::schema_by<format::was_record>,
       .run = ask_was,
       .time = SentenceTime::period,
       .sentences = was_sentences()},
  };
}

}  // namespace loci::memory
