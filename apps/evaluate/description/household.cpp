#include "apps/evaluate/description/household.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/simulation/household.h"
#include "mapping/simulation/household_scenes.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/classification/household_model.h"

namespace loci::apps::description_evaluation {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFeature = "Household";

perception::LabelledRecording rendered_tables(int scenes, const Random& random) {
  const auto tables = std::make_shared<mapping::HouseholdScenes>(static_cast<size_t>(scenes), random);
  perception::LabelledRecording labelled;
  labelled.recording = tables;
  const mapping::HouseholdScenes* last = tables.get();
  labelled.labels = [last](const std::string&) { return last->labels(); };
  labelled.class_of = [last](const std::string&, int object) { return last->class_of(object); };
  return labelled;
}

/// The class that a name speaks of: "mug" of "mug_print", "tin" of "cookie_tin"; "" = none.
std::string class_of_name(const std::string& name) {
  if (name == "pringles") return "can";
  std::string last;
  for (size_t begin = 0; begin < name.size();) {
    const size_t end = std::min(name.find('_', begin), name.size());
    const std::string word = name.substr(begin, end - begin);
    if (std::ranges::binary_search(mapping::household_classes(), word)) last = word;
    begin = end + 1;
  }
  return last;
}

perception::LabelledRecording named_objects(const fs::path& folder) {
  perception::LabelledRecording labelled;
  if (fs::exists(folder / "objects.csv")) {
    labelled = perception::open_labelled_recording(folder);
    labelled.class_of = [of = labelled.class_of](const std::string& frame, int object) {
      return class_of_name(of(frame, object));
    };
    return labelled;
  }
  labelled = perception::open_labelled_recording_by_scene(folder, [](const std::string& category) {
    return std::string(category.find("box") != std::string::npos ? "box" : "");
  });
  return labelled;
}

std::vector<perception::TrainingSample> described(const perception::LabelledSurfaces& surfaces, int threads) {
  std::vector<perception::TrainingSample> samples(surfaces.found.size());
  parallel_for(samples.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      samples[i] = {surfaces.found[i].label,
                    perception::object_features({kFeature}, surfaces.found[i].view).features};
  });
  return samples;
}

NamingScore named(const perception::HouseholdModel& model, const perception::LabelledRecording& labelled,
                  double& seconds, Progress& progress, Warnings& warnings) {
  const perception::LabelledSurfaces surfaces =
      labelled_surfaces(labelled, progress, warnings, perception::kObjectFlow);
  NamingScore score;
  score.objects = static_cast<int>(surfaces.objects);
  for (const perception::LabelledSurface& each : surfaces.found) {
    const Stopwatch watch;
    const auto answer = model.classify(each.view);
    seconds += watch.seconds();
    ++score.found;
    const bool sure = answer && answer->sure;
    ++score.said[each.label][sure ? answer->label : "-"];
    if (!sure) continue;
    const bool right = perception::household_group(answer->label) == perception::household_group(each.label);
    ++score.answered;
    score.right += right;
    score.exact += answer->label == (each.label == "mug" ? "cup" : each.label);
    score.probabilities.emplace_back(answer->probability, right);
  }
  return score;
}

double percent_of(int part, int all) {
  return 100.0 * part / std::max(1, all);
}

}  // namespace

void HouseholdOptions::declare(OptionTable& table) {
  table.integer("household_train", train_scenes, "",
                "Rendered tables to learn names from; 0 = the shipped model.", 0, 100000);
  table.integer("household_test", test_scenes, "", "Other rendered tables to name objects of.", 1, 100000);
  table.integer("household_seed", seed, "", "Seed of these tables.", 0, 1 << 30);
  table.number("precision", precision, "",
               "Share of right answers in cross-validation that thresholds are set for.", 0.5, 1);
}

