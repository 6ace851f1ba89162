#include "memory/questions/routines/co_occurrence.h"

#include <fmt/format.h>

#include <array>

#include "memory/questions/near.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
class CoOccurrenceQuestions : public testing_support::DayFixture {};

TEST_F(CoOccurrenceQuestions, NearIsWithinTheRadiusNearestFirst) {
  const NearAnswer near = ask(*store_, NearQuestion{.subject = "red", .radius_m = 0.5});
  EXPECT_EQ(near.around, "object_1");
  ASSERT_EQ(near.objects.size(), 1U);
  EXPECT_EQ(near.objects[0].object.object.id, 3);
  EXPECT_NEAR(near.objects[0].distance_m, std::hypot(0.4, 0.2), 1e-9);

  const NearAnswer level = ask(*store_, NearQuestion{.subject = "3.5, 0.3", .radius_m = 1});
  ASSERT_EQ(level.objects.size(), 3U);
  EXPECT_EQ(level.objects[0].object.object.id, 1);
  EXPECT_NEAR(level.objects[2].distance_m, 0.6, 1e-9) << "height does not count without one";
}

TEST_F(CoOccurrenceQuestions, NearKnowsWhereObjectsWere) {
  const NearAnswer near = ask(*store_, NearQuestion{"table_1", 0.6, at("08:30")});
  ASSERT_EQ(near.objects.size(), 2U);
  EXPECT_EQ(near.objects[0].object.object.id, 2);
  EXPECT_THROW(ask(*store_, NearQuestion{"red", -1, {}}), Error);
}

TEST_F(CoOccurrenceQuestions, NextToIsWithoutRoomInBetween) {
  const auto found = [&](Relation relation, const std::string& only = "") {
    std::vector<Id> objects;
    for (const NearObject& near :
         ask(*store_, NearQuestion{.subject = "red", .only = only, .relation = relation}).objects)
      objects.push_back(near.object.object.id);
    return objects;
  };
  EXPECT_THAT(found(Relation::next_to), testing::ElementsAre(3)) << "in any case the nearest";
  EXPECT_THAT(found(Relation::next_to, "yellow"), testing::IsEmpty());
  store_.reset();
  {
    Store store = Store::open_write(file_, {});
    const BeliefRow red = *store.belief(1);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    const Id id = scene.add_scene({.time = testing_support::day_time("11:00")});
    scene.add_belief({.object = 2,
                      .scene = id,
                      .status = ObjectStatus::seen,
                      .probability = 0.95,
                      .place = red.place,
                      .position = *red.position + Vector3d(-0.12, 0, 0),
                      .last_scene = id,
                      .color = "blue",
                      .size = Vector3d::Constant(0.1)});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  EXPECT_THAT(found(Relation::near), testing::ElementsAre(2, 3));
  EXPECT_THAT(found(Relation::next_to), testing::ElementsAre(2));
  EXPECT_THAT(found(Relation::next_to, "green"), testing::IsEmpty());
}

TEST_F(CoOccurrenceQuestions, BesideAndBehindAreAsTheCameraSawThem) {
  // Its image has x to the right and y up.
  const auto found = [&](const char* subject, Relation relation) {
    std::vector<Id> objects;
    for (const NearObject& near :
         ask(*store_, NearQuestion{.subject = subject, .relation = relation}).objects)
      objects.push_back(near.object.object.id);
    return objects;
  };
  EXPECT_THAT(found("red", Relation::left), testing::ElementsAre(3));
  EXPECT_THAT(found("green", Relation::right), testing::ElementsAre(1));
  for (const Relation relation : {Relation::right, Relation::behind, Relation::in_front, Relation::under})
    EXPECT_THAT(found("red", relation), testing::IsEmpty());
  EXPECT_EQ(ask(*store_, NearQuestion{.subject = "red", .relation = Relation::left}).seen->time,
            testing_support::day_time("10:30"));

  const auto reply = [&](std::map<std::string, std::string> arguments, Asks asks) {
    const Query query{.question = "near", .arguments = std::move(arguments), .asks = asks};
    return ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)});
  };
  EXPECT_EQ(reply({{"around", "red"}, {"object", "green"}, {"relation", "left"}}, Asks::verdict).verdict,
            Verdict::yes);
  const Reply not_right =
      reply({{"around", "red"}, {"object", "green"}, {"relation", "right"}}, Asks::verdict);
  EXPECT_EQ(not_right.verdict, Verdict::no);
  EXPECT_THAT(not_right.text, HasSubstr("is not right of"));
  const Reply hidden = reply({{"around", "red"}, {"relation", "behind"}}, Asks::objects);
  EXPECT_TRUE(hidden.not_known) << "what it hides may be there";
  EXPECT_EQ(reply({{"around", "red"}, {"relation", "under"}}, Asks::objects).places,
            std::vector<std::string>{"counter_1"});
}

TEST_F(CoOccurrenceQuestions, CountsScenesWithBoth) {
  const CoOccurrenceAnswer all = ask(*store_, CoOccurrenceQuestion{.subject = "red"});
  ASSERT_EQ(all.objects.size(), 1U);
  EXPECT_EQ(all.objects[0].scenes, 3U);
  ASSERT_EQ(all.objects[0].others.size(), 3U);
  EXPECT_EQ(all.objects[0].others[0].object.id, 4) << "one of the three scenes with either";
  EXPECT_EQ(all.objects[0].others[0].same_place, 0U) << "in the drawer";

  const CoOccurrenceAnswer two = ask(*store_, CoOccurrenceQuestion{.subject = "blue", .other = "green"});
  EXPECT_EQ(two.objects[0].others.at(0).together, 0U);
  EXPECT_EQ(two.objects[0].others.at(0).scenes, 2U);
}

