// What is forgotten is not left as a hole's shape either: its depth is gone, that of the others stays.

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "memory/store/erasure/erased_images.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "memory/store/store.h"
#include "perception/types/scene_cas.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

class ForgetDepth : public testing_support::TemporaryFolder {
 protected:
  static constexpr int kWidth = 80, kHeight = 60;  // of the thumbnail; the camera has eight times as many

  static std::vector<float> ramp() {
    std::vector<float> depth;
    for (int i = 0; i < kWidth * kHeight; ++i) depth.push_back(1.0F + 0.001F * static_cast<float>(i));
    return depth;
  }

  /// Two objects: the first at columns 20 to 29 and rows 10 to 19 of the thumbnail, the second with or
  /// without a region.
  void make(bool with_region) {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    const Id blob = scene.add_blob(encode_depth_thumbnail(ramp()), kDepthThumbnailMedia);
    const Id id = scene.add_scene({.time = 1000,
                                   .camera = SceneCamera{640, 480, 585, 585, 319.5, 239.5, 0.5, 5.0},
                                   .map_from_camera = Isometry3d::Identity(),
                                   .depth = blob,
                                   .depth_width = kWidth,
                                   .depth_height = kHeight});
    for (const int number : {0, 1}) {
      ObservationRow row{.scene = id, .number = number};
      if (with_region || number == 1) row.roi = {160 + 240 * number, 80, 80, 80};
      const Id seen = scene.add_observation(row);
      const Id object = scene.add_object({});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = object,
                             .explanation = Explanation::appear,
                             .probability = 1,
                             .chosen = true});
      scene.add_belief({.object = object, .scene = id, .status = ObjectStatus::seen, .last_scene = id});
    }
    scene.commit();
  }

  void forget_first() {
    Store store = Store::open_write(file_);
    store.forget({.object = 1}, store.begin_run("test", "{}"));
  }
};

TEST_F(ForgetDepth, CutsTheObjectOutAndKeepsTheRest) {
  make(true);
  forget_first();
  const Store store = Store::open_read(file_);
  const auto thumbnail = DepthThumbnail::of(store, store.scene(1));
  ASSERT_TRUE(thumbnail.has_value());
  const std::vector<float> before = ramp();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const auto i = static_cast<size_t>(y * kWidth + x);
      const bool object = x >= 20 && x < 30 && y >= 10 && y < 20;
      const bool near = x >= 18 && x < 32 && y >= 8 && y < 22;
      if (object) {
        EXPECT_EQ(thumbnail->depth()[i], 0) << x << " " << y;
      } else if (!near) {
        EXPECT_NEAR(thumbnail->depth()[i], before[i], 0.0006F) << x << " " << y;
      }
    }
  NoProgress silent;
  EXPECT_THAT(store.verify(silent).problems, testing::IsEmpty());
}

TEST_F(ForgetDepth, LeavesNoBytesOfTheOldThumbnailInTheFile) {
  make(true);
  const std::string row = encode_depth_thumbnail(ramp()).substr(2 * (12 * kWidth + 20), 20);
  forget_first();
  const Store store = Store::open_read(file_);
  EXPECT_EQ(store.blob(*store.scene(1).depth).bytes.find(row), std::string::npos);
  const auto sizes = store.statistics(false);
  const auto blobs = std::ranges::find(sizes, "blob", &Store::TableSize::table);
  EXPECT_EQ(blobs->rows, 1);
}

TEST_F(ForgetDepth, DropsTheThumbnailWhereNobodyKnowsWhereTheObjectWas) {
  make(false);
  forget_first();
  const Store store = Store::open_read(file_);
  EXPECT_FALSE(store.scene(1).depth.has_value());
  NoProgress silent;
  EXPECT_THAT(store.verify(silent).problems, testing::IsEmpty());
}

/// A box at 2 m whose object is observed in the first scene; then a door stands before it.
class ForgetImages : public testing_support::TemporaryFolder {
 protected:
  static constexpr int kWidth = 80, kHeight = 60;

