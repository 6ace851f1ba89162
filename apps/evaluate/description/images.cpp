#include "apps/evaluate/description/images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mapping/base/parallel.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/classification/ensemble.h"

namespace loci::apps::description_evaluation {
namespace {

constexpr int kFolds = 2;

std::vector<perception::TrainingSample> described(const std::filesystem::path& folder,
                                                  const std::vector<std::string>& features, int threads) {
  const CsvTable table = CsvTable::read(folder / "labels.csv");
  const size_t file = table.require_column("file"), name = table.require_column("class_name");
  std::vector<perception::TrainingSample> samples(table.rows());
  parallel_for(samples.size(), threads, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      perception::ObjectView view;
      view.image = mapping::read_color(folder / table.cell(row, file));
      perception::ObjectFeatures of = object_features(features, view);
      samples[row] = {table.cell(row, name), std::move(of.features), std::move(of.local)};
    }
  });
  return samples;
}

/// Which part each object belongs to: each class spread evenly; classes of too few objects are left out.
std::vector<int> parts_of(std::vector<perception::TrainingSample>& samples, int parts) {
  std::map<std::string, int> count;
  for (const perception::TrainingSample& sample : samples) ++count[sample.label];
  std::erase_if(samples, [&](const perception::TrainingSample& sample) {
    return count[sample.label] < kFolds * parts;
  });
  std::map<std::string, int> seen;
  std::vector<int> part;
  for (const perception::TrainingSample& sample : samples) part.push_back(seen[sample.label]++ % parts);
  return part;
}

void test(const perception::Ensemble& model, const perception::TrainingSample& sample,
          ImagesResult::Row& row) {
  ++row.samples;
  const auto truth = std::find(model.classes().begin(), model.classes().end(), sample.label);
  if (!model.knows_enough(sample.features, sample.local) || truth == model.classes().end()) return;
  const perception::Classification result = model.classify(sample.features, sample.local);
  const auto number = static_cast<size_t>(truth - model.classes().begin());
  row.right += result.best == number;
  row.log_loss -= std::log(std::max(result.probabilities[number], 1e-9));
}

}  // namespace

void ImagesOptions::declare(OptionTable& table) {
  table.texts("image_experts", experts, "DESCRIPTOR:CLASSIFIER[:DISTANCE] of each, on images.");
  table.integer("image_parts", parts, "", "Each part of the images is tested once.", 2, 100);
  table.integer("image_seed", seed, "", "Seed of the words.", 0, 1 << 30);
}

ImagesResult evaluate_images(const std::filesystem::path& folder, const ImagesOptions& options, int threads,
                             Progress& progress) {
  std::vector<std::vector<perception::ExpertSpec>> groups;
  std::vector<perception::ExpertSpec> all;
  std::vector<std::string> features;
  for (const std::string& text : options.experts) {
    all.push_back(perception::parse_expert(text));
    groups.push_back({all.back()});
    features.push_back(all.back().feature);
  }
  groups.push_back(all);
  progress.check(0, "features");
  std::vector<perception::TrainingSample> samples = described(folder, features, threads);
  const std::vector<int> part = parts_of(samples, options.parts);
  ImagesResult result;
  std::set<std::string> classes;
  for (const perception::TrainingSample& sample : samples) classes.insert(sample.label);
  result.classes = classes.size();
  const Random random(static_cast<uint64_t>(options.seed));
  for (size_t g = 0; g < groups.size(); ++g) {
    ImagesResult::Row& row = result.rows.emplace_back();
    row.name = g < all.size() ? name_of(all[g]) : "fused";
    for (int tested = 0; tested < options.parts; ++tested) {
      progress.check(0.2 + 0.8 * static_cast<double>(g) / static_cast<double>(groups.size()), row.name);
      std::vector<perception::TrainingSample> examples;
      for (size_t i = 0; i < samples.size(); ++i)
        if (part[i] != tested) examples.push_back(samples[i]);
      NoProgress none;
      const perception::Ensemble model =
          perception::Ensemble::train(std::move(examples), groups[g], kFolds, random, threads, none);
      for (size_t i = 0; i < samples.size(); ++i)
        if (part[i] == tested) test(model, samples[i], row);
    }
    row.log_loss /= std::max(1, row.samples);
  }
  return result;
}

std::string ImagesResult::text() const {
  std::string text = fmt::format("images: {} of {} classes, each tested by who has not learned it\n",
                                 rows.empty() ? 0 : rows.front().samples, classes);
  for (const Row& row : rows)
    text += fmt::format("  {:<28}{:>7.1f} %{:>11.3f} log loss\n", row.name,
                        100.0 * row.right / std::max(1, row.samples), row.log_loss);
  return text;
}

Json ImagesResult::to_json() const {
  Json json = {{"classes", classes}, {"experts", Json::array()}};
  for (const Row& row : rows)
    json["experts"].push_back(
        {{"name", row.name}, {"right", row.right}, {"objects", row.samples}, {"log_loss", row.log_loss}});
  return json;
}

}  // namespace loci::apps::description_evaluation
