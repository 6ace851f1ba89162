#include <algorithm>
#include <cmath>

#include "apps/evaluate/identity/models.h"
#include "memory/belief/evidence/likelihood.h"

namespace loci::apps::identity_experiment {
namespace {

using memory::belief::Domain;
using memory::belief::log_same;
using memory::belief::mass;
using memory::belief::Measured;

/// The tables cut into cells, side by side: the sensor sees all of a table's depth.
class Cells {
 public:
  static constexpr double kTable = 1.0;  ///< metres, both sides
  static constexpr size_t kStripes = 50;
  static constexpr double kArea = kTable * kTable / kStripes;

  explicit Cells(int tables) : tables_(tables) {}
  size_t count() const { return kStripes * static_cast<size_t>(tables_); }
  static size_t first(int table) { return kStripes * static_cast<size_t>(table); }
  double total_area() const { return tables_ * kTable * kTable; }

 private:
  int tables_;
};

/// Variances of what is measured.
struct Noise {
  double position = 0, color = 0;
};

/// Evidence of a scene, independent of rates: likelihood ratios, and the observed part of the tables.
struct ViewEvidence {
  memory::PairTable log_similar, log_proximity;
  std::vector<double> in_view;  ///< per believed object: probability of its location being in view
  std::vector<double> cells;    ///< share of each cell that is in view
  std::vector<std::vector<double>> from_cell;  ///< per measurement: probability of coming from the cell

  /// Density per square metre, at the origin of a measurement, of a distribution over cells.
  double density(size_t measurement, const std::vector<double>& in_cells) const;
  /// Part of it that is in view.
  double visible_part(const std::vector<double>& in_cells) const;
};

constexpr double kTiny = 1e-12;
constexpr double kCellWidth = Cells::kTable / Cells::kStripes;

double log_color(const Entry& entry, const Measurement& seen, double variance) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    sum += log_same({entry.fused.color[i], variance / entry.color_views}, {0, 1}, {seen.color[i], variance},
                    {0, 1});
  return sum;
}

double log_position(const Entry& entry, const Measurement& seen, double variance, const Domain& visible) {
  const Domain table{0, Cells::kTable};
  double sum = 0;
  for (int i = 0; i < 2; ++i)
    sum += log_same({entry.fused.position[i], variance / entry.position_views}, table,
                    {seen.position[i], variance}, i == 0 ? visible : table);
  return sum;
}

std::vector<double> cells_in_view(const View& view, const Cells& cells, const Domain& visible) {
  std::vector<double> shares(cells.count(), 0.0);
  for (size_t i = 0; i < Cells::kStripes; ++i) {
    const double low = static_cast<double>(i) * kCellWidth;
    const double inside = std::min(visible.high, low + kCellWidth) - std::max(visible.low, low);
    shares[Cells::first(view.table) + i] = std::clamp(inside / kCellWidth, 0.0, 1.0);
  }
  return shares;
}

std::vector<double> origin_of(const Measurement& seen, int table, const std::vector<double>& in_view,
                              double variance) {
  std::vector<double> shares(in_view.size(), 0.0);
  double sum = 0;
  for (size_t i = 0; i < Cells::kStripes; ++i) {
    const size_t cell = Cells::first(table) + i;
    if (in_view[cell] == 0) continue;
    const double distance = (static_cast<double>(i) + 0.5) * kCellWidth - seen.position.x();
    shares[cell] = kTiny + in_view[cell] * std::exp(-0.5 * distance * distance / variance);
    sum += shares[cell];
  }
  for (double& share : shares) share /= sum;
  return shares;
}

double ViewEvidence::density(size_t measurement, const std::vector<double>& in_cells) const {
  double sum = 0;
  for (size_t i = 0; i < in_cells.size(); ++i) sum += from_cell[measurement][i] * in_cells[i];
  return sum / Cells::kArea;
}

double ViewEvidence::visible_part(const std::vector<double>& in_cells) const {
  double sum = 0;
  for (size_t i = 0; i < in_cells.size(); ++i) sum += cells[i] * in_cells[i];
  return sum;
}

ViewEvidence view_evidence(const View& view, const Cells& cells, const Noise& noise,
                           const std::vector<Entry>& old, const std::vector<Measurement>& seen) {
  const Domain visible{std::max(0.0, view.centre - view.half),
                       std::min(Cells::kTable, view.centre + view.half)};
  ViewEvidence evidence;
  evidence.cells = cells_in_view(view, cells, visible);
  for (const Measurement& measurement : seen)
    evidence.from_cell.push_back(origin_of(measurement, view.table, evidence.cells, noise.position));
  const auto m = static_cast<Eigen::Index>(old.size()), n = static_cast<Eigen::Index>(seen.size());
  evidence.log_similar.setZero(m, n);
  evidence.log_proximity.setConstant(m, n, memory::kNever);
  for (Eigen::Index o = 0; o < m; ++o) {
    const Entry& entry = old[static_cast<size_t>(o)];
    const bool same_table = entry.last.table == view.table;
    const Measured x{entry.fused.position.x(), noise.position / entry.position_views};
    const double in_view =
        same_table ? std::clamp(mass(x, visible) / mass(x, {0, Cells::kTable}), kTiny, 1 - kTiny) : kTiny;
    evidence.in_view.push_back(in_view);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Measurement& measurement = seen[static_cast<size_t>(k)];
      evidence.log_similar(o, k) = log_color(entry, measurement, noise.color);
      if (same_table)
        evidence.log_proximity(o, k) =
            log_position(entry, measurement, noise.position, visible) - std::log(in_view);
    }
  }
  return evidence;
}

