#include "perception/pipeline/goal.h"

#include <gmock/gmock.h>

#include "tests/perception/pipeline/test_annotators.h"

namespace loci::perception {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

AnnotatorRegistry experts() {
  AnnotatorRegistry registry = test_registry();
  add_scripted(registry, {"Finder", "", {"Scene"}, {"Cluster"}});
  add_scripted(registry, {"Colors", "", {"Cluster"}, {"ColorAnnotation"}});
  add_scripted(registry, {"SlowColors", "", {"Cluster"}, {"ColorAnnotation"}});
  add_scripted(registry, {"Features", "", {"Cluster"}, {"PclFeatureAnnotation"}});
  add_scripted(registry, {"Classes", "", {"PclFeatureAnnotation"}, {"ClassificationAnnotation"}});
  return registry;
}

AnnotatorStatistics record(double seconds, const std::string& type, int64_t made) {
  AnnotatorStatistics statistics;
  statistics.scenes = 1;
  statistics.clusters = 10;
  statistics.seconds = seconds;
  statistics.products[type] = {made, 0, 0};
  return statistics;
}

GoalPlan plan(const std::string& goal, std::optional<double> budget = {}) {
  const StatisticsTable statistics = {{"Finder", record(0.1, "Cluster", 10)},
                                      {"Colors", record(0.001, "ColorAnnotation", 10)},
                                      {"SlowColors", record(0.1, "ColorAnnotation", 10)},
                                      {"Features", record(0.02, "PclFeatureAnnotation", 10)},
                                      {"Classes", record(0.01, "ClassificationAnnotation", 8)}};
  return plan_goal(parse_goal(goal), Json::array({"Finder"}), Json::object(), experts(), statistics, budget);
}

std::vector<std::string> taken(const GoalPlan& plan) {
  std::vector<std::string> names;
  for (const GoalChoice& choice : plan.choices)
    if (choice.taken) names.push_back(choice.annotator);
  return names;
}

TEST(Goal, TakesTheMostGainPerTimeAndSaysWhy) {
  const GoalPlan made = plan("class=mug color=red");
  EXPECT_THAT(taken(made), ElementsAre("Colors", "Classes"));
  EXPECT_NEAR(made.seconds, 0.131, 1e-9);
  EXPECT_THAT(plan_text(made), HasSubstr("- SlowColors for color=red: less gain per time than Colors"));
  EXPECT_THAT(plan_text(made), HasSubstr("with Features"));
}

TEST(Goal, WhoFindsThingsIsNotAskedAboutWhatOthersFound) {
  AnnotatorRegistry registry = experts();
  add_scripted(registry, {"Glasses", "", {"Scene"}, {"Cluster", "ClassificationAnnotation"}});
  const GoalPlan made =
      plan_goal(parse_goal("class=mug"), Json::array({"Finder"}), Json::object(), registry, {}, std::nullopt);
  EXPECT_THAT(taken(made), ElementsAre("Classes"));
}

TEST(Goal, AWordOfATextOrAProductIsEnough) {
  EXPECT_EQ(parse_goal("text=milk")[0].condition, "TextAnnotation.text ~ 'milk'");
  EXPECT_EQ(parse_goal("product=tea")[0].condition, "ProductAnnotation.name ~ 'tea'");
}

TEST(Goal, AsksLaterExpertsOnlyAboutWhatFitsSoFar) {
  const Json flow = plan("class=mug color=red").pipeline["flow"];
  ASSERT_EQ(flow.size(), 3U);
  EXPECT_EQ(flow[2]["if"], "ColorAnnotation.names == 'red'");
  EXPECT_EQ(flow[2]["then"][0], "Features");
  // It is a pipeline.
  AnnotatorRegistry registry = experts();
  EXPECT_EQ(refusal_of(Json{{"flow", flow}}.dump(), registry).find("needs"), std::string::npos);
}

TEST(Goal, WhatTwoTermsNeedRunsOnce) {
  AnnotatorRegistry registry = experts();
  add_scripted(registry, {"Products", "", {"PclFeatureAnnotation"}, {"ProductAnnotation"}});
  const GoalPlan made = plan_goal(parse_goal("class=mug product=tea"), Json::array({"Finder"}),
                                  Json::object(), registry, {}, std::nullopt);
  EXPECT_THAT(taken(made), ::testing::UnorderedElementsAre("Classes", "Products"));
  const std::string flow = made.pipeline.dump();
  ASSERT_NE(flow.find("Features"), std::string::npos);
  EXPECT_EQ(flow.find("Features"), flow.rfind("Features")) << flow;
}

TEST(Goal, KeepsToTheBudget) {
  const GoalPlan made = plan("class=mug color=red", 0.12);
  EXPECT_THAT(taken(made), ElementsAre("Colors"));
  EXPECT_THAT(made.unanswered, ElementsAre("class=mug"));
  EXPECT_THAT(plan_text(made), HasSubstr("the budget is used up"));
}

TEST(Goal, WhoCannotStartIsNotTaken) {
  AnnotatorRegistry registry = experts();
  AnnotatorDescriptor needy{"Products", "", {"Cluster"}, {"ProductAnnotation"}};
  needy.needs_options = true;
  add_scripted(registry, needy);
  const auto plan_with = [&](const Json& configured) {
    return plan_goal(parse_goal("product=tea"), Json::array({"Finder"}), configured, registry, {},
                     std::nullopt);
  };
  const GoalPlan without = plan_with(Json::object());
  EXPECT_THAT(taken(without), ElementsAre());
  EXPECT_THAT(without.unanswered, ElementsAre("product=tea"));
  EXPECT_THAT(plan_text(without), HasSubstr("- Products for product=tea: it cannot start without options"));
  EXPECT_THAT(taken(plan_with({{"Products", {{"word", "x"}}}})), ElementsAre("Products"));
}

TEST(Goal, ItsWordsAreThoseOfTheAnnotators) {
  const auto words = [](const std::string&, const std::string& value) {
    return value == "gray" ? std::string("grey") : value;
  };
  EXPECT_EQ(parse_goal("color=gray", words)[0].condition, "ColorAnnotation.names == 'grey'");
  EXPECT_EQ(parse_goal("color=gray", words)[0].text(), "color=grey");
  EXPECT_THAT([] { parse_goal("color"); },
              testing::ThrowsMessage<Error>(HasSubstr("give a value: color=VALUE")));
}

TEST(Goal, ValuesAreWhatAnnotatorsSaid) {
  cas::Cas cas(types::type_system());
  const auto cluster = types::Cluster::create(cas);
  const auto color = types::ColorAnnotation::create(cas);
  color.names.set({"red", "white"});
  cluster.annotations.push_back(color);
  EXPECT_THAT(values_of(parse_goal("color=red")[0], cluster), ElementsAre("red", "white"));
  EXPECT_THAT(values_of(parse_goal("class=cup")[0], cluster), ElementsAre());
}

TEST(Goal, SaysWhatNobodyCanAnswer) {
  EXPECT_THAT(plan("barcode=123").unanswered, ElementsAre("barcode=123"));
  EXPECT_THROW(parse_goal("colour=red"), Error);
  EXPECT_THROW(parse_goal(""), Error);
}

}  // namespace
}  // namespace loci::perception
