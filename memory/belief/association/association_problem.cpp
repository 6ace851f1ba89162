#include "memory/belief/association/association_problem.h"

#include <algorithm>
#include <cmath>

#include "memory/belief/evidence/proximity.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

Eigen::Index index(size_t i) {
  return static_cast<Eigen::Index>(i);
}

class ProblemBuilder {
 public:
  ProblemBuilder(const BeliefState& state, const std::vector<Prediction>& predicted, const Scene& scene,
                 const std::vector<PlaceView>& places, const PairEvidence& evidence,
                 const BeliefOptions& options)
      : state_(state),
        predicted_(predicted),
        scene_(scene),
        evidence_(evidence),
        options_(options),
        timing_(state, scene, options),
        detection_(state.detection.value(options)),
        places_(places) {
    for (const Observation& observation : scene.observations)
      place_of_.push_back(index_of(places, observation.place));
  }

  LogOddsProblem build() {
    const size_t m = state_.objects.size(), n = scene_.observations.size();
    problem_.log_similar = evidence_.log_similar;
    problem_.log_proximity = evidence_.log_proximity;
    keep_known_partners();
    for (PairTable* table : {&problem_.stay_prior, &problem_.move_prior, &problem_.newview_prior})
      table->setZero(index(m), index(n));
    sum_occupants();
    for (size_t o = 0; o < m; ++o) add_object(o);
    for (size_t k = 0; k < n; ++k) add_observation(k);
    return std::move(problem_);
  }

