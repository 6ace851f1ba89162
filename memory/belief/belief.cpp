#include "memory/belief/belief.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "memory/belief/evidence.h"
#include "memory/belief/fusion.h"
#include "memory/belief/proximity.h"

namespace loci::belief {
namespace {

constexpr double kSmallestShare = 0.001;
constexpr double kSmallestAlternative = 0.02;
/// So probable must it have been to find an object in its place before its absence makes it gone.
constexpr double kLooked = 0.3;
/// What is cut off is less certainly an object, by so much of log odds.
constexpr double kCutOff = 0.5;

double log_odds(double probability) {
  return std::log(probability / (1 - probability));
}

/// Carries the belief over one scene; its members are what the steps share.
class Step {
 public:
  Step(BeliefState& state, const Scene& scene, const BeliefOptions& options)
      : state_(state),
        scene_(scene),
        options_(options),
        snapshot_(is_snapshot(state, scene, options)),
        seconds_(seconds_since_last_scene(state, scene)),
        apart_(seconds_ >= options.snapshot_gap_s),
        attention_(attention_at(state, scene, options)) {}

  BeliefUpdate run() {
    expected_ = expect(state_, scene_, options_);
    update_.evidence = pair_evidence(state_, expected_, scene_, options_);
    update_.problem = identity_problem(state_, expected_, scene_, update_.evidence, options_);
    IdentityOptions identity;
    identity.best = 1;
    identity.gate = 1e-4;  // a tenth of the smallest share that is told
    identity.priors.clutter = 0;
    identity.priors.missed = 0;
    weights_ = weights_of(update_.problem, identity);
    solution_ = solve(weights_, identity);
    update_.log_evidence = solution_.log_evidence;
    update_.gate_bound = solution_.gate_bound;
    pair_up();
    report_distributions();
    const std::vector<std::vector<Alternative>> alternatives = mixed_alternatives();
    const size_t believed = state_.objects.size();
    for (size_t o = 0; o < believed; ++o) {
      if (partner_of_object_[o])
        see(o, *partner_of_object_[o]);
      else
        miss(o);
    }
    for (size_t o = 0; o < believed; ++o) state_.objects[o].alternatives = alternatives[o];
    for (size_t k = 0; k < scene_.observations.size(); ++k)
      if (!partner_of_observation_[k]) meet(k);
    if (apart_) learn_arrivals();
    if (scene_.seconds_to_next && *scene_.seconds_to_next >= options_.snapshot_gap_s) confirm_unrefuted();
    forget_clutter();
    state_.attention_s = attention_;
    finish_outcomes();
    retire();
    state_.last_scene = scene_.time;
    return std::move(update_);
  }

 private:
  void pair_up() {
    partner_of_object_.resize(state_.objects.size());
    partner_of_observation_.resize(scene_.observations.size());
    for (const auto& [o, k] : solution_.map.pairs) {
      partner_of_object_[o] = k;
      partner_of_observation_[k] = o;
    }
    if (snapshot_) return;
    for (size_t k = 0; k < partner_of_observation_.size(); ++k) prefer_known(k);
  }

  /// In a video, what is seen where a known object must be is that object rather than a new one: drift of the
  /// pose and cut views would otherwise make doubles.
  void prefer_known(size_t k) {
    const std::optional<size_t> now = partner_of_observation_[k];
    if (now && state_.objects[*now].status != Status::tentative) return;
    std::optional<size_t> known;
    double most = 0.4;
    for (size_t o = 0; o < state_.objects.size(); ++o) {
      if (state_.objects[o].status != Status::present || partner_of_object_[o]) continue;
      const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
      const AxisBox& seen = scene_.observations[k].box;
      const double covered = covered_share(expected_[o], seen);
      const double color = update_.evidence.log_similar(row, column) -
                           options_.appearance_weight * update_.evidence.log_size(row, column);
      if (covered <= most || color < -2.5 || seen.volume() > 3 * expected_[o].box.volume()) continue;
      most = covered;
      known = o;
    }
    if (!known) return;
    if (now) {
      partner_of_object_[*now].reset();
      state_.objects[*now].exists_log_odds = -100;  // it was a double
    }
    partner_of_object_[*known] = k;
    partner_of_observation_[k] = known;
  }

