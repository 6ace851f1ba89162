// Corrections by people: what they change, what stays known, and that undo brings everything back.

#include "memory/edits/edits.h"

#include <fmt/format.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/world/urdf.h"
#include "memory/catalogue/catalogue.h"
#include "memory/questions/contents.h"
#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/facts.h"
#include "memory/questions/location.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/objects.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/snapshot.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::day_time;
using testing_support::SyntheticDay;

class Edits : public testing_support::DayFixture {
 protected:
  /// Writes as if it were some days after the day was taken in.
  template <class Change>
  auto edit(Change change) {
    store_.reset();
    const auto result = [&] {
      Store store = Store::open_write(file_, {.now = SyntheticDay::kKnownSecond + ++days_ * 86400 * kSecond});
      return change(store);
    }();
    store_.emplace(Store::open_read(file_));
    return result;
  }
  std::string refusal(const std::function<void(Store&)>& change) {
    try {
      edit([&](Store& store) {
        change(store);
        return 0;
      });
    } catch (const Error& error) {
      store_.emplace(Store::open_read(file_));
      return error.what();
    }
    return "not refused";
  }
  /// All that questions can tell, now and at times of the day.
  std::string everything() const {
    std::string all = text(ask(*store_, ChangesQuestion{})) + text(ask(*store_, TimelineQuestion{}));
    for (const char* clock : {"08:00", "08:30", "09:00", "09:30", "10:30"})
      all += text(ask(*store_, ObjectsQuestion{{}, at(clock)})) +
             text(ask(*store_, ContentsQuestion{"counter_1", at(clock), {}})) +
             text(ask(*store_, ContentsQuestion{"table_1", at(clock), {}}));
    // What is restored is said by the person who restored it.
    const std::string by_user = " - says user";
    for (size_t i = all.find(by_user); i != std::string::npos; i = all.find(by_user))
      all.erase(i, by_user.size());
    return all;
  }
  void expect_sound() const {
    NoProgress quiet;
    EXPECT_THAT(store_->verify(quiet).problems, IsEmpty());
  }

  int days_ = 0;
};

TEST_F(Edits, MergedObjectsAreOneWithOneHistory) {
  const Edit done = edit([](Store& store) { return merge_objects(store, 4, 2); });
  EXPECT_EQ(done.text, "object_4 is object_2") << "the elder keeps its number";
  EXPECT_FALSE(store_->belief(4).has_value());
  const auto history = ask(*store_, HistoryQuestion{"object_2"}).objects.at(0);
  EXPECT_EQ(history.now.place->name, "drawer_1_bottom");
  EXPECT_EQ(history.now.sightings, 3U);
  const Change& last = history.changes.back();
  EXPECT_EQ(last.kind, EventKind::moved) << "it was known, so it has come from somewhere";
  EXPECT_EQ(last.from_place->name, "table_1");
  expect_sound();
}

TEST_F(Edits, AMergeMakesNoStatementOfWhatACatalogueSays) {
  const FactRow guess{.object = 4,
                      .key = "class",
                      .value = "apple",
                      .probability = 0.86,
                      .clock = {.source = kCatalogueSource}};
  edit([&](Store& store) { return store.add_fact(guess, store.begin_run("test", "{}")); });
  edit([](Store& store) { return merge_objects(store, 4, 2); });
  EXPECT_THAT(ask(*store_, FactsQuestion{"object_2", "class", {}}).facts, IsEmpty());
  expect_sound();
}

TEST_F(Edits, WhatWasKnownBeforeIsStillKnownToHaveBeenKnown) {
  edit([](Store& store) { return merge_objects(store, 2, 4); });
  const AsOf before = {std::nullopt, SyntheticDay::kKnownSecond};
  EXPECT_TRUE(store_->belief(4, before).has_value());
  EXPECT_EQ(store_->belief(2, before)->last_scene, 3);
  EXPECT_EQ(store_->belief(2)->last_scene, 6);
}

TEST_F(Edits, ObjectsThatWereSeenTogetherAreTwo) {
  EXPECT_THAT(refusal([](Store& store) { merge_objects(store, 1, 2); }), HasSubstr("seen together"));
  EXPECT_THAT(refusal([](Store& store) { merge_objects(store, 1, 1); }), HasSubstr("itself"));
  EXPECT_THAT(refusal([](Store& store) { merge_objects(store, 1, 99); }), HasSubstr("no object_99"));
}