double log_of(double probability) {
  return std::log(std::max(kTiny, probability));
}

/// One activity level: its expectation and its solution of the scene.
struct Level {
  ChangeRates rates;
  UndetectedIntensity undetected{0};
  double weight = 1;
  memory::IdentitySolution solution;
};

/// Posterior over all levels.
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

/// The generative model: likelihood ratios from the noise, priors from learned rates, fusion of measurements,
/// and a location belief for unobserved objects.
class GenerativeModel : public Model {
 public:
  GenerativeModel(const WorldOptions& world, const NoiseSetting& noise, bool rates_known)
      : world_(world),
        rates_known_(rates_known),
        cells_(world.tables),
        position_noise_(noise.known ? NoiseEstimate::known(noise.sigma) : NoiseEstimate(0.1)),
        color_noise_(position_noise_) {
    options_.best = 1;
  }

  void begin(const Sequence& sequence) override {
    activity_.begin_world();
    if (rates_known_) read_rates(sequence);
    levels_.assign(rates_known_ ? 1 : activity_.levels(), Level{});
    set_rates();
    for (Level& level : levels_) {
      level.undetected = UndetectedIntensity(cells_.count());
      level.undetected.initial.assign(cells_.count(), level.rates[Change::initial] * Cells::kArea);
    }
  }

  Judgement judge(const View& view, int, std::vector<Entry>& old, const std::vector<Measurement>& seen,
                  bool everything_seen_before) override {
    set_rates();
    for (Entry& entry : old) entry.where.resize(levels_.size());
    const ViewEvidence evidence =
        view_evidence(view, cells_, {position_noise_.variance(), color_noise_.variance()}, old, seen);
    std::vector<double> log_evidence;
    for (size_t i = 0; i < levels_.size(); ++i) {
      if (everything_seen_before) levels_[i].undetected = UndetectedIntensity(cells_.count());
      predict_all(i, old);
      levels_[i].solution = solve(problem_of(i, old, evidence), options_);
      // The number of undetected objects in view is Poisson.
      log_evidence.push_back(levels_[i].solution.log_z - visible_undetected(levels_[i], evidence));
    }
    if (!rates_known_) {
      activity_.observe(log_evidence);
      for (size_t i = 0; i < levels_.size(); ++i) levels_[i].weight = activity_.weight(i);
    }
    for (size_t i = 0; i < levels_.size(); ++i) learn_rates(i, old, evidence);
    learner_.finish_scene();
    const memory::IdentitySolution solution = mixture(levels_);
    learn_noise(old, seen, solution);
    const Judgement judgement = judgement_of(old, seen, solution);
    learn_absence(old, judgement, evidence);
    return judgement;
  }

  /// The mean over the views since the last change.
  Entry update(const Entry& before, const Measurement& seen, int step, const Link& link) const override {
    Entry entry = Entry::first(seen, step);
    entry.position_views += link.same_position * before.position_views;
    entry.color_views += link.same_color * before.color_views;
    entry.fused.position += (before.fused.position - seen.position) * (1 - 1 / entry.position_views);
    entry.fused.color += (before.fused.color - seen.color) * (1 - 1 / entry.color_views);
    return entry;
  }

 private:
  /// The rates of the simulator, for comparison with learned ones.
  void read_rates(const Sequence& sequence) {
    std::array<double, kActions> per_step{};
    double present = 0;
    for (const SimulatedScene& scene : sequence.scenes) {
      for (size_t i = 0; i < kActions; ++i)
        per_step[i] += scene.actions[i] / static_cast<double>(sequence.scenes.size());
      present += scene.present / static_cast<double>(sequence.scenes.size());
    }
    const auto of = [&](Action action) { return std::max(1e-6, per_step[static_cast<size_t>(action)]); };
    known_rates_[Change::removed] = of(Action::disappear);
    known_rates_[Change::moved] = of(Action::move);
    known_rates_[Change::changed] = of(Action::newview);
    known_rates_[Change::returned] = of(Action::appear) * present / std::max(1.0, world_.objects - present);
    known_rates_[Change::arrived] = of(Action::appear) / cells_.total_area();
    known_rates_[Change::initial] =
        std::max(1e-6, start_objects(world_, sequence.limit) / cells_.total_area());
  }

