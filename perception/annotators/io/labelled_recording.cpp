#include "perception/annotators/io/labelled_recording.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/text/csv.h"
#include "mapping/image/image_io.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/description/shape_annotators.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"
#include "perception/detection/people_detector.h"
#include "perception/pipeline/pipeline.h"

namespace loci::perception {
namespace {

const std::array<cv::Scalar, 8> kPalette = {{{60, 60, 230},
                                             {60, 200, 60},
                                             {230, 120, 40},
                                             {40, 200, 230},
                                             {220, 60, 220},
                                             {220, 220, 60},
                                             {80, 140, 255},
                                             {200, 120, 160}}};

namespace fs = std::filesystem;

/// How many pixels each cluster (from 1) shares with each object.
struct Overlaps {
  std::map<int, double> of_object;
  std::map<int, double> of_cluster;
  std::map<int, std::map<int, double>> shared;  ///< by cluster and object
};

Overlaps overlaps_of(const cv::Mat& clusters, const cv::Mat& labels) {
  Overlaps overlaps;
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int label = labels.at<uint16_t>(v, u);
      if (label == 0) continue;
      const int object = label < 20 ? 0 : label / 10 * 10;
      const int cluster = clusters.at<uint16_t>(v, u);
      if (object > 0) overlaps.of_object[object] += 1;
      if (cluster > 0) overlaps.of_cluster[cluster] += 1;
      if (object > 0 && cluster > 0) overlaps.shared[cluster][object] += 1;
    }
  return overlaps;
}

/// The object that a cluster is; 0 = none.
int object_of(const Overlaps& overlaps, int cluster) {
  const auto shared = overlaps.shared.find(cluster);
  if (shared == overlaps.shared.end()) return 0;
  for (const auto& [object, both] : shared->second)
    if (both >= 0.5 * (overlaps.of_object.at(object) + overlaps.of_cluster.at(cluster) - both)) return object;
  return 0;
}

}  // namespace

cv::Mat label_image(const types::SceneCas& scene, const std::vector<int>& numbers) {
  const cv::Mat depth = types::view_image(scene, types::SceneCas::kDepth);
  cv::Mat labels = cv::Mat::zeros(depth.size(), CV_16U);
  const std::vector<types::Cluster> clusters = scene.clusters();
  for (size_t i = 0; i < clusters.size(); ++i) {
    const int number = numbers.empty() ? static_cast<int>(i) + 1 : numbers.at(i);
    for (const int32_t index : cluster_indices(clusters[i]))
      labels.ptr<uint16_t>()[index] = static_cast<uint16_t>(number);
  }
  return labels;
}

std::vector<int> tracked_numbers(const types::SceneCas& scene) {
  std::vector<int> numbers;
  for (const types::Cluster& cluster : scene.clusters()) {
    int& number = numbers.emplace_back(0);
    for (const types::Annotation& annotation : cluster.annotations)
      if (const auto tracking = types::try_as<types::TrackingAnnotation>(annotation))
        if (tracking->annotator_id.get() == tracking->source.get())  // others are votes of simple trackers
          number = static_cast<int>(tracking->tracking_id.get());
  }
  return numbers;
}

std::string class_of(const types::Cluster& cluster) {
  types::ClassificationAnnotation best;
  for (const auto& one : cluster.annotations.filter<types::ClassificationAnnotation>())
    if (one.kind.get() == "object" && !one.label.get().empty() &&
        (!best || one.confidence.get() > best.confidence.get()))
      best = one;
  return best ? best.label.get() : std::string();
}

void write_label_image(const types::SceneCas& scene, const std::filesystem::path& folder,
                       const std::vector<int>& numbers) {
  mapping::write_image(folder / (scene.scene().frame_name.get() + "_label.png"), label_image(scene, numbers));
}

void write_overlay(const types::SceneCas& scene, const std::filesystem::path& folder, bool keep_people) {
  if (!scene.has(types::SceneCas::kColor)) return;
  cv::Mat image = types::view_image(scene, types::SceneCas::kColor).clone();
  if (!keep_people) anonymise(image, types::heads_of_people(scene.scene()));
  int number = 0;
  for (const types::Cluster& cluster : scene.clusters()) {
    const cv::Scalar& color = kPalette[static_cast<size_t>(number++) % kPalette.size()];
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Rect box = types::from<cv::Rect>(roi.roi.get());
    cv::Mat part = image(box);
    cv::Mat tinted(part.size(), part.type(), color);
    cv::addWeighted(part, 0.5, tinted, 0.5, 0, tinted);
    tinted.copyTo(part, types::from<cv::Mat>(roi.mask.get()));
    cv::rectangle(image, box, color);
    const std::string name = class_of(cluster);
    cv::putText(image, std::to_string(number) + (name.empty() ? "" : " " + name), box.tl() + cv::Point(2, 14),
                cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  }
  mapping::write_image(folder / (std::to_string(scene.scene().frame_index.get()) + ".png"), image);
}

std::map<std::string, fs::path> find_label_images(const fs::path& folder) {
  constexpr std::string_view kEnding = "_label.png";
  std::map<std::string, fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::string name = entry.path().filename().string();
    if (!name.ends_with(kEnding)) continue;
    name.resize(name.size() - kEnding.size());
    files[name] = entry.path();
  }
  return files;
}

