#include <algorithm>
#include <cmath>

#include "apps/evaluate/identity/our_view.h"

namespace loci::apps::identity_experiment {
namespace {

using memory::belief::Change;
using memory::belief::ChangeRates;
using memory::belief::Untracked;
using memory::belief::Whereabouts;

constexpr double kTiny = 1e-12;

double log_of(double probability) {
  return std::log(std::max(kTiny, probability));
}

/// One level of busyness: what it expects and how it explains the scene.
struct Level {
  ChangeRates rates;
  Untracked untracked{0};
  double weight = 1;
  memory::IdentitySolution solution;
};

/// What the levels say together.
memory::IdentitySolution mixture(const std::vector<Level>& levels) {
  const auto likeliest = std::max_element(levels.begin(), levels.end(),
                                          [](const Level& a, const Level& b) { return a.weight < b.weight; });
  memory::IdentitySolution sum = likeliest->solution;
  for (memory::PairTable* table : {&sum.stay, &sum.move, &sum.newview, &sum.none}) table->setZero();
  for (auto* row : {&sum.appear, &sum.clutter, &sum.disappear, &sum.missed, &sum.hidden})
    std::fill(row->begin(), row->end(), 0.0);
  const auto add = [](std::vector<double>& to, const std::vector<double>& from, double weight) {
    for (size_t i = 0; i < to.size(); ++i) to[i] += weight * from[i];
  };
  for (const Level& level : levels) {
    const memory::IdentitySolution& part = level.solution;
    sum.stay += level.weight * part.stay;
    sum.move += level.weight * part.move;
    sum.newview += level.weight * part.newview;
    sum.none += level.weight * part.none;
    add(sum.appear, part.appear, level.weight);
    add(sum.disappear, part.disappear, level.weight);
    add(sum.hidden, part.hidden, level.weight);
  }
  return sum;
}

/// The generative model: likelihood ratios from the noise, priors from rates that are learned, fusion of what
/// was seen, and for what was not seen where it may be.
class OurModel : public Model {
 public:
  OurModel(const WorldOptions& world, const NoiseSetting& noise, bool told)
      : world_(world),
        told_(told),
        cells_(world.tables),
        position_noise_(noise.known ? memory::belief::NoiseEstimate::known(noise.sigma)
                                    : memory::belief::NoiseEstimate(0.1)),
        color_noise_(position_noise_) {
    options_.best = 1;
  }

  void begin(const Sequence& sequence) override {
    busyness_.begin_world();
    if (told_) tell(sequence);
    levels_.assign(told_ ? 1 : busyness_.levels(), Level{});
    set_rates();
    for (Level& level : levels_) {
      level.untracked = Untracked(cells_.count());
      level.untracked.initial.assign(cells_.count(), level.rates[Change::initial] * Cells::kArea);
    }
  }

  Judgement judge(const View& view, int, std::vector<Entry>& old, const std::vector<Measurement>& seen,
                  bool everything_seen_before) override {
    set_rates();
    for (Entry& entry : old) entry.where.resize(levels_.size());
    const ViewEvidence evidence =
        evidence_of(view, cells_, {position_noise_.variance(), color_noise_.variance()}, old, seen);
    std::vector<double> log_evidence;
    for (size_t i = 0; i < levels_.size(); ++i) {
      if (everything_seen_before) levels_[i].untracked = Untracked(cells_.count());
      let_time_pass(i, old);
      levels_[i].solution = solve(problem_of(i, old, evidence), options_);
      // How many unknown things turn up is Poisson.
      log_evidence.push_back(levels_[i].solution.log_z - visible_unknown(levels_[i], evidence));
    }
    if (!told_) {
      busyness_.observe(log_evidence);
      for (size_t i = 0; i < levels_.size(); ++i) levels_[i].weight = busyness_.weight(i);
    }
    for (size_t i = 0; i < levels_.size(); ++i) learn_rates(i, old, evidence);
    learner_.finish_scene();
    const memory::IdentitySolution solution = mixture(levels_);
    learn_noise(old, seen, solution);
    const Judgement judgement = judgement_of(old, seen, solution);
    learn_absence(old, judgement, evidence);
    return judgement;
  }

