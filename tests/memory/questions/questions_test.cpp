#include "mapping/base/text/json.h"
#include "memory/questions/contents.h"
#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/near.h"
#include "memory/questions/objects.h"
#include "memory/questions/presence.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/visits.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::day_time;

class Questions : public testing_support::DayFixture {
 protected:
  ObjectBelief where(const std::string& subject, const AsOf& as_of = {}) const {
    const WhereAnswer answer = ask(*store_, WhereQuestion{.subject = subject, .as_of = as_of});
    EXPECT_EQ(answer.objects.size(), 1U) << subject;
    return answer.objects.at(0);
  }
  WasObject was(const std::string& subject, const std::string& place, const std::string& from,
                const std::string& to) const {
    const WasAnswer answer = ask(*store_, WasQuestion{.subject = subject,
                                                      .place = place,
                                                      .from = testing_support::day_time(from),
                                                      .to = testing_support::day_time(to)});
    EXPECT_EQ(answer.objects.size(), 1U);
    return answer.objects.at(0);
  }
  std::string message(const std::function<void()>& action) const {
    try {
      action();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(Questions, TheMemoryIsSound) {
  NoProgress quiet;
  EXPECT_THAT(store_->verify(quiet).problems, testing::IsEmpty());
}

TEST_F(Questions, WhereFollowsAnObjectThroughTheDay) {
  EXPECT_EQ(where("red", at("08:00")).place->name, "table_1");
  EXPECT_EQ(where("red", at("09:10")).status, ObjectStatus::gone);
  EXPECT_EQ(where("red").place->name, "counter_1");
  EXPECT_EQ(where("red").last_seen->scene, 6);
  EXPECT_THAT(text(ask(*store_, WhereQuestion{"red"})),
              HasSubstr("tea cup (object_1, red, 8 x 8 x 10 cm) is on counter_1 at (3.60, 0.40, 0.80) "
                        "(98 % sure), last seen at 10:30"));
}

TEST_F(Questions, WhereListsAlternativeLocations) {
  store_.reset();
  Id fresh = 0;
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    const Id id = scene.add_scene({.time = testing_support::day_time("20:00")});
    const Id seen = scene.add_observation(
        {.scene = id, .number = 0, .position = Vector3d(0.2, 0.3, 0.8), .color = "red"});
    fresh = scene.add_object({});
    const auto considered = [&](Id object, Explanation explanation, double probability) {
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = object,
                             .explanation = explanation,
                             .probability = probability,
                             .chosen = object == fresh});
    };
    considered(fresh, Explanation::appear, 0.6);
    considered(1, Explanation::move, 0.3);
    considered(1, Explanation::stay, 0.05);
    considered(2, Explanation::move, 0.01);
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const WhereAnswer answer = ask(*store_, WhereQuestion{"object_1"});
  ASSERT_EQ(answer.objects.at(0).alternatives.size(), 1U);
  const AlternativeLocation& other = answer.objects[0].alternatives[0];
  EXPECT_DOUBLE_EQ(other.probability, 0.35);
  EXPECT_EQ(other.taken_for->id, fresh);
  EXPECT_THAT(text(answer), HasSubstr("or else"));
  EXPECT_NEAR(to_json(answer)["objects"][0]["alternatives"][0]["probability"].get<double>(), 0.35, 1e-12);
  EXPECT_TRUE(where("object_2").alternatives.empty());
}

TEST_F(Questions, AnObjectIsCalledByTheBestNameKnown) {
  const auto label = [&] { return where("object_2").object.label.value_or("none"); };
  const auto write = [&](auto add) {
    store_.reset();
    {
      Store store = Store::open_write(file_);
      SceneTransaction scene(store, store.begin_run("test", "{}"));
      add(scene);
      scene.commit();
    }
    store_.emplace(Store::open_read(file_));
  };
  const auto state = [&](const std::string& key, const std::string& value) {
    write([&](SceneTransaction& scene) {
      scene.add_fact({.object = 2, .key = key, .value = value, .clock = {.source = "user"}});
    });
  };
  const ObjectObservation seen = store_->observations_of(2).front();
  const auto annotate = [&](const std::string& type, const std::string& value) {
    write([&](SceneTransaction& scene) {
      scene.add_annotation({.scene = seen.observation.scene,
                            .observation = seen.observation.id,
                            .type = type,
                            .value = value});
    });
  };
  EXPECT_EQ(label(), "none");
  annotate("loci.annotation.ClassificationAnnotation", "jar");
  EXPECT_EQ(label(), "jar");
  annotate("loci.annotation.ProductAnnotation", "Blue's jam");
  EXPECT_EQ(label(), "Blue's jam");
  state("class", "jam jar");
  EXPECT_EQ(label(), "jam jar");
  EXPECT_THAT(text(ask(*store_, WhereQuestion{"object_2"})), HasSubstr("jam jar (object_2, blue"));
  EXPECT_THAT(text(ask(*store_, ObjectsQuestion{})), HasSubstr("object_2 (jam jar)"));
  EXPECT_EQ(to_json(ask(*store_, WhereQuestion{"object_2"}))["objects"][0]["label"], "jam jar");
  state("product", "Plum jam");
  EXPECT_EQ(label(), "Plum jam");
  state("alias", "grandma's jam");
  EXPECT_EQ(label(), "grandma's jam");
}

TEST_F(Questions, WhatIsOutOfViewStaysRemembered) {
  const ObjectBelief blue = where("blue", at("08:40"));
  EXPECT_EQ(blue.place->name, "table_1");
  EXPECT_EQ(blue.status, ObjectStatus::out_of_view);
  EXPECT_EQ(blue.scenes_out_of_view, 1U);
  EXPECT_EQ(blue.last_seen->time, testing_support::day_time("08:00"));
}

TEST_F(Questions, WhatWasLookedForAndIsNotThereHasGone) {
  const ObjectBelief red = where("red", at("09:10"));
  EXPECT_EQ(red.last_missed->scene, 3);
  EXPECT_THAT(text(ask(*store_, WhereQuestion{"red", at("09:10")})),
              HasSubstr("has gone. It was on table_1 at (0.30, 0.30, 0.80), last seen at 08:00 (scene 1, "
                        "frame 0); since then looked for at 09:00 and not seen"));
}

TEST_F(Questions, KnownAtForgetsWhatWasLearntLater) {
  const AsOf then{.at = {}, .known_at = testing_support::SyntheticDay::kKnownFirst};
  EXPECT_EQ(where("red", then).status, ObjectStatus::gone);
  EXPECT_EQ(ask(*store_, ScenesQuestion{.as_of = then}).scenes.size(), 3U);
  EXPECT_EQ(ask(*store_, ObjectsQuestion{.as_of = then}).objects.size(), 3U);
  EXPECT_TRUE(where("red", then).object.aliases.empty());
}

TEST_F(Questions, SubjectsAreIdsAliasesColoursSizesTextsAndPlaces) {
  for (const char* subject :
       {"object_1", "tea cup", "Tea Cup", "the red thing", "darjeeling", "red on counter_1", "small red"})
    EXPECT_EQ(where(subject).object.id, 1) << subject;
  EXPECT_EQ(ask(*store_, WhereQuestion{"small"}).objects.size(), 4U);
  EXPECT_EQ(ask(*store_, WhereQuestion{"on counter_1"}).objects.size(), 2U);
  EXPECT_EQ(ask(*store_, WhereQuestion{"counter_1"}).objects.size(), 2U);
}

TEST_F(Questions, UnknownNamesAreErrorsWithTheNearest) {
  EXPECT_THAT(message([&] { ask(*store_, WhereQuestion{"purple"}); }),
              HasSubstr("nothing is known as 'purple'"));
  EXPECT_THAT(message([&] { ask(*store_, WhereQuestion{"bleu"}); }), HasSubstr("did you mean 'blue'?"));
  EXPECT_THAT(message([&] { ask(*store_, WhereQuestion{"object_9"}); }), HasSubstr("did you mean 'object_"));
  EXPECT_THAT(message([&] { ask(*store_, ContentsQuestion{"tabel_1"}); }),
              HasSubstr("did you mean 'table_1'?"));
  EXPECT_THAT(message([&] { ask(*store_, WhereQuestion{"red blue"}); }),
              HasSubstr("no object is 'red blue'"));
}

TEST_F(Questions, ANameThatWasLearntLaterSaysSo) {
  EXPECT_THAT(message([&] {
                ask(*store_, WhereQuestion{"green", at("08:10")});
              }),
              HasSubstr("it was first seen at 08:30"));
}

TEST_F(Questions, SqlInAQuestionIsOnlyANameThatNobodyKnows) {
  for (const char* words :
       {"'; DROP TABLE object; --", "\" OR 1=1 --", "red' OR 'a'='a", "milk* NEAR(a b)"}) {
    EXPECT_THROW(ask(*store_, WhereQuestion{words}), Error) << words;
    EXPECT_THROW(ask(*store_, ContentsQuestion{.place = words}), Error) << words;
    EXPECT_TRUE(store_->objects_with_text(words).empty()) << words;
  }
  EXPECT_EQ(where("red").object.id, 1);
  EXPECT_EQ(store_->objects_with_text("darjeeling"), std::vector<Id>{1});
}

TEST_F(Questions, WhatIsNearIsFoundByPositionAndTime) {
  EXPECT_EQ(store_->objects_near({0.3, 0.3, 0.8}, 0.1, at("08:10")), std::vector<Id>{1});
  EXPECT_EQ(store_->objects_near({3.6, 0.4, 0.8}, 0.1), std::vector<Id>{1});
  EXPECT_TRUE(store_->objects_near({0.3, 0.3, 0.8}, 0.05).empty());
}

TEST_F(Questions, OnListsWhatIsThereAndWhatIsNoLonger) {
  const ContentsAnswer now = ask(*store_, ContentsQuestion{"table_1"});
  ASSERT_EQ(now.places.size(), 1U);
  ASSERT_EQ(now.places[0].there.size(), 1U);
  EXPECT_EQ(now.places[0].there[0].object.color, std::optional<std::string>("blue"));
  EXPECT_EQ(now.places[0].last_view->time, testing_support::day_time("10:00"));
  EXPECT_EQ(ask(*store_, ContentsQuestion{"table_1", at("08:40")}).places[0].there.size(), 2U);
  EXPECT_EQ(ask(*store_, ContentsQuestion{"table_1", at("09:10")}).places[0].gone.size(), 1U);
}

TEST_F(Questions, APlaceIsFoundByTheBeginningOfItsNameAndByItsClass) {
  EXPECT_EQ(ask(*store_, ContentsQuestion{"drawer_1"}).places[0].there.size(), 1U);
  EXPECT_EQ(ask(*store_, ContentsQuestion{"counter"}).places[0].place.name, "counter_1");
  EXPECT_THAT(text(ask(*store_, ContentsQuestion{"drawer_1"})), HasSubstr("1 object is in drawer_1_bottom"));
}

TEST_F(Questions, WasIsYesWithTheFramesWhereItWasSeenThere) {
  const WasObject red = was("red", "table_1", "07:50", "08:10");
  EXPECT_EQ(red.verdict, Verdict::yes);
  ASSERT_EQ(red.seen_there.size(), 1U);
  EXPECT_EQ(red.seen_there[0].frame, std::optional<int64_t>(0));
}

TEST_F(Questions, WasIsNoWhereThePlaceWasLookedAtWithoutIt) {
  const WasObject red = was("red", "table_1", "08:50", "09:10");
  EXPECT_EQ(red.verdict, Verdict::no);
  EXPECT_EQ(red.before->scene, 1);
  ASSERT_EQ(red.views.size(), 1U);
  EXPECT_GT(red.views[0].fraction, 0.8);
  EXPECT_EQ(was("green", "table_1", "08:50", "09:10").verdict, Verdict::no);
}

TEST_F(Questions, WasIsNoWhereItWasSeenElsewhere) {
  const WasObject red = was("red", "table_1", "09:20", "09:40");
  EXPECT_EQ(red.verdict, Verdict::no);
  ASSERT_EQ(red.seen_elsewhere.size(), 1U);
  EXPECT_EQ(red.seen_elsewhere[0].second, "counter_1");
}

/// A look elsewhere at the end of a period says nothing of its beginning.
TEST_F(Questions, WasIsNoOnlyWhereThePeriodIsCovered) {
  const WasObject red = was("red", "table_1", "08:30", "09:40");
  EXPECT_EQ(red.verdict, Verdict::not_observed);
  EXPECT_THAT(red.reason, HasSubstr("seen there at 08:00; not there at 2 looks from 09:00 to 09:30"));
  EXPECT_GT(red.probability, 0.2);
  EXPECT_EQ(was("red", "table_1", "09:00", "09:30").verdict, Verdict::no) << "covered from end to end";
  EXPECT_LE(was("red", "table_1", "09:00", "09:30").probability, 0.2);
}

TEST_F(Questions, WasIsNotObservedWithoutScenesOutOfViewOrBehindSomething) {
  const WasObject no_scene = was("red", "table_1", "11:00", "12:00");
  EXPECT_EQ(no_scene.verdict, Verdict::not_observed);
  EXPECT_THAT(no_scene.reason, HasSubstr("no scene"));
  const WasObject away = was("blue", "table_1", "08:20", "08:40");
  EXPECT_EQ(away.verdict, Verdict::not_observed);
  EXPECT_THAT(away.reason, HasSubstr("out of view"));
  EXPECT_EQ(away.before->scene, 1);
  EXPECT_EQ(away.after->scene, 3);
  const WasObject hidden = was("blue", "table_1", "09:50", "10:10");
  EXPECT_EQ(hidden.verdict, Verdict::not_observed);
  EXPECT_THAT(hidden.reason, HasSubstr("hidden"));
  EXPECT_THAT(message([&] { was("red", "table_1", "09:00", "08:00"); }),
              HasSubstr("first time is after the second"));
}

/// `was --at` agrees with `where --at`, also where nobody looked at that moment.
TEST_F(Questions, WasAtAMomentIsWhatTheBeliefSaysOfIt) {
  const auto reply = [&](const char* object, const char* place, const char* time) {
    const Query query{.question = "was",
                      .arguments = {{"object", object}, {"place", place}, {"at", time}},
                      .asks = Asks::verdict};
    const TimeWriter times(*store_);
    return ask(*store_, query, {}).reply({.store = *store_, .query = query, .as_of = {}, .times = times});
  };
  const Reply there = reply("blue", "table_1", "2026-05-01 08:40");
  EXPECT_EQ(there.verdict, Verdict::yes);
  EXPECT_THAT(there.text, HasSubstr("was on table_1, seen there at 08:00 and 09:00"));
  const Reply elsewhere = reply("red", "table_1", "2026-05-01 10:15");
  EXPECT_EQ(elsewhere.verdict, Verdict::no);
  EXPECT_LT(*elsewhere.probability, 0.5);
  EXPECT_THAT(elsewhere.text, HasSubstr("was on counter_1, seen there at 09:30"));
}

TEST_F(Questions, WhatASentenceHasNoRoomForBeginsItsEvidence) {
  const Query query{.question = "was",
                    .arguments = {{"object", "blue"},
                                  {"place", "table_1"},
                                  {"from", "2026-05-01 08:20"},
                                  {"to", "2026-05-01 08:40"}},
                    .asks = Asks::verdict};
  const TimeWriter times(*store_);
  const Reply reply =
      ask(*store_, query, {}).reply({.store = *store_, .query = query, .as_of = {}, .times = times});
  EXPECT_THAT(reply.text, testing::EndsWith("it was out of view in the one scene of that time."));
  EXPECT_THAT(reply.evidence.at(0), testing::StartsWith("it is believed to have been there ("));
}

TEST_F(Questions, WasOfAnUndescribedContainerThatNobodyOpenedIsNotObserved) {
  EXPECT_EQ(was("yellow", "drawer_1", "08:00", "09:40").verdict, Verdict::not_observed);
  EXPECT_EQ(was("yellow", "drawer_1", "10:00", "11:00").verdict, Verdict::yes);
}

TEST_F(Questions, ChangesAreListedInOrderAndCanBeNarrowed) {
  const auto kinds = [](const ChangesAnswer& answer) {
    std::vector<std::string> result;
    for (const Change& change : answer.changes) result.emplace_back(to_text(change.kind));
    return result;
  };
  EXPECT_EQ(ask(*store_, ChangesQuestion{}).changes.size(), 8U);
  EXPECT_THAT(kinds(ask(*store_, ChangesQuestion{.from = testing_support::day_time("08:50"),
                                                 .to = testing_support::day_time("10:00")})),
              ElementsAre("gone", "moved", "hidden"));
  EXPECT_THAT(kinds(ask(*store_, ChangesQuestion{.subject = "red"})),
              ElementsAre("appeared", "gone", "moved"));
  EXPECT_THAT(kinds(ask(*store_, ChangesQuestion{.place = "drawer_1"})),
              ElementsAre("joint_changed", "appeared"));
  const std::string all = text(ask(*store_, ChangesQuestion{}));
  EXPECT_THAT(all, HasSubstr("09:30 (after 08:00)  tea cup (object_1, red, 8 x 8 x 10 cm) moved from "
                             "table_1 to counter_1 by 3.3 m (90 % sure) [scene 4, frame 3]"));
  EXPECT_THAT(all, HasSubstr("drawer_1 opened from 0.00 to 0.35"));
}

TEST_F(Questions, WhatTheNextLookShowsMayHaveHappenedInThePeriod) {
  const auto moves = [&](const std::string& from, const std::string& to) {
    return ask(*store_, ChangesQuestion{.from = day_time(from), .to = day_time(to), .kind = "moved"});
  };
  EXPECT_TRUE(moves("08:10", "08:50").changes.empty());
  ASSERT_EQ(moves("08:10", "08:50").perhaps.size(), 1U);
  EXPECT_EQ(moves("08:10", "08:50").perhaps[0].time, day_time("09:30"));
  EXPECT_EQ(to_json(moves("08:10", "08:50"))["perhaps"][0]["time"], "2026-05-01T09:30:00Z");
  EXPECT_THAT(text(moves("08:10", "08:50")), HasSubstr("perhaps  09:30 (after 08:00)"));
  EXPECT_TRUE(moves("09:40", "10:20").perhaps.empty());
  EXPECT_TRUE(moves("08:10", "09:40").perhaps.empty()) << "it is among the changes";
}

TEST_F(Questions, AViewOfACornerIsNoLook) {
  const Id table = store_->places().front().id;
  store_.reset();
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    const Id id = scene.add_scene({.time = day_time("11:00")});
    scene.add_visibility({.scene = id, .place = table, .status = ObjectStatus::seen, .fraction = 0.05});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const Snapshot snapshot(*store_, {});
  const PlaceRow place = store_->places().front();
  EXPECT_EQ(last_look(snapshot, place)->to, day_time("11:00"));
  EXPECT_NEAR(last_look(snapshot, place)->fraction.value(), 0.05, 1e-9);
  EXPECT_EQ(last_look(snapshot, place, kMinSeenFraction)->to, day_time("10:00"));
}

TEST_F(Questions, ChangesOfAKindKnowWhatLeftAndWhatCame) {
  const auto told = [&](const std::string& place, const std::string& kind) {
    std::vector<std::string> result;
    for (const Change& change : ask(*store_, ChangesQuestion{.place = place, .kind = kind}).changes)
      result.push_back(std::string(to_text(change.kind)) + " " + change.object->name);
    return result;
  };
  EXPECT_THAT(told("table", "left"), ElementsAre("gone object_1", "moved object_1"));
  EXPECT_THAT(told("table", "came"), ElementsAre("appeared object_1", "appeared object_2"));
  EXPECT_THAT(told("counter", "came"), ElementsAre("appeared object_3", "moved object_1"));
  EXPECT_THAT(told("counter", "left"), ElementsAre());
  EXPECT_THAT(told("", "moved"), ElementsAre("moved object_1"));
  EXPECT_THAT(told("table", "new"), ElementsAre()) << "the first look saw them there";
  EXPECT_THAT(told("counter", "new"), ElementsAre("moved object_1"));
  EXPECT_THAT(message([&] { told("", "flew"); }), HasSubstr("no kind of change"));
}

TEST_F(Questions, NearOneOfSeveralIsNearTheOneThatHasSomethingThere) {
  store_.reset();
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("user", "{}");
    for (const Id cup : {2, 3})
      store.add_fact({.object = cup, .key = "class", .value = "cup", .clock = {.source = "user"}}, run);
    store.finish_run(run);
  }
  store_.emplace(Store::open_read(file_));
  ASSERT_TRUE(ask(*store_, NearQuestion{.subject = "object_2"}).objects.empty());
  const NearAnswer answer = ask(*store_, NearQuestion{.subject = "cup"});
  EXPECT_EQ(answer.around, "object_3");
  ASSERT_EQ(answer.objects.size(), 1U);
  EXPECT_EQ(answer.objects[0].object.object.id, 1);
  const Query query{.question = "near",
                    .arguments = {{"around", "cup"}, {"radius", "0.1"}, {"relation", "on"}},
                    .asks = Asks::verdict};
  const TimeWriter times(*store_);
  EXPECT_EQ(
      ask(*store_, query, {}).reply({.store = *store_, .query = query, .as_of = {}, .times = times}).text,
      "No: nothing is on any 'cup'.");
}

