// Was X there between two times: yes, no, or not observed. Absence of a sighting is only a "no" where
// somebody looked: at enough of the place, and at the spot where the object stood if that is known.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/error.h"
#include "memory/questions/answers.h"
#include "memory/questions/snapshot.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

/// Points on the surface of a place, for asking scenes what they saw of it; empty when its shape is unknown.
std::vector<Vector3d> points_on(const PlaceRow& place) {
  std::vector<Vector3d> points;
  if (place.outline.size() < 3 || !place.height) return points;
  Vector2d low = place.outline[0], high = place.outline[0];
  for (const Vector2d& corner : place.outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const auto inside = [&](const Vector2d& p) {
    bool result = false;
    for (size_t i = 0, j = place.outline.size() - 1; i < place.outline.size(); j = i++) {
      const Vector2d &a = place.outline[i], &b = place.outline[j];
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
        result = !result;
    }
    return result;
  };
  constexpr int kSide = 24;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vector2d p(low.x() + (high.x() - low.x()) * (i + 0.5) / kSide,
                       low.y() + (high.y() - low.y()) * (j + 0.5) / kSide);
      if (inside(p)) points.emplace_back(p.x(), p.y(), *place.height);
    }
  return points;
}

/// What the scenes of the asked time saw of the asked places, all together.
class Looks {
 public:
  Looks(const Snapshot& snapshot, const std::vector<PlaceRow>& places, TimeNs from, TimeNs to)
      : snapshot_(snapshot), from_(from), to_(to) {
    asked_ = snapshot.store().scenes(snapshot.as_of(), from, to);
    for (const SceneRow& scene : asked_) {
      scenes_.push_back(&scene);
    }
    for (const PlaceRow& place : places) add(place);
  }

  const std::vector<const SceneRow*>& scenes() const { return scenes_; }
  /// Fraction of the places that any of the scenes saw.
  double fraction() const { return places_ == 0 ? 0 : fraction_sum_ / static_cast<double>(places_); }
  /// Per scene, the fraction that it saw (of the place of which it saw most).
  const std::map<Id, double>& by_scene() const { return by_scene_; }
  bool asked_places() const { return places_ > 0; }

  const DepthThumbnail* thumbnail(const SceneRow& scene) {
    auto [slot, fresh] = thumbnails_.try_emplace(scene.id);
    if (fresh) slot->second = DepthThumbnail::of(snapshot_.store(), scene);
    return slot->second ? &*slot->second : nullptr;
  }

 private:
  void add(const PlaceRow& place) {
    ++places_;
    std::map<Id, double> told;
    for (const VisibilityRow& look : snapshot_.store().visibility_of_place(place.id, from_, to_))
      if (look.fraction) told[look.scene] = *look.fraction;
    const std::vector<Vector3d> points = points_on(place);
    std::vector<bool> seen(points.size(), false);
    double most_told = 0;
    for (const SceneRow* scene : scenes_) {
      double fraction = 0;
      const DepthThumbnail* depth = points.empty() ? nullptr : thumbnail(*scene);
      if (depth != nullptr) {
        size_t count = 0;
        for (size_t i = 0; i < points.size(); ++i) {
          const auto look = depth->spot_status(points[i]);
          if (look != SpotStatus::seen && look != SpotStatus::seen_empty) continue;
          seen[i] = true;
          ++count;
        }
        fraction = static_cast<double>(count) / static_cast<double>(points.size());
      }
      if (const auto found = told.find(scene->id); found != told.end()) {
        fraction = std::max(fraction, found->second);
        most_told = std::max(most_told, found->second);
      }
      by_scene_[scene->id] = std::max(by_scene_[scene->id], fraction);
    }
    const auto together = static_cast<double>(std::count(seen.begin(), seen.end(), true));
    fraction_sum_ +=
        std::max(most_told, points.empty() ? 0.0 : together / static_cast<double>(points.size()));
  }

  const Snapshot& snapshot_;
  std::vector<SceneRow> asked_;
  std::vector<const SceneRow*> scenes_;
  TimeNs from_, to_;
  std::map<Id, double> by_scene_;
  std::map<Id, std::optional<DepthThumbnail>> thumbnails_;
  size_t places_ = 0;
  double fraction_sum_ = 0;
};

class Judge {
 public:
  Judge(const Snapshot& snapshot, const WasQuestion& question, const std::vector<PlaceRow>& places,
        Looks& looks)
      : snapshot_(snapshot), question_(question), places_(places), looks_(looks) {}

  WasObject judge(Id object) {
    WasObject result;
    result.object = snapshot_.object_ref(object);
    collect_sightings(object, result);
    collect_looks(object, result);
    decide(result);
    return result;
  }

