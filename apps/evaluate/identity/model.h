#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/evaluate/identity/simulator.h"
#include "memory/belief/whereabouts.h"
#include "memory/identity/solution.h"

namespace loci::apps::identity_experiment {

/// What a model believes about one object: its last measurement, and what its sightings add up to.
struct Entry {
  Measurement last;
  int step = 0;                                    ///< of the last measurement
  Measurement fused;                               ///< mean over the sightings since the last change
  double position_looks = 1, color_looks = 1;      ///< how many sightings are in that mean
  std::vector<memory::belief::Whereabouts> where;  ///< when it is not seen; per level of busyness

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
  std::vector<Link> links;                     ///< one consistent story, for the belief that goes on
  std::vector<bool> kept;                      ///< per believed object without link: still believed in
};

/// One method. It sees measurements only. The same instance judges all sequences of one noise level, one
/// after the other, and may learn.
class Model {
 public:
  virtual ~Model() = default;

  /// A new world: nothing is believed.
  virtual void begin(const Sequence&) {}
  /// `everything_seen_before`: all tables were looked at as a whole just before the actions of this step. May
  /// note in `old` what not being seen tells about where an object is.
  virtual Judgement judge(const View& view, int step, std::vector<Entry>& old,
                          const std::vector<Measurement>& seen, bool everything_seen_before) = 0;
  /// What is believed of an object that was seen again.
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

/// Closeness of the dissertation, exp(-(x/scale)²): scale 0.25 reproduces its table 6.2, 0.5 is equation 6.1
/// as printed.
double closeness(double distance, double scale);
constexpr double kEffectiveScale = 0.25, kPrintedScale = 0.5;

/// Similarity and proximity of an old and a new measurement.
struct Closeness {
  double similar = 0, proximity = 0;
};
Closeness compare(const Measurement& old, const Measurement& seen, double scale);

std::unique_ptr<Model> make_paper_model(double scale);
std::unique_ptr<Model> make_greedy_model();
std::unique_ptr<Model> make_nearest_model();
std::unique_ptr<Model> make_hungarian_model();
/// `told`: the rates of change are those of the simulator instead of learned ones.
std::unique_ptr<Model> make_our_model(const WorldOptions& world, const NoiseSetting& noise, bool told);

}  // namespace loci::apps::identity_experiment