TEST_F(Edits, ASplitObjectGoesOnAsAnother) {
  const size_t seen = store_->observations_of(1).size();
  edit([](Store& store) { return split_object(store, 1, testing_support::day_time("09:15")); });
  const Id made = store_->max_object_id();
  EXPECT_EQ(store_->observations_of(1).size() + store_->observations_of(made).size(), seen);
  EXPECT_EQ(store_->belief(made)->status, ObjectStatus::seen);
  EXPECT_EQ(ask(*store_, WhereQuestion{object_name(made)}).objects.at(0).place->name, "counter_1");
  EXPECT_EQ(store_->belief(1)->status, ObjectStatus::gone) << "what was believed before stays";
  const auto changes = ask(*store_, HistoryQuestion{object_name(made)}).objects.at(0).changes;
  ASSERT_FALSE(changes.empty());
  EXPECT_EQ(changes[0].kind, EventKind::appeared);
  expect_sound();
  EXPECT_THAT(refusal([](Store& store) { split_object(store, 1, testing_support::day_time("07:00")); }),
              HasSubstr("not before"));
}

TEST_F(Edits, UndoBringsEverythingBackAndRedoAgain) {
  const std::string first = everything();
  edit([](Store& store) { return merge_objects(store, 2, 3); });
  const std::string merged = everything();
  edit([](Store& store) { return split_object(store, 1, testing_support::day_time("09:15")); });
  const std::string split = everything();
  EXPECT_NE(first, merged);
  EXPECT_NE(merged, split);
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(everything(), merged);
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(everything(), first);
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(everything(), merged);
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(everything(), split);
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(everything(), merged);
  expect_sound();
  EXPECT_EQ(edits(*store_).done.size(), 1U);
  EXPECT_EQ(edits(*store_).undone.size(), 1U);
}

TEST_F(Edits, ANewEditEndsWhatCouldBeRedone) {
  edit([](Store& store) { return say(store, "object_1", "owner", "Ada"); });
  edit([](Store& store) { return undo(store); });
  edit([](Store& store) { return say(store, "object_1", "owner", "Grace"); });
  EXPECT_THAT(edits(*store_).undone, IsEmpty());
  EXPECT_THAT(refusal([](Store& store) { redo(store); }), HasSubstr("nothing to redo"));
}

TEST_F(Edits, WhatIsSaidIsTakenBackToWhatWasSaidBefore) {
  const auto owner = [&] {
    const auto facts = ask(*store_, FactsQuestion{"object_1", "owner", {}}).facts;
    return facts.empty() ? std::string() : facts.back().value;
  };
  for (const char* name : {"Ada", "Grace"})
    edit([&](Store& store) { return say(store, "object_1", "owner", name); });
  EXPECT_EQ(owner(), "Grace");
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(owner(), "Ada");
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(owner(), "");
  EXPECT_THAT(refusal([](Store& store) { undo(store); }), HasSubstr("nothing to undo"));
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(owner(), "Ada");
}

TEST_F(Edits, ARenamedPlaceIsCalledSoInAnswersAndFoundByBothNames) {
  const std::string before = text(ask(*store_, ContentsQuestion{"counter_1", at("09:30"), {}}));
  const Edit done = edit([](Store& store) { return name_place(store, "counter_1", "worktop"); });
  EXPECT_EQ(done.text, "counter_1: name is worktop");
  const std::string after = text(ask(*store_, ContentsQuestion{"worktop", at("09:30"), {}}));
  EXPECT_THAT(after, HasSubstr("worktop"));
  EXPECT_THAT(after, testing::Not(HasSubstr("counter_1")));
  EXPECT_EQ(text(ask(*store_, ContentsQuestion{"counter_1", at("09:30"), {}})), after);
  edit([](Store& store) { return name_place(store, "worktop", "kitchen worktop"); });
  EXPECT_THAT(text(ask(*store_, ContentsQuestion{"kitchen worktop", at("09:30"), {}})),
              HasSubstr("kitchen worktop"));
  const AsOf once = {std::nullopt, SyntheticDay::kKnownSecond};
  EXPECT_EQ(Snapshot(*store_, once).find_places("counter_1").at(0).name, "counter_1") << "so it was known";
  edit([](Store& store) { return undo(store); });
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(text(ask(*store_, ContentsQuestion{"counter_1", at("09:30"), {}})), before);
  expect_sound();
}

