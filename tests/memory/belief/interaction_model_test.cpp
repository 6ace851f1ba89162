#include "memory/belief/interaction_model.h"

#include <gtest/gtest.h>

namespace loci::memory::belief {
namespace {

constexpr double kHour = 3600;
const BeliefOptions kOptions;

/// An object of a class that is observed every hour, and was handled at every `period`th view.
InteractionModel observed(const std::string& class_name, int views, int period, InteractionModel model = {}) {
  RateFactor own;
  for (int i = 1; i <= views; ++i)
    model.learn_interaction({class_name, "table_1", own}, own, 0, kHour, i % period == 0 ? 1 : 0, 1,
                            kOptions);
  return model;
}

TEST(InteractionModel, BeginsWithTheOptions) {
  const InteractionModel model;
  const double expected = kOptions.move_cap * (1 - std::exp(-kHour / kOptions.move_time_s));
  EXPECT_NEAR(model.probability({"mug", "table_1"}, 0, kHour, kOptions), expected, 0.01);
  EXPECT_EQ(model.probability({"mug", "table_1"}, kHour, kHour, kOptions), 0);
}

TEST(InteractionModel, ProbabilityOfStayingMultipliesOverTime) {
  const InteractionModel model = observed("mug", 50, 5);
  const auto stays = [&](double from, double to) {
    return 1 - model.probability({"mug", {}}, from, to, kOptions);
  };
  EXPECT_NEAR(stays(0, 10 * kHour), stays(0, kHour / 2) * stays(kHour / 2, 10 * kHour), 1e-12);
}

TEST(InteractionModel, LearnsHowLongObjectsStay) {
  EXPECT_NEAR(observed("mug", 400, 10).probability({"mug", "table_1"}, 0, kHour, kOptions), 0.1, 0.03);
  EXPECT_NEAR(observed("mug", 400, 2).probability({"mug", "table_1"}, 0, kHour, kOptions), 0.5, 0.1);
}

TEST(InteractionModel, LearnsHowOftenUsesOfADrawerConcernItsContents) {
  const auto after = [](double handled) {
    InteractionModel model;
    RateFactor own;
    for (int i = 0; i < 100; ++i)
      model.learn_interaction({"spoon", "drawer_1", own, 1}, own, 0, 60, handled, 1, kOptions);
    return model.probability({"spoon", "drawer_1", {}, 1}, 0, 60, kOptions);
  };
  const double prior = InteractionModel().probability({"spoon", "drawer_1", {}, 1}, 0, 60, kOptions);
  EXPECT_GT(prior, InteractionModel().probability({"spoon", "drawer_1"}, 0, 60, kOptions) + 0.2);
  EXPECT_NEAR(after(0.6), 0.6, 0.15);
  EXPECT_LT(after(0), 0.05);
}

TEST(InteractionModel, ClassesDiffer) {
  const InteractionModel model = observed("mug", 200, 2, observed("vase", 200, 50));
  const double mug = model.probability({"mug", "table_1"}, 0, kHour, kOptions);
  const double vase = model.probability({"vase", "table_1"}, 0, kHour, kOptions);
  EXPECT_GT(mug, 3 * vase);
}

TEST(InteractionModel, DestinationsAreLearned) {
  InteractionModel model;
  EXPECT_NEAR(model.moved_to("table_1", "table_1"), 2.0 / 3, 1e-9) << "no other place is known";
  for (int i = 0; i < 20; ++i) model.learn_moved("table_1", "sink_1", 1, 0.5);
  model.learn_moved("table_1", "shelf_1", 1, 0.5);
  EXPECT_GT(model.moved_to("table_1", "sink_1"), 5 * model.moved_to("table_1", "shelf_1"));
  EXPECT_GT(model.moved_to("table_1", "shelf_1"), 0);
  const PlaceHistories places{{"shelf_1", {}}, {"sink_1", {}}, {"table_1", {}}};
  const std::vector<double> destinations = model.destinations("table_1", places);
  size_t i = 0;
  for (const auto& [place, history] : places)
    EXPECT_DOUBLE_EQ(destinations[i++], model.moved_to("table_1", place)) << place;
}

TEST(InteractionModel, OutcomesThatAreNotFoundAreExpectedLess) {
  InteractionModel model;
  model.learn_moved("table_1", "sink_1", 1, 0.5);
  const double before = model.moved_to("table_1", "sink_1");
  for (int i = 0; i < 20; ++i) model.learn_moved("table_1", "sink_1", 0, 0.3);
  EXPECT_LT(model.moved_to("table_1", "sink_1"), before / 2);
}

TEST(InteractionModel, MoreNewObjectsAreExpectedWhereNobodyLookedForLonger) {
  InteractionModel model;
  for (int i = 0; i < 20; ++i) model.learn_arrivals({"table_1", 1, 0, 600}, 0.5, kOptions);
  const double usual = model.arrivals({"table_1", 1, 0, 600}, kOptions);
  EXPECT_NEAR(model.arrivals({"table_1", 1, 0, 1800}, kOptions), 3 * usual, 0.2 * usual);
}

TEST(InteractionModel, NewObjectsAreExpectedOnPlacesNeverObserved) {
  InteractionModel model;
  for (int i = 0; i < 20; ++i) model.learn_arrivals({"place_" + std::to_string(i)}, 5, kOptions);
  const PlaceView seen{"place_3", 1, 0, 600};
  for (int i = 0; i < 50; ++i) model.learn_arrivals(seen, 0, kOptions);
  EXPECT_GT(model.arrivals({"place_99"}, kOptions), 10 * model.arrivals(seen, kOptions));
}

TEST(InteractionModel, LongGoneObjectsReturnLessOften) {
  InteractionModel model;
  for (int i = 0; i < 100; ++i) {
    model.learn_returns(100, i % 2, kOptions);
    model.learn_returns(5 * kHour, 0, kOptions);
  }
  EXPECT_NEAR(model.returns(100, kOptions), 0.5, 0.05);
  EXPECT_LT(model.returns(5 * kHour, kOptions), 0.03);
}

TEST(InteractionModel, ClutterShareOfNewObjectsIsLearned) {
  InteractionModel model;
  for (int i = 0; i < 20; ++i) model.learn_arrivals({"table_" + std::to_string(i)}, 5, kOptions);
  EXPECT_NEAR(model.clutter_share("table_1", 0.45, kOptions), 0.1, 1e-9);
  EXPECT_LT(model.clutter_share("table_99", model.arrivals({"table_99"}, kOptions), kOptions), 0.02)
      << "on a place never observed all is new";
  for (int i = 0; i < 200; ++i) model.learn_clutter(i % 2, kOptions);
  EXPECT_NEAR(model.clutter_share("table_1", 0.45, kOptions), 0.5, 0.05);
}

}  // namespace
}  // namespace loci::memory::belief
