#include "memory/exchange/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/csv.h"
#include "mapping/base/json.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "memory/edits/edits.h"
#include "memory/exchange/observation_image.h"
#include "memory/store/depth_thumbnail.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

/// Objects are tens from here on in a label image; what is below is none (perception's labelled
/// recordings).
constexpr int64_t kFirstLabel = 20;
constexpr int64_t kMaxThings = (65535 - kFirstLabel) / 10;

mapping::PinholeCamera scaled(const SceneCamera& camera, int width, int height) {
  const double x = double(width) / camera.width, y = double(height) / camera.height;
  // Pixel centres are at integers, so edges are at -0.5 and scale with the image.
  return {
      width, height, camera.fx * x, camera.fy * y, (camera.cx + 0.5) * x - 0.5, (camera.cy + 0.5) * y - 0.5};
}

cv::Mat image(const Store& store, Id blob) {
  const std::string bytes = store.blob(blob).bytes;
  return mapping::decode_image({bytes.begin(), bytes.end()}, store.path().string());
}

/// The frame as far as the memory has it.
std::optional<mapping::RgbdFrame> remembered_frame(const Store& store, const SceneRow& scene) {
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

/// The recording that comes to be, with its tables.
class Dataset {
 public:
  Dataset(const Store& store, const fs::path& folder, const DatasetOptions& options)
      : store_(store), folder_(folder), options_(options) {}

  void add(const SceneRow& scene) {
    std::optional<mapping::RgbdFrame> frame =
        options_.frame_of ? options_.frame_of(scene) : remembered_frame(store_, scene);
    const std::vector<Thing> things = frame ? things_in(scene, frame->depth.size()) : std::vector<Thing>{};
    if (things.empty() || (writer_ && frame->camera.depth != camera_.depth)) {
      ++result_.left_out;
      return;
    }
    if (!writer_) {
      camera_ = frame->camera;
      writer_ =
          std::make_unique<mapping::RecordingWriter>(folder_, frame->camera, scene.map ? "map" : "world");
    }
    frame->index = scene.id;
    frame->time_ns = scene.time;
    const cv::Size color(camera_.color.width, camera_.color.height);  // one for all images of a recording
    if (!frame->color.empty() && frame->color.size() != color) cv::resize(frame->color, frame->color, color);
    writer_->add(*frame);
    cv::Mat labels = cv::Mat::zeros(frame->depth.size(), CV_16U);
    for (size_t i = 0; i < things.size(); ++i) add_thing(scene, things[i], label_of_thing(i), labels);
    add_image(fmt::format("frames/{:06}_label.png", scene.id), labels);
    ++result_.scenes;
  }

  DatasetResult finish() {
    if (!writer_)
      throw Error("nothing of this memory can be made a dataset", {store_.path().string(), 0, {}},
                  "scenes need depth, and observations that are objects need masks");
    writer_->add_file("objects.csv",
                      "scene,label_group,class,said_by,object,observation,place,color,size_x,"
                      "size_y,size_z,crop,mask\n" +
                          table_);
    writer_->finish();
    return result_;
  }

 private:
  struct Thing {
    ObservationRow row;
    Id object = 0;
    cv::Mat mask;  ///< of the depth image
  };

  static int64_t label_of_thing(size_t i) { return kFirstLabel + 10 * static_cast<int64_t>(i); }

  std::vector<Thing> things_in(const SceneRow& scene, const cv::Size& size) {
    std::vector<Thing> things;
    for (const AssociationRow& row : store_.associations(scene.id)) {
      if (!row.chosen || !row.object || !row.observation || row.probability <= 0) continue;
      Thing thing{store_.observation(*row.observation), *row.object, {}};
      const cv::Mat mask = mask_of(store_, scene, thing.row);
      if (mask.empty() || int64_t(things.size()) >= kMaxThings) continue;
      cv::resize(mask, thing.mask, size, 0, 0, cv::INTER_NEAREST);
      if (cv::countNonZero(thing.mask) > 0) things.push_back(std::move(thing));
    }
    return things;
  }

  void add_thing(const SceneRow& scene, const Thing& thing, int64_t label, cv::Mat& labels) {
    labels.setTo(static_cast<double>(label), thing.mask);
    const SaidClass said = options_.by_object ? SaidClass{object_name(thing.object), "object"}
                                              : class_of(store_, thing.row, thing.object);
    const std::string stem = fmt::format("crops/{}/{}_scene_{:06}_{}", path_part(said.name),
                                         object_name(thing.object), scene.id, thing.row.number);
    const std::string crop = add_blob(stem, thing.row.crop), mask = add_blob(stem + "_mask", thing.row.mask);
    const auto size = [&](int axis) {
      return thing.row.size ? fmt::format("{:.4f}", (*thing.row.size)[axis]) : std::string();
    };
    table_ += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", scene.id, label, csv_cell(said.name),
                          said.by, object_name(thing.object), thing.row.number, csv_cell(place(thing.row)),
                          csv_cell(thing.row.color.value_or("")), size(0), size(1), size(2), crop, mask);
    ++result_.things;
    ++result_.classes[said.name];
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
    const std::string name = stem + (blob.media == "image/png" ? ".png" : ".jpg");
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
  std::string table_;
  DatasetResult result_;
};

}  // namespace

SaidClass class_of(const Store& store, const ObservationRow& observation, Id object) {
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
  std::string text = fmt::format("{} things in {} scenes", things, scenes);
  if (left_out > 0)
    text +=
        fmt::format("; {} scenes left out (nothing of depth or masks is kept, or another camera)", left_out);
  for (const auto& [name, count] : classes)
    text += fmt::format("\n  {:20} {:5}", name.empty() ? "(nobody says what)" : name, count);
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
          {"things", things},
          {"left_out", left_out},
          {"unnamed", unknown},
          {"classes", named}};
}

}  // namespace loci::memory
