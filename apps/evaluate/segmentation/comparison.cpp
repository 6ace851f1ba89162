#include "apps/evaluate/segmentation/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "apps/evaluate/segmentation/strips.h"
#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/pipeline/pipeline.h"

namespace loci::apps::segmentation_evaluation {
namespace {

namespace fs = std::filesystem;

/// Category of a scene by the number in its name, where scenes.csv tells.
std::map<int64_t, std::string> read_categories(const fs::path& folder) {
  std::map<int64_t, std::string> categories;
  if (!fs::exists(folder / "scenes.csv")) return categories;
  const CsvTable table = CsvTable::read(folder / "scenes.csv");
  const int scene = table.column("scene");
  const int category = table.column("category");
  if (scene < 0 || category < 0) return categories;
  for (size_t row = 0; row < table.rows(); ++row)
    categories[table.integer(row, static_cast<size_t>(scene))] =
        table.cell(row, static_cast<size_t>(category));
  return categories;
}

/// The objects of a label image (CV_16U).
LabelledImage objects_of(const cv::Mat& raw) {
  LabelledImage image{cv::Mat::zeros(raw.size(), CV_16U), raw > 0};
  for (int v = 0; v < raw.rows; ++v)
    for (int u = 0; u < raw.cols; ++u)
      if (const int label = raw.at<uint16_t>(v, u); label >= 20)
        image.object.at<uint16_t>(v, u) = static_cast<uint16_t>(label / 10 - 1);
  return image;
}

/// Our segments and seconds of every frame, by the frame's name.
std::map<std::string, Segmentation> ours(const std::shared_ptr<mapping::Recording>& recording,
                                         const fs::path& pipeline_file, Progress& progress,
                                         Warnings& warnings) {
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  perception::Pipeline pipeline =
      pipeline_file.empty() ? perception::Pipeline::parse(
                                  fmt::format("reader: RecordingReader\nflow: {}\n", perception::kObjectFlow),
                                  "the tabletop pipeline", registry)
                            : perception::Pipeline::parse(Config::read(pipeline_file), registry);
  perception::Resources resources;
  resources.put(recording);
  perception::Context context{resources, warnings, 1, {}};
  std::map<std::string, Segmentation> found;
  const perception::PipelineResult result =
      pipeline.run(context, perception::types::type_system(), progress, [&](perception::cas::Cas& cas) {
        const perception::types::SceneCas scene(cas);
        found[scene.scene().frame_name.get()].segments = perception::label_image(scene);
      });
  // Reading files is nobody's method.
  double seconds = 0;
  for (size_t i = 1; i < result.seconds.size(); ++i) seconds += result.seconds[i].second;
  for (auto& [name, each] : found) each.seconds = seconds / static_cast<double>(found.size());
  return found;
}

Scores& category_of(MethodResult& method, const std::string& category) {
  for (auto& [name, scores] : method.by_category)
    if (name == category) return scores;
  return method.by_category.emplace_back(category, Scores()).second;
}

std::string row(const std::string& name, const Scores& scores) {
  return fmt::format("  {:<30}{:>7.1f} %{:>7.1f} %{:>7.1f} %{:>7.1f} %{:>7.1f} %{:>7.1f} %", name,
                     100 * scores.weighted_overlap(), 100 * scores.over_segmentation(),
                     100 * scores.under_segmentation(), 100 * scores.f1(), 100 * scores.precision(),
                     100 * scores.recall());
}

}  // namespace

void ComparisonOptions::declare(OptionTable& table) {
  table.flag("peers", peers, "Runs PCL's methods beside ours.");
  peer.declare(table);
}

LabelledImage read_labels(const fs::path& path) {
  return objects_of(perception::read_label_image(path));
}

LabelledScenes open_labelled_scenes(const fs::path& folder) {
  LabelledScenes scenes;
  scenes.recording = mapping::open_recording(folder);
  scenes.name = scenes.recording->info().path;
  const std::map<std::string, fs::path> files = perception::find_label_images(folder);
  if (files.empty())
    throw Error("there are no labels", {folder.string(), 0, {}},
                "FRAME_label.png belongs beside FRAME_depth.png");
  scenes.labels = [files](const std::string& frame) -> std::optional<LabelledImage> {
    const auto file = files.find(frame);
    if (file == files.end()) return std::nullopt;
    return read_labels(file->second);
  };
  scenes.category = [categories = read_categories(folder)](const std::string& frame) {
    const auto category = categories.find(perception::scene_number(frame));
    return category == categories.end() ? std::string() : category->second;
  };
  return scenes;
}

LabelledScenes drawn_tables(mapping::Arrangement arrangement, int tables, int seed) {
  const auto drawn = std::make_shared<mapping::HouseholdScenes>(
      static_cast<size_t>(tables), Random(static_cast<uint64_t>(seed)), arrangement);
  LabelledScenes scenes;
  scenes.name = fmt::format("rendered tables, {}, seed {}",
                            arrangement == mapping::Arrangement::stacked ? "stacks" : "objects apart", seed);
  scenes.recording = drawn;
  const mapping::HouseholdScenes* last = drawn.get();
  scenes.labels = [last](const std::string&) -> std::optional<LabelledImage> {
    LabelledImage image = objects_of(last->labels());
    std::map<int, int> pixels;
    for (const uint16_t object : cv::Mat_<uint16_t>(image.object)) ++pixels[object];
    for (const auto& [object, count] : pixels)
      if (object > 0 && count < perception::ClusterOptions().min_points)
        image.judged.setTo(0, image.object == object);
    return image;
  };
  scenes.category = [](const std::string&) { return std::string(); };
  return scenes;
}

Comparison compare(const LabelledScenes& scenes, const fs::path& pipeline, const fs::path& images,
                   const ComparisonOptions& options, Progress& progress, Warnings& warnings) {
  const std::shared_ptr<mapping::Recording>& recording = scenes.recording;
  const std::map<std::string, Segmentation> found = ours(recording, pipeline, progress, warnings);
  std::vector<std::unique_ptr<Peer>> peers;
  Comparison comparison;
  comparison.folder = scenes.name;
  comparison.methods.push_back({"ours", {}, {}, {}});
  if (options.peers) {
    comparison.methods.push_back({"PCL EuclideanClusterExtraction", {}, {}, {}});
    comparison.methods.push_back({"PCL LCCP", {}, {}, {}});
    comparison.methods.push_back({"PCL LCCP, plane removed", {}, {}, {}});
    peers.push_back(pcl_euclidean(options.peer));
    peers.push_back(pcl_lccp(options.peer, false));
    peers.push_back(pcl_lccp(options.peer, true));
  }
  if (!images.empty()) make_folder(images);
  for (size_t i = 0; i < recording->size(); ++i) {
    const mapping::RgbdFrame frame = recording->frame(i);
    progress.check(static_cast<double>(i) / static_cast<double>(recording->size()), frame.name);
    const std::optional<LabelledImage> labels = scenes.labels(frame.name);
    if (!labels) continue;
    const LabelledImage& truth = *labels;
    if (truth.object.size() != frame.depth.size())
      throw Error(fmt::format("the label image of frame {} is not as large as its depth image", frame.name),
                  {scenes.name, 0, {}}, "");
    std::vector<Segmentation> results = {found.at(frame.name)};
    for (const auto& peer : peers) results.push_back(peer->segment(frame.depth, frame.camera.depth));
    FrameResult& judged = comparison.frames.emplace_back();
    judged.name = frame.name;
    judged.category = scenes.category(frame.name);
    std::vector<cv::Mat> segments;
    for (size_t m = 0; m < results.size(); ++m) {
      MethodResult& method = comparison.methods[m];
      method.scores.add(truth, results[m].segments);
      if (!judged.category.empty()) category_of(method, judged.category).add(truth, results[m].segments);
      judged.scores.emplace_back().add(truth, results[m].segments);
      method.seconds.push_back(results[m].seconds);
      segments.push_back(results[m].segments);
    }
    if (images.empty()) continue;
    const cv::Mat color = frame.color.empty() ? cv::Mat(frame.depth.size(), CV_8UC3, cv::Scalar::all(128))
                                              : color_in_depth(frame);
    mapping::write_image(images / (frame.name + ".png"), strip(color, truth.object, segments, 0.5));
  }
  if (comparison.frames.empty())
    throw Error("no frame has labels", {scenes.name, 0, {}},
                "labels are named after frames: FRAME_label.png");
  return comparison;
}

std::string Comparison::text(bool verbose) const {
  std::string text = fmt::format("{}: {} frames, {} objects\n  {:<30}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
                                 folder, frames.size(), methods.front().scores.objects(), "", "overlap",
                                 "over", "under", "F1", "prec.", "recall", "ms");
  for (const MethodResult& method : methods)
    text += fmt::format("{}{:>9.1f}\n", row(method.name, method.scores), 1000 * median(method.seconds));
  const Scores::Wrong& wrong = methods.front().scores.wrong_segments();
  text += fmt::format(
      "  of ours find no object: {} inexact, {} further pieces of objects, {} of the table, {} joined "
      "objects\n",
      wrong.inexact, wrong.pieces, wrong.table, wrong.joined);
  for (size_t c = 0; c < methods.front().by_category.size(); ++c) {
    text += fmt::format("{}\n", methods.front().by_category[c].first);
    for (const MethodResult& method : methods) text += row(method.name, method.by_category[c].second) + "\n";
  }
  if (!verbose) return text;
  for (const FrameResult& frame : frames) {
    text += frame.name + "\n";
    for (size_t m = 0; m < methods.size(); ++m) text += row(methods[m].name, frame.scores[m]) + "\n";
  }
  return text;
}

Json Comparison::to_json() const {
  Json json = {{"folder", folder}, {"methods", Json::array()}, {"frames", Json::array()}};
  for (const MethodResult& method : methods) {
    Json each = method.scores.to_json();
    each["method"] = method.name;
    each["ms"] = 1000 * median(method.seconds);
    each["categories"] = Json::object();
    for (const auto& [name, scores] : method.by_category) each["categories"][name] = scores.to_json();
    json["methods"].push_back(std::move(each));
  }
  for (const FrameResult& frame : frames) {
    Json each = {{"frame", frame.name}, {"category", frame.category}, {"methods", Json::object()}};
    for (size_t m = 0; m < methods.size(); ++m) each["methods"][methods[m].name] = frame.scores[m].to_json();
    json["frames"].push_back(std::move(each));
  }
  return json;
}

}  // namespace loci::apps::segmentation_evaluation
