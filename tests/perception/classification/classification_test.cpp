#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "perception/classification/ensemble.h"

namespace loci::perception {
namespace {

/// The near side of a cylinder, or of a box of the same extent, upright before the camera.
SurfacePoints seen(bool round, double size, double turn, Random random) {
  SurfacePoints surface;
  const Eigen::Vector3d centre(0, 0, 0.9);
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 40; ++j) {
      const double part = i / 60.0 - 0.5, height = (j / 40.0 - 0.5) * 2 * size;
      Eigen::Vector3d point, normal;
      if (round) {
        const double angle = part * kPi;
        normal = {std::sin(angle), 0, -std::cos(angle)};
        point = size * normal + Eigen::Vector3d(0, height, 0);
      } else {
        // Two faces that meet at an edge towards the camera.
        const double angle = (part < 0 ? -1 : 1) * kPi / 4 + turn;
        normal = {std::sin(angle), 0, -std::cos(angle)};
        const Eigen::Vector3d edge = Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitY()) *
                                     Eigen::Vector3d(0, 0, -size * std::numbers::sqrt2);
        const Eigen::Vector3d along(std::cos(angle), 0, std::sin(angle));
        point = edge + 3 * size * part * along + Eigen::Vector3d(0, height, 0);
      }
      surface.points.emplace_back(
          (centre + point + 0.001 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()))
              .cast<float>());
      surface.normals.emplace_back(normal.cast<float>());
      surface.colors.emplace_back(40.0f, static_cast<float>(100 + 50 * std::sin(0.7 * i) * std::cos(0.9 * j)),
                                  150.0f);
    }
  return surface;
}

std::vector<TrainingSample> things(const std::vector<std::string>& features, size_t count, uint64_t seed) {
  const Random random(seed);
  std::vector<TrainingSample> all;
  for (size_t i = 0; i < count; ++i) {
    Random draw = random.fork(i);
    const bool round = i % 2 == 0;
    const double size = draw.uniform(0.03, 0.08), turn = draw.uniform(-0.5, 0.5);
    all.push_back({round ? "cylinder" : "box", feature_set(features, seen(round, size, turn, draw.fork(0)))});
  }
  return all;
}

double share_right(const Ensemble& model, const std::vector<TrainingSample>& tests) {
  int right = 0;
  for (const TrainingSample& thing : tests)
    right += model.classes()[model.classify(thing.features).best] == thing.label;
  return static_cast<double>(right) / static_cast<double>(tests.size());
}

Ensemble trained(const std::vector<TrainingSample>& examples, const std::vector<std::string>& experts) {
  std::vector<ExpertSpec> specs;
  for (const std::string& each : experts) specs.push_back(parse_expert(each));
  NoProgress progress;
  return Ensemble::train(examples, specs, 3, Random(1), 1, progress);
}

TEST(ShapeFeatures, every_descriptor_has_the_length_of_its_name_and_is_the_same_twice) {
  const SurfacePoints surface = seen(true, 0.05, 0, Random(3));
  for (const std::string& name : shape_feature_names()) {
    const std::vector<float> values = shape_feature(name, surface);
    const std::string signature = shape_feature_signature(name);
    const size_t digits = signature.find_first_of("0123456789");
    EXPECT_EQ(values.size(), std::stoul(signature.substr(digits))) << name;
    EXPECT_GT(std::accumulate(values.begin(), values.end(), 0.0), 0.0) << name;
    EXPECT_EQ(values, shape_feature(name, surface)) << name;
  }
}

TEST(ShapeFeatures, what_rests_on_colors_needs_them) {
  SurfacePoints surface = seen(true, 0.05, 0, Random(3));
  surface.colors.clear();
  for (const char* name : {"RIFT", "PFHRGB", "ColorSHOT"})
    EXPECT_TRUE(shape_feature(name, surface).empty()) << name;
  EXPECT_FALSE(shape_feature("OURCVFH", surface).empty());
}

TEST(ShapeFeatures, a_surface_of_few_points_has_none_and_an_unknown_descriptor_is_named) {
  for (const std::string& name : shape_feature_names()) {
    EXPECT_TRUE(shape_feature(name, {}).empty());
    EXPECT_TRUE(shape_feature(name, {{{0, 0, 1}}, {{0, 0, -1}}}).empty());
  }
  try {
    shape_feature("VHF", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.hint().find("VFH"), std::string::npos);
  }
}

TEST(ShapeFeatures, points_without_normal_do_not_count) {
  SurfacePoints surface = seen(false, 0.05, 0.2, Random(3));
  const std::vector<float> before = shape_feature("PFH", surface);
  surface.points.emplace_back(0.0f, 0.0f, 0.9f);
  surface.normals.emplace_back(Eigen::Vector3f::Constant(std::nanf("")));
  surface.colors.emplace_back(0.0f, 0.0f, 0.0f);
  EXPECT_EQ(shape_feature("PFH", surface), before);
}

