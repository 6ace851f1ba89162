#include "apps/evaluate/description/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/evaluate/description/primitive_scenes.h"
#include "mapping/base/parallel.h"
#include "mapping/base/text/json.h"
#include "perception/classification/ensemble.h"

namespace loci::apps::description_evaluation {
namespace {

namespace fs = std::filesystem;

struct TestSet {
  std::string name;
  std::vector<perception::TrainingSample> samples;
  std::vector<std::string> frames;  ///< of each object
  int missed = 0;
};

std::string class_of_category(const std::string& category) {
  if (category.find("box") != std::string::npos) return "box";
  if (category.find("cylindric") != std::string::npos) return "cylinder";
  return "";
}

TestSet described(const std::string& name, const perception::LabelledRecording& labelled,
                  const std::vector<std::string>& features, int threads, Progress& progress,
                  Warnings& warnings) {
  const perception::LabelledSurfaces surfaces = labelled_surfaces(labelled, progress, warnings);
  TestSet set{name,
              std::vector<perception::TrainingSample>(surfaces.found.size()),
              {},
              static_cast<int>(surfaces.objects - surfaces.found.size())};
  for (const perception::LabelledSurface& each : surfaces.found) set.frames.push_back(each.frame);
  parallel_for(surfaces.found.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      perception::ObjectFeatures of = object_features(features, surfaces.found[i].view);
      set.samples[i] = {surfaces.found[i].label, std::move(of.features), std::move(of.local)};
    }
  });
  return set;
}

Confusion confusion_of(const perception::Ensemble& model, const TestSet& set) {
  Confusion confusion{model.classes(), {}, 0, set.missed, {}};
  const size_t classes = model.classes().size();
  confusion.counts.assign(classes, std::vector<int>(classes, 0));
  int count = 0;
  for (size_t i = 0; i < set.samples.size(); ++i) {
    const perception::TrainingSample& sample = set.samples[i];
    const bool complete = model.knows_enough(sample.features, sample.local);
    const auto truth = std::find(confusion.classes.begin(), confusion.classes.end(), sample.label);
    if (!complete || truth == confusion.classes.end()) {
      ++confusion.missed;
      continue;
    }
    const auto row = static_cast<size_t>(truth - confusion.classes.begin());
    const perception::Classification result = model.classify(sample.features, sample.local);
    ++confusion.counts[row][result.best];
    confusion.log_loss -= std::log(std::max(result.probabilities[row], 1e-9));
    if (result.best != row)
      confusion.mistakes.push_back(fmt::format("{}: {} taken for {} ({:.2f})", set.frames[i], sample.label,
                                               model.classes()[result.best],
                                               result.probabilities[result.best]));
    ++count;
  }
  confusion.log_loss /= std::max(1, count);
  return confusion;
}

std::string table_text(const Confusion& confusion) {
  std::string text = fmt::format("    {:12}", "");
  for (const std::string& name : confusion.classes) text += fmt::format("{:>10}", name);
  text += "   success rate\n";
  for (size_t row = 0; row < confusion.classes.size(); ++row) {
    if (std::isnan(confusion.rate(row))) continue;
    text += fmt::format("    {:12}", confusion.classes[row]);
    for (const int count : confusion.counts[row]) text += fmt::format("{:>10}", count);
    text += fmt::format("{:>13.1f} %\n", 100 * confusion.rate(row));
  }
  return text;
}

}  // namespace

void ShapesOptions::declare(OptionTable& table) {
  table.integer("train_scenes", train_scenes, "", "Simulated scenes to learn from.", 5, 100000);
  table.integer("test_scenes", test_scenes, "", "Other simulated scenes to be tested on.", 1, 100000);
  table.integer("folds", folds, "", "Parts for cross-validation.", 2, 100);
  table.integer("shapes_seed", seed, "", "Seed of the simulated scenes.", 0, 1 << 30);
  table.texts("experts", experts, "DESCRIPTOR:CLASSIFIER[:DISTANCE] of each.");
}

double Confusion::rate(size_t row) const {
  int all = 0;
  for (const int count : counts[row]) all += count;
  return all > 0 ? static_cast<double>(counts[row][row]) / all : std::nan("");
}

