#include "memory/questions/environment.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "mapping/base/text/json.h"
#include "memory/questions/emptiness.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kUrdf = R"(<robot name="kitchen">
  <link name="map"/>
  <link name="table_1"><visual><geometry><box size="1 0.8 0.04"/></geometry></visual>
    <collision><geometry><box size="0.8 1 0.04"/></geometry></collision></link>
  <link name="drawer_1_front"><visual><geometry><box size="0.02 0.4 0.2"/></geometry></visual></link>
  <link name="drawer_1_handle"><visual><geometry><box size="0.02 0.1 0.02"/></geometry></visual></link>
  <link name="door_1"><visual><geometry><box size="0.02 0.4 0.6"/></geometry></visual></link>
  <joint name="table_1_joint" type="fixed"><parent link="map"/><child link="table_1"/></joint>
  <joint name="drawer_1_joint" type="prismatic"><parent link="map"/><child link="drawer_1_front"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.4" effort="10" velocity="1"/></joint>
  <joint name="handle_joint" type="fixed"><parent link="drawer_1_front"/><child link="drawer_1_handle"/></joint>
  <joint name="door_1_joint" type="revolute"><parent link="map"/><child link="door_1"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="1.6" effort="10" velocity="1"/></joint>
</robot>)";

constexpr const char* kSidecar = R"({"version": 1, "frame": "map", "links": {
  "table_1": {"class": "table", "confidence": 1, "geometry": {}, "evidence": {}},
  "door_1": {"class": "door", "confidence": 1, "geometry": {}, "evidence": {}, "appliance": "fridge"}}})";

/// A memory with that map: the drawer stands open by 30 cm at eight and is closed at nine.
class Room : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    testing_support::TemporaryFolder::SetUp();
    {
      Store store = Store::open_write(file_);
      const Id run = store.begin_run("test", "{}");
      const Id map = store.add_map("kitchen.urdf", kUrdf, kSidecar);
      const Id table =
          store.add_place({.name = "table_1", .class_name = "table", .map = map, .height = 0.75}, run);
      for (const auto& [time, position] : {std::pair<TimeNs, double>{8, 0.3}, {9, 0.0}}) {
        SceneTransaction scene(store, run);
        const Id id = scene.add_scene(
            {.time = time * 3600 * kSecond, .map = map, .joints = {{"drawer_1_joint", position}}});
        scene.add_visibility({.scene = id, .place = table, .status = ObjectStatus::seen, .fraction = 0.9});
        scene.add_event({.scene = id,
                         .kind = EventKind::joint_changed,
                         .joint = "drawer_1_joint",
                         .joint_position = position,
                         .from_joint_position = 0.3 - position});
        scene.commit();
      }
      store.finish_run(run);
    }
    store_.emplace(Store::open_read(file_));
  }
  void TearDown() override {
    store_.reset();
    testing_support::TemporaryFolder::TearDown();
  }
  std::optional<Store> store_;
};

std::vector<std::string> names(const std::vector<EnvironmentPart>& parts) {
  std::vector<std::string> names;
  for (const EnvironmentPart& part : parts) names.push_back(part.name);
  return names;
}

TEST_F(Room, ConsistsOfTheMapsPartsWithoutTheirPieces) {
  const RoomAnswer answer = ask(*store_, RoomQuestion{});
  EXPECT_THAT(names(answer.parts), ElementsAre("door_1", "drawer_1_front", "table_1"));
  EXPECT_EQ(answer.classes, (std::map<std::string, size_t>{{"door", 1}, {"drawer", 1}, {"table", 1}}));
  EXPECT_EQ(answer.parts[2].height, 0.75);
  EXPECT_EQ(answer.parts[2].last_view->time, 9 * 3600 * kSecond);
  EXPECT_THAT(to_text(answer, TimeWriter(*store_)),
              HasSubstr("door_1 (door, fridge): turns up to 92 degrees"));
  EXPECT_EQ(to_json(answer)["parts"][1]["joint"]["open"], false);
}

TEST_F(Room, SaysWhichPartsANameIsTakenFor) {
  const Snapshot snapshot(*store_, {});
  EXPECT_EQ(kind_meant(snapshot, "fridge drawer"), "drawer");
  EXPECT_EQ(kind_meant(snapshot, "big fridge drawers"), "drawer");
  for (const char* name :
       {"drawer 1", "drawers", "the drawer", "top drawer", "widest drawer", "fridge", "sink"})
    EXPECT_EQ(kind_meant(snapshot, name), "") << name;
  const Query query{"opens", {{"part", "fridge drawer"}}};
  const Question& opens = *find_question("opens");
  EXPECT_THAT(opens.reply(*store_, query, opens.ask(*store_, query)).notes,
              ElementsAre("no part is called 'fridge drawer'; any drawer is meant"));
}