 private:
  /// Excludes all other partners of observations whose object is known, and of pairs that the trackers
  /// settle. Whether a settled pair is the same, against one being gone and the other new, is left to the
  /// model.
  void keep_known_partners() {
    std::vector<bool> known(state_.objects.size(), false);
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      if (!scene_.observations[k].known_object) continue;
      const std::optional<size_t> object = known_partner(k);
      if (object) known[*object] = true;
      keep_partner(object, k);
    }
    for (size_t k = 0; k < evidence_.settled.size(); ++k)
      if (evidence_.settled[k] && !scene_.observations[k].known_object && !known[*evidence_.settled[k]])
        keep_partner(evidence_.settled[k], k);
  }

  /// The believed object that an observation is known to be of; unset = none is believed yet, or it is
  /// clutter.
  std::optional<size_t> known_partner(size_t k) const {
    const int64_t id = scene_.observations[k].known_object.value_or(0);
    if (id <= 0) return std::nullopt;
    const auto found = std::ranges::find(state_.objects, id, &ProtoObject::id);
    if (found == state_.objects.end()) return std::nullopt;
    return static_cast<size_t>(found - state_.objects.begin());
  }

  void keep_partner(std::optional<size_t> o, size_t k) {
    for (const auto& [table, evidence] : {std::pair{&problem_.log_similar, &evidence_.log_similar},
                                          std::pair{&problem_.log_proximity, &evidence_.log_proximity}}) {
      table->col(index(k)).setConstant(kNever);
      if (!o) continue;
      table->row(index(*o)).setConstant(kNever);
      (*table)(index(*o), index(k)) = (*evidence)(index(*o), index(k));
    }
  }

  void add_object(size_t o) {
    const Prediction& p = predicted_[o];
    const AbsenceEvidence absence = absence_of(o);
    add_stay_priors(o);
    add_move_priors(o, absence);
    if (state_.objects[o].alternative_of != 0) {  // elsewhere it is already believed as another object
      problem_.move_prior.row(index(o)).setConstant(kNever);
      problem_.newview_prior.row(index(o)).setConstant(kNever);
    }
    problem_.out_of_view.push_back(undetectable(o));
    problem_.disappear_prior.push_back(std::log(std::max(1e-6, 1 - p.here)) + absence.if_gone);
    problem_.missed_prior.push_back(std::log(std::max(1e-6, p.here)) + absence.if_there + p.log_surface);
    problem_.hidden_prior.push_back(std::log(1 - p.here + p.here * std::exp(p.log_surface)));
  }

  AbsenceEvidence absence_of(size_t o) const {
    std::vector<double> other(scene_.observations.size(), 0.0);
    for (size_t k = 0; k < other.size(); ++k) {
      const double same =
          evidence_.log_proximity(index(o), index(k)) + evidence_.log_similar(index(o), index(k));
      other[k] = (timing_.snapshot ? 1.0 : kParameters.merged_in_video) /
                 (1 + std::exp(std::clamp(same, -30.0, 30.0)));
    }
    return absence_evidence(predicted_[o], empty_share(predicted_[o].seen, other),
                            std::min(1e9, timing_.seconds), detection_, options_);
  }

  /// Whether an observation shows that the place of an object is in view: it may be the part of the object
  /// that is not cut off, or the object itself, which stands a little nearer than another view showed and
  /// hides its predicted box, or it lies there and no depth measures what is in view.
  bool shows_in_view(size_t o, size_t k) const {
    const Observation& observation = scene_.observations[k];
    const bool may_be_it = predicted_[o].with_depth ? observation.partial || timing_.independent
                                                    : state_.objects[o].place == observation.place;
    return may_be_it && evidence_.log_proximity(index(o), index(k)) > 0;
  }

  /// Probability of not being detected if there. What is seen where the object should be shows that not all
  /// of it is out of view.
  double undetectable(size_t o) const {
    constexpr double kMinInView = 1e-3;
    for (size_t k = 0; k < scene_.observations.size(); ++k)
      if (shows_in_view(o, k)) return std::min(predicted_[o].undetectable, 1 - kMinInView);
    return predicted_[o].undetectable;
  }

  void add_stay_priors(size_t o) {
    const Prediction& p = predicted_[o];
    // Of staying with the same and with other looks.
    const auto priors = [&](double in_view) {
      const double stays = std::max(1e-6, p.here) * detection_ / in_view;
      return std::pair(std::log(stays * (1 - p.appearance_change)), std::log(stays * p.appearance_change));
    };
    const auto of_whole = priors(1), of_part = priors(1 - undetectable(o));
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      // Where only the position is uncertain, an observation that is near shows that the object is in view.
      const bool shows_it = !state_.objects[o].has_size || shows_in_view(o, k);
      const auto [stays, turns] = shows_it ? of_part : of_whole;
      problem_.stay_prior(index(o), index(k)) = stays + evidence_.log_same_print(index(o), index(k));
      // Another side hardly has another size, and shares some colours. A detector without depth reports a
      // mean colour, which may be any where it changed, and a class, which hardly depends on the side.
      const double size = evidence_.log_size(index(o), index(k));
      const double looks =
          p.with_depth ? kParameters.newview_color_weight *
                             (evidence_.log_similar(index(o), index(k)) - options_.appearance_weight * size)
                       : evidence_.log_class(index(o), index(k));
      problem_.newview_prior(index(o), index(k)) = turns + size + std::min(0.0, looks);
    }
  }

  void add_move_priors(size_t o, const AbsenceEvidence& absence) {
    const Prediction& p = predicted_[o];
    const ProtoObject& object = state_.objects[o];
    const bool gone = object.status == Status::gone;
    const double left = detection_ * (p.undetectable + (1 - p.undetectable) * std::exp(absence.if_gone));
    std::vector<double> moves_to;
    for (const double moved : p.moved_to) moves_to.push_back(std::log(std::max(1e-9, moved * left)));
    const double shorts = state_.interaction.short_share();
    for (size_t k = 0; k < scene_.observations.size(); ++k) {
      const Observation& observation = scene_.observations[k];
      // A video would have shown the hand that nudges; gone objects may return anywhere.
      const bool anywhere = !p.with_depth || !timing_.snapshot || gone || object.place != observation.place;
      problem_.move_prior(index(o), index(k)) =
          moves_to[place_of_[k]] +
          (anywhere ? 0.0
                    : std::log(1 - shorts +
                               shorts * short_move_ratio(p.box.centre - observation.box.centre, options_))) +
          exchange(o, k);
    }
  }

  /// Log density of where a moved object is put down, against anywhere on the place: now and then it is where
  /// another one stood.
  double exchange(size_t o, size_t k) const {
    const bool same_place = state_.objects[o].place == scene_.observations[k].place;
    const double others = occupants_[k] - (same_place ? 1 : 0);
    if (others <= 0) return 0;
    const double sum = occupied_[k] - (same_place ? density(o, k) : 0.0);
    constexpr double kShare = kParameters.exchange_share;
    return std::log(1 - kShare + kShare * std::max(0.0, sum) / others);
  }

  /// How much more probable an observation is at its position than anywhere, if it is of an object there.
  double density(size_t o, size_t k) const { return std::exp(evidence_.log_proximity(index(o), index(k))); }

  /// Sums over the objects that stood on the place of each observation.
  void sum_occupants() {
    occupants_.assign(scene_.observations.size(), 0);
    occupied_.assign(scene_.observations.size(), 0);
    for (size_t k = 0; k < scene_.observations.size(); ++k)
      for (size_t o = 0; o < state_.objects.size(); ++o) {
        if (state_.objects[o].place != scene_.observations[k].place) continue;
        occupants_[k] += 1;
        occupied_[k] += density(o, k);
      }
  }

  void add_observation(size_t k) {
    const Observation& observation = scene_.observations[k];
    // Pieces of believed objects are clutter: objects fall into parts more often than a new one is put
    // inside.
    double piece = 0;
    for (size_t o = 0; o < predicted_.size() && observation.has_size; ++o) {
      double inside =
          shared_volume(predicted_[o].box, observation.box) / std::max(1e-9, observation.box.volume());
      if (!timing_.snapshot && is_piece(predicted_[o], observation.box)) inside = 1;
      piece = std::max(piece, inside * predicted_[o].here);
    }
    const double arrivals = expected_arrivals(places_[place_of_[k]], timing_, state_, options_);
    const double clutter = state_.interaction.clutter_share(observation.place, arrivals, options_);
    problem_.appear_prior.push_back(std::log(arrivals * (1 - clutter)));
    problem_.clutter_prior.push_back(
        std::log(arrivals * clutter + (timing_.snapshot ? kParameters.piece_in_snapshot : 1.0) * piece));
    if (!observation.known_object) return;
    const bool is_object = *observation.known_object != 0;
    if (!is_object || known_partner(k)) problem_.appear_prior.back() = kParameters.excluded;
    if (is_object) problem_.clutter_prior.back() = kParameters.excluded;
  }

  const BeliefState& state_;
  const std::vector<Prediction>& predicted_;
  const Scene& scene_;
  const PairEvidence& evidence_;
  const BeliefOptions& options_;
  const SceneTiming timing_;
  const double detection_;
  const std::vector<PlaceView>& places_;
  std::vector<size_t> place_of_;              ///< index of each observation's
  std::vector<double> occupants_, occupied_;  ///< per observation: objects of its place, sum of density()
  LogOddsProblem problem_;
};

}  // namespace

LogOddsProblem association_problem(const BeliefState& state, const std::vector<Prediction>& predicted,
                                   const Scene& scene, const std::vector<PlaceView>& places,
                                   const PairEvidence& evidence, const BeliefOptions& options) {
  return ProblemBuilder(state, predicted, scene, places, evidence, options).build();
}

}  // namespace loci::memory::belief