TEST(FeatureDistance, is_what_its_name_says) {
  const std::vector<float> a = {0.5f, 0.5f, 0}, b = {0.25f, 0.5f, 0.25f};
  EXPECT_FLOAT_EQ(distance_between(a, b, feature_distance("L1")), 0.5f);
  EXPECT_FLOAT_EQ(distance_between(a, b, feature_distance("L2")), 0.125f);
  EXPECT_FLOAT_EQ(distance_between(a, b, feature_distance("chi-squared")), 0.0625f / 0.75f + 0.25f);
  EXPECT_FLOAT_EQ(distance_between(a, b, feature_distance("intersection")), 0.25f);
  EXPECT_THROW(feature_distance("L3"), Error);
}

TEST(Classifier, knn_scores_are_shares_of_the_neighbours) {
  LabelledVectors data{{{1, 0}, {0.9f, 0.1f}, {0, 1}, {0.1f, 0.9f}}, {0, 0, 1, 1}, 2};
  ClassifierOptions options;
  options.method = "knn";
  options.k = 3;
  for (const char* distance : {"L1", "L2", "chi-squared", "intersection"}) {
    options.distance = distance;
    const std::vector<double> scores = train_classifier(data, options, Random(0))->scores({4, 0});
    EXPECT_NEAR(scores[0], 2.0 / 3, 1e-12) << distance;
    EXPECT_NEAR(scores[1], 1.0 / 3, 1e-12) << distance;
  }
}

TEST(Classifier, each_kind_learns_a_ring_around_a_disc) {
  LabelledVectors data;
  data.classes = 2;
  Random draw(5);
  const auto example = [&](size_t label) {
    const double radius = label == 0 ? draw.uniform(0, 0.08) : draw.uniform(0.12, 0.2);
    const double angle = draw.uniform(0, 2 * kPi);
    const auto x = static_cast<float>(0.3 + radius * std::cos(angle)),
               y = static_cast<float>(0.3 + radius * std::sin(angle));
    return FeatureVector{x, y, 1 - x - y};
  };
  for (size_t i = 0; i < 200; ++i) {
    data.labels.push_back(i % 2);
    data.vectors.push_back(example(i % 2));
  }
  for (const char* method : {"knn", "svm", "forest"}) {
    ClassifierOptions options;
    options.method = method;
    const auto classifier = train_classifier(data, options, Random(0));
    const auto again = classifier_from_json(parse_json(classifier->to_json().dump(), "model"));
    int right = 0;
    for (size_t i = 0; i < 100; ++i) {
      const FeatureVector vector = example(i % 2);
      const std::vector<double> scores = classifier->scores(vector);
      EXPECT_NEAR(scores[0] + scores[1], 1, 1e-6);
      EXPECT_EQ(scores, again->scores(vector)) << method;
      right += scores[i % 2] > 0.5;
    }
    EXPECT_GE(right, 93) << method;
  }
}

/// Classes differ by little in the second value, and everything by much in the first.
LabelledVectors stretched(size_t count, uint64_t seed) {
  Random draw(seed);
  LabelledVectors data{{}, {}, 2};
  for (size_t i = 0; i < count; ++i) {
    const size_t label = i % 2;
    const double first = draw.uniform(0.2, 0.6);
    const double second = 0.1 + 0.004 * static_cast<double>(label) + draw.normal(0.001);
    data.vectors.push_back(
        {static_cast<float>(first), static_cast<float>(second), static_cast<float>(1 - first - second)});
    data.labels.push_back(label);
  }
  return data;
}

int right_of(const Classifier& classifier, const LabelledVectors& tests) {
  int right = 0;
  for (size_t i = 0; i < tests.vectors.size(); ++i)
    right += classifier.scores(tests.vectors[i]).at(tests.labels[i]) > 0.5;
  return right;
}

TEST(Classifier, mahalanobis_weighs_directions_by_how_much_classes_spread_in_them) {
  for (const char* method : {"knn", "svm"}) {
    ClassifierOptions options;
    options.method = method;
    options.k = 5;
    options.distance = "L2";
    const LabelledVectors data = stretched(100, 1), tests = stretched(100, 2);
    const int plain = right_of(*train_classifier(data, options, Random(1)), tests);
    options.distance = "Mahalanobis";
    const auto classifier = train_classifier(data, options, Random(1));
    EXPECT_GE(right_of(*classifier, tests), 95) << method;
    EXPECT_LT(plain, 90) << method;
    const auto again = classifier_from_json(classifier->to_json());
    for (const FeatureVector& vector : tests.vectors)
      EXPECT_EQ(again->scores(vector), classifier->scores(vector));
  }
}

TEST(SoftmaxRegression, finds_the_shares_behind_the_labels) {
  // Without information the answer is how often each class is.
  const std::vector<size_t> labels = {0, 0, 0, 1};
  const std::vector<Eigen::MatrixXd> examples(4, Eigen::MatrixXd::Identity(2, 2));
  const auto regression = SoftmaxRegression::fit(examples, labels, 1e-6);
  EXPECT_NEAR(regression.probabilities(examples[0])[0], 0.75, 1e-3);
}

