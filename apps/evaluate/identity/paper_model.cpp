#include "apps/evaluate/identity/model.h"

namespace loci::apps::identity_experiment {
namespace {

/// The dissertation's model: closeness as the probability of the evidence, table 6.1, exact inference.
class PaperModel : public Model {
 public:
  explicit PaperModel(double scale) : scale_(scale) { options_.best = 1; }

  Judgement judge(const View& view, int, std::vector<Entry>& old, const std::vector<Measurement>& seen,
                  bool) override {
    memory::IdentityProblem problem;
    problem.old_count = old.size();
    problem.new_count = seen.size();
    for (const Entry& entry : old) {
      auto& similar = problem.similar.emplace_back();
      auto& proximity = problem.proximity.emplace_back();
      for (const Measurement& measurement : seen) {
        const Closeness close = compare(entry.last, measurement, scale_);
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

}  // namespace

std::unique_ptr<Model> make_paper_model(double scale) {
  return std::make_unique<PaperModel>(scale);
}

}  // namespace loci::apps::identity_experiment