TEST_F(Room, PlacesThatWereLookedAtAreEmptyOrInUse) {
  const auto of_state = [&](const char* state) {
    return names(ask(*store_, RoomQuestion{.state = state}).parts);
  };
  EXPECT_THAT(of_state("empty"), ElementsAre("table_1"));
  EXPECT_THAT(of_state("in use"), testing::IsEmpty());
}

TEST_F(Room, WhatWasSeenWithNothingOnItWasEmpty) {
  const EmptinessAnswer answer = ask(*store_, EmptinessQuestion{.place = "table"});
  ASSERT_EQ(answer.places.size(), 1U);
  EXPECT_EQ(answer.places[0].looks, 2U);
  EXPECT_EQ(answer.places[0].empty.size(), 2U);
  EXPECT_FALSE(answer.places[0].occupied_throughout);
  const Query query{"empty", {{"place", "table"}}, Asks::verdict};
  const Reply reply = ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)});
  EXPECT_EQ(reply.verdict, Verdict::yes);
  EXPECT_THAT(reply.text, HasSubstr("table_1 was empty in 2 of 2 looks"));
  EXPECT_EQ(ask(*store_, EmptinessQuestion{.place = "table", .from = 9 * 3600 * kSecond}).places[0].looks,
            1U);
}

TEST_F(Room, TheWidestDrawerIsOneOfTheDrawers) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    const Id map = store.add_map("drawers.urdf", R"(<robot name="room"><link name="map"/>
      <link name="drawer_1_front"><visual><geometry><box size="0.02 0.4 0.2"/></geometry></visual>
        <collision><geometry><box size="0.02 0.4 0.2"/></geometry></collision></link>
      <link name="drawer_2_front"><visual><geometry><box size="0.02 0.6 0.1"/></geometry></visual>
        <collision><geometry><box size="0.02 0.6 0.1"/></geometry></collision></link>
      <link name="table_1"><visual><geometry><box size="0.8 1.2 0.04"/></geometry></visual>
        <collision><geometry><box size="0.8 1.2 0.04"/></geometry></collision></link>
      <joint name="a" type="fixed"><parent link="map"/><child link="drawer_1_front"/></joint>
      <joint name="b" type="fixed"><parent link="map"/><child link="drawer_2_front"/></joint>
      <joint name="c" type="fixed"><parent link="map"/><child link="table_1"/></joint></robot>)",
                                 "");
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene({.time = 12 * 3600 * kSecond, .map = map});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const auto named = [&](const char* part) {
    const Query query{"room", {{"part", part}}, Asks::place};
    return ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)}).places;
  };
  EXPECT_THAT(named("widest drawer"), ElementsAre("drawer_2_front"));
  EXPECT_THAT(named("tallest drawer"), ElementsAre("drawer_1_front"));
}

TEST_F(Room, OpensWhatHasAJointAsItStoodAtThatTime) {
  const OpensAnswer now = ask(*store_, OpensQuestion{});
  EXPECT_THAT(names(now.parts), ElementsAre("door_1", "drawer_1_front"));
  EXPECT_FALSE(now.parts[0].motion->position);
  EXPECT_EQ(now.parts[1].motion->open(), false);
  EXPECT_EQ(now.parts[1].motion->opened->time, 8 * 3600 * kSecond);
  EXPECT_EQ(now.parts[1].motion->closed->time, 9 * 3600 * kSecond);
  const OpensAnswer then = ask(*store_, OpensQuestion{.as_of = {.at = 8 * 3600 * kSecond}});
  EXPECT_EQ(then.parts[1].motion->open(), true);
  EXPECT_FALSE(then.parts[1].motion->closed);
}

TEST_F(Room, WhatTurnsWithoutLimitsIsClosedNearItsZero) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    const Id map = store.add_map("tap.urdf", R"(<robot name="room"><link name="map"/>
      <link name="tap_1"><visual><geometry><box size="0.02 0.1 0.02"/></geometry></visual></link>
      <joint name="tap_1_joint" type="continuous"><parent link="map"/><child link="tap_1"/>
        <axis xyz="0 0 1"/></joint></robot>)",
                                 "");
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene({.time = 12 * 3600 * kSecond, .map = map, .joints = {{"tap_1_joint", 0.05}}});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const OpensAnswer answer = ask(*store_, OpensQuestion{});
  ASSERT_THAT(names(answer.parts), ElementsAre("tap_1"));
  EXPECT_EQ(answer.parts[0].motion->open(), false);
  EXPECT_THAT(to_text(answer, TimeWriter(*store_)), HasSubstr("turns up to 180 degrees"));
}

