// Stages of SceneUpdate that change single objects: observed, new and unobserved ones, alternative
// hypotheses.

#include <algorithm>
#include <cmath>

#include "memory/belief/association/fusion.h"
#include "memory/belief/association/scene_update.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {

double SceneUpdate::detection_rate() const {
  return timing_.snapshot ? state_.detection.value(options_) : options_.detection;
}

double SceneUpdate::repeat_clutter() const {
  return timing_.snapshot ? options_.repeat_clutter
                          : std::max(options_.repeat_clutter, kParameters.repeat_clutter_in_video);
}

void SceneUpdate::update_observed(size_t o, size_t k) {
  ProtoObject& object = state_.objects[o];
  Observation observation = scene_.observations[k];
  if (!observation.has_size && object.has_size) observation.box.size = predicted_[o].box.size;
  const bool piece = !timing_.snapshot && is_piece(predicted_[o], observation.box);
  observation.partial = observation.partial || piece;
  const Explanation explanation = update_.observations[k].explanation;
  update_.objects[o].explanation = explanation;
  const Status status_before = object.status;
  const std::string place_before = object.place;
  const bool was_hidden = object.hidden_reported;
  const TimeNs seen_before = object.last_seen;
  const double seconds_unobserved = in_seconds(scene_.time - object.last_seen);

  if (timing_.independent && object.status == Status::gone)
    state_.interaction.learn_returns(timing_.exposure_s - object.last_seen_exposure_s, 1, options_);
  if (timing_.independent) {
    weigh_clutter(object, options_.repeat_clutter, predicted_[o].here * state_.detection.value(options_));
    learn_clutter(object);
  }
  if (explanation == Explanation::move && status_before == Status::present) keep_alternative(o, k);
  if (merged_[o] == 0) update_box_and_views(o, k, observation, explanation, piece);
  learn_detection(object, explanation);
  object.probability_here = 1;
  object.hidden_scenes = 0;
  object.hidden_reported = false;
  mark_observed(object, observation);
  const double weight =
      std::lerp(kParameters.min_sighting, kParameters.max_sighting, std::clamp(seconds_unobserved, 0.0, 1.0));
  object.exists_log_odds +=
      (observation.partial ? 0.5 : 1.0) * weight * std::log(detection_rate() / repeat_clutter());
  object.exists_log_odds = std::min(object.exists_log_odds, kParameters.max_log_odds);

  if (object.status == Status::tentative) {
    if (object.pending.empty()) object.first_seen = scene_.time;
    object.pending.push_back({observation.id, scene_.time, false, update_.observations[k].probability});
    if (object.exists_log_odds >= (timing_.snapshot ? 0.0 : log_odds(options_.confirm))) confirm(object, k);
    return;
  }
  object.status = Status::present;
  const auto report = [&](EventKind kind) {
    update_.events.push_back({kind, object.id, scene_.time, seen_before, update_.observations[k].probability,
                              place_before, object.place, predicted_[o].box, observation.box, k});
  };
  if (status_before == Status::gone || was_hidden) report(EventKind::reappeared);
  if (status_before != Status::gone && explanation == Explanation::move) report(EventKind::moved);
  // In a video, another side, a shadow or a finger changes the appearance for some frames.
  if (explanation == Explanation::newview && !observation.partial &&
      seconds_unobserved >= options_.snapshot_gap_s)
    report(EventKind::looks_different);
}

void SceneUpdate::update_box_and_views(size_t o, size_t k, const Observation& observation,
                                       Explanation explanation, bool piece) {
  ProtoObject& object = state_.objects[o];
  const bool moved = explanation == Explanation::move;
  const bool elsewhere = moved || object.status == Status::gone;
  if (elsewhere)
    reset_box(object, observation, scene_, options_);
  else
    fuse_box(object, predicted_[o], observation, scene_, options_);
  if (!observation.place.empty()) set_place(object, observation.place, scene_);
  // Views that follow each other at once repeat each other's errors: what was kept first stays.
  const bool rested = in_seconds(scene_.time - object.last_seen) >= options_.snapshot_gap_s;
  if (rested || elsewhere) store_surface(object, surfaces_[k], predicted_[o].surface, scene_, elsewhere);
  // An object that moved was recognised by its appearance alone: a dissimilar view may be another object's.
  if (!piece) {
    store_view(object, observation, scene_, options_, state_.calibration.corrections(), !moved);
    store_texture(object, observation, scene_, elsewhere,
                  !elsewhere || update_.observations[k].probability >= kParameters.certain_partner);
  }
  object.class_name = most_probable_class(object);
}

