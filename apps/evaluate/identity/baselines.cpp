#include <algorithm>
#include <limits>

#include "apps/evaluate/identity/model.h"
#include "apps/evaluate/pairing.h"
#include "memory/identity/matchings.h"

namespace loci::apps::identity_experiment {
namespace {

/// Methods that pair up and know no probabilities. What stays alone in view is gone, out of view it is
/// hidden.
class PairingModel : public Model {
 public:
  Judgement judge(const View& view, int, std::vector<Entry>& old, const std::vector<Measurement>& seen,
                  bool) override {
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
    const Closeness close = compare(old.last, seen, kEffectiveScale);
    if (close.proximity < 0.5 && close.similar > close.proximity) return memory::Explanation::move;
    return close.similar < 0.5 ? memory::Explanation::newview : memory::Explanation::stay;
  }
};

/// Half similarity, half proximity, as the annotator that RoboSherlock ships weighs what was seen within the
/// last two minutes.
double combined(const Entry& old, const Measurement& seen) {
  const Closeness close = compare(old.last, seen, kEffectiveScale);
  return 0.5 * close.similar + 0.5 * close.proximity;
}
constexpr double kMinCombined = 0.2;

/// RoboSherlock's ObjectIdentityResolution: who is each other's best is the same, if they are alike enough.
class GreedyModel : public PairingModel {
  Pairs pair_up(const std::vector<Entry>& old, const std::vector<Measurement>& seen) const override {
    return mutual_best(old.size(), seen.size(), kMinCombined,
                       [&](size_t o, size_t k) { return combined(old[o], seen[k]); });
  }
};

/// A tracker of positions: the nearest first.
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

/// The assignment of the largest sum of what the greedy method compares.
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

std::unique_ptr<Model> make_greedy_model() {
  return std::make_unique<GreedyModel>();
}

std::unique_ptr<Model> make_nearest_model() {
  return std::make_unique<NearestModel>();
}

std::unique_ptr<Model> make_hungarian_model() {
  return std::make_unique<HungarianModel>();
}

}  // namespace loci::apps::identity_experiment
