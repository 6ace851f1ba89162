#include "apps/evaluate/identity/simulator.h"

#include <algorithm>

namespace loci::apps::identity_experiment {
namespace {

struct SimulatedObject {
  bool present = false;
  bool handled = false;  ///< in this step
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  Origin origin;
};

class World {
 public:
  World(const WorldOptions& options, int limit, double sigma, Random random)
      : options_(options), limit_(limit), sigma_(sigma), random_(random) {
    objects_.resize(static_cast<size_t>(options.objects));
    for (size_t i = 0; i < objects_.size(); ++i) {
      objects_[i].origin.object = static_cast<int>(i);
      objects_[i].color = any_color();
    }
    const int start = std::min(options.objects, start_objects(options, limit));
    for (int i = 0; i < start; ++i) act(Action::appear);
  }

  SimulatedScene step(int actions) {
    SimulatedScene scene;
    for (const SimulatedObject& object : objects_)
      if (object.present) scene.before.push_back(measure(object));
    for (SimulatedObject& object : objects_) object.handled = false;
    for (int i = 0; i < actions; ++i) {
      const std::optional<Action> action = draw_action();
      if (!action) break;
      act(*action);
      ++scene.actions[static_cast<size_t>(*action)];
    }
    scene.view.table = static_cast<int>(random_.index(static_cast<uint64_t>(options_.tables)));
    scene.view.centre = random_.uniform();
    scene.view.half = options_.view_m / 2;
    for (const SimulatedObject& object : objects_) {
      if (!object.present) continue;
      ++scene.present;
      if (scene.view.contains(object.origin.table, object.origin.position.x()))
        scene.seen.push_back(measure(object));
    }
    for (size_t i = scene.seen.size(); i > 1; --i) std::swap(scene.seen[i - 1], scene.seen[random_.index(i)]);
    return scene;
  }

 private:
  Eigen::Vector3d any_color() {
    Eigen::Vector3d color;
    for (int i = 0; i < 3; ++i) color[i] = random_.uniform();
    return color;
  }

  std::vector<size_t> candidates(Action action) const {
    std::vector<size_t> found;
    int present = 0;
    for (size_t i = 0; i < objects_.size(); ++i) {
      present += objects_[i].present ? 1 : 0;
      if (!objects_[i].handled && objects_[i].present != (action == Action::appear)) found.push_back(i);
    }
    if (action == Action::appear && present >= limit_) found.clear();
    return found;
  }

  /// Among the types that are possible, by their weights.
  std::optional<Action> draw_action() {
    std::array<double, kActions> weight{options_.appear, options_.disappear, options_.move, options_.newview};
    double sum = 0;
    for (size_t i = 0; i < kActions; ++i) {
      if (candidates(static_cast<Action>(i)).empty()) weight[i] = 0;
      sum += weight[i];
    }
    if (!(sum > 0)) return std::nullopt;
    double drawn = random_.uniform(0, sum);
    size_t last = 0;
    for (size_t i = 0; i < kActions; ++i) {
      if (weight[i] == 0) continue;
      last = i;
      if (drawn < weight[i]) break;
      drawn -= weight[i];
    }
    return static_cast<Action>(last);
  }

  void act(Action action) {
    const std::vector<size_t> possible = candidates(action);
    SimulatedObject& object = objects_[possible[random_.index(possible.size())]];
    object.handled = true;
    if (action == Action::disappear) object.present = false;
    if (action == Action::newview) {
      object.color = any_color();
      ++object.origin.appearances;
    }
    if (action != Action::appear && action != Action::move) return;
    object.present = true;
    object.origin.table = static_cast<int>(random_.index(static_cast<uint64_t>(options_.tables)));
    object.origin.position.x() = random_.uniform();
    object.origin.position.y() = random_.uniform();
    ++object.origin.placements;
  }

  SimulatedObservation measure(const SimulatedObject& object) {
    SimulatedObservation observation;
    observation.origin = object.origin;
    observation.seen.table = object.origin.table;
    for (int i = 0; i < 2; ++i)
      observation.seen.position[i] = object.origin.position[i] + random_.normal(sigma_);
    for (int i = 0; i < 3; ++i) observation.seen.color[i] = object.color[i] + random_.normal(sigma_);
    return observation;
  }

  const WorldOptions& options_;
  int limit_;
  double sigma_;
  Random random_;
  std::vector<SimulatedObject> objects_;
};

}  // namespace

void WorldOptions::declare(OptionTable& table) {
  table.number("appear", appear, "", "How often an action puts an absent object on a table.", 0, 1000);
  table.number("disappear", disappear, "", "How often it takes one away.", 0, 1000);
  table.number("move", move, "", "How often it puts one somewhere else.", 0, 1000);
  table.number("newview", newview, "", "How often it gives one another colour.", 0, 1000);
  table.integer("tables", tables, "", "Tables of 1 m by 1 m.", 1, 100);
  table.integer("objects", objects, "", "Objects that exist.", 1, 200);
  table.number("view_m", view_m, "m", "Width of the strip that the sensor sees.", 0.05, 2);
  table.integer("start_objects", start_objects, "",
                "Objects there before the first step; negative = a third of the limit.", -1, 100);
  table.integer("steps", steps, "", "Scenes of one sequence.", 1, 10000);
  table.integer("min_objects", min_objects, "", "Smallest object limit.", 1, 100);
  table.integer("max_objects", max_objects, "", "Largest object limit.", 1, 100);
  table.integer("min_actions", min_actions, "", "Fewest actions between two scenes.", 0, 100);
  table.integer("max_actions", max_actions, "", "Most actions between two scenes.", 0, 100);
}

int start_objects(const WorldOptions& options, int limit) {
  return std::min(limit, options.start_objects < 0 ? limit / 3 : options.start_objects);
}

Sequence simulate(const WorldOptions& options, int limit, int actions, double sigma, Random random) {
  World world(options, limit, sigma, random);
  Sequence sequence{limit, actions, {}};
  for (int i = 0; i < options.steps; ++i) sequence.scenes.push_back(world.step(actions));
  return sequence;
}

std::vector<Sequence> simulate_level(const WorldOptions& options, double sigma, const Random& random) {
  if (options.min_objects > options.max_objects || options.min_actions > options.max_actions)
    throw Error("the fewest objects or actions are more than the most");
  std::vector<Sequence> sequences;
  for (int limit = options.min_objects; limit <= options.max_objects; ++limit)
    for (int actions = options.min_actions; actions <= options.max_actions; ++actions)
      sequences.push_back(simulate(options, limit, actions, sigma, random.fork(sequences.size())));
  return sequences;
}

}  // namespace loci::apps::identity_experiment
