#include "apps/evaluate/identity/report.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "mapping/base/text/json.h"

namespace loci::apps::identity_experiment {
namespace {

std::string level_name(double level) {
  return fmt::format("{}", level);
}

std::string both(const Success& success) {
  if (success.association.total == 0) return "-";
  return fmt::format("{:.1f} / {:.1f}", 100 * success.association.fraction(),
                     100 * success.explanation.fraction());
}

/// Standard error of the mean over runs.
double standard_error(const Cell& cell, Tally Success::*part) {
  const double n = double(cell.runs.size());
  if (n < 2) return 0;
  double sum = 0, squares = 0;
  for (const Success& run : cell.runs) {
    const double value = (run.*part).fraction();
    sum += value;
    squares += value * value;
  }
  return std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)) / (n - 1));
}

std::string success_table(const ExperimentResult& result) {
  std::string out = "Association / explanation, percent of old and new objects\n";
  for (const Condition condition : result.conditions) {
    out += fmt::format("\n{}, {:<28}", condition_name(condition),
                       condition == Condition::own     ? "own belief"
                       : condition == Condition::truth ? "true belief, last seen"
                                                       : "true belief, fresh");
    for (const double level : result.levels) out += fmt::format(" {:>13}", level);
    out += '\n';
    for (const std::string& model : result.models) {
      out += fmt::format("  {:<29}", model);
      for (size_t i = 0; i < result.levels.size(); ++i)
        out += fmt::format(" {:>13}", both(result.cell(condition, model, i).score.all));
      out += '\n';
    }
  }
  return out;
}

std::string evidence_table(const ExperimentResult& result) {
  std::string out =
      "\nErrors of the evidence (table 6.2), mean ± deviation; position, colour, of the same and of other\n"
      "objects on the same table\n";
  const std::string& model = result.models.front();
  for (const Condition condition : result.conditions)
    for (size_t i = 0; i < result.levels.size(); ++i) {
      const Score& s = result.cell(condition, model, i).score;
      out += fmt::format("  {} {:<6}", condition_name(condition), result.levels[i]);
      for (const ErrorSum* e : {&s.same_position, &s.same_color, &s.other_position, &s.other_color})
        out += fmt::format("  {:.3f} ± {:.3f}", e->mean(), e->deviation());
      out += '\n';
    }
  return out;
}

std::string action_table(const ExperimentResult& result) {
  std::string out = fmt::format("\nActions (table 6.3), {} scenes per noise level\n", result.scenes);
  const char* names[] = {"appear", "disappear", "move", "newview"};
  for (size_t i = 0; i < kActions; ++i) {
    int64_t sum = 0;
    for (const auto& counts : result.actions) sum += counts[i];
    out += fmt::format("  {:<10} {:>8}\n", names[i], sum);
  }
  return out;
}

template <size_t size>
std::string confusion(const std::array<std::array<int64_t, size>, size>& counts,
                      const std::array<const char*, size>& names) {
  std::string out = fmt::format("    {:<10}", "");
  for (const char* name : names) out += fmt::format(" {:>10}", name);
  out += '\n';
  for (size_t i = 0; i < size; ++i) {
    int64_t sum = 0;
    for (const int64_t count : counts[i]) sum += count;
    out += fmt::format("    {:<10}", names[i]);
    for (const int64_t count : counts[i])
      out += fmt::format(" {:>10.1f}", sum == 0 ? 0.0 : 100 * double(count) / double(sum));
    out += '\n';
  }
  return out;
}

std::string by_number(const ExperimentResult& result, Condition condition, const std::string& model,
                      std::map<int, Success> Score::*part, int most) {
  std::set<int> numbers;
  for (size_t i = 0; i < result.levels.size(); ++i)
    for (const auto& [number, success] : result.cell(condition, model, i).score.*part)
      if (number <= most) numbers.insert(number);
  std::string out = fmt::format("  {} {:<14}", condition_name(condition), model);
  for (const int number : numbers) out += fmt::format(" {:>13}", number);
  out += '\n';
  for (size_t i = 0; i < result.levels.size(); ++i) {
    out += fmt::format("    {:<12}", result.levels[i]);
    const auto& counts = result.cell(condition, model, i).score.*part;
    for (const int number : numbers) {
      const auto found = counts.find(number);
      out += fmt::format(" {:>13}", found == counts.end() ? "" : both(found->second));
    }
    out += '\n';
  }
  return out;
}

std::string calibration_table(const Calibration& calibration) {
  std::string out;
  for (const Calibration::Bin& bin : calibration.bins) {
    if (bin.answers.total == 0) continue;
    out += fmt::format("    stated {:.3f}  right {:.3f} of {:>7}  allowed ±{:.3f}  {}\n", bin.mean_stated(),
                       bin.answers.fraction(), bin.answers.total, bin.allowed(),
                       bin.holds() ? "holds" : "MISSED");
  }
  return out;
}

Json success_json(const Success& success) {
  return {{"association", success.association.fraction()}, {"explanation", success.explanation.fraction()}};
}