TEST_F(Room, BetweenLooksThatDifferTheStateIsNotKnown) {
  const auto reply = [&](const char* part, const char* at, Asks asks) {
    const Query query{.question = "opens", .arguments = {{"part", part}, {"at", at}}, .asks = asks};
    return ask(*store_, query).reply({*store_, query, read_as_of(*store_, at, ""), TimeWriter(*store_)});
  };
  const Reply between = reply("drawer", "08:30", Asks::open);
  EXPECT_EQ(between.verdict, Verdict::not_observed);
  EXPECT_EQ(between.text,
            "Not observed: drawer_1 was open at 08:00 and closed at 09:00, and nobody looked in between.");
  EXPECT_EQ(reply("drawer", "08:30", Asks::closed).verdict, Verdict::not_observed);
  EXPECT_EQ(reply("drawer", "08:00", Asks::open).text, "Yes: drawer_1 was open, as of 08:00.");
  EXPECT_EQ(reply("drawer", "07:30", Asks::open).verdict, Verdict::not_observed) << "before the first look";
  EXPECT_EQ(reply("drawer", "now", Asks::open).text, "No: drawer_1 is closed, as of 09:00.");
  const OpensAnswer open = ask(*store_, OpensQuestion{.state = "open", .as_of = {.at = 30600 * kSecond}});
  EXPECT_THAT(names(open.parts), testing::IsEmpty());
  EXPECT_THAT(names(open.not_observed), ElementsAre("door_1", "drawer_1_front"));
}

TEST_F(Room, BetweenLooksThatAgreeTheStateIsProbable) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene(
        {.time = 12 * 3600 * kSecond, .map = store.maps().at(0).id, .joints = {{"drawer_1_joint", 0.0}}});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const Query query{
      .question = "opens", .arguments = {{"part", "drawer"}, {"at", "10:00"}}, .asks = Asks::open};
  EXPECT_EQ(ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)}).text,
            "No, probably: drawer_1 was closed, as seen at 09:00 and 12:00.");
}

TEST_F(Room, WhatNobodyLookedAtIsNotUnopened) {
  const OpensAnswer unopened = ask(*store_, OpensQuestion{.state = "unopened"});
  EXPECT_THAT(names(unopened.parts), testing::IsEmpty());
  EXPECT_THAT(names(unopened.others), ElementsAre("drawer_1_front"));
  EXPECT_THAT(names(unopened.not_observed), ElementsAre("door_1"));
  EXPECT_THAT(to_text(unopened, TimeWriter(*store_)),
              testing::StartsWith("None is unopened.\nNot observed: door_1"));
  const auto reply = [&](const char* place, const char* kind, Asks asks) {
    const Query query{.question = "changes", .arguments = {{"place", place}, {"kind", kind}}, .asks = asks};
    return ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)});
  };
  for (const Asks asks : {Asks::verdict, Asks::number, Asks::last_time, Asks::objects})
    EXPECT_EQ(reply("fridge", "opened", asks).text,
              "Not observed: no look showed whether the fridge was open.");
  EXPECT_EQ(reply("fridge", "opened", Asks::verdict).verdict, Verdict::not_observed);
  EXPECT_FALSE(reply("fridge", "opened", Asks::number).number);
  EXPECT_EQ(reply("fridge", "left", Asks::verdict).text, "Not observed: nobody looked into the fridge then.");
  EXPECT_EQ(reply("drawer", "opened", Asks::verdict).verdict, Verdict::yes);
}

TEST_F(Room, AJointStandsAsItWasSeenLastThoughLaterScenesDoNotShowIt) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene({.time = 10 * 3600 * kSecond, .map = store.maps().at(0).id});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const OpensAnswer answer = ask(*store_, OpensQuestion{});
  ASSERT_TRUE(answer.parts[1].motion->position);
  EXPECT_EQ(answer.parts[1].motion->open(), false);
  EXPECT_EQ(answer.parts[1].motion->seen->time, 9 * 3600 * kSecond);
}

