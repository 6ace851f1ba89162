#include "apps/evaluate/identity/model.h"

#include <cmath>

#include "mapping/base/error.h"

namespace loci::apps::identity_experiment {

Entry Model::update(const Entry&, const Measurement& seen, int step, const Link&) const {
  return Entry::first(seen, step);
}

const std::vector<std::string>& model_names() {
  static const std::vector<std::string> names = {"paper",  "paper_printed", "ours",     "told",
                                                 "greedy", "nearest",       "hungarian"};
  return names;
}

std::unique_ptr<Model> make_model(const std::string& name, const WorldOptions& world,
                                  const NoiseSetting& noise) {
  if (name == "paper") return make_paper_model(kEffectiveScale);
  if (name == "paper_printed") return make_paper_model(kPrintedScale);
  if (name == "ours") return make_our_model(world, noise, false);
  if (name == "told") return make_our_model(world, noise, true);
  if (name == "greedy") return make_greedy_model();
  if (name == "nearest") return make_nearest_model();
  if (name == "hungarian") return make_hungarian_model();
  throw Error("there is no identity model '" + name + "'");
}

double closeness(double distance, double scale) {
  return std::exp(-(distance / scale) * (distance / scale));
}

Closeness compare(const Measurement& old, const Measurement& seen, double scale) {
  Closeness result;
  result.similar = closeness((old.color - seen.color).norm(), scale);
  if (old.table == seen.table) result.proximity = closeness((old.position - seen.position).norm(), scale);
  return result;
}

}  // namespace loci::apps::identity_experiment