Json calibration_json(const Calibration& calibration) {
  Json bins = Json::array();
  for (const Calibration::Bin& bin : calibration.bins)
    bins.push_back({{"stated", bin.mean_stated()},
                    {"right", bin.answers.fraction()},
                    {"count", bin.answers.total},
                    {"allowed", bin.allowed()},
                    {"holds", bin.holds()}});
  return bins;
}

Json by_number_json(const std::map<int, Success>& numbers) {
  Json json = Json::object();
  for (const auto& [number, success] : numbers) json[std::to_string(number)] = success_json(success);
  return json;
}

Json cell_json(const Cell& cell) {
  Json json = success_json(cell.score.all);
  json["association_error"] = standard_error(cell, &Success::association);
  json["explanation_error"] = standard_error(cell, &Success::explanation);
  json["new"] = success_json(cell.score.of_new);
  json["old"] = success_json(cell.score.of_old);
  json["whole_scenes"] = success_json(cell.score.whole_scenes);
  json["by_objects"] = by_number_json(cell.score.by_objects);
  json["by_actions"] = by_number_json(cell.score.by_actions);
  json["new_confusion"] = cell.score.new_confusion;
  json["old_confusion"] = cell.score.old_confusion;
  json["calibration"] = {{"association", calibration_json(cell.score.association)},
                         {"explanation", calibration_json(cell.score.explanation)}};
  return json;
}

}  // namespace

std::string text_of(const ExperimentResult& result, bool verbose) {
  std::string out = success_table(result) + evidence_table(result) + action_table(result);
  for (const std::string& model : result.models) {
    if (!verbose && model != "paper" && model != "shipped") continue;
    for (const Condition condition : result.conditions) {
      if (!verbose && condition == Condition::truth) continue;
      out += "\nBy number of objects (figure 6.5) and of actions (figure 6.8)\n";
      out += by_number(result, condition, model, &Score::by_objects, 10);
      out += by_number(result, condition, model, &Score::by_actions, 100);
      for (size_t i = 0; i < result.levels.size(); ++i) {
        const Score& score = result.cell(condition, model, i).score;
        out += fmt::format(
            "\n  {} {} {}: new objects (figure 6.6), old objects (figure 6.7), rows are the truth\n",
            condition_name(condition), model, result.levels[i]);
        out += confusion<4>(score.new_confusion, {"stay", "move", "newview", "appear"});
        out += confusion<5>(score.old_confusion, {"newview", "move", "persist", "disappear", "stay"});
      }
    }
  }
  for (const std::string& model : result.models) {
    if (model != "shipped" && model != "paper") continue;
    for (const Condition condition : result.conditions) {
      Calibration association, explanation;
      for (size_t i = 0; i < result.levels.size(); ++i) {
        association += result.cell(condition, model, i).score.association;
        explanation += result.cell(condition, model, i).score.explanation;
      }
      out += fmt::format("\n  {} {}: stated probability of the association, all levels\n",
                         condition_name(condition), model);
      out += calibration_table(association);
      out += fmt::format("  {} {}: of the explanation\n", condition_name(condition), model);
      out += calibration_table(explanation);
    }
  }
  return out;
}

Json json_of(const ExperimentResult& result) {
  Json json = Json::object();
  for (const Condition condition : result.conditions)
    for (const std::string& model : result.models)
      for (size_t i = 0; i < result.levels.size(); ++i)
        json[condition_name(condition)][model][level_name(result.levels[i])] =
            cell_json(result.cell(condition, model, i));
  for (const Condition condition : result.conditions)
    for (size_t i = 0; i < result.levels.size(); ++i) {
      const Score& s = result.cell(condition, result.models.front(), i).score;
      Json& row = json["evidence"][condition_name(condition)][level_name(result.levels[i])];
      for (const auto& [name, e] :
           {std::pair{"same_position", &s.same_position}, std::pair{"same_color", &s.same_color},
            std::pair{"other_position", &s.other_position}, std::pair{"other_color", &s.other_color}})
        row[name] = {{"mean", e->mean()}, {"deviation", e->deviation()}};
    }
  const char* names[] = {"appear", "disappear", "move", "newview"};
  for (size_t i = 0; i < kActions; ++i) {
    int64_t sum = 0;
    for (const auto& counts : result.actions) sum += counts[i];
    json["actions"][names[i]] = sum;
  }
  json["scenes_per_level"] = result.scenes;
  return json;
}

std::string text_of(const std::vector<SpeedRow>& rows) {
  std::string out = "Exact marginals and the best matching, one core, CPU time, best of many\n";
  for (const SpeedRow& row : rows)
    out += fmt::format("  {:<30} {:>9.3f} ms  {:<14} error at most {:.1e}\n", row.problem, row.milliseconds,
                       row.aim_milliseconds > 0 ? fmt::format("aim {} ms", row.aim_milliseconds) : "",
                       row.gate_bound);
  return out;
}

Json json_of(const std::vector<SpeedRow>& rows) {
  Json json = Json::array();
  for (const SpeedRow& row : rows)
    json.push_back({{"problem", row.problem},
                    {"milliseconds", row.milliseconds},
                    {"aim_milliseconds", row.aim_milliseconds},
                    {"gate_error_bound", row.gate_bound}});
  return {{"speed", json}};
}

}  // namespace loci::apps::identity_experiment
