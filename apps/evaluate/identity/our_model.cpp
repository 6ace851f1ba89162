#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/evaluate/identity/model.h"
#include "memory/belief/generative.h"

namespace loci::identity_experiment {
namespace {

using belief::Change;
using belief::ChangeRates;
using belief::Domain;
using belief::Fates;
using belief::Measured;

constexpr double kTable = 1.0;   ///< metres, both sides
constexpr size_t kStripes = 50;  ///< along a table: when each was looked at last
constexpr double kTiny = 1e-12;

/// A stretch of the view that was last looked at at one time.
struct Stretch {
  double width = 0;         ///< metres
  double objects_time = 0;  ///< since it was looked at, on the objects' clock
  double world_time = 0;    ///< the same on the world's clock
  bool never = false;
};

/// The generative model: likelihood ratios from the noise, priors from rates that are learned, fusion of what
/// was seen.
class OurModel : public Model {
 public:
  OurModel(const WorldOptions& world, const NoiseSetting& noise, bool told)
      : world_(world),
        told_(told),
        position_noise_(noise.known ? belief::NoiseEstimate::known(noise.sigma) : belief::NoiseEstimate(0.1)),
        color_noise_(position_noise_) {
    options_.best = 1;
  }

  void begin(const Sequence& sequence) override {
    learner_.begin_world();
    last_look_.assign(static_cast<size_t>(world_.tables), std::vector<int>(kStripes, kNever));
    objects_clock_.assign(1, 0.0);
    unseen_present_ = 0;
    if (told_) tell(sequence);
  }

  Judgement judge(const View& view, int step, const std::vector<Entry>& old,
                  const std::vector<Measurement>& seen, bool everything_seen_before) override {
    rates_ = told_ ? told_rates_ : learner_.rates();
    objects_clock_.push_back(objects_clock_.back() + 1 / believed_present(old, everything_seen_before));
    now_ = step;
    if (everything_seen_before)
      for (auto& table : last_look_) std::fill(table.begin(), table.end(), step - 1);
    seen_domain_ = {std::max(0.0, view.centre - view.half), std::min(kTable, view.centre + view.half)};
    const std::vector<Stretch> stretches = stretches_of(view);

    const IdentitySolution solution = solve(problem_of(view, old, seen, stretches), options_);
    learn(old, seen, stretches, solution);
    look(view);
    return judgement_of(old, seen, solution);
  }

  Entry update(const Entry& before, const Measurement& seen, int step,
               Explanation explanation) const override {
    Entry entry = Entry::first(seen, step);
    if (explanation != Explanation::move) {
      entry.position_looks = before.position_looks + 1;
      entry.fused.position += (before.fused.position - seen.position) * (1 - 1 / entry.position_looks);
    }
    if (explanation != Explanation::newview) {
      entry.color_looks = before.color_looks + 1;
      entry.fused.color += (before.fused.color - seen.color) * (1 - 1 / entry.color_looks);
    }
    return entry;
  }

 private:
  static constexpr int kNever = std::numeric_limits<int>::min();

  /// The simulator's own rates, for comparison with what is learned.
  void tell(const Sequence& sequence) {
    std::array<double, kActions> per_step{};
    for (const SimulatedScene& scene : sequence.scenes)
      for (size_t i = 0; i < kActions; ++i)
        per_step[i] += scene.actions[i] / static_cast<double>(sequence.scenes.size());
    const auto of = [&](Action action) { return std::max(1e-6, per_step[static_cast<size_t>(action)]); };
    told_rates_[Change::removed] = of(Action::disappear);
    told_rates_[Change::moved] = of(Action::move);
    told_rates_[Change::changed] = of(Action::newview);
    told_rates_[Change::returned] =
        of(Action::appear) * sequence.limit / std::max(1, world_.objects - sequence.limit);
    told_rates_[Change::arrived] = of(Action::appear) / places_area();
    told_rates_[Change::initial] = std::max(1e-6, sequence.limit * world_.start_share / places_area());
  }

  double places_area() const { return world_.tables * kTable * kTable; }

  double gap(int since) const {
    const auto at = static_cast<size_t>(std::max(0, since + 1));
    return objects_clock_.back() - objects_clock_[at];
  }

  /// Expected number of objects that share the attention of who handles them.
  double believed_present(const std::vector<Entry>& old, bool everything_seen_before) {
    double present = 0;
    for (const Entry& entry : old) {
      const double since =
          objects_clock_.back() - objects_clock_[static_cast<size_t>(std::max(0, entry.step + 1))];
      present += std::exp(-rates_[Change::removed] * std::max(0.0, since));
    }
    if (!everything_seen_before) present += unseen_present_;
    return std::max(1.0, present);
  }

  std::vector<Stretch> stretches_of(const View& view) const {
    std::vector<Stretch> stretches;
    const std::vector<int>& looks = last_look_[static_cast<size_t>(view.table)];
    const double width = kTable / kStripes;
    int before = kNever + 1;
    for (size_t i = 0; i < kStripes; ++i) {
      if (!view.contains(view.table, (static_cast<double>(i) + 0.5) * width)) continue;
      if (looks[i] != before) stretches.push_back(stretch(looks[i]));
      stretches.back().width += width;
      before = looks[i];
    }
    return stretches;
  }