void SceneUpdate::mark_observed(ProtoObject& object, const Observation& observation) {
  object.last_seen = scene_.time;
  object.last_update = scene_.time;
  object.exposure_s = object.last_seen_exposure_s = timing_.exposure_s;
  object.uses = 0;
  object.map_from_camera = scene_.view.map_from_camera;
  object.last_observation = observation.id;
  ++object.observation_count;
}

void SceneUpdate::create_object(size_t k) {
  ObservationOutcome& outcome = update_.observations[k];
  const Observation& observation = scene_.observations[k];
  const double clutter = probability_from_log_odds(weights_.clutter[k] - weights_.appear[k]);
  // Where clutter is usual, another view decides, unless this one is stronger evidence than that.
  const double usual =
      timing_.snapshot
          ? state_.interaction.clutter_share(
                observation.place,
                expected_arrivals(places_[index_of(places_, observation.place)], timing_, state_, options_),
                options_)
          : 0.0;
  const bool known = observation.known_object.value_or(0) != 0;
  if (!known && (clutter > (1 + usual) / 2 || piece_probability_[k] > 0)) {
    outcome.explanation = Explanation::clutter;
    outcome.probability = outcome.clutter;
    return;
  }
  outcome.explanation = Explanation::appear;
  outcome.probability = outcome.appear;
  ProtoObject object;
  object.key = state_.next_key++;
  object.has_size = false;  // set by reset_box()
  object.first_seen = scene_.time;
  object.exists_log_odds =
      log_odds(options_.first_sight) - (observation.partial ? kParameters.cut_off_log_odds : 0.0);
  const bool wait = usual > 1 - options_.first_sight;
  if (wait) object.exists_log_odds = -log_odds(clutter);
  if (state_.interaction.knows(observation.place)) object.clutter_probability = clutter;
  reset_box(object, observation, scene_, options_);
  store_view(object, observation, scene_, options_, state_.calibration.corrections(), true);
  store_texture(object, observation, scene_, false, true);
  store_surface(object, surfaces_[k], {}, scene_, true);
  object.class_name = most_probable_class(object);
  mark_observed(object, observation);
  object.pending.push_back({observation.id, scene_.time, true, outcome.appear});
  object.former_id = known ? *observation.known_object : observation.former_object;
  outcome.key = object.key;
  state_.objects.push_back(std::move(object));
  if (known || (timing_.snapshot && !wait)) confirm(state_.objects.back(), k);
}

void SceneUpdate::confirm(ProtoObject& object, std::optional<size_t> k) {
  object.status = Status::present;
  const bool keeps_number = object.former_id > 0 && state_.find(object.former_id) == nullptr;
  object.id = keeps_number ? object.former_id : state_.next_id++;
  state_.next_id = std::max(state_.next_id, object.id + 1);
  std::vector<PendingObservation> earlier = std::move(object.pending);
  object.pending.clear();
  if (k) earlier.pop_back();  // the present one is reported with its scene
  update_.confirmed.push_back({object.id, object.key, object.first_seen, std::move(earlier)});
  const bool now = object.first_seen == scene_.time;
  update_.events.push_back({EventKind::appeared,
                            object.id,
                            object.first_seen,
                            now ? state_.last_scene : std::nullopt,
                            probability_from_log_odds(object.exists_log_odds),
                            {},
                            object.place,
                            std::nullopt,
                            box_in_map(object, scene_.places),
                            k});
}

void SceneUpdate::confirm_unrefuted() {
  const double min_log_odds = log_odds(options_.first_sight) - kParameters.cut_off_log_odds - 0.1;
  for (ProtoObject& object : state_.objects) {
    if (object.status != Status::tentative || object.exists_log_odds < min_log_odds || object.pending.empty())
      continue;
    std::optional<size_t> observation;
    for (size_t k = 0; k < update_.observations.size(); ++k)
      if (update_.observations[k].key == object.key) observation = k;
    confirm(object, observation);
  }
}

