#include "memory/exchange/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "memory/edits/edits.h"
#include "memory/exchange/observation_image.h"
#include "memory/store/scene_images.h"
#include "perception/detection/people_detector.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

/// Objects are tens from here on in a label image; what is below is none (perception's labelled
/// recordings).
constexpr int64_t kFirstLabel = 20;
constexpr int64_t kMaxObjects = (65535 - kFirstLabel) / 10;

mapping::PinholeCamera scaled(const SceneCamera& camera, int width, int height) {
  const double x = double(width) / camera.width, y = double(height) / camera.height;
  // Pixel centres are at integers, so edges are at -0.5 and scale with the image.
  return {
      width, height, camera.fx * x, camera.fy * y, (camera.cx + 0.5) * x - 0.5, (camera.cy + 0.5) * y - 0.5};
}

cv::Mat image(const Store& store, Id blob) {
  const std::string bytes = store.blob(blob).bytes;
  return mapping::decode_image({bytes.begin(), bytes.end()}, store.name());
}

/// The frame from the thumbnail and the image of a scene.
std::optional<mapping::RgbdFrame> stored_frame(const Store& store, const SceneRow& scene) {
  if (!scene.camera || !scene.depth) return std::nullopt;
  mapping::RgbdFrame frame;
  const std::vector<float> depth = decode_depth_thumbnail(store.blob(*scene.depth).bytes);
  if (depth.size() != size_t(scene.depth_width) * size_t(scene.depth_height)) return std::nullopt;
  frame.depth = cv::Mat(scene.depth_height, scene.depth_width, CV_32F);
  std::ranges::transform(depth, frame.depth.begin<float>(),
                         [](float z) { return z > 0 ? z : std::numeric_limits<float>::quiet_NaN(); });
  frame.camera.depth = scaled(*scene.camera, scene.depth_width, scene.depth_height);
  frame.camera.color = frame.camera.depth;
  if (scene.image) {
    frame.color = image(store, *scene.image);
    frame.camera.color = scaled(*scene.camera, frame.color.cols, frame.color.rows);
  }
  frame.map_from_camera = scene.map_from_camera;
  frame.joints = scene.joints;
  return frame;
}

/// Letters, digits, '-' and '_' of a name: what may be part of a path.
std::string path_part(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  return name.empty() ? "unknown" : name;
}

/// The recording that is written, with its tables.
class Dataset {
 public:
  Dataset(const Store& store, const fs::path& folder, const DatasetOptions& options)
      : store_(store), folder_(folder), options_(options) {}

  void add(const SceneRow& scene) {
    std::optional<mapping::RgbdFrame> frame =
        options_.frame_of ? options_.frame_of(scene) : stored_frame(store_, scene);
    const std::vector<LabelledObject> objects =
        frame ? objects_in(scene, frame->depth.size()) : std::vector<LabelledObject>{};
    if (objects.empty() || (writer_ && frame->camera.depth != camera_.depth)) {
      ++result_.left_out;
      return;
    }
    if (!writer_) {
      camera_ = frame->camera;
      writer_ = std::make_unique<mapping::RecordingWriter>(
          folder_, frame->camera, scene.map ? "map" : "world",
          mapping::RecordingWriterOptions{.inputs = options_.inputs});
    }
    frame->index = scene.id;
    if (scene.map_from_camera) frame->map_from_camera = scene.map_from_camera;
    frame->time_ns = scene.time;
    const cv::Size color(camera_.color.width, camera_.color.height);  // one for all images of a recording
    if (!options_.keep_people && options_.frame_of) perception::anonymise(*frame, people_);
    if (!frame->color.empty() && frame->color.size() != color) cv::resize(frame->color, frame->color, color);
    writer_->add(*frame);
    cv::Mat labels = cv::Mat::zeros(frame->depth.size(), CV_16U);
    for (size_t i = 0; i < objects.size(); ++i) add_object(scene, objects[i], label_of(i), labels);
    add_image(fmt::format("frames/{:06}_label.png", scene.id), labels);
    ++result_.scenes;
  }

  DatasetResult finish() {
    if (!writer_)
      throw Error("the memory has nothing for a dataset", {store_.name(), 0, {}},
                  "scenes need depth, and observations that are objects need masks");
    writer_->add_file("objects.csv",
                      "scene,label_group,class,said_by,object,observation,place,color,size_x,"
                      "size_y,size_z,crop,mask\n" +
                          table_);
    writer_->finish();
    return result_;
  }

 private:
  struct LabelledObject {
    ObservationRow row;
    Id id = 0;
    cv::Mat mask;  ///< of the depth image
  };