TEST_F(Room, PartsAreCalledByNameClassOrAppliance) {
  const auto called = [&](const char* part) { return names(ask(*store_, OpensQuestion{part, {}}).parts); };
  EXPECT_THAT(called("drawer 1"), ElementsAre("drawer_1_front"));
  EXPECT_THAT(called("drawers"), ElementsAre("drawer_1_front"));
  EXPECT_THAT(called("the fridge"), ElementsAre("door_1"));
  EXPECT_THAT(called("table"), ElementsAre());
  EXPECT_THROW(called("oven"), UnknownName);
}

TEST_F(Room, ItsPartsHaveTheSizeOfTheirShapesAndTheHeightOfTheirSurface) {
  const Query query{.question = "room", .arguments = {{"part", "table"}}, .asks = Asks::property};
  EXPECT_EQ(ask(*store_, query).reply({*store_, query, {}, TimeWriter(*store_)}).text,
            "Table_1 measures 1.00 x 0.80 m and is 0.75 m high.");
}

TEST_F(Room, DrawersAreCalledByTheirLevel) {
  store_.reset();
  {
    std::string urdf = "<robot name=\"kitchen\"><link name=\"map\"/>";
    for (const auto& [name, z] : std::map<std::string, double>{
             {"drawer_1", 0.8}, {"drawer_2", 0.5}, {"drawer_3", 0.2}, {"drawer_4", 0.21}})
      urdf += fmt::format(
          "<link name=\"{0}_front\"><visual><geometry><box size=\"0.02 0.4 0.2\"/></geometry></visual></link>"
          "<joint name=\"{0}_joint\" type=\"prismatic\"><origin xyz=\"0 0 {1}\"/><parent link=\"map\"/>"
          "<child link=\"{0}_front\"/><axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"0.4\" effort=\"1\" "
          "velocity=\"1\"/></joint>",
          name, z);
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene(
        {.time = 11 * 3600 * kSecond, .map = store.add_map("drawers.urdf", urdf + "</robot>", "")});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const auto called = [&](const char* part) { return names(ask(*store_, OpensQuestion{part, {}}).parts); };
  EXPECT_THAT(called("top drawer"), ElementsAre("drawer_1_front"));
  EXPECT_THAT(called("middle drawer"), ElementsAre("drawer_2_front"));
  EXPECT_THAT(called("lowest drawers"), ElementsAre("drawer_3_front", "drawer_4_front"));
}

/// What is said of a part that is no place.
std::string hint_for(const Store& store, const std::string& part) {
  try {
    Snapshot(store, {}).find_places(part);
  } catch (const UnknownName& error) {
    return error.hint();
  }
  return "it is a place";
}

TEST_F(Room, APartWithoutAnInsideInTheMapIsNoPlaceAndIsNamed) {
  EXPECT_EQ(hint_for(*store_, "fridge"), "door_1 is called so, but the map has no surface in or on door_1");
}

TEST_F(Room, APartThatNoSceneSawInsideIsNoPlaceAndIsNamed) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    const Id map = store.add_map("drawer.urdf", R"(<robot name="room"><link name="map"/>
      <link name="drawer_1"><visual><geometry><box size="0.02 0.4 0.2"/></geometry></visual></link>
      <link name="drawer_1_bottom"/>
      <joint name="a" type="prismatic"><parent link="map"/><child link="drawer_1"/>
        <limit lower="0" upper="0.4" effort="10" velocity="1"/></joint>
      <joint name="b" type="fixed"><parent link="drawer_1"/><child link="drawer_1_bottom"/></joint></robot>)",
                                 R"({"version": 1, "frame": "map", "links": {"drawer_1_bottom": {
      "class": "drawer_bottom", "confidence": 1, "evidence": {},
      "geometry": {"height": 0.5, "outline": [[0, 0], [0.4, 0], [0.4, 0.4], [0, 0.4]]}}}})");
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_scene({.time = 12 * 3600 * kSecond, .map = map});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  EXPECT_EQ(hint_for(*store_, "drawer_1"), "drawer_1 is called so, but no scene has seen its contents");
}

class RoomWithoutMap : public testing_support::DayFixture {};

TEST_F(RoomWithoutMap, ConsistsOfThePlacesThatWereFound) {
  const RoomAnswer answer = ask(*store_, RoomQuestion{});
  EXPECT_TRUE(answer.map.empty());
  EXPECT_THAT(names(answer.parts), ElementsAre("counter_1", "drawer_1_bottom", "table_1"));
  EXPECT_EQ(answer.parts[0].objects, 2U);
  EXPECT_TRUE(ask(*store_, OpensQuestion{}).parts.empty());
}

}  // namespace
}  // namespace loci::memory