  /// 640 x 480, brighter from left to right, or from top to bottom.
  static cv::Mat image_of(bool object) {
    cv::Mat image(480, 640, CV_8UC3);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        image.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<uint8_t>(object ? x / 3 : y / 2));
    return image;
  }

  Id add_scene(SceneTransaction& scene, TimeNs time, float depth_m, const cv::Mat& image,
               const char* ending = ".png") {
    const auto bytes = mapping::encode_image(image, ending);
    const Id color = scene.add_blob({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                    ending == std::string(".png") ? "image/png" : "image/jpeg");
    const Id depth = scene.add_blob(encode_depth_thumbnail(std::vector<float>(kWidth * kHeight, depth_m)),
                                    kDepthThumbnailMedia);
    return scene.add_scene({.time = time,
                            .camera = SceneCamera{640, 480, 585, 585, 319.5, 239.5, 0.5, 5.0},
                            .map_from_camera = Isometry3d::Identity(),
                            .depth = depth,
                            .depth_width = kWidth,
                            .depth_height = kHeight,
                            .image = color});
  }

  ForgottenTokens forget_object() {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    SceneTransaction first(store, run);
    const Id scene = add_scene(first, 1000, 2.0F, image_of(true));
    const Id seen = first.add_observation({.scene = scene,
                                           .position = Vector3d(0, 0, 2),
                                           .size = Vector3d(0.3, 0.3, 0.3),
                                           .roi = std::array{270, 190, 100, 100}});
    const Id object = first.add_object({});
    first.add_association({.scene = scene,
                           .observation = seen,
                           .object = object,
                           .explanation = Explanation::appear,
                           .probability = 1,
                           .chosen = true});
    first.add_belief({.object = object, .scene = scene, .status = ObjectStatus::seen, .last_scene = scene});
    first.commit();
    // The depth of a door within the box may be that of the object: it is cut out. One nearer is a door.
    for (const auto& [time, depth_m] : {std::pair{2000, 1.95F}, {3000, 1.0F}}) {
      SceneTransaction next(store, run);
      add_scene(next, time, depth_m, image_of(false));
      next.commit();
    }
    return store.forget({.object = object}, run).tokens;
  }

  std::vector<std::string> left(const ForgottenTokens& tokens) {
    NoProgress silent;
    return find_forgotten(file_, tokens, silent);
  }
};

TEST_F(ForgetImages, ADoorThatHidTheObjectProvesNothing) {
  const ForgottenTokens tokens = forget_object();
  EXPECT_FALSE(tokens.images.empty());
  EXPECT_THAT(left(tokens), testing::IsEmpty());
}

TEST_F(ForgetImages, AnImageThatShowsTheObjectIsFound) {
  const ForgottenTokens tokens = forget_object();
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    add_scene(scene, 4000, 1.0F, image_of(true), ".jpg");
    scene.commit();
  }
  EXPECT_THAT(left(tokens), testing::ElementsAre(testing::HasSubstr("the image of scene 4, of 1970-01-01")));
}

/// A box at 2 m that the depth image shows in part, at its right border, then another before it, then again
/// the box. The colour camera has a wider field of view.
class ForgetAtBorder : public testing_support::TemporaryFolder {
 protected:
  static constexpr int kWidth = 640, kHeight = 480;
  static constexpr double kDepthFocal = 585, kColorFocal = 480;
  static inline const Vector3d kBox{0.3, 0.3, 0.3};

  /// The columns of the colour image that show something of x, at 2 m.
  static int column(double x) { return static_cast<int>(kColorFocal * x / 2 + 319.5); }

  /// A scene that shows the box from `left` m on, white on black; `distance_m` of all that is measured.
  Id add_scene(SceneTransaction& scene, TimeNs time, double left, float distance_m) {
    cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar::all(0));
    const int first = column(left), last = column(left + kBox.x());
    image(cv::Rect(first, 200, last - first, 80)).setTo(cv::Scalar::all(255));
    const auto bytes = mapping::encode_image(image, ".png");
    const Id id = scene.add_scene(
        {.time = time,
         .camera = SceneCamera{kWidth, kHeight, kDepthFocal, kDepthFocal, 319.5, 239.5, 0.5, 5.0},
         .map_from_camera = Isometry3d::Identity(),
         .depth = scene.add_blob(encode_depth_thumbnail(std::vector<float>(80 * 60, distance_m)),
                                 kDepthThumbnailMedia),
         .depth_width = 80,
         .depth_height = 60,
         .image = scene.add_blob({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "image/png")});
    perception::cas::Cas cas(perception::types::type_system());
    const auto camera = perception::types::CameraInfo::create(cas);
    camera.name.set("color");
    camera.width.set(kWidth);
    camera.height.set(kHeight);
    camera.fx.set(kColorFocal);
    camera.fy.set(kColorFocal);
    camera.cx.set(319.5);
    camera.cy.set(239.5);
    FeatureStructureWriter(scene, id).add(camera);
    return id;
  }