TEST_F(Edits, TwoPlacesHaveTwoNames) {
  EXPECT_THAT(refusal([](Store& store) { name_place(store, "counter_1", "table_1"); }),
              HasSubstr("another place"));
  EXPECT_THAT(refusal([](Store& store) { name_place(store, "counter_1", "object_7"); }),
              HasSubstr("of an object"));
  EXPECT_THAT(refusal([](Store& store) { name_place(store, "balcony", "terrace"); }),
              HasSubstr("no place is called 'balcony'"));
}

/// A day in a home that has a map; the drawer that opens is in it.
class MapEdits : public Edits {
 protected:
  void SetUp() override {
    Edits::SetUp();
    const std::filesystem::path kitchen =
        std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";
    std::string urdf = read_file(kitchen);
    const std::string joint = "drawer_1_front_joint";
    for (size_t at = urdf.find(joint); at != std::string::npos; at = urdf.find(joint))
      urdf.replace(at, joint.size(), "drawer_1_joint");
    edit([&](Store& store) { return store.add_map("kitchen.urdf", urdf, ""); });
  }
  /// The one part that is meant.
  EnvironmentPart part(const std::string& name, const AsOf& as_of = {}) const {
    const std::vector<EnvironmentPart> parts = ask(*store_, RoomQuestion{name, as_of}).parts;
    EXPECT_EQ(parts.size(), 1U) << name;
    return parts.empty() ? EnvironmentPart{} : parts.front();
  }
};

TEST_F(MapEdits, APlaceOfTheMapIsOnePartOfTheRoomByItsNewNameToo) {
  const size_t count = ask(*store_, RoomQuestion{}).parts.size();
  edit([](Store& store) { return name_part(store, "table_1", "breakfast bar"); });
  EXPECT_EQ(ask(*store_, RoomQuestion{}).parts.size(), count) << "not the link and the place apart";
  EXPECT_EQ(part("breakfast bar").map_name, "table_1");
  EXPECT_EQ(part("table_1").name, "breakfast bar");
  EXPECT_TRUE(part("table_1").place.has_value());
}

TEST_F(MapEdits, APartThatIsNoPlaceIsCalledSoAndFoundByBothNames) {
  const std::string link = "drawer_2_front";
  ASSERT_FALSE(part(link).place.has_value());
  const Edit done = edit([&](Store& store) { return name_part(store, link, "Cutlery"); });
  EXPECT_EQ(done.text, "drawer_2_front is called Cutlery");
  EXPECT_EQ(part(link).name, "Cutlery");
  EXPECT_EQ(part("cutlery").map_name, link);
  EXPECT_EQ(part("drawer 2").name, "Cutlery");
  EXPECT_EQ(named_map(*store_)->parent_joint("Cutlery")->name, "drawer_2_front_joint");
  EXPECT_EQ(part(link, {std::nullopt, SyntheticDay::kKnownSecond}).name, link) << "so it was known";
  edit([](Store& store) { return name_part(store, "Cutlery", "Forks"); });
  EXPECT_EQ(part(link).name, "Forks");
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(part(link).name, "Cutlery");
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(part(link).name, link);
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(part(link).name, "Cutlery");
  edit([](Store& store) { return name_part(store, "Cutlery", ""); });
  EXPECT_EQ(part(link).name, link);
  expect_sound();
}

TEST_F(MapEdits, AJointIsCalledSoInWhatOpensAndCanBeCorrectedByItsNewName) {
  const std::string joint = "drawer_2_front_joint";
  edit([&](Store& store) { return name_part(store, joint, "cutlery slide"); });
  for (const std::string& name : {joint, std::string("cutlery slide"), std::string("drawer_2_front")}) {
    const OpensAnswer answer = ask(*store_, OpensQuestion{name, {}});
    ASSERT_EQ(answer.parts.size(), 1U) << name;
    EXPECT_EQ(answer.parts[0].motion->joint, "cutlery slide");
    EXPECT_EQ(answer.parts[0].motion->map_joint, joint);
  }
  ASSERT_NE(named_map(*store_)->find_joint("cutlery slide"), nullptr);
  edit([](Store& store) { return set_joint_type(store, "cutlery slide", "revolute"); });
  EXPECT_EQ(named_map(*store_)->find_joint("cutlery slide")->type, mapping::JointType::revolute)
      << "and keeps it";
}