  Explanation explanation_of_pair(size_t o, size_t k) const {
    const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
    const double stay = weights_.stay(row, column), move = weights_.move(row, column),
                 newview = weights_.newview(row, column);
    if (stay >= move && stay >= newview) return Explanation::stay;
    if (!snapshot_ && covered_share(expected_[o], scene_.observations[k].box) > 0.4) return Explanation::stay;
    return move >= newview ? Explanation::move : Explanation::newview;
  }

  void report_distributions() {
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      ObservationOutcome outcome;
      const auto column = static_cast<Eigen::Index>(k);
      for (size_t o = 0; o < state_.objects.size(); ++o) {
        const auto row = static_cast<Eigen::Index>(o);
        const Share share{state_.objects[o].key, state_.objects[o].id, solution_.stay(row, column),
                          solution_.move(row, column), solution_.newview(row, column)};
        if (partner_of_observation_[k] == o) {
          outcome.key = share.key;
          outcome.explanation = explanation_of_pair(o, k);
          outcome.probability = share.probability();
        }
        if (share.probability() >= kSmallestShare || partner_of_observation_[k] == o)
          outcome.shares.push_back(share);
      }
      std::stable_sort(outcome.shares.begin(), outcome.shares.end(),
                       [](const Share& a, const Share& b) { return a.probability() > b.probability(); });
      outcome.appear = solution_.appear[k];
      outcome.clutter = solution_.clutter[k];
      update_.observations.push_back(std::move(outcome));
    }
    for (size_t o = 0; o < state_.objects.size(); ++o) {
      ObjectOutcome outcome;
      outcome.key = state_.objects[o].key;
      outcome.visibility = expected_[o].seen.visibility;
      outcome.disappear = solution_.disappear[o];
      outcome.missed = solution_.missed[o];
      outcome.hidden = solution_.hidden[o];
      outcome.matched = std::max(0.0, 1 - outcome.disappear - outcome.missed - outcome.hidden);
      update_.objects.push_back(outcome);
    }
  }

  // An object was seen.
  void see(size_t o, size_t k) {
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
      object.pending.push_back({observation.id, scene_.time, false, update_.observations[k].probability});
      if (snapshot_ || object.exists_log_odds >= log_odds(options_.confirm)) confirm(object, k);
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

  // What the home's habits are: from looks that lie apart only, since video frames confirm each other.
  void learn_from_sighting(size_t o, size_t k) {
    ProtoObject& object = state_.objects[o];
    if (object.status == Status::tentative) return;
    const std::string& place = scene_.observations[k].place;
    if (object.status == Status::gone) {
      state_.habits.learn_returns(1, options_.reappear);
      if (place != object.place) state_.habits.learn_found_again(object.place, place, 1);
      return;
    }
    const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
    const double stay = solution_.stay(row, column) + solution_.newview(row, column);
    const double move = solution_.move(row, column);
    const double moved = stay + move > 0 ? move / (stay + move) : 0.0;
    const double seconds = attention_ - object.seen_attention_s;
    state_.habits.learn_handled(handled(object), object.handling, seconds, moved, options_);
    state_.habits.learn_moved(object.place, place, moved);
  }

  // What surely stayed and is found whole both times shows how well poses and visible parts agree. Where it
  // moved a little after all it must not count in full.
  void learn_view_noise(size_t o, size_t k) {
    constexpr double kWeight = 0.25, kSure = 0.9, kFarthest = 4;
    const ProtoObject& object = state_.objects[o];
    const Observation& observation = scene_.observations[k];
    const bool whole = !object.partial && !observation.partial && object.sized && observation.sized;
    const double other = object.variance + observation_variance(observation, options_);
    if (!whole || object.id == 0 || update_.observations[k].probability < kSure) return;
    const double learned = view_noise(state_), expected = expected_[o].view_variance / learned;
    if (expected < 4 * other) return;  // about the same view point
    const Vector3d offset = observation.box.centre - expected_[o].box.centre;
    const double found = offset.head<2>().squaredNorm() / 2 / expected;
    state_.view_noise.count(kWeight * std::min(found, kFarthest * learned), kWeight);
  }

  void learn_from_absence(ProtoObject& object) {
    const double seconds = attention_ - object.seen_attention_s;
    const double gone = 1 - object.probability_here;
    state_.habits.learn_handled(handled(object), object.handling, seconds, gone, options_);
    state_.habits.learn_carried_off(gone);
  }

  void learn_arrivals() {
    std::map<std::string, double> found;
    if (scene_.view.observed)
      for (const ObservedPlace& observed : *scene_.view.observed) found[observed.name];
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      const bool fresh = update_.observations[k].explanation == Explanation::appear;
      found[scene_.observations[k].place] += fresh ? update_.observations[k].probability : 0.0;
    }
    for (const auto& [place, count] : found) state_.habits.learn_arrivals(place, count, options_);
  }