  static int64_t label_of(size_t i) { return kFirstLabel + 10 * static_cast<int64_t>(i); }

  std::vector<LabelledObject> objects_in(const SceneRow& scene, const cv::Size& size) {
    std::vector<LabelledObject> objects;
    for (const AssociationRow& row : store_.associations(scene.id)) {
      if (!row.chosen || !row.object || !row.observation || row.probability <= 0) continue;
      LabelledObject object{store_.observation(*row.observation), *row.object, {}};
      const cv::Mat mask = mask_of(store_, scene, object.row);
      if (mask.empty() || int64_t(objects.size()) >= kMaxObjects) continue;
      cv::resize(mask, object.mask, size, 0, 0, cv::INTER_NEAREST);
      if (cv::countNonZero(object.mask) > 0) objects.push_back(std::move(object));
    }
    return objects;
  }

  void add_object(const SceneRow& scene, const LabelledObject& object, int64_t label, cv::Mat& labels) {
    labels.setTo(static_cast<double>(label), object.mask);
    const ObjectClass stated = options_.by_object ? ObjectClass{object_name(object.id), "object"}
                                                  : class_of(store_, object.row, object.id);
    const std::string stem = fmt::format("crops/{}/{}_scene_{:06}_{}", path_part(stated.name),
                                         object_name(object.id), scene.id, object.row.number);
    const std::string crop = add_blob(stem, object.row.crop),
                      mask = add_blob(stem + "_mask", object.row.mask);
    const auto size = [&](int axis) {
      return object.row.size ? fmt::format("{:.4f}", (*object.row.size)[axis]) : std::string();
    };
    table_ += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", scene.id, label, csv_cell(stated.name),
                          stated.by, object_name(object.id), object.row.number, csv_cell(place(object.row)),
                          csv_cell(object.row.color.value_or("")), size(0), size(1), size(2), crop, mask);
    ++result_.objects;
    ++result_.classes[stated.name];
  }

  std::string place(const ObservationRow& row) const {
    for (const PlaceRow& place : places_)
      if (place.id == row.place) return place.name;
    return {};
  }

  /// The file's name; empty when there is no such blob.
  std::string add_blob(const std::string& stem, const std::optional<Id>& id) {
    if (!id) return {};
    const BlobRow blob = store_.blob(*id);
    std::string name = stem + (blob.media == "image/png" ? ".png" : ".jpg");
    writer_->add_file(name, blob.bytes);
    return name;
  }

  void add_image(const std::string& name, const cv::Mat& image) {
    const std::vector<unsigned char> bytes = mapping::encode_image(image, ".png");
    writer_->add_file(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  const Store& store_;
  fs::path folder_;
  const DatasetOptions& options_;
  std::vector<PlaceRow> places_ = store_.places();
  std::unique_ptr<mapping::RecordingWriter> writer_;
  mapping::RgbdCamera camera_;
  perception::PeopleDetector people_;
  std::string table_;
  DatasetResult result_;
};

}  // namespace

ObjectClass class_of(const Store& store, const ObservationRow& observation, Id object) {
  const std::string label = label_of(store, observation.scene, observation.id);
  if (!label.empty()) return {label, "label"};
  return class_of(store, object);
}

DatasetResult export_dataset(const Store& store, const fs::path& folder, const DatasetOptions& options,
                             Progress& progress) {
  Dataset dataset(store, folder, options);
  const std::vector<SceneRow> scenes = store.scenes();
  for (size_t i = 0; i < scenes.size(); ++i) {
    progress.check(double(i) / double(scenes.size()), "dataset");
    dataset.add(scenes[i]);
  }
  return dataset.finish();
}

std::string DatasetResult::summary() const {
  std::string text = fmt::format("{} in {}", counted(objects, "object"), counted(scenes, "scene"));
  if (left_out > 0)
    text += fmt::format("; {} left out (no depth or masks stored, or another camera)",
                        counted(left_out, "scene"));
  for (const auto& [name, count] : classes)
    text += fmt::format("\n  {:20} {:5}", name.empty() ? "(unknown)" : name, count);
  return text;
}

Json DatasetResult::report() const {
  Json named = Json::object();
  size_t unknown = 0;
  for (const auto& [name, count] : classes) {
    if (name.empty())
      unknown = count;
    else
      named[name] = count;
  }
  return {{"scenes", scenes},
          {"objects", objects},
          {"left_out", left_out},
          {"unnamed", unknown},
          {"classes", named}};
}

}  // namespace loci::memory