TEST_F(MapEdits, EventsOfANamedJointSayTheName) {
  ASSERT_THAT(text(ask(*store_, ChangesQuestion{})), HasSubstr("drawer_1 opened"));
  edit([](Store& store) { return name_part(store, "drawer_1_joint", "top slide"); });
  EXPECT_THAT(text(ask(*store_, ChangesQuestion{})),
              testing::AllOf(HasSubstr("top slide opened"), testing::Not(HasSubstr("drawer_1 opened"))));
  EXPECT_TRUE(part("drawer_1_front").motion->opened.has_value()) << "its events are found";
}

TEST_F(MapEdits, TwoPartsHaveTwoNames) {
  for (const char* taken : {"table_1", "counter_1", "drawer_1_front", "drawer_1_joint"})
    EXPECT_THAT(refusal([&](Store& store) { name_part(store, "drawer_2_front", taken); }),
                HasSubstr("is called '" + std::string(taken)));
  EXPECT_THAT(refusal([](Store& store) { name_part(store, "drawer_2_front", "drawer_2_front"); }),
              HasSubstr("already"));
  EXPECT_THAT(refusal([](Store& store) { name_part(store, "drawer_2_fron", "x"); }),
              HasSubstr("drawer_2_front"));
}

TEST_F(MapEdits, NoNameMakesTheMapUnreadable) {
  const std::vector<std::string> bad = {
      "a --> b", "a--b", "<b>",         "\"",       "Tom & Ada",          " blank",
      "blank ",  "a\nb", "\033[31mred", "\xff\xfe", std::string(101, 'x')};
  for (const std::string& name : bad) {
    for (const char* part : {"drawer_2_front", "drawer_2_front_joint", "table_1"}) {
      EXPECT_THAT(refusal([&](Store& store) { name_part(store, part, name); }),
                  testing::Not(HasSubstr("not refused")))
          << name;
    }
    EXPECT_THAT(refusal([&](Store& store) { set_fact(store, "table_1", kPlaceNameKey, name); }),
                testing::Not(HasSubstr("not refused")))
        << name;
  }
  for (const char* name : {"Ada's drawer - the 2nd (left)", "Schublade für Löffel"}) {
    edit([&](Store& store) { return name_part(store, "drawer_2_front_joint", name); });
    edit([&](Store& store) { return set_joint_type(store, name, "revolute"); });
    EXPECT_EQ(named_map(*store_)->find_joint(name)->type, mapping::JointType::revolute);
    edit([](Store& store) { return undo(store); });
    EXPECT_EQ(named_map(*store_)->find_joint(name)->type, mapping::JointType::prismatic);
  }
  expect_sound();
}

/// A day in a home whose map says where objects can be; no scene has looked into its second and third drawer.
class DrawerEdits : public Edits {
 protected:
  void SetUp() override {
    Edits::SetUp();
    const std::filesystem::path samples = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples";
    edit([&](Store& store) {
      return store.add_map("kitchen.urdf", read_file(samples / "kitchen.urdf"),
                           read_file(samples / "kitchen.semantic.json"));
    });
  }
  Reply reply(const Query& query) const {
    const Question& question = *find_question(query.question);
    return question.reply(*store_, query, question.ask(*store_, query));
  }
  /// What `opens` calls the one part that it finds.
  std::string opens(const std::string& name) const {
    const OpensAnswer answer = ask(*store_, OpensQuestion{name, {}});
    return answer.parts.size() == 1 ? answer.parts[0].name : fmt::format("{} parts", answer.parts.size());
  }
};

TEST_F(DrawerEdits, APieceOfFurnitureIsNamedByWhatAnswersCallIt) {
  edit([](Store& store) { return name_part(store, "drawer_2", "cutlery drawer"); });
  for (const char* name : {"cutlery drawer", "the cutlery drawer", "drawer_2", "drawer_2_front",
                           "drawer_2_bottom", "drawer_2_front_joint"}) {
    const std::vector<PlaceRow> places = Snapshot(*store_, {}).find_places(name);
    ASSERT_EQ(places.size(), 1U) << name;
    EXPECT_EQ(places[0].name, "cutlery drawer") << name;
    EXPECT_EQ(opens(name), "cutlery drawer") << name;
  }
  const Reply in = reply({"in", {{"place", "drawer_2"}}});
  EXPECT_THAT(in.text, HasSubstr("in the cutlery drawer"));
  EXPECT_THAT(in.notes, IsEmpty());
  EXPECT_EQ(Snapshot(*store_, {}).joint_name("drawer_2_front_joint"), "cutlery drawer") << "in events";
  EXPECT_THAT(refusal([](Store& store) { name_part(store, "drawer_3", "cutlery drawer"); }),
              HasSubstr("is called 'cutlery drawer'"));
  edit([](Store& store) { return set_joint_type(store, "cutlery drawer", "fixed"); });
  EXPECT_EQ(named_map(*store_)->find_joint("drawer_2_front_joint")->type, mapping::JointType::fixed);
  edit([](Store& store) { return undo(store); });
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(opens("drawer_2"), "drawer_2_front");
  expect_sound();
}