cv::Mat read_label_image(const fs::path& path) {
  const std::string text = read_file(path);
  cv::Mat raw = mapping::decode_image(std::vector<unsigned char>(text.begin(), text.end()), path.string());
  if (raw.channels() != 1)
    throw Error("a label image has one channel", {path.string(), 0, {}},
                "labels: 0 not judged, 1 to 19 table, from 20 on tens are objects");
  raw.convertTo(raw, CV_16U);
  return raw;
}

int64_t scene_number(const std::string& frame_name) {
  const size_t last = frame_name.find_last_of("0123456789");
  if (last == std::string::npos) return -1;
  size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(frame_name[first - 1]))) --first;
  return last - first > 15 ? -1 : std::stoll(frame_name.substr(first, last - first + 1));
}

namespace {

/// Without classes.
LabelledRecording open_label_images(const fs::path& folder) {
  LabelledRecording labelled;
  labelled.recording = mapping::open_recording(folder);
  const auto images = find_label_images(folder);
  if (images.empty())
    throw Error("there are no labels", {folder.string(), 0, {}},
                "FRAME_label.png belongs beside FRAME_depth.png");
  labelled.labels = [images](const std::string& frame) {
    const auto found = images.find(frame);
    return found == images.end() ? cv::Mat() : read_label_image(found->second);
  };
  return labelled;
}

}  // namespace

LabelledRecording open_labelled_recording(const fs::path& folder) {
  LabelledRecording labelled = open_label_images(folder);
  const CsvTable table = CsvTable::read(folder / "objects.csv");
  const size_t scene = table.require_column("scene"), group = table.require_column("label_group");
  const int own = table.column("class");
  const size_t name = own >= 0 ? static_cast<size_t>(own) : table.require_column("object");
  std::map<std::pair<int64_t, int64_t>, std::string> classes;
  for (size_t row = 0; row < table.rows(); ++row)
    classes[{table.integer(row, scene), table.integer(row, group)}] = table.cell(row, name);
  labelled.class_of = [classes](const std::string& frame, int object) {
    const auto found = classes.find({scene_number(frame), object});
    return found == classes.end() ? std::string() : found->second;
  };
  return labelled;
}

LabelledRecording open_labelled_recording_by_scene(
    const fs::path& folder,
    const std::function<std::string(const std::string& category)>& class_of_category) {
  LabelledRecording labelled = open_label_images(folder);
  const CsvTable table = CsvTable::read(folder / "scenes.csv");
  const size_t scene = table.require_column("scene"), category = table.require_column("category");
  std::map<int64_t, std::string> classes;
  for (size_t row = 0; row < table.rows(); ++row)
    classes[table.integer(row, scene)] = class_of_category(table.cell(row, category));
  labelled.class_of = [classes](const std::string& frame, int) {
    const auto found = classes.find(scene_number(frame));
    return found == classes.end() ? std::string() : found->second;
  };
  return labelled;
}

std::vector<LabelledPart> labelled_parts(const LabelledRecording& labelled, const std::string& frame) {
  const cv::Mat labels = labelled.labels(frame);
  std::set<int> objects;
  for (const uint16_t label : cv::Mat_<uint16_t>(labels))
    if (label >= 20) objects.insert(label / 10 * 10);
  std::vector<LabelledPart> parts;
  for (const int object : objects)
    if (const std::string name = labelled.class_of(frame, object); !name.empty())
      parts.push_back({name, (labels >= object) & (labels < object + 10)});
  return parts;
}

LabelledSurfaces labelled_surfaces(const LabelledRecording& labelled, Progress& progress, Warnings& warnings,
                                   const std::string& flow) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  Pipeline pipeline =
      Pipeline::parse("reader: RecordingReader\nflow: " + flow + "\n", "the tabletop pipeline", registry);
  Resources resources;
  resources.put(labelled.recording);
  Context context{resources, warnings, 1, {}};
  LabelledSurfaces surfaces;
  pipeline.run(context, types::type_system(), progress, [&](cas::Cas& cas) {
    const types::SceneCas scene(cas);
    const std::string frame = scene.scene().frame_name.get();
    const cv::Mat labels = labelled.labels(frame);
    if (labels.empty()) return;
    const cv::Mat numbers = label_image(scene);
    if (labels.size() != numbers.size())
      throw Error("the label image of frame " + frame + " is not as large as its depth image");
    const Overlaps overlaps = overlaps_of(numbers, labels);
    for (const auto& [object, pixels] : overlaps.of_object)
      surfaces.objects += labelled.class_of(frame, object).empty() ? 0 : 1;
    const std::vector<types::Cluster> clusters = scene.clusters();
    for (size_t i = 0; i < clusters.size(); ++i) {
      const int object = object_of(overlaps, static_cast<int>(i) + 1);
      const std::string name = object > 0 ? labelled.class_of(frame, object) : "";
      if (!name.empty())
        surfaces.found.push_back(
            {frame, name, object, cluster_view(scene, clusters[i]), cluster_ground(scene, clusters[i])});
    }
  });
  return surfaces;
}

}  // namespace loci::perception
