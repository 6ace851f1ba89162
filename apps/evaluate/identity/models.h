#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/evaluate/identity/simulator.h"
#include "memory/identity/solution.h"

namespace loci::apps::identity_experiment {

/// Belief of a model about one object.
struct Entry {
  Measurement last;
  int step = 0;  ///< of the last measurement
};

struct Link {
  size_t old = 0, seen = 0;
};

/// A model's answer to one scene.
struct Judgement {
  std::vector<memory::IdentityDecision> seen;  ///< per measurement
  std::vector<memory::IdentityDecision> old;   ///< per believed object
  std::vector<Link> links;                     ///< MAP hypothesis, for the belief that goes on
  std::vector<bool> kept;                      ///< per believed object without link: still believed in
};

/// A data association method. It gets measurements only. One instance judges all sequences of a noise level
/// in turn, and may learn.
class Model {
 public:
  virtual ~Model() = default;

  /// Whether the model cannot be given another belief than its own (condition A).
  virtual bool own_belief_only() const { return false; }
  /// Starts a world with an empty belief.
  virtual void begin(const Sequence&) {}
  virtual Judgement judge(const View& view, int step, const std::vector<Entry>& old,
                          const std::vector<Measurement>& seen) = 0;
};

/// Names of the models in the order of the tables.
const std::vector<std::string>& model_names();
std::unique_ptr<Model> make_model(const std::string& name);

/// Scales of the dissertation's similarity exp(-(x/scale)²): 0.25 reproduces its table 6.2, 0.5 is
/// equation 6.1 as printed.
constexpr double kEffectiveScale = 0.25, kPrintedScale = 0.5;

/// Similarity and proximity of an old and a new measurement.
struct PairSimilarity {
  double similar = 0, proximity = 0;
};
PairSimilarity compare(const Measurement& old, const Measurement& seen, double scale);

/// The belief as it ships. Condition A only: it goes on with its own objects.
std::unique_ptr<Model> make_shipped_model();

}  // namespace loci::apps::identity_experiment