TEST_F(DrawerEdits, ADoorIsCalledInEventsAsPeopleCallIt) {
  edit([](Store& store) { return name_part(store, "door_1", "pan cupboard"); });
  EXPECT_EQ(Snapshot(*store_, {}).joint_name("door_1_joint"), "pan cupboard");
  EXPECT_EQ(opens("pan cupboard"), "pan cupboard");
}

TEST_F(DrawerEdits, ADrawerThatNobodyLookedIntoHasFacts) {
  ASSERT_TRUE(Snapshot(*store_, {}).places_called("drawer_3").empty());
  edit([](Store& store) { return set_fact(store, "drawer_3", "alias", "Spoon drawer"); });
  EXPECT_EQ(Snapshot(*store_, {}).find_places("spoon drawer").at(0).name, "drawer_3_bottom");
  EXPECT_EQ(opens("spoon drawer"), "drawer_3_front");
  EXPECT_EQ(ask(*store_, FactsQuestion{"drawer_3", "", {}}).facts.at(0).value, "Spoon drawer");
  EXPECT_THAT(refusal([](Store& store) { set_fact(store, "object_1", "alias", "drawer_2"); }),
              HasSubstr("a place already"));
  EXPECT_EQ(Snapshot(*store_, {}).places_called("dining table").size(), 1U) << "an alias of the map";
  expect_sound();
}

TEST_F(Edits, AWithdrawnExampleTakesItsClassBack) {
  const auto class_of = [&] {
    const std::vector<Fact> facts = ask(*store_, FactsQuestion{"object_1", "class", {}}).facts;
    return facts.size() == 1 ? facts[0].value : fmt::format("{} facts", facts.size());
  };
  edit([](Store& store) { return set_fact(store, "object_1", "class", "mug"); });
  edit([](Store& store) { return teach(store, "object_1", "cup").report(); });
  edit([](Store& store) { return teach(store, "object_1", "jug").report(); });
  ASSERT_EQ(class_of(), "jug");
  const FactsAnswer removed = edit([](Store& store) { return remove_fact(store, "object_1", "taught", ""); });
  EXPECT_EQ(class_of(), "mug") << "what was said before it was taught";
  EXPECT_THAT(to_text(removed), HasSubstr("object_1 class mug"));
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(class_of(), "jug");
  edit([](Store& store) { return remove_fact(store, "object_1", "taught", ""); });
  EXPECT_EQ(class_of(), "mug");
  edit([](Store& store) { return teach(store, "object_2", "cup").report(); });
  edit([](Store& store) { return set_fact(store, "object_2", "class", "bowl"); });
  edit([](Store& store) { return remove_fact(store, "object_2", "taught", ""); });
  EXPECT_EQ(ask(*store_, FactsQuestion{"object_2", "class", {}}).facts.at(0).value, "bowl")
      << "what was said since";
  expect_sound();
}

TEST_F(Edits, ALabelledThingCanBeFoundByItsClass) {
  const Id observation = store_->observations(1).front().id;
  edit([](Store& store) { return label_observation(store, 1, 0, "mug"); });
  EXPECT_EQ(label_of(*store_, 1, observation), "mug");
  EXPECT_THAT(store_->objects_annotated("mug"), testing::Not(IsEmpty()));
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(label_of(*store_, 1, observation), "");
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(label_of(*store_, 1, observation), "mug");
  EXPECT_THAT(refusal([](Store& store) { label_observation(store, 1, 77, "mug"); }),
              HasSubstr("no observation 77"));
}