/// A counter of 5 m, of which one view shows 44 %, in the morning with two objects and at noon with one.
void remember_long_counter(const std::filesystem::path& file) {
  Store store = Store::open_write(file, {.now = testing_support::SyntheticDay::kKnownFirst});
  const Id run = store.begin_run("test", "{}");
  const Id counter = store.add_place({.name = "counter_1",
                                      .class_name = "counter",
                                      .height = 0.75,
                                      .outline = {{0, 0}, {5, 0}, {5, 0.8}, {0, 0.8}}},
                                     run);
  SceneTransaction scene(store, run);
  const std::array<Id, 2> objects = {scene.add_object({}), scene.add_object({})};
  for (const char* hour : {"08", "12"})
    for (size_t view = 0; view < 2; ++view) {
      Isometry3d map_from_camera = Isometry3d::Identity();
      map_from_camera.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      map_from_camera.translation() = Vector3d(view == 0 ? 1.1 : 3.9, 0.4, 2.75);
      const Id id =
          scene.add_scene({.time = testing_support::day_time(fmt::format("{}:0{}", hour, view)),
                           .camera = SceneCamera{640, 480, 585, 585, 319.5, 239.5, 0.5, 5.0},
                           .map_from_camera = map_from_camera,
                           .depth = scene.add_blob(encode_depth_thumbnail(std::vector<float>(80 * 60, 2.0F)),
                                                   kDepthThumbnailMedia),
                           .depth_width = 80,
                           .depth_height = 60});
      scene.add_visibility({.scene = id, .place = counter, .status = ObjectStatus::seen, .fraction = 0.44});
      const bool gone = view == 1 && std::string_view(hour) == "12";
      if (!gone) {
        const Id seen = scene.add_observation({.scene = id, .number = 0, .place = counter});
        scene.add_association({.scene = id,
                               .observation = seen,
                               .object = objects[view],
                               .explanation = Explanation::stay,
                               .probability = 1,
                               .chosen = true});
      }
      scene.add_belief({.object = objects[view],
                        .scene = id,
                        .status = gone ? ObjectStatus::gone : ObjectStatus::seen,
                        .probability = gone ? 0.0 : 1.0,
                        .place = counter,
                        .last_scene = id});
    }
  scene.commit();
  store.finish_run(run);
}

TEST_F(CoOccurrenceQuestions, MissingTakesTheViewsOfAVisitTogether) {
  const std::filesystem::path file = folder_ / "long.loci";
  remember_long_counter(file);
  const MissingAnswer answer = ask(Store::open_read(file), MissingQuestion{.place = "counter_1"});
  ASSERT_EQ(answer.places.size(), 1U);
  EXPECT_EQ(answer.places[0].visits, 2U);
  ASSERT_EQ(answer.places[0].missing.size(), 1U);
  EXPECT_EQ(answer.places[0].missing[0].now.object.id, 2);
}

TEST_F(CoOccurrenceQuestions, MissingIsWhatMostVisitsShowedWithTheRest) {
  const MissingAnswer answer = ask(*store_, MissingQuestion{.place = "table_1"});
  ASSERT_EQ(answer.places.size(), 1U);
  EXPECT_EQ(answer.places[0].visits, 2U) << "the third saw only what hides";
  ASSERT_EQ(answer.places[0].missing.size(), 1U);
  EXPECT_EQ(answer.places[0].missing[0].now.object.id, 1);
  EXPECT_EQ(answer.places[0].missing[0].now.place->name, "counter_1");
  ASSERT_EQ(answer.places[0].present.size(), 1U);
  EXPECT_EQ(answer.places[0].present[0].now.object.id, 2);
  EXPECT_THAT(text(answer), HasSubstr("Missing on table_1, by 2 visits"));
  EXPECT_EQ(reason_of(answer.places[0]), "what was there in at least half of 2 visits is not there now");
  EXPECT_EQ(ask(*store_, MissingQuestion{"table_1", "dinner", {}}).places[0].visits, 0U);
  EXPECT_THROW(ask(*store_, MissingQuestion{"table_1", "brunch", {}}), Error);
}

TEST_F(CoOccurrenceQuestions, WhatIsNotMissingHasAReason) {
  const auto reason = [&](const std::string& place, const std::string& object) {
    return reason_of(ask(*store_, MissingQuestion{.place = place, .subject = object}).places.at(0));
  };
  EXPECT_EQ(reason("table_1", "red"), "it was there in 1 of 2 visits and is not there now");
  EXPECT_EQ(reason("table_1", "blue"), "it is there now");
  EXPECT_EQ(reason("table_1", "green"), "it was there in 0 of 2 visits, less than half");
  EXPECT_EQ(reason("counter_1", ""), "what was there in at least half of 3 visits is there now");
  EXPECT_THAT(text(ask(*store_, MissingQuestion{.place = "counter_1"})), HasSubstr("is there now"));
}

TEST_F(CoOccurrenceQuestions, SceneTypeIsByWhatOtherScenesHaveInCommon) {
  const SceneTypeAnswer answer = ask(*store_, SceneTypeQuestion{.scene = 4});
  ASSERT_EQ(answer.objects.size(), 2U);
  EXPECT_EQ(answer.places, std::vector<std::string>{"counter_1"});
  ASSERT_EQ(answer.similar.size(), 3U);
  EXPECT_EQ(answer.similar[0].scene.scene, 2);
  EXPECT_DOUBLE_EQ(answer.similar[0].similarity, 0.5);
  ASSERT_FALSE(answer.occasions.empty());
  EXPECT_EQ(answer.occasions[0].first, "breakfast");
  EXPECT_THROW(ask(*store_, SceneTypeQuestion{.scene = 99}), Error);
}

}  // namespace
}  // namespace loci::memory
