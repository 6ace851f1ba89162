#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/text/json.h"
#include "memory/store/store.h"
#include "perception/pipeline/condition.h"
#include "perception/pipeline/goal.h"

namespace loci::apps {

/// Reads --goal with the words that people have for colours and classes.
std::vector<perception::GoalTerm> read_goal(const std::string& text);

/// What a run with --goal found.
class GoalAnswers {
 public:
  /// Error when no term of the goal can be tested.
  explicit GoalAnswers(const perception::GoalPlan& plan);

  /// Adds the clusters of a scene that fit. `objects`: the numbers that the memory has for the clusters, 0 =
  /// unknown; empty without a memory.
  void look_at(const perception::types::SceneCas& scene, const std::vector<int>& objects);
  /// A line per cluster that fits, and one per term that nothing fits. `memory` names the objects, may be
  /// null.
  std::string text(const memory::Store* memory) const;
  Json json(const memory::Store* memory) const;

 private:
  struct Find {
    int64_t frame = 0;
    int cluster = 0;
    std::string place;
    Vector3d position;
    memory::Id object = 0;
  };
  struct Answered {
    perception::GoalTerm term;
    perception::Condition condition;
    size_t tested = 0, fitting = 0;  ///< clusters
    std::set<std::string> values;    ///< that were seen
  };
  std::string line(const Find& find, const std::map<memory::Id, std::string>& names) const;
  std::string unmet(const Answered& answered) const;

  std::vector<Answered> answered_;
  std::vector<std::string> untested_;
  std::vector<Find> found_;
};

}  // namespace loci::apps