TEST(SoftmaxRegression, calibrates_an_expert_that_is_very_sure_of_one_of_many_classes) {
  // A whole step of Newton's method goes so far that the next one would lead away for good.
  constexpr Eigen::Index kClasses = 29;
  std::vector<Eigen::MatrixXd> examples;
  std::vector<size_t> labels;
  for (size_t i = 0; i < 290; ++i) {
    Eigen::MatrixXd scores = Eigen::MatrixXd::Constant(kClasses, 1, std::log(0.01));
    scores(static_cast<Eigen::Index>(i % kClasses), 0) = 0;
    examples.push_back(scores);
    labels.push_back(i % 10 == 0 ? (i + 1) % kClasses : i % kClasses);  // one in ten is wrong
  }
  const auto regression = SoftmaxRegression::fit(examples, labels, 1e-3);
  EXPECT_NEAR(regression.probabilities(examples[1])[1], 0.9, 0.02);
}

TEST(Classifier, a_network_learns_and_is_the_same_after_saving) {
  LabelledVectors data;
  data.classes = 3;
  Random draw(5);
  const auto example = [&](size_t label) {
    const auto x = static_cast<float>(draw.normal(0.03) + 0.2 * (label == 1)),
               y = static_cast<float>(draw.normal(0.03) + 0.2 * (label == 2));
    return FeatureVector{0.3F + x, 0.3F + y, 2 - x - y};
  };
  for (size_t i = 0; i < 300; ++i) {
    data.labels.push_back(i % 3);
    data.vectors.push_back(example(i % 3));
  }
  ClassifierOptions options;
  options.method = "network";
  const auto classifier = train_classifier(data, options, Random(0));
  EXPECT_EQ(classifier->to_json(), train_classifier(data, options, Random(0))->to_json());
  const auto again = classifier_from_json(parse_json(classifier->to_json().dump(), "model"));
  int right = 0;
  for (size_t i = 0; i < 99; ++i) {
    const FeatureVector vector = example(i % 3);
    const std::vector<double> scores = classifier->scores(vector);
    EXPECT_EQ(scores, again->scores(vector));
    right += scores[i % 3] > 0.5;
  }
  EXPECT_GE(right, 95);
}

TEST(Ensemble, tells_boxes_from_cylinders_that_it_has_not_seen) {
  const std::vector<std::string> features = {"VFH", "PFH"};
  const auto examples = things(features, 40, 1), tests = things(features, 20, 2);
  for (const std::vector<std::string>& experts :
       {std::vector<std::string>{"VFH:knn:L1"}, {"PFH:svm"}, {"VFH:forest", "PFH:knn:intersection"}})
    EXPECT_GE(share_right(trained(examples, experts), tests), 0.9) << experts.front();
}

TEST(Ensemble, answers_the_same_after_saving_and_on_any_number_of_threads) {
  const auto examples = things({"VFH", "GRSD"}, 20, 1);
  const std::vector<ExpertSpec> experts = {parse_expert("VFH:svm:L2"), parse_expert("GRSD:forest")};
  NoProgress progress;
  const Ensemble one = Ensemble::train(examples, experts, 2, Random(7), 1, progress);
  const Ensemble two = Ensemble::train(examples, experts, 2, Random(7), 4, progress);
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path path = folder.path() / "ensemble.model";
  one.save(path);
  const std::string bytes = read_file(path);
  two.save(path);
  EXPECT_EQ(read_file(path), bytes);
  const Ensemble loaded = Ensemble::load(path);
  EXPECT_EQ(loaded.classes(), (std::vector<std::string>{"box", "cylinder"}));
  for (const TrainingSample& thing : examples)
    EXPECT_EQ(loaded.classify(thing.features).probabilities, one.classify(thing.features).probabilities);
}

TEST(Ensemble, refuses_what_it_cannot_learn_or_read) {
  const auto examples = things({"VFH"}, 6, 1);
  NoProgress progress;
  EXPECT_THROW(trained({examples[0], examples[2]}, {"VFH:knn"}), Error);  // one class
  EXPECT_THROW(Ensemble::train(examples, {parse_expert("VFH:knn")}, 5, Random(0), 1, progress), Error);
  EXPECT_THROW(parse_expert("VFH"), Error);
  EXPECT_THROW(parse_expert("VFH:tree"), Error);
  EXPECT_THROW(parse_expert("VFH:knn:L9"), Error);
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path path = folder.path() / "no_ensemble.model";
  write_file_atomically(path, "{\"kind\": \"loci classifier\", \"version\": 1}");
  EXPECT_THROW(Ensemble::load(path), Error);
  EXPECT_THROW(trained(examples, {"VFH:knn"}).classify({}), Error);
}

}  // namespace
}  // namespace loci::perception