void SceneUpdate::update_unobserved(size_t o) {
  ProtoObject& object = state_.objects[o];
  const Prediction& p = predicted_[o];
  if (object.status == Status::gone && timing_.independent)
    state_.interaction.learn_returns(timing_.exposure_s - object.last_seen_exposure_s,
                                     update_.objects[o].matched, options_);
  if (is_double_[o]) return remove_double(o);
  if (p.undetectable >= 1) {  // its spot was not observed
    update_.objects[o].explanation = Explanation::hidden;
    if (object.status == Status::present) note_hidden(object, p);
    return;
  }
  const PresenceEvidence presence = presence_evidence(o);
  const double in_view = 1 - p.undetectable;
  if (timing_.independent) object.missed_views += in_view * (1 - merged_[o]);
  object.probability_here = presence.probability();
  if (timing_.independent && in_view >= kParameters.min_observed)
    weigh_clutter(object, presence.empty * (1 - options_.repeat_clutter), presence.there + presence.away);
  object.last_update = scene_.time;
  object.exposure_s = timing_.exposure_s;
  object.uses = 0;
  // The undetectable part explains neither presence nor absence.
  const double there_hidden = p.here * p.undetectable * std::exp(p.log_surface),
               away_hidden = (1 - p.here) * p.undetectable;
  const double hidden = there_hidden + away_hidden;
  const double missed = presence.there - there_hidden, left = presence.away - away_hidden;
  update_.objects[o].explanation = hidden >= missed && hidden >= left ? Explanation::hidden
                                   : missed >= left                   ? Explanation::missed
                                                                      : Explanation::disappear;
  if (object.alternative_of != 0) return;
  if (object.status == Status::tentative) {
    const double empty = posterior_empty_share(o);
    const double factor = empty > kParameters.seen_empty ? kParameters.seen_empty_factor : 1.0;
    const double missed_if_object = 1 - p.resolved * detection_rate() * in_view * factor;
    object.exists_log_odds += std::log(std::max(0.01, missed_if_object) / (1 - repeat_clutter() * in_view));
    return;
  }
  if (object.status != Status::present) return;
  // Time alone makes nothing go: objects out of view stay present until their spot is observed.
  // However little of it would be in view: where most of that is seen through, its spot was observed.
  const bool observed = in_view >= kParameters.min_observed ||
                        displaced_share(p.surface).value_or(0) > kParameters.mostly_displaced;
  if (1 - object.probability_here >= options_.gone && observed) {
    update_.objects[o].explanation = Explanation::disappear;
    learn_clutter(object);
    set_gone(o);
    return;
  }
  note_hidden(object, p);
}

void SceneUpdate::set_gone(size_t o) {
  ProtoObject& object = state_.objects[o];
  object.status = Status::gone;
  object.gone_by_s = timing_.exposure_s;
  object.hidden_reported = false;
  update_.events.push_back({EventKind::gone,
                            object.id,
                            scene_.time,
                            object.last_seen,
                            1 - object.probability_here,
                            object.place,
                            {},
                            predicted_[o].box,
                            std::nullopt,
                            std::nullopt});
}

double SceneUpdate::PresenceEvidence::probability() const {
  return there / std::max(1e-300, there + away);
}

SceneUpdate::PresenceEvidence SceneUpdate::presence_evidence(size_t o) const {
  const Prediction& p = predicted_[o];
  const AbsenceEvidence evidence = absence_evidence(p, posterior_empty_share(o), timing_.seconds,
                                                    state_.detection.value(options_), options_);
  const double in_view = 1 - p.undetectable;
  const double empty = p.undetectable + in_view * std::exp(evidence.if_gone);
  const double there = p.here * (p.undetectable + in_view * std::exp(evidence.if_there)) *
                       std::exp(p.log_surface),
               away = (1 - p.here) * empty;
  // A cluster of several that shows it leaves no doubt that it is there.
  return {std::lerp(there, there + away, merged_[o]), (1 - merged_[o]) * away, empty};
}

double SceneUpdate::posterior_empty_share(size_t o) const {
  std::vector<double> other(scene_.observations.size(), timing_.snapshot ? 1.0 : kParameters.merged_in_video);
  for (size_t k = 0; k < other.size(); ++k) {
    const ObservationOutcome& outcome = update_.observations[k];
    if (outcome.explanation == Explanation::clutter) other[k] = 0;
    if (!partner_of_observation_[k] || outcome.explanation == Explanation::move) continue;
    const double before = predicted_[*partner_of_observation_[k]].box.volume();
    if (scene_.observations[k].box.volume() > kParameters.merged_volume * before) other[k] = 0;
  }
  return empty_share(predicted_[o].seen, other);
}

void SceneUpdate::note_hidden(ProtoObject& object, const Prediction& predicted) {
  const Visibility& v = predicted.seen.visibility;
  object.hidden_scenes = v.hidden > 0.5 && v.hidden > v.out_of_view ? object.hidden_scenes + 1 : 0;
  const int min_scenes = timing_.snapshot ? 1 : 3;
  if (object.hidden_scenes < min_scenes || object.hidden_reported) return;
  object.hidden_reported = true;
  update_.events.push_back({EventKind::hidden, object.id, scene_.time, object.last_seen,
                            object.probability_here, object.place, object.place, predicted.box, predicted.box,
                            std::nullopt});
}