  /// What each track may be after this scene instead of what it is taken for.
  std::vector<std::vector<Alternative>> mixed_alternatives() const {
    std::vector<std::vector<Alternative>> mixed;
    for (size_t o = 0; o < state_.objects.size(); ++o) {
      if (state_.objects[o].id == 0) {
        mixed.emplace_back();
        continue;
      }
      std::map<int64_t, double> keys;
      double sum = 0;
      const auto add = [&](size_t other, double weight) {
        if (weight <= 0 || state_.objects[other].id == 0) return;
        sum += weight;
        keys[state_.objects[other].key] += weight * state_.objects[other].probability_itself();
        for (const Alternative& alternative : state_.objects[other].alternatives)
          keys[alternative.key] += weight * alternative.probability;
      };
      if (const std::optional<size_t> seen_as = partner_of_object_[o]) {
        for (size_t other = 0; other < state_.objects.size(); ++other)
          add(other, probability(other, *seen_as));
      } else {
        double matched = 0;
        for (size_t k = 0; k < scene_.observations.size(); ++k) matched += probability(o, k);
        if (matched < kSmallestAlternative) {
          mixed.push_back(state_.objects[o].alternatives);
          continue;
        }
        for (size_t k = 0; k < scene_.observations.size(); ++k)
          if (partner_of_observation_[k]) add(*partner_of_observation_[k], probability(o, k));
        add(o, std::max(0.0, 1 - matched));
      }
      mixed.push_back(alternatives_of(keys, state_.objects[o].key, sum));
    }
    return mixed;
  }

  static std::vector<Alternative> alternatives_of(const std::map<int64_t, double>& keys, int64_t itself,
                                                  double sum) {
    std::vector<Alternative> list;
    for (const auto& [key, weight] : keys)
      if (key != itself && weight / sum >= kSmallestAlternative) list.push_back({key, weight / sum});
    std::stable_sort(list.begin(), list.end(), [](const Alternative& a, const Alternative& b) {
      return a.probability > b.probability;
    });
    return list;
  }

  double probability(size_t o, size_t k) const {
    const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
    return solution_.stay(row, column) + solution_.move(row, column) + solution_.newview(row, column);
  }

  void mark_seen(ProtoObject& object, const Observation& observation) {
    object.last_seen = scene_.time;
    object.last_update = scene_.time;
    object.attention_s = object.seen_attention_s = attention_;
    object.map_from_camera = scene_.view.map_from_camera;
    object.last_observation = observation.id;
    ++object.sightings;
  }

