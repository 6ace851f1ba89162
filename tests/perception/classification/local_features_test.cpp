#include "perception/classification/local_features.h"
#include "mapping/base/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "mapping/base/text/json.h"
#include "perception/classification/ensemble.h"

namespace loci::perception {
namespace {

/// Stripes or rings, somewhere in the image.
cv::Mat drawn(bool rings, uint64_t seed) {
  Random draw(seed);
  cv::Mat image(160, 160, CV_8UC3, cv::Scalar(200, 200, 200));
  const int x = 60 + static_cast<int>(draw.index(40)), y = 60 + static_cast<int>(draw.index(40));
  const int step = 12 + static_cast<int>(draw.index(4));
  for (int i = 1; i <= 4; ++i) {
    const cv::Scalar color(30 * i, 20, 40);
    if (rings)
      cv::circle(image, {x, y}, step * i, color, 3);
    else
      cv::rectangle(image, {x - step * i, y - 50}, {x - step * i + 4, y + 50}, color, cv::FILLED);
  }
  return image;
}

ObjectView shown(const cv::Mat& image, const cv::Mat& mask = {}) {
  ObjectView view;
  view.image = image;
  view.mask = mask;
  return view;
}

std::vector<TrainingSample> images(const std::vector<std::string>& features, size_t count, uint64_t seed) {
  std::vector<TrainingSample> things;
  for (size_t i = 0; i < count; ++i) {
    const bool rings = i % 2 == 0;
    ObjectFeatures of = object_features(features, shown(drawn(rings, seed + i)));
    things.push_back({rings ? "rings" : "stripes", of.features, of.local});
  }
  return things;
}

TEST(LocalFeatures, have_a_descriptor_for_each_place_within_the_mask) {
  cv::Mat mask = cv::Mat::zeros(160, 160, CV_8U);
  mask(cv::Rect(0, 0, 90, 160)).setTo(255);
  for (const auto& [name, length] : {std::pair{"SIFT", 128u}, {"ORB", 256u}}) {
    const LocalFeatures features = local_features(name, shown(drawn(true, 1), mask));
    ASSERT_GT(features.count(), 5u) << name;
    EXPECT_EQ(features.length, length);
    EXPECT_EQ(features.values.size(), features.count() * length);
    for (const Eigen::Vector3f& place : features.places) EXPECT_LE(place.x(), 91.0f);
    EXPECT_EQ(local_features(name, {}).count(), 0u);
  }
  EXPECT_THROW(local_features("SURF", {}), Error);
}

TEST(LocalFeatures, of_a_surface_lie_on_it) {
  SurfacePoints surface;
  for (float x = -0.05f; x < 0.05f; x += 0.002f)
    for (float y = -0.05f; y < 0.05f; y += 0.002f) {
      surface.points.emplace_back(x, y, 1 + 0.3f * std::abs(x));
      surface.normals.emplace_back(Eigen::Vector3f(x < 0 ? -0.3f : 0.3f, 0, -1).normalized());
    }
  for (const auto& [name, length] : {std::pair{"SHOT", 352u}, {"FPFH", 33u}}) {
    ObjectView view;
    view.surface = surface;
    const LocalFeatures features = local_features(name, view);
    ASSERT_GT(features.count(), 5u) << name;
    EXPECT_EQ(features.length, length);
    for (const Eigen::Vector3f& p : features.places) EXPECT_NEAR(p.z(), 1 + 0.3f * std::abs(p.x()), 0.003f);
  }
}

TEST(Hog, does_not_see_what_is_outside_of_the_mask) {
  const cv::Mat image = drawn(false, 2);
  cv::Mat other = image.clone(), mask = cv::Mat::zeros(160, 160, CV_8U);
  mask(cv::Rect(20, 20, 100, 100)).setTo(255);
  cv::line(other, {130, 0}, {130, 159}, cv::Scalar(0, 0, 0), 5);
  EXPECT_EQ(hog_of(image, mask).size(), kHogLength);
  EXPECT_EQ(hog_of(image, mask), hog_of(other, mask));
  EXPECT_NE(hog_of(image, {}), hog_of(other, {}));
  EXPECT_TRUE(hog_of({}, {}).empty());
}

TEST(Vocabulary, tells_apart_what_it_was_learned_from) {
  LocalFeatures two{
      2, {0, 0, 0, 0.1f, 5, 5, 5.1f, 5}, std::vector<Eigen::Vector3f>(4, Eigen::Vector3f::Zero())};
  const Vocabulary vocabulary = Vocabulary::learn({&two}, 2, Random(0));
  const LocalFeatures three{2, {0, 0, 5, 5, 5, 5, 5, 5}, two.places};
  FeatureVector bag = vocabulary.bag_of(three);
  std::sort(bag.begin(), bag.end());
  EXPECT_NEAR(bag[0], std::sqrt(0.25f), 1e-6f);
  EXPECT_NEAR(bag[1], std::sqrt(0.75f), 1e-6f);
  EXPECT_TRUE(vocabulary.bag_of({}).empty());
  EXPECT_EQ(Vocabulary::from_json(vocabulary.to_json()).bag_of(three), vocabulary.bag_of(three));
  EXPECT_THROW(Vocabulary::learn({}, 2, Random(0)), Error);
}

TEST(Ensemble, learns_words_of_key_points_and_keeps_them) {
  const std::vector<std::string> names = {"SIFTBag", "ORBBag", "HOG"};
  const auto examples = images(names, 24, 100), tests = images(names, 12, 500);
  std::vector<ExpertSpec> experts;
  for (const std::string& name : names) experts.push_back(parse_expert(name + ":svm"));
  NoProgress progress;
  const Ensemble model = Ensemble::train(examples, experts, 3, Random(1), 1, progress);
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path path = folder.path() / "bags.model";
  model.save(path);
  const Ensemble loaded = Ensemble::load(path);
  int right = 0;
  for (const TrainingSample& thing : tests) {
    const Classification result = model.classify(thing.features, thing.local);
    right += model.classes()[result.best] == thing.label;
    EXPECT_EQ(loaded.classify(thing.features, thing.local).probabilities, result.probabilities);
  }
  EXPECT_GE(right, 11);
  EXPECT_FALSE(model.knows_enough({}, {}));
}

}  // namespace
}  // namespace loci::perception
