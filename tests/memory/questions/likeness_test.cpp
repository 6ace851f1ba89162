#include "memory/questions/likeness.h"

#include <array>
#include <opencv2/core.hpp>

#include "mapping/image/image_io.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using Likeness = testing_support::TemporaryFolder;

cv::Mat colored(const cv::Scalar& bgr) {
  return cv::Mat(40, 30, CV_8UC3, bgr);
}

/// Object 1 and 2 are red, 3 is blue.
void remember_three(const std::filesystem::path& file) {
  Store store = Store::open_write(file, {.now = 1'900'000'000 * kSecond});
  const Id run = store.begin_run("test", "{}");
  SceneTransaction scene(store, run);
  const Id id = scene.add_scene({.time = testing_support::day_time("08:00")});
  const std::array<cv::Scalar, 3> colors = {cv::Scalar(20, 20, 200), {30, 25, 210}, {210, 40, 30}};
  for (size_t i = 0; i < colors.size(); ++i) {
    const auto bytes = mapping::encode_image(colored(colors[i]), ".png");
    const Id crop = scene.add_blob(std::string(bytes.begin(), bytes.end()), "image/png");
    const Id seen = scene.add_observation({.scene = id, .number = static_cast<int64_t>(i), .crop = crop});
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
  store.finish_run(run);
}

TEST_F(Likeness, OfAnObjectIsByItsImages) {
  remember_three(file_);
  const Store store = Store::open_read(file_);
  const LikeAnswer answer = ask(store, LikeQuestion{.subject = "object_1"});
  ASSERT_EQ(answer.objects.size(), 2U);
  EXPECT_EQ(answer.objects[0].object.object.id, 2);
  EXPECT_GT(answer.objects[0].likeness, 0.9);
  EXPECT_LT(answer.objects[1].likeness, 0.1);
}

TEST_F(Likeness, OfAImageIsTheSame) {
  remember_three(file_);
  const std::filesystem::path image = file_.parent_path() / "blue.png";
  mapping::write_image(image, colored({200, 45, 35}));
  const Store store = Store::open_read(file_);
  EXPECT_EQ(ask(store, LikeQuestion{.image = image}).objects.at(0).object.object.id, 3);
  EXPECT_THROW(ask(store, LikeQuestion{.image = "missing.png"}), Error);
}

}  // namespace
}  // namespace loci::memory