 private:
  bool is_asked(std::optional<Id> place) const {
    if (places_.empty()) return true;
    return place &&
           std::any_of(places_.begin(), places_.end(), [&](const PlaceRow& row) { return row.id == *place; });
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
  void collect_looks(Id object, WasObject& result) {
    const std::map<Id, std::string> told = told_about(object);
    for (const SceneRow* scene : looks_.scenes()) {
      PlaceLook look{.scene = snapshot_.scene_ref(*scene),
                     .fraction = looks_.by_scene().count(scene->id) > 0 ? looks_.by_scene().at(scene->id) : 0,
                     .spot = "unknown"};
      if (spot_) {
        if (const DepthThumbnail* depth = looks_.thumbnail(*scene))
          look.spot = to_text(depth->spot_status(*spot_));
        // What the belief found with the full image, when it was asked about this very place.
        const auto found = told.find(scene->id);
        if (look.spot == "unknown" && found != told.end()) look.spot = found->second;
      }
      if (look.fraction > 0 || (look.spot != "out_of_view" && look.spot != "unknown"))
        result.looks.push_back(look);
    }
  }

  /// What the belief found in the scenes of the time: those that tell nothing had it out of view, from its
  /// first sighting on and except while it was known to be gone.
  std::map<Id, std::string> told_about(Id object) const {
    std::map<Id, std::string> told;
    if (looks_.scenes().empty()) return told;
    for (const VisibilityRow& row :
         snapshot_.store().visibility_of_object(object, question_.from, question_.to))
      told[row.scene] = row.status == ObjectStatus::missed ? "seen_empty" : to_text(row.status);
    std::map<TimeNs, bool> present;  // from this time on
    AsOf then = snapshot_.as_of();
    then.at = std::min(then.at.value_or(question_.to), question_.to);
    for (const BeliefRow& row : snapshot_.store().belief_history(object, then, question_.from))
      present[row.clock.valid_from] = row.status != ObjectStatus::gone;
    for (const SceneRow* scene : looks_.scenes()) {
      const auto next = present.upper_bound(scene->time);
      if (next != present.begin() && std::prev(next)->second) told.try_emplace(scene->id, "out_of_view");
    }
    return told;
  }

  void decide(WasObject& result) const {
    if (!result.seen_there.empty()) {
      result.verdict = Verdict::yes;
      return;
    }
    result.verdict = Verdict::not_observed;
    for (const ForgottenRow& row : snapshot_.store().forgotten())
      if (row.valid_from && *row.valid_from <= question_.to && *row.valid_to >= question_.from) {
        result.reason = "what was seen in that time was forgotten on request";
        return;
      }
    const std::string preposition = !places_.empty() && places_[0].container ? "into " : "at ";
    if (looks_.scenes().empty()) {
      result.reason = "nobody looked: there is no scene in that time";
      return;
    }
    const auto spot_was = [&](const char* status) {
      return std::any_of(result.looks.begin(), result.looks.end(),
                         [&](const PlaceLook& look) { return look.spot == status; });
    };
    if (!looks_.asked_places()) {
      decide_anywhere(result, spot_was("seen_empty"));
      return;
    }
    const double fraction = looks_.fraction();
    const std::string much = fmt::format("{:.0f} % of {}", 100 * fraction, question_.place);
    if (!result.seen_elsewhere.empty() && (fraction >= kEnoughSeen || spot_was("seen_empty"))) {
      result.verdict = Verdict::no;
      result.reason = fmt::format("it was seen elsewhere, and {} was seen without it", much);
    } else if (!result.seen_elsewhere.empty()) {
      result.verdict = Verdict::no;
      result.reason = "it was seen elsewhere";
    } else if (spot_was("seen_empty")) {
      result.verdict = Verdict::no;
      result.reason = "the spot where it stood was seen without it";
    } else if (spot_ && spot_was("hidden")) {
      result.reason = "the spot where it stood was hidden behind something";
    } else if (fraction >= kEnoughSeen && !(spot_ && spot_was("out_of_view") && !spot_was("seen"))) {
      result.verdict = Verdict::no;
      result.reason = fmt::format("{} was seen and it was not there", much);
    } else if (spot_ && fraction > 0) {
      result.reason = fmt::format("only {} was seen, and not the spot where it stood", much);
    } else if (fraction > 0) {
      result.reason = fmt::format("only {} was seen", much);
    } else {
      const size_t count = looks_.scenes().size();
      result.reason =
          fmt::format("nobody looked {}{}: it was out of view in the {} of that time", preposition,
                      question_.place, count == 1 ? "one scene" : fmt::format("{} scenes", count));
    }
  }

  static void decide_anywhere(WasObject& result, bool looked_for) {
    if (looked_for) {
      result.verdict = Verdict::no;
      result.reason = "the spot where it stood was seen without it, and it was seen nowhere else";
    } else {
      result.reason = "it was not seen, and where it stood was not looked at";
    }
  }

  const Snapshot& snapshot_;
  const WasQuestion& question_;
  const std::vector<PlaceRow>& places_;
  Looks& looks_;
  std::optional<Vector3d> spot_;  ///< where the object stood on the asked place, before or after
};

}  // namespace

WasAnswer ask(const Store& store, const WasQuestion& question) {
  if (question.from > question.to)
    throw Error("the first time is after the second", {}, "write --between EARLIER LATER");
  const Snapshot snapshot(store, question.as_of);
  std::vector<PlaceRow> places;
  if (!question.place.empty()) places = snapshot.find_places(question.place);
  WasAnswer answer{
      .asked = question.subject, .place = question.place, .from = question.from, .to = question.to};
  answer.container = !places.empty() && places[0].container;
  Looks looks(snapshot, places, question.from, question.to);
  Judge judge(snapshot, question, places, looks);
  for (const Id object : snapshot.find_objects(question.subject))
    answer.objects.push_back(judge.judge(object));
  const auto any = [&](Verdict verdict) {
    return std::any_of(answer.objects.begin(), answer.objects.end(),
                       [&](const WasObject& object) { return object.verdict == verdict; });
  };
  answer.verdict = any(Verdict::yes)            ? Verdict::yes
                   : any(Verdict::not_observed) ? Verdict::not_observed
                                                : Verdict::no;
  return answer;
}

}  // namespace loci::memory