TEST_F(Edits, ACorrectedJointIsInANewMapAndTheOldOneStays) {
  const std::filesystem::path kitchen = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";
  edit([&](Store& store) { return store.add_map("kitchen.urdf", read_file(kitchen), ""); });
  const auto type = [&] {
    const MapRow newest = store_->maps().back();
    return mapping::parse_urdf(store_->blob(newest.urdf).bytes, newest.name)
        .find_joint("drawer_2_front_joint")
        ->type;
  };
  ASSERT_EQ(type(), mapping::JointType::prismatic);
  edit([](Store& store) { return set_joint_type(store, "drawer_2_front_joint", "revolute"); });
  EXPECT_EQ(type(), mapping::JointType::revolute);
  EXPECT_EQ(store_->maps().size(), 2U);
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(type(), mapping::JointType::prismatic);
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(type(), mapping::JointType::revolute);
  EXPECT_THAT(refusal([](Store& store) { set_joint_type(store, "drawer_2_front_join", "fixed"); }),
              HasSubstr("drawer_2_front_joint"));
  EXPECT_THAT(refusal([](Store& store) { set_joint_type(store, "drawer_2_front_joint", "bent"); }),
              HasSubstr("prismatic"));
}

TEST_F(Edits, OfTwoOwnersTheOneThatWasSaidLastHolds) {
  edit([](Store& store) { return say(store, "object_2", "owner", "Ada"); });
  edit([](Store& store) { return say(store, "object_4", "owner", "Grace"); });
  edit([](Store& store) { return say(store, "object_2", "alias", "bowl"); });
  edit([](Store& store) { return say(store, "object_4", "alias", "pot"); });
  const auto owners = [&] {
    std::vector<std::string> values;
    for (const Fact& fact : ask(*store_, FactsQuestion{"object_2", "owner", {}}).facts)
      values.push_back(fact.value);
    return values;
  };
  const Edit merged = edit([](Store& store) { return merge_objects(store, 2, 4); });
  EXPECT_EQ(owners(), std::vector<std::string>{"Grace"});
  EXPECT_THAT(merged.note, HasSubstr("owner is Grace, as was said last, not Ada"));
  EXPECT_EQ(ask(*store_, FactsQuestion{"object_2", "alias", {}}).facts.size(), 2U) << "names are many";
  edit([](Store& store) { return undo(store); });
  EXPECT_EQ(owners(), std::vector<std::string>{"Ada"});
  edit([](Store& store) { return say(store, "object_2", "owner", "Ida"); });
  const Edit again = edit([](Store& store) { return merge_objects(store, 2, 4); });
  EXPECT_EQ(owners(), std::vector<std::string>{"Ida"});
  EXPECT_THAT(again.note, HasSubstr("owner is Ida, as was said last, not Grace"));
}

TEST_F(Edits, AnObjectThatIsAnotherNowIsNotMissing) {
  edit([](Store& store) { return merge_objects(store, 2, 4); });
  EXPECT_EQ(ask(*store_, WhereQuestion{"object_4", {}}).objects.at(0).object.id, 2);
  const Query query{"where", {{"object", "object_4"}}};
  const Reply reply = find_question("where")->reply(*store_, query, ask(*store_, query));
  EXPECT_THAT(reply.notes, testing::ElementsAre("object_4 is object_2 now"));
  const AsOf before = {std::nullopt, SyntheticDay::kKnownSecond};
  EXPECT_EQ(ask(*store_, WhereQuestion{"object_4", before}).objects.size(), 1U);
}

TEST_F(Edits, AnUndoneLabelIsInNoAnswer) {
  edit([](Store& store) { return label_observation(store, 1, 0, "gizmo"); });
  const auto says_gizmo = [&](const AsOf& as_of) {
    return text(ask(*store_, AboutQuestion{.subject = "object_1", .as_of = as_of})).find("gizmo") !=
           std::string::npos;
  };
  const AsOf before_it = {std::nullopt, SyntheticDay::kKnownSecond + kSecond},
             with_it = {std::nullopt, SyntheticDay::kKnownSecond + 86400 * kSecond};
  EXPECT_EQ(ask(*store_, WhereQuestion{"gizmo", {}}).objects.at(0).object.id, 1);
  EXPECT_TRUE(says_gizmo({}));
  EXPECT_FALSE(says_gizmo(before_it));
  EXPECT_THROW(ask(*store_, WhereQuestion{"gizmo", before_it}), Error);
  edit([](Store& store) { return undo(store); });
  EXPECT_THROW(ask(*store_, WhereQuestion{"gizmo", {}}), Error);
  EXPECT_FALSE(says_gizmo({}));
  EXPECT_TRUE(says_gizmo(with_it)) << "it was known then";
  edit([](Store& store) { return redo(store); });
  EXPECT_EQ(ask(*store_, WhereQuestion{"gizmo", {}}).objects.at(0).object.id, 1);
}

}  // namespace
}  // namespace loci::memory