  void set_rates() {
    for (size_t i = 0; i < levels_.size(); ++i) {
      levels_[i].rates = rates_known_ ? known_rates_ : learner_.rates().times(activity_.factor(i));
      levels_[i].weight = rates_known_ ? 1.0 : activity_.weight(i);
    }
  }

  /// A person handles one object at a time: exposure is shared among all that are present.
  void predict_all(size_t index, std::vector<Entry>& old) {
    Level& level = levels_[index];
    double present = level.undetected.sum();
    for (const Entry& entry : old) present += entry.where[index].present();
    const Interactions handled = interactions(level.rates, 1 / std::max(1.0, present));
    predict(level.undetected, handled, level.rates[Change::arrived] * Cells::kArea);
    for (Entry& entry : old) predict(entry.where[index], handled, cells_.count(), level.undetected);
  }

  static double visible_undetected(const Level& level, const ViewEvidence& evidence) {
    return evidence.visible_part(level.undetected.arrived) + evidence.visible_part(level.undetected.initial) +
           evidence.visible_part(level.undetected.lost);
  }

  memory::LogOddsProblem problem_of(size_t index, const std::vector<Entry>& old,
                                    const ViewEvidence& evidence) const {
    const UndetectedIntensity& undetected = levels_[index].undetected;
    memory::LogOddsProblem problem;
    problem.log_similar = evidence.log_similar;
    problem.log_proximity = evidence.log_proximity;
    for (memory::PairTable* table : {&problem.stay_prior, &problem.move_prior, &problem.newview_prior})
      table->setZero(evidence.log_similar.rows(), evidence.log_similar.cols());
    for (size_t k = 0; k < evidence.from_cell.size(); ++k)
      problem.appear_prior.push_back(log_of(evidence.density(k, undetected.arrived) +
                                            evidence.density(k, undetected.initial) +
                                            evidence.density(k, undetected.lost)));
    for (size_t o = 0; o < old.size(); ++o) {
      const LocationBelief& where = old[o].where[index];
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

  /// Events found against events expected.
  void learn_rates(size_t index, const std::vector<Entry>& old, const ViewEvidence& evidence) {
    const auto& [rates, undetected, weight, solution] = levels_[index];
    for (size_t o = 0; o < old.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o);
      const LocationBelief& where = old[o].where[index];
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
      const double arrived = evidence.density(k, undetected.arrived),
                   initial = evidence.density(k, undetected.initial);
      const double sum = std::max(kTiny, arrived + initial + evidence.density(k, undetected.lost));
      learner_.find(Change::arrived, solution.appear[k] * arrived / sum, weight);
      learner_.find(Change::initial, solution.appear[k] * initial / sum, weight);
    }
    learner_.expect(Change::arrived, evidence.visible_part(undetected.arrived), weight);
    learner_.expect(Change::initial, evidence.visible_part(undetected.initial), weight);
  }

  void learn_noise(const std::vector<Entry>& old, const std::vector<Measurement>& seen,
                   const memory::IdentitySolution& solution) {
    for (size_t o = 0; o < old.size(); ++o)
      for (size_t k = 0; k < seen.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
        const double stay = solution.stay(row, column);
        for (int i = 0; i < 2; ++i)
          position_noise_.count(seen[k].position[i] - old[o].fused.position[i], old[o].position_views,
                                stay + solution.newview(row, column));
        for (int i = 0; i < 3; ++i)
          color_noise_.count(seen[k].color[i] - old[o].fused.color[i], old[o].color_views,
                             stay + solution.move(row, column));
      }
  }

  /// Unobserved objects are not in view. Dropped tracks become undetected objects.
  void learn_absence(std::vector<Entry>& old, const Judgement& judgement, const ViewEvidence& evidence) {
    std::vector<bool> linked(old.size(), false);
    for (const Link& link : judgement.links) linked[link.old] = true;
    for (size_t i = 0; i < levels_.size(); ++i) {
      UndetectedIntensity& undetected = levels_[i].undetected;
      observe(undetected, evidence.cells);
      for (size_t o = 0; o < old.size(); ++o) {
        if (linked[o]) continue;
        LocationBelief& where = old[o].where[i];
        observe_absence(where, evidence.in_view[o], evidence.cells);
        if (judgement.kept[o]) continue;
        for (size_t cell = 0; cell < where.elsewhere.size(); ++cell)
          undetected.lost[cell] += where.elsewhere[cell];
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
  const bool rates_known_;
  const Cells cells_;
  memory::IdentityOptions options_;
  RateLearner learner_;
  ActivityLevel activity_;
  ChangeRates known_rates_;
  std::vector<Level> levels_;
  NoiseEstimate position_noise_, color_noise_;
};

}  // namespace

std::unique_ptr<Model> make_generative_model(const WorldOptions& world, const NoiseSetting& noise,
                                             bool rates_known) {
  return std::make_unique<GenerativeModel>(world, noise, rates_known);
}

}  // namespace loci::apps::identity_experiment