TEST_F(Questions, WhatWasNotSeenSinceATime) {
  std::vector<std::string> names;
  for (const ObjectBelief& state :
       ask(*store_, ObjectsQuestion{.unseen_since = testing_support::day_time("08:15")}).objects)
    names.push_back(state.object.name);
  EXPECT_THAT(names, testing::Not(testing::Contains("object_1")));
  for (const ObjectBelief& state :
       ask(*store_, ObjectsQuestion{.unseen_since = testing_support::day_time("10:00")}).objects)
    EXPECT_LT(state.last_seen->time, testing_support::day_time("10:00")) << state.object.name;
  EXPECT_EQ(ask(*store_, ObjectsQuestion{.unseen_since = testing_support::day_time("11:00")}).objects.size(),
            4U);
  EXPECT_TRUE(
      ask(*store_, ObjectsQuestion{.unseen_since = testing_support::day_time("07:00")}).objects.empty());
}

TEST_F(Questions, TheBiggestIsOneOfThoseThatAreMeant) {
  const auto one = ask(*store_, ObjectsQuestion{.subject = "biggest red thing"}).objects;
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].object.name, "object_1");
  EXPECT_EQ(ask(*store_, ObjectsQuestion{.subject = "smallest on counter"}).objects.size(), 1U);
}

