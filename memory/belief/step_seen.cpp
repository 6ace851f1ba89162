// What becomes of objects that were seen, known and new ones.

#include <algorithm>
#include <cmath>

#include "memory/belief/fusion.h"
#include "memory/belief/step.h"

namespace loci::memory::belief {
namespace {

/// What is cut off is less certainly an object, by so much of log odds.
constexpr double kCutOff = 0.5;

}  // namespace

void Step::see(size_t o, size_t k) {
  ProtoObject& object = state_.objects[o];
  Observation observation = scene_.observations[k];
  if (!observation.sized && object.sized) observation.box.size = expected_[o].box.size;
  const bool piece = !snapshot_ && is_piece(expected_[o], observation.box);
  observation.partial = observation.partial || piece;
  const Explanation explanation = update_.observations[k].explanation;
  update_.objects[o].explanation = explanation;
  const AxisBox before = expected_[o].box;
  const std::string place_before = object.place;
  const Status status_before = object.status;
  const bool was_hidden = object.told_hidden;
  const TimeNs seen_before = object.last_seen;
  const double seconds_unseen = double(scene_.time - object.last_seen) / double(kSecond);

  if (explanation != Explanation::move) learn_view_noise(o, k);
  if (apart_) learn_from_sighting(o, k);
  if (apart_) learn_doubt(object, options_.repeat_clutter, expected_[o].here * options_.detection);
  if (explanation == Explanation::move && status_before == Status::present) leave_behind(o, k);
  if (explanation == Explanation::move || status_before == Status::gone)
    put(object, observation, scene_, options_);
  else
    fuse(object, expected_[o], observation, scene_, options_);  // a piece leaves a whole box as it is
  if (!observation.place.empty()) set_place(object, observation.place, scene_);
  // What was recognised by its look alone may be something else: only its place vouches for another look.
  if (!piece) remember_look(object, observation, scene_, options_, explanation != Explanation::move);
  object.kind = kind_of(object);
  object.probability_here = 1;
  object.hidden_looks = 0;
  object.told_hidden = false;
  mark_seen(object, observation);
  // Frames that follow each other quickly repeat each other's errors.
  const double independence = 1 + std::clamp(seconds_unseen, 0.0, 1.0);
  object.exists_log_odds += (observation.partial ? 0.5 : 1.0) * independence *
                            std::log(options_.detection / options_.repeat_clutter);
  object.exists_log_odds = std::min(object.exists_log_odds, 20.0);

  if (object.status == Status::tentative) {
    if (object.pending.empty()) object.first_seen = scene_.time;
    object.pending.push_back({observation.id, scene_.time, false, update_.observations[k].probability});
    if (object.exists_log_odds >= (snapshot_ ? 0.0 : log_odds(options_.confirm))) confirm(object, k);
    return;
  }
  object.status = Status::present;
  const double probability = update_.observations[k].probability;
  const auto tell = [&](EventKind kind) {
    update_.events.push_back({kind, object.id, scene_.time, seen_before, probability, place_before,
                              object.place, before, observation.box, k});
  };
  if (status_before == Status::gone || was_hidden) tell(EventKind::reappeared);
  if (status_before != Status::gone && explanation == Explanation::move) tell(EventKind::moved);
  // Another side, a shadow or a finger changes the look of a video's frame: only what is seen anew counts.
  if (explanation == Explanation::newview && !observation.partial &&
      seconds_unseen >= options_.snapshot_gap_s)
    tell(EventKind::looks_different);
}

void Step::mark_seen(ProtoObject& object, const Observation& observation) {
  object.last_seen = scene_.time;
  object.last_update = scene_.time;
  object.attention_s = object.seen_attention_s = attention_;
  object.map_from_camera = scene_.view.map_from_camera;
  object.last_observation = observation.id;
  ++object.sightings;
}

void Step::meet(size_t k) {
  ObservationOutcome& outcome = update_.observations[k];
  const Observation& observation = scene_.observations[k];
  const double doubt = 1 / (1 + std::exp(weights_.appear[k] - weights_.clutter[k]));
  // Where false clusters are usual, another look decides, unless this one says more than that.
  const double usual = snapshot_ ? state_.habits.false_share(observation.place, options_) : 0.0;
  if (doubt > (1 + usual) / 2) {
    outcome.explanation = Explanation::clutter;
    outcome.probability = outcome.clutter;
    return;
  }
  outcome.explanation = Explanation::appear;
  outcome.probability = outcome.appear;
  ProtoObject object;
  object.key = state_.next_key++;
  object.sized = false;  // until put() knows better
  object.first_seen = scene_.time;
  object.exists_log_odds = log_odds(options_.first_sight) - (observation.partial ? kCutOff : 0.0);
  const bool wait = usual > 1 - options_.first_sight;
  if (wait) object.exists_log_odds = -log_odds(doubt);
  if (state_.habits.knows(observation.place)) object.doubt = doubt;
  put(object, observation, scene_, options_);
  remember_look(object, observation, scene_, options_, true);
  object.kind = kind_of(object);
  mark_seen(object, observation);
  object.pending.push_back({observation.id, scene_.time, true, outcome.appear});
  outcome.key = object.key;
  state_.objects.push_back(std::move(object));
  if (snapshot_ && !wait) confirm(state_.objects.back(), k);
}

void Step::confirm(ProtoObject& object, std::optional<size_t> k) {
  object.status = Status::present;
  object.id = state_.next_id++;
  std::vector<PendingSighting> earlier = std::move(object.pending);
  object.pending.clear();
  if (k) earlier.pop_back();  // the present one is reported with its scene
  const double exists = 1 / (1 + std::exp(-object.exists_log_odds));
  update_.confirmed.push_back({object.id, object.key, object.first_seen, std::move(earlier)});
  const bool now = object.first_seen == scene_.time;
  update_.events.push_back({EventKind::appeared,
                            object.id,
                            object.first_seen,
                            now ? state_.last_scene : std::nullopt,
                            exists,
                            {},
                            object.place,
                            std::nullopt,
                            box_in_map(object, scene_.places),
                            k});
}

void Step::confirm_unrefuted() {
  const double least = log_odds(options_.first_sight) - kCutOff - 0.1;
  for (ProtoObject& object : state_.objects) {
    if (object.status != Status::tentative || object.exists_log_odds < least || object.pending.empty())
      continue;
    std::optional<size_t> seen;
    for (size_t k = 0; k < update_.observations.size(); ++k)
      if (update_.observations[k].key == object.key) seen = k;
    confirm(object, seen);
  }
}

}  // namespace loci::memory::belief
