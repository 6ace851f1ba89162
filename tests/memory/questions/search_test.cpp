#include "memory/questions/search.h"

#include <array>
#include <opencv2/core.hpp>

#include "mapping/image/image_io.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using SearchNext = testing_support::DayFixture;
using Similarity = testing_support::TemporaryFolder;

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

TEST_F(Similarity, OfAnObjectIsByItsCrops) {
  remember_three(file_);
  const Store store = Store::open_read(file_);
  const SimilarAnswer answer = ask(store, SimilarQuestion{.subject = "object_1"});
  ASSERT_EQ(answer.objects.size(), 2U);
  EXPECT_EQ(answer.objects[0].object.object.id, 2);
  EXPECT_GT(answer.objects[0].similarity, 0.9);
  EXPECT_LT(answer.objects[1].similarity, 0.1);
}

TEST_F(Similarity, OfAnImageIsTheSame) {
  remember_three(file_);
  const std::filesystem::path image = file_.parent_path() / "blue.png";
  mapping::write_image(image, colored({200, 45, 35}));
  const Store store = Store::open_read(file_);
  EXPECT_EQ(ask(store, SimilarQuestion{.image = image}).objects.at(0).object.object.id, 3);
  EXPECT_THROW(ask(store, SimilarQuestion{.image = "missing.png"}), Error);
}

TEST_F(SearchNext, StartsWhereItIsBelievedToBe) {
  const SearchAnswer answer = ask(*store_, SearchQuestion{.subject = "red"});
  ASSERT_EQ(answer.objects.size(), 1U);
  ASSERT_EQ(answer.objects[0].places.size(), 3U);
  EXPECT_EQ(answer.objects[0].places[0].place.name, "counter_1");
  EXPECT_NEAR(answer.objects[0].places[0].probability, 0.98, 1e-9);
  double sum = 0;
  for (const SearchPlace& place : answer.objects[0].places) sum += place.probability;
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST_F(SearchNext, PlacesSeenSinceAreLessProbable) {
  const SearchAnswer answer = ask(*store_, SearchQuestion{.subject = "red", .as_of = at("09:00")});
  const auto& places = answer.objects.at(0).places;
  EXPECT_EQ(places[0].place.name, "drawer_1_bottom")
      << "nobody has looked there; the counter was seen at 08:30";
  EXPECT_GT(places[0].probability, 0.8);
  EXPECT_EQ(places.back().place.name, "table_1") << "it has gone from there";
  EXPECT_EQ(places.back().probability, 0);
}

TEST_F(SearchNext, DistanceCosts) {
  const auto seconds = [&](const Vector2d& start) {
    const auto answer = ask(*store_, SearchQuestion{.subject = "red", .start = start});
    return answer.objects.at(0).places.at(0).seconds;
  };
  EXPECT_NEAR(seconds({0.5, 0.4}) - seconds({3.5, 0.4}), 6, 1e-9) << "three metres at half a metre a second";
}

}  // namespace
}  // namespace loci::memory