TEST_F(Questions, HistoryJoinsSightingsAtOneSpotToAStay) {
  const HistoryAnswer answer = ask(*store_, HistoryQuestion{"red"});
  ASSERT_EQ(answer.objects.size(), 1U);
  const auto& stays = answer.objects[0].stays;
  ASSERT_EQ(stays.size(), 2U);
  EXPECT_EQ(stays[0].place->name, "table_1");
  EXPECT_EQ(stays[1].place->name, "counter_1");
  EXPECT_EQ(stays[1].scenes.size(), 2U);
  EXPECT_THAT(text(answer), HasSubstr("from 09:30 to 10:30, on counter_1"));
  EXPECT_THAT(text(answer), HasSubstr(", for 1 h 0 min at least"));
  EXPECT_EQ(to_json(answer)["objects"][0]["stays"][1]["seconds"], 3600);
}

TEST_F(Questions, AnAbsenceEndsAStay) {
  EXPECT_EQ(ask(*store_, HistoryQuestion{"red"}).objects[0].stays.size(), 2U);
  store_.reset();
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    scene.add_event(
        {.scene = 4, .kind = EventKind::gone, .object = 1, .clock = {.valid_from = day_time("10:00")}});
    scene.commit();
  }
  store_.emplace(Store::open_read(file_));
  const std::vector<Stay> stays = ask(*store_, HistoryQuestion{"red"}).objects[0].stays;
  ASSERT_EQ(stays.size(), 3U) << "on the counter, away, and on the counter again";
  EXPECT_EQ(stays[2].place->name, "counter_1");
  EXPECT_EQ(spans_of(stays).size(), 3U);
}

