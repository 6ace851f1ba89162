#include "perception/pipeline/goal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "mapping/base/text/json.h"
#include "perception/cas/json.h"
#include "perception/pipeline/flow.h"

namespace loci::perception {
namespace {

// What is assumed of an annotator that never ran: it answers for half of the clusters, is right half of the
// time, and takes as long as a slow one.
constexpr double kAssumedAnswers = 0.5;
constexpr double kAssumedConfidence = 0.5;
constexpr double kAssumedSeconds = 0.2;

struct KeyMeaning {
  std::string product;
  std::string feature;
  std::string comparison;
};

const std::map<std::string, KeyMeaning>& meanings() {
  static const std::map<std::string, KeyMeaning> all = {
      {"barcode", {"BarcodeAnnotation", "code", "=="}},
      {"class", {"ClassificationAnnotation", "label", "=="}},
      {"color", {"ColorAnnotation", "names", "=="}},
      {"on", {"TFLocationAnnotation", "frame_id", "=="}},
      {"product", {"ProductAnnotation", "name", "~"}},
      {"text", {"TextAnnotation", "text", "~"}},
  };
  return all;
}

std::string step_name(const Json& step) {
  return step.is_string() ? step.get<std::string>() : step.begin().key();
}

double expected_seconds(const std::string& name, const StatisticsTable& statistics) {
  const auto known = statistics.find(name);
  return known == statistics.end() || known->second.scenes == 0 ? kAssumedSeconds
                                                                : known->second.seconds_per_scene();
}

/// The annotators that have to run first, in order, to provide the inputs of one; nothing when that is
/// impossible.
std::optional<std::vector<std::string>> prerequisites(const std::string& name, std::set<std::string> made,
                                                      const AnnotatorRegistry& registry, int depth = 0) {
  std::vector<std::string> before;
  for (const std::string& need : registry.make(name)->descriptor().inputs) {
    const auto met = [&] {
      return std::any_of(made.begin(), made.end(),
                         [&](const std::string& product) { return meets(product, need); });
    };
    if (met()) continue;
    bool found = false;
    for (const std::string& maker : depth > 8 ? std::vector<std::string>() : registry.producers_of(need)) {
      const std::vector<std::string> annotators = registry.annotators();
      if (std::find(annotators.begin(), annotators.end(), maker) == annotators.end()) continue;
      const auto more = prerequisites(maker, made, registry, depth + 1);
      if (!more) continue;
      before.insert(before.end(), more->begin(), more->end());
      before.push_back(maker);
      for (const std::string& each : before)
        for (const std::string& product : registry.make(each)->descriptor().outputs) made.insert(product);
      found = true;
      break;
    }
    if (!found) return std::nullopt;
  }
  return before;
}

GoalChoice consider(const GoalTerm& term, const std::string& name, const std::vector<std::string>& with,
                    const StatisticsTable& statistics) {
  GoalChoice choice;
  choice.term = term.text();
  choice.annotator = name;
  choice.with = with;
  AnnotatorStatistics record;
  if (const auto known = statistics.find(name); known != statistics.end()) record = known->second;
  choice.known = record.scenes > 0;
  for (const std::string& product : term.products)
    choice.gain =
        std::max(choice.gain, record.answer_rate(product, kAssumedAnswers) *
                                  record.confidence(product, choice.known ? 1 : kAssumedConfidence));
  choice.seconds = expected_seconds(name, statistics);
  for (const std::string& each : with) choice.seconds += expected_seconds(each, statistics);
  return choice;
}

/// By gain per time; what takes no measurable time pays most.
bool pays_more(const GoalChoice& one, const GoalChoice& two) {
  return one.gain * two.seconds > two.gain * one.seconds;
}

/// Takes out of a choice what runs already, and its time.
void leave_out(const std::set<std::string>& running, const StatisticsTable& statistics, GoalChoice& choice) {
  std::erase_if(choice.with, [&](const std::string& each) {
    if (!running.contains(each)) return false;
    choice.seconds -= expected_seconds(each, statistics);
    return true;
  });
  if (running.contains(choice.annotator)) choice.seconds = 0;
}

}  // namespace

std::vector<GoalTerm> parse_goal(const std::string& text, const GoalWords& known_words) {
  std::vector<std::string> keys;
  for (const auto& [key, meaning] : meanings()) keys.push_back(key);
  std::vector<GoalTerm> goal;
  std::stringstream words(text);
  for (std::string word; words >> word;) {
    const size_t equals = word.find('=');
    const std::string key = word.substr(0, equals);
    const auto meaning = meanings().find(key);
    if (equals == std::string::npos || equals + 1 == word.size() || meaning == meanings().end()) {
      const std::string hint =
          meaning != meanings().end() ? fmt::format("give a value: {}=VALUE", key) : did_you_mean(key, keys);
      throw Error(fmt::format("'{}' is not a term of a goal", word), {"", 0, "--goal"},
                  hint.empty() ? fmt::format("KEY=VALUE with {}", fmt::join(keys, ", ")) : hint);
    }
    std::string value = word.substr(equals + 1);
    if (known_words) value = known_words(key, value);
    if (value.find('\'') != std::string::npos) throw Error("a value cannot hold a quote", {"", 0, "--goal"});
    const auto& [product, name, comparison] = meaning->second;
    const std::string feature = product + "." + name;
    goal.push_back({key, value, feature, {product}, fmt::format("{} {} '{}'", feature, comparison, value)});
  }
  if (goal.empty()) throw Error("the goal is empty", {"", 0, "--goal"}, "e.g. \"color=red on=table_1\"");
  return goal;
}

std::vector<std::string> values_of(const GoalTerm& term, const types::Cluster& cluster) {
  const size_t dot = term.feature.find('.');
  const cas::Type wanted = named_type(cluster.cas().type_system(), term.feature.substr(0, dot));
  std::vector<std::string> values;
  for (const types::Annotation& annotation : cluster.annotations) {
    const cas::FeatureStructure& structure = annotation;
    if (!cas::is_a(structure.type(), wanted)) continue;
    const auto feature = structure.type().find_feature(term.feature.substr(dot + 1));
    if (!feature || !structure.is_set(*feature)) continue;
    if (feature->range().kind() == cas::Kind::kString) {
      values.push_back(structure.text(*feature));
    } else if (const auto texts = structure.get<cas::FeatureStructure>(*feature)) {
      for (const Json& text : cas::elements_to_json(texts))
        if (text.is_string()) values.push_back(text.get<std::string>());
    }
  }
  return values;
}

GoalPlan plan_goal(const std::vector<GoalTerm>& goal, const Json& base, const Json& configured,
                   const AnnotatorRegistry& registry, const StatisticsTable& statistics,
                   std::optional<double> budget_s) {
  GoalPlan plan;
  std::set<std::string> made = {"Scene", "view:depth", "view:color", "CameraInfo", "JointState"};
  for (const Json& step : base) {
    const std::string name = step_name(step);
    for (const std::string& product : registry.make(name)->descriptor().outputs) made.insert(product);
    plan.seconds += expected_seconds(name, statistics);
  }
  std::vector<std::pair<GoalChoice, const GoalTerm*>> best;
  for (const GoalTerm& term : goal) {
    std::vector<GoalChoice> options;
    for (const std::string& name : registry.annotators()) {
      const AnnotatorDescriptor descriptor = registry.make(name)->descriptor();
      // An extractor describes the clusters that it adds, not the given ones.
      if (std::ranges::find(descriptor.outputs, "Cluster") != descriptor.outputs.end()) continue;
      const bool answers = std::any_of(term.products.begin(), term.products.end(), [&](const auto& product) {
        return std::find(descriptor.outputs.begin(), descriptor.outputs.end(), product) !=
               descriptor.outputs.end();
      });
      if (!answers) continue;
      if (const auto before = prerequisites(name, made, registry))
        options.push_back(consider(term, name, *before, statistics));
    }
    // One that was given with its options comes first, those that lack what they need to start come last.
    const auto is_given = [&](const GoalChoice& choice) { return configured.contains(choice.annotator); };
    const auto can_start = [&](const GoalChoice& choice) {
      return is_given(choice) || !registry.make(choice.annotator)->descriptor().needs_options;
    };
    const auto rank = [&](const GoalChoice& choice) {
      return is_given(choice) ? 0 : can_start(choice) ? 1 : 2;
    };
    std::stable_sort(options.begin(), options.end(), [&](const GoalChoice& one, const GoalChoice& two) {
      const int a = rank(one), b = rank(two);
      return a != b ? a < b : pays_more(one, two);
    });
    const bool answered = !options.empty() && can_start(options[0]);
    if (answered) best.emplace_back(options[0], &term);
    for (size_t i = answered ? 1 : 0; i < options.size(); ++i) {
      options[i].why = can_start(options[i])
                           ? "less gain per time than " + options[0].annotator
                           : fmt::format("it cannot start without options, --annotator \"{}: {{…}}\"",
                                         options[i].annotator);
      plan.choices.push_back(options[i]);
    }
    if (!answered) plan.unanswered.push_back(term.text());
  }
  std::stable_sort(best.begin(), best.end(),
                   [](const auto& one, const auto& two) { return pays_more(one.first, two.first); });
  // From the inside out: later annotators see only the clusters that fit so far.
  std::vector<std::pair<Json, std::string>> taken;
  std::set<std::string> running;
  for (auto& [choice, term] : best) {
    leave_out(running, statistics, choice);
    choice.taken = !budget_s || plan.seconds + choice.seconds <= *budget_s;
    choice.why = choice.taken
                     ? choice.seconds > 0
                           ? fmt::format("gain per time is {:.3g} per second", choice.gain / choice.seconds)
                           : "it takes no further time"
                     : "the budget is used up";
    plan.choices.push_back(choice);
    if (!choice.taken) {
      plan.unanswered.push_back(choice.term);
      continue;
    }
    plan.seconds += choice.seconds;
    Json steps = Json::array();
    for (const std::string& each : choice.with) steps.push_back(each);
    const Json options =
        configured.contains(choice.annotator) ? configured[choice.annotator] : Json::object();
    if (!running.contains(choice.annotator)) steps.push_back({{choice.annotator, options}});
    running.insert(choice.with.begin(), choice.with.end());
    running.insert(choice.annotator);
    taken.emplace_back(steps, term->condition);
    plan.answered.push_back(*term);
  }
  Json flow = base;
  Json inner = Json::array();
  for (auto each = taken.rbegin(); each != taken.rend(); ++each) {
    Json level = each->first;
    if (!inner.empty()) level.push_back({{"if", each->second}, {"then", inner}});
    inner = level;
  }
  for (const Json& step : inner) flow.push_back(step);
  plan.pipeline = {{"flow", flow}};
  return plan;
}

Json to_json(const GoalPlan& plan) {
  Json choices = Json::array();
  for (const GoalChoice& choice : plan.choices)
    choices.push_back({{"for", choice.term},
                       {"annotator", choice.annotator},
                       {"with", choice.with},
                       {"gain", choice.gain},
                       {"seconds", choice.seconds},
                       {"known", choice.known},
                       {"taken", choice.taken},
                       {"why", choice.why}});
  return {{"choices", choices}, {"seconds", plan.seconds}, {"unanswered", plan.unanswered}};
}

std::string plan_text(const GoalPlan& plan) {
  std::string text;
  for (const GoalChoice& choice : plan.choices) {
    text += fmt::format("{} {} for {}: {}; expected gain {:.2f} in {:.1f} ms{}", choice.taken ? "+" : "-",
                        choice.annotator, choice.term, choice.why, choice.gain, choice.seconds * 1e3,
                        choice.known ? "" : " (assumed: it never ran)");
    if (!choice.with.empty()) text += fmt::format(", with {}", fmt::join(choice.with, ", "));
    text += "\n";
  }
  for (const std::string& term : plan.unanswered) text += fmt::format("no annotator is taken for {}\n", term);
  return text + fmt::format("expected {:.0f} ms per scene\n", plan.seconds * 1e3);
}

}  // namespace loci::perception