double NamingScore::calibration_error() const {
  auto sorted = probabilities;
  std::ranges::sort(sorted, std::greater<>());
  constexpr size_t kParts = 10;
  double error = 0;
  for (size_t part = 0; part < kParts; ++part) {
    const size_t begin = part * sorted.size() / kParts, end = (part + 1) * sorted.size() / kParts;
    double difference = 0;
    for (size_t i = begin; i < end; ++i) difference += sorted[i].first - (sorted[i].second ? 1 : 0);
    error += std::abs(difference) / static_cast<double>(std::max<size_t>(1, sorted.size()));
  }
  return error;
}

HouseholdResult evaluate_household(const std::vector<std::string>& folders, const HouseholdOptions& options,
                                   const fs::path& out, int threads, Progress& progress, Warnings& warnings) {
  HouseholdResult result;
  const Random random(static_cast<uint64_t>(options.seed));
  std::optional<perception::HouseholdModel> trained;
  if (options.train_scenes > 0) {
    PartialProgress rendering(progress, 0, 0.6), learning(progress, 0.6, 0.7);
    std::vector<perception::TrainingSample> samples =
        described(labelled_surfaces(rendered_tables(options.train_scenes, random.fork(0)), rendering,
                                    warnings, perception::kObjectFlow),
                  threads);
    result.trained_on = samples.size();
    trained = perception::HouseholdModel::train(std::move(samples), options.precision, random.fork(2),
                                                threads, learning);
    if (!out.empty()) trained->save(out);
  }
  const perception::HouseholdModel& model = trained ? *trained : perception::HouseholdModel::shipped();
  PartialProgress testing(progress, 0.7, 0.9), real(progress, 0.9, 1);
  double seconds = 0;
  result.by_set.emplace_back(
      "rendered, unseen",
      named(model, rendered_tables(options.test_scenes, random.fork(1)), seconds, testing, warnings));
  for (const std::string& folder : folders)
    result.by_set.emplace_back(fs::path(folder).lexically_normal().filename().string(),
                               named(model, named_objects(folder), seconds, real, warnings));
  int objects = 0;
  for (const auto& [name, score] : result.by_set) objects += score.found;
  result.milliseconds = 1000 * seconds / std::max(1, objects);
  return result;
}

std::string HouseholdResult::text() const {
  std::string text = trained_on == 0 ? "names: the shipped model"
                                     : fmt::format("names: trained on {} rendered objects", trained_on);
  text += fmt::format(", {:.2f} ms an object\n  {:<18}{:>9}{:>9}{:>10}{:>12}{:>14}{:>12}{:>14}\n",
                      milliseconds, "", "objects", "found", "answered", "right of it", "right of found",
                      "the class", "calibration");
  for (const auto& [name, score] : by_set)
    text += fmt::format("  {:<18}{:>9}{:>9}{:>10}{:>10.1f} %{:>12.1f} %{:>10.1f} %{:>12.1f} %\n", name,
                        score.objects, score.found, score.answered, percent_of(score.right, score.answered),
                        percent_of(score.right, score.found), percent_of(score.exact, score.answered),
                        100 * score.calibration_error());
  for (const auto& [name, score] : by_set) {
    text += "  " + name + "\n";
    for (const auto& [truth, said] : score.said) {
      text += fmt::format("    {:15}", truth);
      for (const auto& [label, count] : said)
        text += fmt::format(" {} {}", count, label == "-" ? "unnamed" : label);
      text += "\n";
    }
  }
  return text;
}

Json HouseholdResult::to_json() const {
  Json json = {{"trained_on", trained_on}, {"milliseconds", milliseconds}, {"sets", Json::array()}};
  for (const auto& [name, score] : by_set)
    json["sets"].push_back({{"name", name},
                            {"objects", score.objects},
                            {"found", score.found},
                            {"answered", score.answered},
                            {"right", score.right},
                            {"class_right", score.exact},
                            {"calibration_error", score.calibration_error()},
                            {"said", score.said}});
  return json;
}

}  // namespace loci::apps::description_evaluation