  void observe(SceneTransaction& scene, Id id, Id object, const Vector3d& at, const Vector3d& size,
               const std::array<int, 4>& roi) {
    const Id seen =
        scene.add_observation({.scene = id, .number = 0, .position = at, .size = size, .roi = roi});
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = object,
                           .explanation = Explanation::stay,
                           .probability = 1,
                           .chosen = true});
    scene.add_belief({.object = object, .scene = id, .status = ObjectStatus::seen, .last_scene = id});
  }

  size_t white_pixels(Id scene) {
    const Store store = Store::open_read(file_);
    const std::optional<cv::Mat> image = stored_image(store, store.scene(scene));
    cv::Mat white;
    cv::inRange(*image, cv::Scalar::all(128), cv::Scalar::all(255), white);
    return static_cast<size_t>(cv::countNonZero(white));
  }
};

TEST_F(ForgetAtBorder, WhatOnlyTheColourImageShowsIsCutToo) {
  // The depth image ends at x = 1.09 m.
  Store store = Store::open_write(file_);
  const Id run = store.begin_run("test", "{}");
  Id object = 0;
  for (const auto& [time, left] : {std::pair{1000, 0.0}, {2000, 1.0}}) {
    SceneTransaction scene(store, run);
    if (object == 0) object = scene.add_object({});
    const Id id = add_scene(scene, time, left, 2.0F);
    const double right = std::min(left + kBox.x(), 1.09);
    const int first = static_cast<int>(kDepthFocal * left / 2 + 319.5),
              last = static_cast<int>(kDepthFocal * right / 2 + 319.5);
    observe(scene, id, object, {(left + right) / 2, 0, 2}, {right - left, 0.3, 0.3},
            {first, 200, last - first, 80});
    scene.commit();
  }
  store.forget({.object = object}, run);
  EXPECT_EQ(white_pixels(1), 0U);
  EXPECT_EQ(white_pixels(2), 0U) << "the part of it beyond the depth image";
}

TEST_F(ForgetAtBorder, WhereItIsBelievedToStandBehindAnotherItIsCut) {
  Store store = Store::open_write(file_);
  const Id run = store.begin_run("test", "{}");
  Id object = 0;
  for (const auto& [time, distance_m] : {std::pair{1000, 2.0F}, {2000, 1.0F}, {3000, 2.0F}}) {
    SceneTransaction scene(store, run);
    if (object == 0) object = scene.add_object({});
    const Id id = add_scene(scene, time, 0, distance_m);
    if (distance_m == 2.0F) observe(scene, id, object, {0.15, 0, 2}, kBox, {320, 200, 87, 80});
    scene.commit();
  }
  store.forget({.object = object}, run);
  for (const Id scene : {1, 2, 3}) EXPECT_EQ(white_pixels(scene), 0U) << scene;
}

TEST_F(ForgetAtBorder, WhatStandsAtItsSpotWhileItIsElsewhereStays) {
  Store store = Store::open_write(file_);
  const Id run = store.begin_run("test", "{}");
  const double away = -0.8;
  Id object = 0;
  // At its spot, elsewhere, unseen with another before its spot, and at its spot again.
  for (const auto& [time, left] : {std::pair{1000, std::optional(0.0)},
                                   {2000, std::optional(away)},
                                   {3000, std::optional<double>()},
                                   {4000, std::optional(0.0)}}) {
    SceneTransaction scene(store, run);
    if (object == 0) object = scene.add_object({});
    const Id id = add_scene(scene, time, left.value_or(0), left ? 2.0F : 1.0F);
    const int first = static_cast<int>(kDepthFocal * left.value_or(0) / 2 + 319.5);
    if (left) observe(scene, id, object, {*left + 0.15, 0, 2}, kBox, {first, 200, 87, 80});
    scene.commit();
  }
  store.forget({.object = object}, run);
  for (const Id scene : {1, 2, 4}) EXPECT_EQ(white_pixels(scene), 0U) << scene;
  EXPECT_GT(white_pixels(3), 0U) << "another stands there";
}

}  // namespace
}  // namespace loci::memory
