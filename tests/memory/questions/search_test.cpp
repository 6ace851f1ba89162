#include "memory/questions/search.h"

#include <array>
#include <opencv2/core.hpp>

#include "mapping/base/files.h"
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

/// Adds a vector of a network to the first observations of the memory.
void add_embeddings(const std::filesystem::path& file, const std::vector<std::string>& vectors) {
  Store store = Store::open_write(file, {.now = 1'900'000'001 * kSecond});
  const Id run = store.begin_run("test", "{}");
  SceneTransaction transaction(store, run);
  const std::string type = "loci.annotation.ImageFeatureAnnotation";
  for (size_t i = 0; i < vectors.size(); ++i) {
    const Id observation = static_cast<Id>(i) + 1;
    const Id types = transaction.add_type_system("<typeSystemDescription/>");
    const Id structure = transaction.add_feature_structure(
        {.scene = 1,
         .observation = observation,
         .type = type,
         .type_system = types,
         .json = R"({"root": "#1", "structures": [{"id": 1, "type": ")" + type +
                 R"(", "features": {"source": "NetworkEmbedding", "name": "net", "feature": )" + vectors[i] +
                 "}}]}"});
    transaction.add_annotation({.scene = 1,
                                .observation = observation,
                                .type = type,
                                .value = "net",
                                .feature_structure = structure});
  }
  transaction.commit();
  store.finish_run(run);
}

TEST_F(Similarity, IsOfTheVectorsOfANetworkWhereThereAreAny) {
  remember_three(file_);
  add_embeddings(file_, {"[1, 0]", "[0, 2]", "[3, 0.3]"});
  const Store store = Store::open_read(file_);
  const SimilarAnswer answer = ask(store, SimilarQuestion{.subject = "object_1"});
  ASSERT_EQ(answer.objects.size(), 2U);
  EXPECT_EQ(answer.objects[0].object.object.id, 3);
  EXPECT_GT(answer.objects[0].similarity, 0.99);
  EXPECT_NEAR(answer.objects[1].similarity, 0, 1e-6);
}

TEST_F(Similarity, TextsAreFoundByVectorsOfWords) {
  remember_three(file_);
  const std::filesystem::path words = file_.parent_path() / "words.txt";
  write_file_atomically(words, "mug 0 1\ntea towel 1 0\nred 1 1\n");
  {
    const Store store = Store::open_read(file_);
    EXPECT_THROW(ask(store, SimilarQuestion{.text = "mug", .vectors = words}), Error);  // no vectors yet
  }
  add_embeddings(file_, {"[1, 0]", "[0, 2]", "[3, 0.3]"});
  const Store store = Store::open_read(file_);
  EXPECT_EQ(ask(store, SimilarQuestion{.text = "Mug", .vectors = words}).objects.at(0).object.object.id, 2);
  EXPECT_EQ(ask(store, SimilarQuestion{.text = "tea towel", .vectors = words}).objects.at(0).object.object.id,
            1);
  EXPECT_THROW(ask(store, SimilarQuestion{.text = "spoon", .vectors = words}), Error);
  EXPECT_THROW(ask(store, SimilarQuestion{.text = "mug"}), Error);
  write_file_atomically(words, "mug 0 1\ntea 1\n");
  EXPECT_THROW(ask(store, SimilarQuestion{.text = "mug", .vectors = words}), Error);
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

TEST_F(SearchNext, WhatMayHaveLeftTheHomeIsNotSurelyAtOneOfItsPlaces) {
  store_.reset();
  {
    Store store = Store::open_write(file_, {.now = testing_support::SyntheticDay::kKnownSecond + kSecond});
    const Id run = store.begin_run("test", "{}");
    SceneTransaction rows(store, run);
    BeliefRow row = *store.belief(1);
    row.status = ObjectStatus::gone;
    row.probability = 0;
    row.elsewhere = 0.5;
    row.clock.supersedes = row.id;
    row.clock.known_to.reset();
    rows.add_belief(row);
    rows.commit();
    store.finish_run(run);
  }
  store_.emplace(Store::open_read(file_));
  const ObjectSearch search = ask(*store_, SearchQuestion{.subject = "object_1"}).objects.at(0);
  double sum = 0;
  for (const SearchPlace& place : search.places) sum += place.probability;
  EXPECT_GT(sum, 0.1);
  EXPECT_LT(sum, search.now.in_home) << "less than before the places were looked at since";
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