  Stretch stretch(int last_look) const {
    const bool never = last_look == kNever;
    return {0, never ? objects_clock_.back() : gap(last_look), double(now_ - (never ? -1 : last_look)),
            never};
  }

  Stretch stretch_at(const View& view, double x) const {
    const double inside = std::clamp(x, seen_domain_.low, seen_domain_.high - kTiny);
    const auto stripe =
        std::min(kStripes - 1, static_cast<size_t>(std::max(0.0, inside) / kTable * kStripes));
    return stretch(last_look_[static_cast<size_t>(view.table)][stripe]);
  }

  /// Things per square metre that nobody believes in: those that came, and those that were there already.
  struct Density {
    double arrived = 0, initial = 0;
    double sum() const { return arrived + initial; }
  };
  Density unknown(const Stretch& stretch) const {
    const double leaving = (rates_[Change::removed] + rates_[Change::moved]) *
                           (objects_clock_.back() - objects_clock_[objects_clock_.size() - 2]);
    Density density;
    density.arrived = belief::untracked(rates_[Change::arrived], leaving, stretch.world_time);
    if (stretch.never) density.initial = rates_[Change::initial] * std::exp(-leaving * stretch.world_time);
    return density;
  }

  LogOddsProblem problem_of(const View& view, const std::vector<Entry>& old,
                            const std::vector<Measurement>& seen, const std::vector<Stretch>& stretches) {
    const auto m = static_cast<Eigen::Index>(old.size()), n = static_cast<Eigen::Index>(seen.size());
    LogOddsProblem problem;
    for (PairTable* table : {&problem.log_similar, &problem.log_proximity, &problem.stay_prior,
                             &problem.move_prior, &problem.newview_prior})
      table->setZero(m, n);
    place_of_.clear();
    for (const Measurement& measurement : seen) {
      place_of_.push_back(stretch_at(view, measurement.position.x()));
      problem.appear_prior.push_back(std::log(std::max(kTiny, unknown(place_of_.back()).sum())));
    }
    in_view_.clear();
    for (Eigen::Index o = 0; o < m; ++o) {
      const Entry& entry = old[static_cast<size_t>(o)];
      const Fates fates(rates_, gap(entry.step));
      const Measured x{entry.fused.position.x(), position_noise_.variance() / entry.position_looks};
      const double in_view = entry.last.table == view.table
                                 ? std::clamp(mass(x, seen_domain_) / mass(x, {0, kTable}), kTiny, 1 - kTiny)
                                 : kTiny;
      in_view_.push_back(in_view);
      const double turns_up = moves_into(stretches, fates) + returns_into(stretches, fates);
      problem.out_of_view.push_back(1 - in_view);
      problem.disappear_prior.push_back(
          std::log(std::max(1e-9, 1 - fates.stays() - fates.changed() - turns_up)));
      problem.hidden_prior.push_back(std::log(std::max(1e-9, 1 - turns_up)));
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto index = static_cast<size_t>(k);
        problem.log_similar(o, k) = log_color(entry, seen[index]);
        problem.log_proximity(o, k) = entry.last.table == view.table
                                          ? log_position(entry, seen[index]) - std::log(in_view)
                                          : loci::kNever;
        problem.stay_prior(o, k) = std::log(std::max(kTiny, fates.stays()));
        problem.newview_prior(o, k) = std::log(std::max(kTiny, fates.changed()));
        const double window = place_of_[index].objects_time;
        problem.move_prior(o, k) =
            std::log(std::max(kTiny, (fates.moved(window) + fates.returned(window)) / places_area()));
      }
    }
    return problem;
  }

  double log_color(const Entry& entry, const Measurement& seen) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      sum += belief::log_same({entry.fused.color[i], color_noise_.variance() / entry.color_looks}, {0, 1},
                      {seen.color[i], color_noise_.variance()}, {0, 1});
    return sum;
  }

  double log_position(const Entry& entry, const Measurement& seen) const {
    const double variance = position_noise_.variance();
    double sum = 0;
    for (int i = 0; i < 2; ++i)
      sum += belief::log_same({entry.fused.position[i], variance / entry.position_looks}, {0, kTable},
                      {seen.position[i], variance}, i == 0 ? seen_domain_ : Domain{0, kTable});
    return sum;
  }

  double moves_into(const std::vector<Stretch>& stretches, const Fates& fates) const {
    double sum = 0;
    for (const Stretch& s : stretches) sum += s.width * kTable * fates.moved(s.objects_time);
    return sum / places_area();
  }

  double returns_into(const std::vector<Stretch>& stretches, const Fates& fates) const {
    double sum = 0;
    for (const Stretch& s : stretches) sum += s.width * kTable * fates.returned(s.objects_time);
    return sum / places_area();
  }

