#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "perception/pipeline/registry.h"
#include "perception/pipeline/statistics.h"

namespace loci::perception {

/// One term of a goal: "color=red".
struct GoalTerm {
  std::string key;
  std::string value;
  /// Types that can answer it, and the condition that a cluster fits ("ColorAnnotation.names == 'red'").
  std::vector<std::string> products;
  std::string condition;
};

/// Reads "class=mug color=red on=table_1". Keys: barcode, class, color, on, product, text. Error that names
/// the nearest key.
std::vector<GoalTerm> parse_goal(const std::string& text);

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
  std::string condition;                ///< holds for clusters that fit all terms that were taken
  std::vector<std::string> unanswered;  ///< terms without an annotator
};

/// Chooses annotators for a goal: per term the one with the best expected gain per time, in that order, as
/// long as the budget (seconds per scene) allows. `base` are the steps that find the objects. `configured`
/// are steps with options ("FeatureClassifier" -> {"model": ...}); an annotator whose needs nobody meets is
/// left out.
GoalPlan plan_goal(const std::vector<GoalTerm>& goal, const Json& base, const Json& configured,
                   const AnnotatorRegistry& registry, const StatisticsTable& statistics,
                   std::optional<double> budget_s);

/// What was chosen and why, one line each.
std::string plan_text(const GoalPlan& plan);
Json to_json(const GoalPlan& plan);

}  // namespace loci::perception