double Confusion::accuracy() const {
  int all = 0, right = 0;
  for (size_t row = 0; row < counts.size(); ++row) {
    right += counts[row][row];
    for (const int count : counts[row]) all += count;
  }
  return all > 0 ? static_cast<double>(right) / all : 0;
}

ShapesResult evaluate_shapes(const std::vector<std::string>& folders, const ShapesOptions& options,
                             int threads, Progress& progress, Warnings& warnings) {
  std::vector<perception::ExpertSpec> experts;
  std::set<std::string> names;
  for (const std::string& text : options.experts) {
    experts.push_back(perception::parse_expert(text));
    names.insert(experts.back().feature);
  }
  const std::vector<std::string> features(names.begin(), names.end());
  const Random random(static_cast<uint64_t>(options.seed));
  PartialProgress training(progress, 0, 0.4), testing(progress, 0.4, 0.6), real(progress, 0.6, 0.7);
  const TestSet train =
      described("training", primitive_scenes(static_cast<size_t>(options.train_scenes), random.fork(0)),
                features, threads, training, warnings);
  std::vector<TestSet> sets;
  sets.push_back(described("simulated, unseen",
                           primitive_scenes(static_cast<size_t>(options.test_scenes), random.fork(1)),
                           features, threads, testing, warnings));
  for (const std::string& folder : folders)
    sets.push_back(described(fs::path(folder).lexically_normal().filename().string(),
                             perception::open_labelled_recording_by_scene(folder, class_of_category),
                             features, threads, real, warnings));
  ShapesResult result;
  result.trained_on = train.samples.size();
  for (const TestSet& set : sets) result.test_sets.push_back(set.name);
  PartialProgress learning(progress, 0.7, 1);
  const auto judge = [&](const std::string& name, const std::vector<perception::ExpertSpec>& together) {
    NoProgress none;
    const perception::Ensemble model =
        perception::Ensemble::train(train.samples, together, options.folds, random.fork(2), threads, none);
    ShapesResult::Row& row = result.rows.emplace_back();
    row.name = name;
    for (const TestSet& set : sets) row.by_test_set.push_back(confusion_of(model, set));
  };
  for (size_t e = 0; e < experts.size(); ++e) {
    learning.check(static_cast<double>(e) / static_cast<double>(experts.size() + 1), name_of(experts[e]));
    judge(name_of(experts[e]), {experts[e]});
  }
  judge("fused", experts);
  return result;
}

std::string ShapesResult::text() const {
  std::string text = fmt::format("shapes: trained on {} simulated clusters\n", trained_on);
  for (size_t set = 0; set < test_sets.size(); ++set) {
    text += fmt::format("{} ({} objects not found)\n  {:<28}{:>9}{:>11}\n", test_sets[set],
                        rows.back().by_test_set[set].missed, "", "right", "log loss");
    for (const Row& row : rows)
      text += fmt::format("  {:<28}{:>7.1f} %{:>11.3f}\n", row.name, 100 * row.by_test_set[set].accuracy(),
                          row.by_test_set[set].log_loss);
    text += "  fused\n" + table_text(rows.back().by_test_set[set]);
    for (const std::string& mistake : rows.back().by_test_set[set].mistakes) text += "    " + mistake + "\n";
  }
  return text;
}

Json ShapesResult::to_json() const {
  Json json = {{"trained_on", trained_on}, {"test_sets", Json::array()}};
  for (size_t set = 0; set < test_sets.size(); ++set) {
    Json each = {{"name", test_sets[set]}, {"experts", Json::array()}};
    for (const Row& row : rows) {
      const Confusion& confusion = row.by_test_set[set];
      each["experts"].push_back({{"name", row.name},
                                 {"classes", confusion.classes},
                                 {"counts", confusion.counts},
                                 {"accuracy", confusion.accuracy()},
                                 {"log_loss", confusion.log_loss},
                                 {"not_found", confusion.missed},
                                 {"mistakes", confusion.mistakes}});
    }
    json["test_sets"].push_back(std::move(each));
  }
  return json;
}

}  // namespace loci::apps::description_evaluation