TEST_F(Questions, AReasonForAnAbsenceIsOneInAllAnswers) {
  const std::string reason = "looked for at 09:00 and not seen";
  EXPECT_THAT(text(ask(*store_, WhereQuestion{"red", at("09:10")})), HasSubstr(reason));
  EXPECT_THAT(was("red", "table_1", "08:50", "09:10").reason, HasSubstr(reason));
  EXPECT_THAT(was("red", "", "08:50", "09:10").reason,
              HasSubstr("looked for where it stood at 09:00 and not seen"));
}

TEST_F(Questions, TimelineHasScenesWithWhatHappenedInThem) {
  const TimelineAnswer answer = ask(*store_, TimelineQuestion{.from = testing_support::day_time("09:00")});
  ASSERT_EQ(answer.entries.size(), 4U);
  EXPECT_EQ(answer.entries[0].changes.size(), 1U);
  EXPECT_EQ(answer.entries[3].changes.size(), 2U);
  EXPECT_EQ(answer.entries[3].seen.size(), 2U);
}

TEST_F(Questions, JsonSaysTheSameAsTheStruct) {
  const Json where = to_json(ask(*store_, WhereQuestion{"red"}));
  EXPECT_EQ(where["objects"][0]["object"], "object_1");
  EXPECT_EQ(where["objects"][0]["place"], "counter_1");
  EXPECT_EQ(where["objects"][0]["last_seen"]["time"], "2026-05-01T10:30:00Z");
  const Json was = to_json(ask(*store_, WasQuestion{"red", "table_1", testing_support::day_time("08:50"),
                                                    testing_support::day_time("09:10")}));
  EXPECT_EQ(was["verdict"], "no");
  EXPECT_EQ(to_json(ask(*store_, ObjectsQuestion{}))["objects"].size(), 4U);
  EXPECT_EQ(to_json(ask(*store_, ScenesQuestion{}))["scenes"][0]["looked_at"]["table_1"], 0.95);
  EXPECT_EQ(to_json(ask(*store_, ChangesQuestion{}))["changes"].size(), 8U);
  EXPECT_EQ(to_json(ask(*store_, TimelineQuestion{}))["timeline"].size(), 6U);
}

}  // namespace
}  // namespace loci::memory
