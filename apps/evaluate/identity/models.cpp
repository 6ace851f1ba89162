#include "apps/evaluate/identity/models.h"

#include <algorithm>
#include <limits>

#include "apps/evaluate/pairing.h"
#include "mapping/base/error.h"
#include "memory/belief/evidence/similarity.h"
#include "memory/identity/matchings.h"

namespace loci::apps::identity_experiment {
namespace {

/// The dissertation's model: similarity as the probability of the evidence, table 6.1, exact inference.
class PaperModel : public Model {
 public:
  explicit PaperModel(double scale) : scale_(scale) { options_.best = 1; }

  Judgement judge(const View& view, int, const std::vector<Entry>& old,
                  const std::vector<Measurement>& seen) override {
    memory::IdentityProblem problem;
    problem.old_count = old.size();
    problem.new_count = seen.size();
    for (const Entry& entry : old) {
      auto& similar = problem.similar.emplace_back();
      auto& proximity = problem.proximity.emplace_back();
      for (const Measurement& measurement : seen) {
        const PairSimilarity close = compare(entry.last, measurement, scale_);
        similar.emplace_back(close.similar);
        proximity.emplace_back(close.proximity);
      }
      problem.out_of_view.push_back(view.contains(entry.last.table, entry.last.position.x()) ? 0 : 1);
    }
    const memory::IdentitySolution solution = solve(problem, options_);
    Judgement judgement;
    for (size_t k = 0; k < seen.size(); ++k) judgement.seen.push_back(decide_observation(solution, k));
    for (size_t o = 0; o < old.size(); ++o) {
      judgement.old.push_back(decide_object(solution, o));
      judgement.kept.push_back(judgement.old.back().explanation == memory::Explanation::hidden);
    }
    return judgement;
  }

 private:
  double scale_;
  memory::IdentityOptions options_;
};

/// Methods without probabilities. An unmatched object in view is gone, out of view it is hidden.
class PairingModel : public Model {
 public:
  Judgement judge(const View& view, int, const std::vector<Entry>& old,
                  const std::vector<Measurement>& seen) override {
    Judgement judgement;
    judgement.seen.assign(seen.size(), {std::nullopt, 1, memory::Explanation::appear, 1});
    for (const Entry& entry : old) {
      const bool in_view = view.contains(entry.last.table, entry.last.position.x());
      judgement.old.push_back(
          {std::nullopt, 1, in_view ? memory::Explanation::disappear : memory::Explanation::hidden, 1});
      judgement.kept.push_back(!in_view);
    }
    for (const auto& [o, k] : pair_up(old, seen)) {
      const memory::Explanation explanation = explain(old[o], seen[k]);
      judgement.links.push_back({o, k});
      judgement.old[o] = {k, 1, explanation, 1};
      judgement.seen[k] = {o, 1, explanation, 1};
    }
    return judgement;
  }

 private:
  virtual Pairs pair_up(const std::vector<Entry>& old, const std::vector<Measurement>& seen) const = 0;

  virtual memory::Explanation explain(const Entry& old, const Measurement& seen) const {
    const PairSimilarity close = compare(old.last, seen, kEffectiveScale);
    if (close.proximity < 0.5 && close.similar > close.proximity) return memory::Explanation::move;
    return close.similar < 0.5 ? memory::Explanation::newview : memory::Explanation::stay;
  }
};

/// Half similarity, half proximity, as the annotator that RoboSherlock ships weighs what was seen within the
/// last two minutes.
double combined(const Entry& old, const Measurement& seen) {
  const PairSimilarity close = compare(old.last, seen, kEffectiveScale);
  return 0.5 * close.similar + 0.5 * close.proximity;
}
constexpr double kMinCombined = 0.2;

/// RoboSherlock's ObjectIdentityResolution: mutual best matches above a threshold.
class GreedyModel : public PairingModel {
  Pairs pair_up(const std::vector<Entry>& old, const std::vector<Measurement>& seen) const override {
    return mutual_best(old.size(), seen.size(), kMinCombined,
                       [&](size_t o, size_t k) { return combined(old[o], seen[k]); });
  }
};

/// Position tracker: nearest pairs first.
class NearestModel : public PairingModel {
  Pairs pair_up(const std::vector<Entry>& old, const std::vector<Measurement>& seen) const override {
    return nearest_first(old.size(), seen.size(), kEffectiveScale, [&](size_t o, size_t k) {
      return old[o].last.table == seen[k].table ? (old[o].last.position - seen[k].position).norm()
                                                : std::numeric_limits<double>::infinity();
    });
  }
  memory::Explanation explain(const Entry&, const Measurement&) const override {
    return memory::Explanation::stay;
  }
};

/// Optimal assignment of the scores of the greedy method.
class HungarianModel : public PairingModel {
  Pairs pair_up(const std::vector<Entry>& old, const std::vector<Measurement>& seen) const override {
    if (old.empty() || seen.empty()) return {};
    memory::IdentityComponent component;
    component.transposed = seen.size() < old.size();
    const size_t rows = std::min(old.size(), seen.size()), columns = std::max(old.size(), seen.size());
    component.log_ratio.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    for (size_t i = 0; i < rows; ++i) component.rows.push_back(i);
    for (size_t j = 0; j < columns; ++j) component.columns.push_back(j);
    for (size_t i = 0; i < rows; ++i)
      for (size_t j = 0; j < columns; ++j) {
        const size_t o = component.transposed ? j : i, k = component.transposed ? i : j;
        const double gain = combined(old[o], seen[k]) - kMinCombined;
        component.log_ratio(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            gain > 0 ? gain : memory::kNever;
      }
    component.row_free.assign(rows, true);
    component.column_free.assign(columns, true);
    return ranked_matchings(component, 1).front().pairs;
  }
};

}  // namespace

const std::vector<std::string>& model_names() {
  static const std::vector<std::string> names = {"paper",   "paper_printed", "greedy",
                                                 "nearest", "hungarian",     "shipped"};
  return names;
}

std::unique_ptr<Model> make_model(const std::string& name) {
  if (name == "shipped") return make_shipped_model();
  if (name == "paper") return std::make_unique<PaperModel>(kEffectiveScale);
  if (name == "paper_printed") return std::make_unique<PaperModel>(kPrintedScale);
  if (name == "greedy") return std::make_unique<GreedyModel>();
  if (name == "nearest") return std::make_unique<NearestModel>();
  if (name == "hungarian") return std::make_unique<HungarianModel>();
  throw Error("there is no identity model '" + name + "'");
}

PairSimilarity compare(const Measurement& old, const Measurement& seen, double scale) {
  PairSimilarity result;
  result.similar = memory::belief::gaussian_similarity((old.color - seen.color).norm(), scale);
  if (old.table == seen.table)
    result.proximity = memory::belief::gaussian_similarity((old.position - seen.position).norm(), scale);
  return result;
}

}  // namespace loci::apps::identity_experiment
