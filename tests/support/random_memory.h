#pragma once

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "mapping/image/image_io.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"

namespace loci::testing_support {

/// A small random memory, and the truth about it. A camera looks straight down at one of two tables; cubes of
/// their own colours and texts stand on them, are moved now and then, and are detected in most scenes that
/// show them. Colour images, depth thumbnails, crops and masks show every cube, detected or not.
class RandomMemory {
 public:
  static constexpr int kWidth = 160, kHeight = 128;
  static constexpr double kFocal = 146, kSide = 0.08, kTop = 0.83, kCamera = 2.75;
  static constexpr TimeNs kStart = 1'777'600'000 * kSecond;

  struct Cube {
    memory::Id object = 0;  ///< 0 = not detected yet
    cv::Scalar color = {};
    std::string mark = {};  ///< a text that only it has
    int table = 0;
    Vector2d at = {0, 0};
  };
  struct Sight {
    memory::Id scene = 0;
    cv::Rect pixels = {};
    bool detected = false;
  };

  /// How the same day was perceived.
  struct Perception {
    int every = 1;                ///< scenes are processed
    bool backwards = false;       ///< observations are numbered from the last to the first
    int confused_from = 1 << 20;  ///< from this scene on two cubes are taken for each other
    TimeNs now = kStart;          ///< transaction time
  };

  RandomMemory(const std::filesystem::path& file, unsigned seed, int cube_count = 5, int scene_count = 14)
      : RandomMemory(file, seed, cube_count, scene_count, Perception()) {}
  RandomMemory(const std::filesystem::path& file, unsigned seed, int cube_count, int scene_count,
               const Perception& perception)
      : perception_(perception), random_(seed) {
    memory::Store store = memory::Store::open_write(file, {.now = perception.now});
    run_ = store.begin_run("loci-perceive run", "{}");
    recording_ =
        store.add_recording({.fingerprint = "random" + std::to_string(seed), .name = "day", .kind = "loci"});
    for (const int table : {0, 1}) {
      const double x = 3.0 * table;
      tables_.push_back(
          store.add_place({.name = "table_" + std::to_string(table + 1),
                           .class_name = "table",
                           .height = 0.75,
                           .outline = {{x - 0.5, -0.4}, {x + 0.5, -0.4}, {x + 0.5, 0.4}, {x - 0.5, 0.4}}},
                          run_));
    }
    for (int i = 0; i < cube_count; ++i) {
      cubes.push_back({.color = cv::Scalar(draw(40, 255), draw(40, 255), draw(40, 255)),
                       .mark = "mark" + std::to_string(1000 * (i + 1)) + std::to_string(int(draw(0, 999)))});
      put(cubes.back());
    }
    for (int i = 0; i < scene_count; ++i) add_scene(store, i);
    store.finish_run(run_);
  }

  std::vector<Cube> cubes;
  std::map<std::string, std::vector<Sight>> sights;  ///< by the mark of the cube

  double draw(double from, double to) { return std::uniform_real_distribution(from, to)(random_); }

 private:
  struct Detection {
    Cube* cube;
    bool detected;
    Vector2d offset = {0, 0};  ///< of the measured position
  };