  // An object was not seen.
  void miss(size_t o) {
    ProtoObject& object = state_.objects[o];
    const Expectation& e = expected_[o];
    if (object.status == Status::gone && apart_)
      state_.habits.learn_returns(update_.objects[o].matched, options_.reappear);
    if (e.undetectable >= 1) {  // looking elsewhere tells nothing
      update_.objects[o].explanation = Explanation::hidden;
      if (object.status == Status::present) note_hidden(object, e);
      return;
    }
    const double empty = empty_share_in_hindsight(o);
    const EmptinessEvidence evidence = emptiness(e, empty, seconds_, options_);
    const double in_view = 1 - e.undetectable;
    const double there = e.here * (e.undetectable + in_view * std::exp(evidence.if_there));
    const double away = (1 - e.here) * (e.undetectable + in_view * std::exp(evidence.if_gone));
    object.probability_here = there / std::max(1e-300, there + away);
    object.last_update = scene_.time;
    object.attention_s = attention_;
    // Where the look could not tell, it explains nothing: there or away, the object is out of sight.
    const double hidden = e.undetectable;
    const double missed = there - e.here * e.undetectable, left = away - (1 - e.here) * e.undetectable;
    const Explanation explanation = hidden >= missed && hidden >= left ? Explanation::hidden
                                    : missed >= left                   ? Explanation::missed
                                                                       : Explanation::disappear;
    update_.objects[o].explanation = explanation;
    if (object.status == Status::tentative) {
      const double missed_if_object = 1 - options_.detection * in_view * (empty > 0.7 ? 1.1 : 1.0);
      object.exists_log_odds +=
          std::log(std::max(0.01, missed_if_object) / (1 - options_.repeat_clutter * in_view));
      return;
    }
    if (object.status != Status::present) return;
    // Time alone makes nothing go: what is out of view stays remembered until somebody looks.
    if (1 - object.probability_here >= options_.gone && in_view >= kLooked) {
      object.status = Status::gone;
      object.told_hidden = false;
      if (apart_) learn_from_absence(object);
      update_.events.push_back({EventKind::gone,
                                object.id,
                                scene_.time,
                                object.last_seen,
                                1 - object.probability_here,
                                object.place,
                                {},
                                e.box,
                                std::nullopt,
                                std::nullopt});
      return;
    }
    note_hidden(object, e);
  }

  /// empty_share() now that it is decided what the others are (a cluster that swallowed both does not count).
  double empty_share_in_hindsight(size_t o) const {
    std::vector<double> other(scene_.observations.size(), snapshot_ ? 1.0 : 0.3);
    for (size_t k = 0; k < other.size(); ++k) {
      const ObservationOutcome& outcome = update_.observations[k];
      if (outcome.explanation == Explanation::clutter) other[k] = 0;
      if (!partner_of_observation_[k] || outcome.explanation == Explanation::move) continue;
      const double before = expected_[*partner_of_observation_[k]].box.volume();
      if (scene_.observations[k].box.volume() > 1.4 * before) other[k] = 0;
    }
    return empty_share(expected_[o].seen, other);
  }

  void note_hidden(ProtoObject& object, const Expectation& e) {
    const Visibility& v = e.seen.visibility;
    object.hidden_looks = v.hidden > 0.5 && v.hidden > v.out_of_view ? object.hidden_looks + 1 : 0;
    const int looks_needed = snapshot_ ? 1 : 3;
    if (object.hidden_looks < looks_needed || object.told_hidden) return;
    object.told_hidden = true;
    update_.events.push_back({EventKind::hidden, object.id, scene_.time, object.last_seen,
                              object.probability_here, object.place, object.place, e.box, e.box,
                              std::nullopt});
  }

