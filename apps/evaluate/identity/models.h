#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/evaluate/identity/change_model.h"
#include "apps/evaluate/identity/simulator.h"
#include "memory/identity/solution.h"

namespace loci::apps::identity_experiment {

/// Belief of a model about one object.
struct Entry {
  Measurement last;
  int step = 0;                                ///< of the last measurement
  Measurement fused;                           ///< mean over the views since the last change
  double position_views = 1, color_views = 1;  ///< number of views in that mean
  std::vector<LocationBelief> where;           ///< while it is unobserved; per activity level

  static Entry first(const Measurement& seen, int step) { return {seen, step, seen, 1, 1, {}}; }
};

struct Link {
  size_t old = 0, seen = 0;
  double same_position = 1, same_color = 1;  ///< probabilities that this has not changed
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
  /// `everything_seen_before`: all tables were observed completely just before the actions of this step. May
  /// update the location belief in `old`.
  virtual Judgement judge(const View& view, int step, std::vector<Entry>& old,
                          const std::vector<Measurement>& seen, bool everything_seen_before) = 0;
  /// Belief about an object that was observed again.
  virtual Entry update(const Entry& before, const Measurement& seen, int step, const Link& link) const;
};

struct NoiseSetting {
  double sigma = 0.05;  ///< of this level
  bool known = true;    ///< the models may use it
};

/// Names of the models in the order of the tables.
const std::vector<std::string>& model_names();
std::unique_ptr<Model> make_model(const std::string& name, const WorldOptions& world,
                                  const NoiseSetting& noise);

/// Scales of the dissertation's similarity exp(-(x/scale)²): 0.25 reproduces its table 6.2, 0.5 is
/// equation 6.1 as printed.
constexpr double kEffectiveScale = 0.25, kPrintedScale = 0.5;

/// Similarity and proximity of an old and a new measurement.
struct PairSimilarity {
  double similar = 0, proximity = 0;
};
PairSimilarity compare(const Measurement& old, const Measurement& seen, double scale);

/// `rates_known`: uses the rates of the simulator instead of learned ones.
std::unique_ptr<Model> make_generative_model(const WorldOptions& world, const NoiseSetting& noise,
                                             bool rates_known);

/// The belief as it ships. Condition A only: it goes on with its own objects.
std::unique_ptr<Model> make_shipped_model();

}  // namespace loci::apps::identity_experiment