  /// At a free spot.
  void put(Cube& cube) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      cube.table = draw(0, 1) < 0.5 ? 0 : 1;
      cube.at = {3.0 * cube.table + draw(-0.4, 0.4), draw(-0.3, 0.3)};
      bool free = true;
      for (const Cube& other : cubes)
        free = free && (&other == &cube || (other.at - cube.at).cwiseAbs().maxCoeff() > 0.22);
      if (free) return;
    }
  }

  static Isometry3d pose(int table) {
    Isometry3d map_from_camera = Isometry3d::Identity();
    map_from_camera.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    map_from_camera.translation() = Vector3d(3.0 * table, 0, kCamera);
    return map_from_camera;
  }

  static cv::Rect pixels_of(const Cube& cube) {
    const double z = kCamera - kTop, u = kFocal * (cube.at.x() - 3.0 * cube.table) / z + kWidth / 2.0,
                 v = -kFocal * cube.at.y() / z + kHeight / 2.0, half = kFocal * kSide / 2 / z;
    return {int(u - half), int(v - half), int(2 * half), int(2 * half)};
  }

  void add_scene(memory::Store& store, int number) {
    for (Cube& cube : cubes)
      if (draw(0, 1) < 0.12) put(cube);
    if (number == perception_.confused_from) std::swap(cubes.front().object, cubes.back().object);
    const int table = draw(0, 1) < 0.5 ? 0 : 1;
    cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 200, 200)),
        depth(kHeight, kWidth, CV_32F, cv::Scalar(2.0));
    for (const Cube& cube : cubes) {
      if (cube.table != table) continue;
      const cv::Rect pixels = pixels_of(cube);
      cv::rectangle(image, pixels, cube.color, cv::FILLED);
      cv::circle(image, {pixels.x + pixels.width / 2, pixels.y + pixels.height / 2}, 1, cv::Scalar::all(0),
                 cv::FILLED);
      depth(pixels).setTo(kCamera - kTop);
    }
    std::vector<float> thumbnail;
    for (int v = 0; v < kHeight; v += 2)
      for (int u = 0; u < kWidth; u += 2) thumbnail.push_back(depth.at<float>(v, u));

    std::vector<Detection> detections;
    for (Cube& cube : cubes) {
      if (cube.table != table) continue;
      Detection one{&cube, draw(0, 1) < 0.75};
      if (one.detected) one.offset = {draw(-1e-3, 1e-3), draw(-1e-3, 1e-3)};
      detections.push_back(one);
    }
    if (number % perception_.every != 0) return;

    memory::SceneTransaction scene(store, run_);
    const memory::Id id = scene.add_scene(
        {.recording = recording_,
         .frame_index = number,
         .time = kStart + number * 600 * kSecond,
         .camera =
             memory::SceneCamera{kWidth, kHeight, kFocal, kFocal, kWidth / 2.0, kHeight / 2.0, 0.3, 5.0},
         .map_from_camera = pose(table),
         .depth = scene.add_blob(memory::encode_depth_thumbnail(thumbnail), memory::kDepthThumbnailMedia),
         .depth_width = kWidth / 2,
         .depth_height = kHeight / 2,
         .image = blob(scene, image)});
    scene.add_visibility({.scene = id,
                          .place = tables_[size_t(table)],
                          .status = memory::ObjectStatus::seen,
                          .fraction = 0.9});
    if (perception_.backwards) std::ranges::reverse(detections);
    int64_t seen = 0;
    for (const Detection& one : detections) {
      sights[one.cube->mark].push_back({id, pixels_of(*one.cube), one.detected});
      if (one.detected) observe(scene, id, seen++, one, image);
    }
    scene.commit();
  }

  static memory::Id blob(memory::SceneTransaction& scene, const cv::Mat& image) {
    const auto png = mapping::encode_image(image, ".png");
    return scene.add_blob({reinterpret_cast<const char*>(png.data()), png.size()}, "image/png");
  }

  void observe(memory::SceneTransaction& scene, memory::Id id, int64_t number, const Detection& detection,
               const cv::Mat& image) {
    using namespace memory;
    Cube& cube = *detection.cube;
    const cv::Rect roi = pixels_of(cube);
    const Vector3d at(cube.at.x() + detection.offset.x(), cube.at.y() + detection.offset.y(),
                      kTop - kSide / 2);
    const Id place = tables_[size_t(cube.table)];
    const bool is_new = cube.object == 0;
    const Id seen = scene.add_observation({.scene = id,
                                           .number = number,
                                           .place = place,
                                           .position = at,
                                           .size = Vector3d::Constant(kSide),
                                           .crop = blob(scene, image(roi)),
                                           .mask = blob(scene, cv::Mat(roi.size(), CV_8U, cv::Scalar(255))),
                                           .roi = std::array<int, 4>{roi.x, roi.y, roi.width, roi.height}});
    if (is_new) cube.object = scene.add_object({});
    scene.add_annotation({.scene = id, .observation = seen, .type = "loci.Text", .value = cube.mark});
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = cube.object,
                           .explanation = is_new ? Explanation::appear : Explanation::move,
                           .probability = 0.9,
                           .chosen = true});
    scene.add_belief({.object = cube.object,
                      .scene = id,
                      .status = ObjectStatus::seen,
                      .place = place,
                      .position = at,
                      .last_scene = id,
                      .last_observation = seen,
                      .size = Vector3d::Constant(kSide)});
    scene.add_event({.scene = id,
                     .kind = is_new ? EventKind::appeared : EventKind::moved,
                     .object = cube.object,
                     .observation = seen,
                     .place = place,
                     .position = at});
  }

  const Perception perception_;
  std::mt19937 random_;
  memory::Id run_ = 0, recording_ = 0;
  std::vector<memory::Id> tables_;
};

}  // namespace loci::testing_support