  /// The mean over what was seen since the last change.
  Entry update(const Entry& before, const Measurement& seen, int step, const Link& link) const override {
    Entry entry = Entry::first(seen, step);
    entry.position_looks += link.same_position * before.position_looks;
    entry.color_looks += link.same_color * before.color_looks;
    entry.fused.position += (before.fused.position - seen.position) * (1 - 1 / entry.position_looks);
    entry.fused.color += (before.fused.color - seen.color) * (1 - 1 / entry.color_looks);
    return entry;
  }

 private:
  /// The simulator's own rates, for comparison with what is learned.
  void tell(const Sequence& sequence) {
    std::array<double, kActions> per_step{};
    double present = 0;
    for (const SimulatedScene& scene : sequence.scenes) {
      for (size_t i = 0; i < kActions; ++i)
        per_step[i] += scene.actions[i] / static_cast<double>(sequence.scenes.size());
      present += scene.present / static_cast<double>(sequence.scenes.size());
    }
    const auto of = [&](Action action) { return std::max(1e-6, per_step[static_cast<size_t>(action)]); };
    told_rates_[Change::removed] = of(Action::disappear);
    told_rates_[Change::moved] = of(Action::move);
    told_rates_[Change::changed] = of(Action::newview);
    told_rates_[Change::returned] = of(Action::appear) * present / std::max(1.0, world_.objects - present);
    told_rates_[Change::arrived] = of(Action::appear) / cells_.total_area();
    told_rates_[Change::initial] =
        std::max(1e-6, start_objects(world_, sequence.limit) / cells_.total_area());
  }

  void set_rates() {
    for (size_t i = 0; i < levels_.size(); ++i) {
      levels_[i].rates = told_ ? told_rates_ : learner_.rates().times(busyness_.factor(i));
      levels_[i].weight = told_ ? 1.0 : busyness_.weight(i);
    }
  }

  /// Who handles things shares the attention among those that are there.
  void let_time_pass(size_t index, std::vector<Entry>& old) {
    Level& level = levels_[index];
    double present = level.untracked.sum();
    for (const Entry& entry : old) present += entry.where[index].present();
    const memory::belief::Handling handling =
        memory::belief::handling(level.rates, 1 / std::max(1.0, present));
    predict(level.untracked, handling, level.rates[Change::arrived] * Cells::kArea);
    for (Entry& entry : old) predict(entry.where[index], handling, cells_.count(), level.untracked);
  }

  static double visible_unknown(const Level& level, const ViewEvidence& evidence) {
    return evidence.visible_part(level.untracked.arrived) + evidence.visible_part(level.untracked.initial) +
           evidence.visible_part(level.untracked.lost);
  }

  memory::LogOddsProblem problem_of(size_t index, const std::vector<Entry>& old,
                                    const ViewEvidence& evidence) const {
    const Untracked& untracked = levels_[index].untracked;
    memory::LogOddsProblem problem;
    problem.log_similar = evidence.log_similar;
    problem.log_proximity = evidence.log_proximity;
    for (memory::PairTable* table : {&problem.stay_prior, &problem.move_prior, &problem.newview_prior})
      table->setZero(evidence.log_similar.rows(), evidence.log_similar.cols());
    for (size_t k = 0; k < evidence.from_cell.size(); ++k)
      problem.appear_prior.push_back(log_of(evidence.density(k, untracked.arrived) +
                                            evidence.density(k, untracked.initial) +
                                            evidence.density(k, untracked.lost)));
    for (size_t o = 0; o < old.size(); ++o) {
      const Whereabouts& where = old[o].where[index];
      const auto row = static_cast<Eigen::Index>(o);
      const double turns_up = evidence.visible_part(where.elsewhere);
      problem.out_of_view.push_back(1 - evidence.in_view[o]);
      problem.disappear_prior.push_back(log_of(1 - where.here - where.changed - turns_up));
      problem.hidden_prior.push_back(log_of(1 - turns_up));
      problem.stay_prior.row(row).setConstant(log_of(where.here));
      problem.newview_prior.row(row).setConstant(log_of(where.changed));
      for (size_t k = 0; k < evidence.from_cell.size(); ++k)
        problem.move_prior(row, static_cast<Eigen::Index>(k)) = log_of(evidence.density(k, where.elsewhere));
    }
    return problem;
  }