void SceneUpdate::delete_clutter() {
  const double min_log_odds = -log_odds(options_.confirm);
  const double unrefuted = log_odds(options_.first_sight);
  const auto is_clutter = [&](const ProtoObject& object) {
    if (object.status != Status::tentative) return false;
    if (object.alternative_of != 0)
      return probability_here(object, state_, options_) < kParameters.min_alternative_hypothesis;
    const double unobserved = in_seconds(scene_.time - object.last_seen);
    const double patience =
        options_.snapshot_gap_s * (object.exists_log_odds > unrefuted ? kParameters.patience : 1.0);
    return object.exists_log_odds <= min_log_odds || 1 - object.probability_here >= options_.gone ||
           (!timing_.snapshot && unobserved > patience);
  };
  const auto clutter = std::stable_partition(state_.objects.begin(), state_.objects.end(),
                                             [&](const ProtoObject& object) { return !is_clutter(object); });
  for (auto object = clutter; object != state_.objects.end(); ++object) learn_clutter(*object);
  state_.objects.erase(clutter, state_.objects.end());
}

void SceneUpdate::prune_gone() {
  std::vector<TimeNs> gone;
  for (const ProtoObject& object : state_.objects)
    if (object.status == Status::gone) gone.push_back(object.last_seen);
  const auto max = static_cast<size_t>(options_.gone_kept);
  if (gone.size() <= max) return;
  std::ranges::nth_element(gone, gone.begin() + static_cast<std::ptrdiff_t>(gone.size() - max));
  const TimeNs oldest = gone[gone.size() - max];
  std::erase_if(state_.objects, [&](const ProtoObject& object) {
    return object.status == Status::gone && object.last_seen < oldest;
  });
}

void SceneUpdate::reinstate_alternatives() {
  for (size_t o = 0; o < partner_of_object_.size(); ++o)
    if (state_.objects[o].alternative_of != 0 && partner_of_object_[o]) reinstate(o, *partner_of_object_[o]);
}

void SceneUpdate::reinstate(size_t o, size_t k) {
  ProtoObject& stayed = state_.objects[o];
  const auto found = std::ranges::find(state_.objects, stayed.alternative_of, &ProtoObject::key);
  stayed.alternative_of = 0;
  if (found == state_.objects.end()) return;
  ProtoObject& other = *found;
  stayed.status = Status::present;
  update_.events.push_back(
      {other.status == Status::gone ? EventKind::reappeared : EventKind::moved, other.id, scene_.time,
       other.last_seen, pair_probability(o, k), other.place, scene_.observations[k].place,
       predicted_[static_cast<size_t>(found - state_.objects.begin())].box, scene_.observations[k].box, k});
  update_.mistakes.push_back({other.id, stayed.last_seen});
  stayed.id = other.id;
  stayed.first_seen = other.first_seen;
  // The object tracked instead becomes tentative, and is reported as a new one when observed once more.
  other.id = 0;
  other.status = Status::tentative;
  other.pending.clear();
  other.interaction = {};
  other.clutter_probability = state_.interaction.clutter_share(other.place, options_.appear, options_);
  std::erase_if(other.views, [&](const StoredView& view) { return view.time <= stayed.last_seen; });
  std::erase_if(other.textures, [&](const TextureView& view) { return view.time <= stayed.last_seen; });
  other.exists_log_odds = log_odds(options_.first_sight);
  for (ProtoObject& object : state_.objects)
    if (object.alternative_of == other.key) object.alternative_of = stayed.key;
}

void SceneUpdate::keep_alternative(size_t o, size_t k) {
  const ProtoObject& object = state_.objects[o];
  // The MAP hypothesis is no less probable than another, and never certain.
  const double other = std::clamp(1 - pair_probability(o, k), 0.001, 0.5);
  const double here = other * presence_evidence(o).probability();
  if (here < kParameters.min_alternative_hypothesis) return;
  ProtoObject& alternative = alternatives_.emplace_back(object);
  alternative.id = 0;
  alternative.status = Status::tentative;
  alternative.alternative_of = object.key;
  alternative.probability_here = here;
  alternative.exposure_s = timing_.exposure_s;
  alternative.uses = 0;
  alternative.last_update = scene_.time;
  alternative.alternatives.clear();
}

}  // namespace loci::memory::belief
