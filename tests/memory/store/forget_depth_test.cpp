// What is forgotten is not left as a hole's shape either: its depth is gone, that of the others stays.

#include <gmock/gmock.h>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "memory/store/store.h"
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

}  // namespace
}  // namespace loci::memory