  /// What was found against what was expected.
  void learn(const std::vector<Entry>& old, const std::vector<Measurement>& seen,
             const std::vector<Stretch>& stretches, const IdentitySolution& solution) {
    for (size_t o = 0; o < old.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o);
      const double time = gap(old[o].step);
      const Fates fates(rates_, time);
      const double moves = moves_into(stretches, fates), returns = returns_into(stretches, fates);
      for (Eigen::Index k = 0; k < solution.move.cols(); ++k) {
        const double window = place_of_[static_cast<size_t>(k)].objects_time;
        const double moved = fates.moved(window), returned = fates.returned(window);
        const double share = moved / std::max(kTiny, moved + returned);
        learner_.count(Change::moved, solution.move(row, k) * share, 0);
        learner_.count(Change::returned, solution.move(row, k) * (1 - share), 0);
      }
      learner_.count(Change::moved, 0, moves);
      learner_.count(Change::returned, 0, returns);
      learner_.count(Change::changed, solution.newview.row(row).sum(), in_view_[o] * fates.changed());
      const double vanished = std::max(1e-9, 1 - fates.stays() - fates.changed() - moves - returns);
      const double removed =
          std::clamp(-std::expm1(-rates_[Change::removed] * time) - returns, 0.0, vanished);
      learner_.count(Change::removed, solution.disappear[o] * removed / vanished, in_view_[o] * removed);
    }
    for (size_t k = 0; k < seen.size(); ++k) {
      const Density density = unknown(place_of_[k]);
      learner_.count(Change::arrived, solution.appear[k] * density.arrived / density.sum(), 0);
      learner_.count(Change::initial, solution.appear[k] * density.initial / density.sum(), 0);
    }
    for (const Stretch& s : stretches) {
      const Density density = unknown(s);
      learner_.count(Change::arrived, 0, s.width * kTable * density.arrived);
      learner_.count(Change::initial, 0, s.width * kTable * density.initial);
    }
    learner_.finish_scene();
    learn_noise(old, seen, solution);
  }

  void learn_noise(const std::vector<Entry>& old, const std::vector<Measurement>& seen,
                   const IdentitySolution& solution) {
    for (size_t o = 0; o < old.size(); ++o)
      for (size_t k = 0; k < seen.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
        const double stay = solution.stay(row, column);
        for (int i = 0; i < 2; ++i)
          position_noise_.count(seen[k].position[i] - old[o].fused.position[i], old[o].position_looks,
                                stay + solution.newview(row, column));
        for (int i = 0; i < 3; ++i)
          color_noise_.count(seen[k].color[i] - old[o].fused.color[i], old[o].color_looks,
                             stay + solution.move(row, column));
      }
  }

  void look(const View& view) {
    std::vector<int>& looks = last_look_[static_cast<size_t>(view.table)];
    for (size_t i = 0; i < kStripes; ++i)
      if (view.contains(view.table, (static_cast<double>(i) + 0.5) * kTable / kStripes)) looks[i] = now_;
    unseen_present_ = 0;
    for (const auto& table : last_look_)
      for (const int look : table)
        if (look != now_) unseen_present_ += unknown(stretch(look)).sum() * kTable * kTable / kStripes;
  }

  Judgement judgement_of(const std::vector<Entry>& old, const std::vector<Measurement>& seen,
                         const IdentitySolution& solution) const {
    Judgement judgement;
    std::vector<bool> linked(old.size(), false);
    for (const auto& [o, k] : solution.map.pairs) {
      linked[o] = true;
      const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
      const double stay = solution.stay(row, column), move = solution.move(row, column),
                   newview = solution.newview(row, column);
      judgement.links.push_back({o, k,
                                 stay >= move && stay >= newview ? Explanation::stay
                                 : move >= newview               ? Explanation::move
                                                                 : Explanation::newview});
    }
    for (size_t k = 0; k < seen.size(); ++k) judgement.seen.push_back(decide_observation(solution, k));
    for (size_t o = 0; o < old.size(); ++o) {
      judgement.old.push_back(decide_object(solution, o));
      judgement.kept.push_back(!linked[o] && solution.hidden[o] > solution.disappear[o]);
    }
    return judgement;
  }

  const WorldOptions world_;
  const bool told_;
  IdentityOptions options_;
  belief::RateLearner learner_;
  ChangeRates rates_, told_rates_;
  belief::NoiseEstimate position_noise_, color_noise_;
  std::vector<std::vector<int>> last_look_;  ///< per table and stripe: the step
  std::vector<double> objects_clock_;        ///< [step + 1]
  double unseen_present_ = 0;
  int now_ = 0;
  Domain seen_domain_;
  std::vector<Stretch> place_of_;  ///< per measurement
  std::vector<double> in_view_;    ///< per believed object
};

}  // namespace

std::unique_ptr<Model> make_our_model(const WorldOptions& world, const NoiseSetting& noise, bool told) {
  return std::make_unique<OurModel>(world, noise, told);
}

}  // namespace loci::identity_experiment