  // Something that is none of the believed objects.
  void meet(size_t k) {
    ObservationOutcome& outcome = update_.observations[k];
    const Observation& observation = scene_.observations[k];
    if (weights_.clutter[k] > weights_.appear[k]) {
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
    put(object, observation, scene_, options_);
    remember_look(object, observation, scene_, options_, true);
    object.kind = kind_of(object);
    mark_seen(object, observation);
    object.pending.push_back({observation.id, scene_.time, true, outcome.appear});
    outcome.key = object.key;
    state_.objects.push_back(std::move(object));
    if (snapshot_) confirm(state_.objects.back(), k);
  }

  void confirm(ProtoObject& object, std::optional<size_t> k) {
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

  /// Before a long pause nothing more can be learned: what was seen, if only once and cut off, and was not
  /// missed is believed.
  void confirm_unrefuted() {
    const double least = log_odds(options_.first_sight) - kCutOff - 0.1;
    for (ProtoObject& object : state_.objects) {
      if (object.status != Status::tentative || object.exists_log_odds < least) continue;
      std::optional<size_t> seen;
      for (size_t k = 0; k < update_.observations.size(); ++k)
        if (update_.observations[k].key == object.key) seen = k;
      confirm(object, seen);
    }
  }

  void forget_clutter() {
    const double least = -log_odds(options_.confirm);
    std::erase_if(state_.objects, [&](const ProtoObject& object) {
      const double unseen = double(scene_.time - object.last_seen) / double(kSecond);
      return object.status == Status::tentative &&
             (object.exists_log_odds <= least || unseen > options_.snapshot_gap_s);
    });
  }

  /// What is gone can be recognised when it comes back, but not everything that ever was is compared with
  /// all that is seen: those missing for longest are let go.
  void retire() {
    std::vector<TimeNs> gone;
    for (const ProtoObject& object : state_.objects)
      if (object.status == Status::gone) gone.push_back(object.last_seen);
    const auto most = static_cast<size_t>(options_.gone_kept);
    if (gone.size() <= most) return;
    std::ranges::nth_element(gone, gone.begin() + static_cast<std::ptrdiff_t>(gone.size() - most));
    const TimeNs oldest = gone[gone.size() - most];
    std::erase_if(state_.objects, [&](const ProtoObject& object) {
      return object.status == Status::gone && object.last_seen < oldest;
    });
  }

  void finish_outcomes() {
    std::map<int64_t, const ProtoObject*> by_key;
    for (const ProtoObject& object : state_.objects) by_key[object.key] = &object;
    const auto find = [&](int64_t key) {
      const auto found = by_key.find(key);
      return found == by_key.end() ? nullptr : found->second;
    };
    const auto id_of = [&](int64_t key) {
      const ProtoObject* object = find(key);
      return object == nullptr ? int64_t{0} : object->id;
    };
    for (ObservationOutcome& outcome : update_.observations) {
      outcome.object = id_of(outcome.key);
      for (Share& share : outcome.shares) share.object = id_of(share.key);
    }
    for (ObjectOutcome& outcome : update_.objects) {
      outcome.object = id_of(outcome.key);
      if (const ProtoObject* object = find(outcome.key))
        outcome.probability_here = probability_here(*object, state_, options_);
    }
  }

  BeliefState& state_;
  const Scene& scene_;
  const BeliefOptions& options_;
  const bool snapshot_;
  const double seconds_;
  const bool apart_;  ///< long enough after the scene before to teach about habits
  const double attention_;
  std::vector<Expectation> expected_;
  IdentityWeights weights_;
  IdentitySolution solution_;
  std::vector<std::optional<size_t>> partner_of_object_, partner_of_observation_;
  BeliefUpdate update_;
};

}  // namespace

const char* event_name(EventKind kind) {
  switch (kind) {
    case EventKind::appeared:
      return "appeared";
    case EventKind::moved:
      return "moved";
    case EventKind::looks_different:
      return "looks_different";
    case EventKind::gone:
      return "gone";
    case EventKind::hidden:
      return "hidden";
    case EventKind::reappeared:
      return "reappeared";
  }
  return "";
}

BeliefUpdate advance(BeliefState& state, const Scene& scene, const BeliefOptions& options) {
  if (state.last_scene && scene.time < *state.last_scene)
    throw Error(
        "a scene at " + format_time(scene.time) + " comes after one at " + format_time(*state.last_scene), {},
        "perceive recordings in the order of time");
  return Step(state, scene, options).run();
}

}  // namespace loci::belief