  /// What was found against what was expected.
  void learn_rates(size_t index, const std::vector<Entry>& old, const ViewEvidence& evidence) {
    const auto& [rates, untracked, weight, solution] = levels_[index];
    for (size_t o = 0; o < old.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o);
      const Whereabouts& where = old[o].where[index];
      const double share = where.moved / std::max(kTiny, where.moved + where.returned);
      const double found = solution.move.row(row).sum(), expected = evidence.visible_part(where.elsewhere);
      learner_.count(Change::moved, found * share, expected * share, weight);
      learner_.count(Change::returned, found * (1 - share), expected * (1 - share), weight);
      learner_.count(Change::changed, solution.newview.row(row).sum(), evidence.in_view[o] * where.changed,
                     weight);
      const double vanished = std::max(kTiny, 1 - where.here - where.changed - expected);
      learner_.count(Change::removed, solution.disappear[o] * std::min(1.0, where.gone / vanished),
                     evidence.in_view[o] * where.gone, weight);
    }
    for (size_t k = 0; k < evidence.from_cell.size(); ++k) {
      const double arrived = evidence.density(k, untracked.arrived),
                   initial = evidence.density(k, untracked.initial);
      const double sum = std::max(kTiny, arrived + initial + evidence.density(k, untracked.lost));
      learner_.find(Change::arrived, solution.appear[k] * arrived / sum, weight);
      learner_.find(Change::initial, solution.appear[k] * initial / sum, weight);
    }
    learner_.expect(Change::arrived, evidence.visible_part(untracked.arrived), weight);
    learner_.expect(Change::initial, evidence.visible_part(untracked.initial), weight);
  }

  void learn_noise(const std::vector<Entry>& old, const std::vector<Measurement>& seen,
                   const memory::IdentitySolution& solution) {
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

  /// Where things were not seen they are not. What is given up may still be anywhere else.
  void learn_absence(std::vector<Entry>& old, const Judgement& judgement, const ViewEvidence& evidence) {
    std::vector<bool> linked(old.size(), false);
    for (const Link& link : judgement.links) linked[link.old] = true;
    for (size_t i = 0; i < levels_.size(); ++i) {
      Untracked& untracked = levels_[i].untracked;
      looked_at(untracked, evidence.cells);
      for (size_t o = 0; o < old.size(); ++o) {
        if (linked[o]) continue;
        Whereabouts& where = old[o].where[i];
        not_seen(where, evidence.in_view[o], evidence.cells);
        if (judgement.kept[o]) continue;
        for (size_t cell = 0; cell < where.elsewhere.size(); ++cell)
          untracked.lost[cell] += where.elsewhere[cell];
      }
    }
  }

  static Judgement judgement_of(const std::vector<Entry>& old, const std::vector<Measurement>& seen,
                                const memory::IdentitySolution& solution) {
    Judgement judgement;
    std::vector<bool> linked(old.size(), false);
    for (const auto& [o, k] : solution.map.pairs) {
      linked[o] = true;
      const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
      const double stay = solution.stay(row, column);
      judgement.links.push_back(
          {o, k, stay + solution.newview(row, column), stay + solution.move(row, column)});
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
  const Cells cells_;
  memory::IdentityOptions options_;
  memory::belief::RateLearner learner_;
  memory::belief::Busyness busyness_;
  ChangeRates told_rates_;
  std::vector<Level> levels_;
  memory::belief::NoiseEstimate position_noise_, color_noise_;
};

}  // namespace

std::unique_ptr<Model> make_our_model(const WorldOptions& world, const NoiseSetting& noise, bool told) {
  return std::make_unique<OurModel>(world, noise, told);
}

}  // namespace loci::apps::identity_experiment
