// What is learned before a run: train, surface.

#include <fmt/format.h>

#include "apps/perceive/commands.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/annotators/segmentation/flat_surface.h"
#include "perception/classification/ensemble.h"
#include "perception/recognition/template_detector.h"

namespace loci::apps {

namespace {

struct TrainArguments {
  std::string dataset, out;
  std::vector<std::string> experts = {"VFH:svm", "ESF:svm", "PFH:svm"};
  bool templates = false;
  int folds = 5;
  uint64_t seed = 0;
  perception::ClassifierOptions options;
};

/// Leaves out classes with fewer samples than folds; returns how many samples each of them has.
std::map<std::string, size_t> leave_out_small_classes(std::vector<perception::TrainingSample>& samples,
                                                      int folds) {
  std::map<std::string, size_t> count;
  for (const perception::TrainingSample& sample : samples) ++count[sample.label];
  std::erase_if(count, [&](const auto& of) { return of.second >= size_t(folds); });
  std::erase_if(samples,
                [&](const perception::TrainingSample& sample) { return count.contains(sample.label); });
  return count;
}

/// Templates of every labelled view, for the annotator TemplateDetector.
void train_templates(const TrainArguments& given, Session& session) {
  const perception::LabelledRecording labelled = perception::open_labelled_recording(given.dataset);
  perception::TemplateDetector detector;
  size_t views = 0;
  for (size_t i = 0; i < labelled.recording->size(); ++i) {
    const mapping::RgbdFrame frame = labelled.recording->frame(i);
    session.progress().check(static_cast<double>(i) / static_cast<double>(labelled.recording->size()),
                             "frame " + frame.name);
    for (const perception::LabelledPart& part : labelled_parts(labelled, frame.name))
      views += detector.add(part.label, frame.color, frame.depth, part.mask) > 0 ? 1 : 0;
  }
  if (views == 0) throw Error("there is no labelled view with colour and depth", {given.dataset, 0, {}});
  detector.save(given.out);
  session.answer(fmt::format("{} templates of {} views in {}\n", detector.templates(), views, given.out),
                 {{"templates", detector.templates()}, {"views", views}, {"out", given.out}});
}

void train(TrainArguments& given, Session& session) {
  if (given.templates) return train_templates(given, session);
  table_of(given.options).validate();
  std::vector<perception::ExpertSpec> experts;
  for (const std::string& text : given.experts) experts.push_back(parse_expert(text, given.options));
  PartialProgress finding(session.progress(), 0, 0.7);
  const perception::LabelledSurfaces surfaces =
      labelled_surfaces(perception::open_labelled_recording(given.dataset), finding, session.warnings());
  std::vector<std::string> features;
  for (const perception::ExpertSpec& expert : experts) features.push_back(expert.feature);
  std::vector<perception::TrainingSample> samples;
  for (const perception::LabelledSurface& each : surfaces.found) {
    perception::ObjectFeatures of = object_features(features, each.view);
    samples.push_back({each.label, std::move(of.features), std::move(of.local)});
  }
  for (const auto& [name, count] : leave_out_small_classes(samples, given.folds))
    session.warnings().add(fmt::format("'{}' is left out: too few were found ({})", name, count));
  PartialProgress learning(session.progress(), 0.7, 1);
  const perception::Ensemble model = perception::Ensemble::train(
      samples, experts, given.folds, Random(given.seed), session.flags().threads, learning);
  model.save(given.out);
  std::string text =
      fmt::format("{} of {} objects found; cross-validated:\n", surfaces.found.size(), surfaces.objects);
  Json classes = Json::object();
  for (size_t c = 0; c < model.classes().size(); ++c) {
    text += fmt::format("  {:20} {:5.1f} % right\n", model.classes()[c], 100 * model.accuracies()[c]);
    classes[model.classes()[c]] = model.accuracies()[c];
  }
  text += "model in " + given.out + "\n";
  session.answer(text, {{"objects", surfaces.objects},
                        {"found", surfaces.found.size()},
                        {"accuracies", classes},
                        {"out", given.out}});
}

}  // namespace

Command train_command() {
  return {"train",
          "Train a classifier of clusters from labelled images",
          {"loci-perceive train tests/data/blocks -o demo-output/blocks.model --folds 2",
           "loci-perceive train tests/data/blocks -o demo-output/blocks.model --folds 2 --expert VFH:knn:L1 "
           "--k 2 --json",
           "loci-perceive train tests/data/blocks -o demo-output/blocks.templates --templates"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<TrainArguments>();
            table.positional("DATASET", &given->dataset,
                             "Recording with FRAME_label.png for its depth images (0 ignored, 1 to 19 table, "
                             "objects in tens from 20 on) and objects.csv (scene, label_group, class)");
            table.output("FILE", &given->out, "The model, for the annotator FeatureClassifier",
                         {.replaces = true});
            table.option("--expert SPEC", &given->experts,
                         "DESCRIPTOR:CLASSIFIER[:DISTANCE]; may be repeated, the experts are fused");
            table.flag("--templates", given->templates,
                       "Train templates of whole images instead, for the annotator TemplateDetector");
            table.option("--folds N", &given->folds, "Number of folds of the cross-validation",
                         {.min = 2, .max = 100});
            table.option("--seed N", &given->seed, "Seed of the forests");
            table.options(table_of(given->options), "Classifiers");
            return [given](Session& session) { train(*given, session); };
          }};
}

namespace {

struct SurfaceArguments {
  std::string recording;
  std::string output;
  int frames = 100;
};

void run(const SurfaceArguments& given, Session& session) {
  const std::unique_ptr<mapping::Recording> recording = mapping::open_recording(given.recording);
  const size_t count = std::min(recording->size(), static_cast<size_t>(given.frames));
  perception::SurfaceCalibration calibration;
  for (size_t i = 0; i < count; ++i) {
    session.progress().check(static_cast<double>(i) / static_cast<double>(count), "averaging");
    calibration.add(recording->frame(i).depth);
  }
  const cv::Mat mean = calibration.mean();
  const double known =
      static_cast<double>(cv::countNonZero(mean == mean)) / static_cast<double>(mean.total());
  perception::write_surface(given.output, mean);
  session.answer(fmt::format("the mean of {} images, {:.0f} % of the pixels known: {}\n", count, 100 * known,
                             given.output),
                 {{"frames", count}, {"known", known}, {"file", given.output}});
}

}  // namespace

Command surface_command() {
  return {"surface",
          "Average depth images of an empty workspace for the detection of flat objects",
          {"loci-perceive surface demo-output/day -o demo-output/surface.png --max-frames 5",
           "loci-perceive surface demo-output/day -o demo-output/surface.png --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<SurfaceArguments>();
            table.positional("RECORDING", &given->recording,
                             "Recording of the empty workspace by a fixed camera");
            table.output("FILE", &given->output, "PNG, 16 bit, in tenths of a millimetre",
                         {.replaces = true});
            table.option("--max-frames N", &given->frames, "Maximum number of images", {.min = 1});
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci::apps
