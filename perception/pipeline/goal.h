#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "perception/pipeline/registry.h"
#include "perception/pipeline/statistics.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// One term of a goal: "color=red".
struct GoalTerm {
  std::string key;
  std::string value;
  std::string feature;  ///< that is compared with the value: "ColorAnnotation.names"
  /// Types that can answer it, and the condition that a cluster fits ("ColorAnnotation.names == 'red'").
  std::vector<std::string> products;
  std::string condition;

  std::string text() const { return key + "=" + value; }
};

/// The word that annotators have for the value of a key: "grey" for color=gray. Error where they have none.
using GoalWords = std::function<std::string(const std::string& key, const std::string& value)>;

/// Reads "class=cup color=red on=table_1". Keys: barcode, class, color, on, product, text. Error that names
/// the nearest key.
std::vector<GoalTerm> parse_goal(const std::string& text, const GoalWords& words = {});
/// What annotators said of a cluster in answer to a term: its classes, its colours, ….
std::vector<std::string> values_of(const GoalTerm& term, const types::Cluster& cluster);

/// An annotator that was considered for a term, and why it was or was not taken (§2.2, §10.1).
struct GoalChoice {
  std::string term;
  std::string annotator;
  std::vector<std::string> with;  ///< prerequisites that the flow does not have yet
  double gain = 0;                ///< expected share of clusters that it answers for, times its confidence
  double seconds = 0;             ///< expected, per scene, with those that have to run before it
  bool known = false;             ///< from statistics, not assumed
  bool taken = false;
  std::string why;
};

struct GoalPlan {
  Json
      pipeline;  ///< as YAML: cheap annotators first, each applied to the clusters that the earlier ones left
  std::vector<GoalChoice> choices;
  double seconds = 0;                   ///< expected, per scene
  std::vector<GoalTerm> answered;       ///< terms that were taken, in the order in which they are tested
  std::vector<std::string> unanswered;  ///< terms without an annotator
};

/// Chooses annotators for a goal: per term the one with the best expected gain per time, in that order, as
/// long as the budget (seconds per scene) allows. `base` are the steps that find the objects. `configured`
/// are steps with options ("FeatureClassifier" -> {"model": ...}); an annotator whose needs nobody meets is
/// left out, and so is one that cannot start without options that were not given.
GoalPlan plan_goal(const std::vector<GoalTerm>& goal, const Json& base, const Json& configured,
                   const AnnotatorRegistry& registry, const StatisticsTable& statistics,
                   std::optional<double> budget_s);

/// What was chosen and why, one line each.
std::string plan_text(const GoalPlan& plan);
Json to_json(const GoalPlan& plan);

}  // namespace loci::perception
