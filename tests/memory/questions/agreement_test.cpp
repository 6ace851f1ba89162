// was, where, on, history and objects are several views of one belief: they agree at the time of every scene,
// and in between.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>
#include <set>

#include "memory/questions/contents.h"
#include "memory/questions/location.h"
#include "memory/questions/objects.h"
#include "memory/questions/presence.h"
#include "memory/questions/snapshot.h"
#include "tests/memory/questions/generated_day.h"

namespace loci::memory {
namespace {

class Agreement : public testing_support::GeneratedDay, public testing::WithParamInterface<uint64_t> {
 protected:
  static constexpr TimeNs kEverKnown = std::numeric_limits<TimeNs>::max();
  static std::string text_of(const ObjectBelief& belief) {
    return fmt::format("{} {} {:.6f} {}", belief.object.name, to_text(belief.status), belief.probability,
                       belief.place ? belief.place->name : "nowhere");
  }
  static TimeNs scenes_end(const Store& store) { return *store.last_scene_time() + 3600 * kSecond; }
  static std::multiset<std::string> texts_of(const std::vector<ObjectBelief>& beliefs) {
    std::multiset<std::string> texts;
    for (const ObjectBelief& belief : beliefs) texts.insert(text_of(belief));
    return texts;
  }
};

TEST_P(Agreement, HoldsAtTheTimeOfEveryScene) {
  generate(GetParam());
  const Store store = Store::open_read(file_);
  std::vector<SceneRow> scenes = store.scenes();
  ASSERT_EQ(scenes.size(), size_t{kScenes});
  for (const SceneRow& scene : scenes) {
    const AsOf as_of{.at = scene.time};
    SCOPED_TRACE(format_time(scene.time));
    const std::vector<ObjectBelief> objects = ask(store, ObjectsQuestion{.as_of = as_of}).objects;
    std::map<std::string, std::multiset<std::string>> there, gone;
    for (const ObjectBelief& object : objects) {
      (object.status == ObjectStatus::gone ? gone : there)[object.place ? object.place->name : ""].insert(
          text_of(object));
      const WhereAnswer where = ask(store, WhereQuestion{.subject = object.object.name, .as_of = as_of});
      EXPECT_EQ(texts_of(where.objects), std::multiset<std::string>{text_of(object)});
      const HistoryAnswer history =
          ask(store, HistoryQuestion{.subject = object.object.name, .as_of = as_of});
      ASSERT_EQ(history.objects.size(), 1U);
      EXPECT_EQ(text_of(history.objects[0].now), text_of(object));
      ASSERT_FALSE(history.objects[0].stays.empty());
      const Stay& last = history.objects[0].stays.back();
      ASSERT_TRUE(object.last_seen.has_value());
      EXPECT_EQ(last.scenes.back().time, object.last_seen->time);
      EXPECT_LE(object.last_seen->time, scene.time);
      EXPECT_EQ(last.place ? last.place->name : "", object.place ? object.place->name : "")
          << object.object.name;
      EXPECT_EQ(object.status == ObjectStatus::seen, object.last_seen->time == scene.time)
          << object.object.name;
      size_t sightings = 0;
      for (const Stay& stay : history.objects[0].stays) sightings += stay.scenes.size();
      EXPECT_EQ(sightings, object.sightings) << object.object.name;
    }
    for (const PlaceRow& place : store.places()) {
      const ContentsAnswer on =
          ask(store, ContentsQuestion{.place = place.name, .as_of = as_of, .max_gone = 1000});
      ASSERT_EQ(on.places.size(), 1U);
      EXPECT_EQ(texts_of(on.places[0].there), there[place.name]) << place.name;
      EXPECT_EQ(texts_of(on.places[0].gone), gone[place.name]) << place.name;
      EXPECT_EQ(on.places[0].gone_in_all, gone[place.name].size()) << place.name;
    }
  }
}

/// The questions about one moment, at a scene and between two of them, have one probability and contradict
/// each other nowhere.
TEST_P(Agreement, OfOneMomentAllQuestionsSayTheSame) {
  generate(GetParam());
  const Store store = Store::open_read(file_);
  const std::vector<SceneRow> scenes = store.scenes();
  std::vector<TimeNs> moments;
  for (size_t i = 0; i < scenes.size(); ++i) {
    moments.push_back(scenes[i].time);
    if (i + 1 < scenes.size())
      for (const double share : {0.2, 0.5, 0.8})
        moments.push_back(scenes[i].time +
                          static_cast<TimeNs>(share * double(scenes[i + 1].time - scenes[i].time)));
  }
  size_t yes = 0, no = 0;
  for (const TimeNs moment : moments) {
    SCOPED_TRACE(format_time(moment));
    const AsOf as_of{.at = moment};
    for (const ObjectBelief& object : ask(store, ObjectsQuestion{.as_of = as_of}).objects) {
      SCOPED_TRACE(object.object.name);
      const std::string& name = object.object.name;
      EXPECT_EQ(text_of(ask(store, WhereQuestion{name, as_of}).objects.at(0)), text_of(object));
      EXPECT_EQ(text_of(ask(store, HistoryQuestion{.subject = name, .as_of = as_of}).objects.at(0).now),
                text_of(object));
      for (const PlaceRow& place : store.places()) {
        const WasAnswer was =
            ask(store, WasQuestion{.subject = name, .place = place.name, .from = moment, .to = moment});
        const ContentsAnswer on =
            ask(store, ContentsQuestion{.place = place.name, .as_of = as_of, .subject = name});
        const bool here = object.place && object.place->id == place.id;
        if (here && object.status != ObjectStatus::gone) {
          EXPECT_EQ(text_of(on.places.at(0).there.at(0)), text_of(object));
          EXPECT_DOUBLE_EQ(was.objects.at(0).probability,
                           was.objects.at(0).seen_there.empty() ? object.probability : 1)
              << place.name;
          EXPECT_EQ(was.verdict == Verdict::yes, object.probability >= 0.5) << place.name;
        }
        EXPECT_EQ(was.verdict == Verdict::yes, on.verdict == Verdict::yes) << place.name;
        yes += was.verdict == Verdict::yes ? 1 : 0;
        no += was.verdict == Verdict::no ? 1 : 0;
      }
    }
  }
  EXPECT_GT(yes, 100U);
  EXPECT_GT(no, 100U);
}

/// An object that is found again where it was seen before was there in between; one that is seen elsewhere
/// next had perhaps left. Who knew only what was seen until then cannot say.
TEST_P(Agreement, WhatIsSeenAfterwardsIsEvidence) {
  generate(GetParam());
  const Store store = Store::open_read(file_);
  size_t again = 0, elsewhere = 0;
  for (const ObjectRow& row : store.objects()) {
    const std::vector<ObjectObservation> seen = store.observations_of(row.id);
    for (size_t i = 0; i + 1 < seen.size(); ++i) {
      const TimeNs from = seen[i].time, to = seen[i + 1].time, half = from + (to - from) / 2;
      const std::optional<BeliefRow> then = store.belief(row.id, {.at = half});
      const Snapshot snapshot(store, {.at = half});
      const BeliefRow* smoothed = snapshot.belief(row.id);
      ASSERT_TRUE(then && smoothed);
      // What looks in between missed may have left and come back.
      const std::vector<BeliefRow> looks = store.belief_history(row.id, {.at = to - 1}, half);
      const bool missed = std::ranges::any_of(looks, [](const BeliefRow& look) {
        return look.status == ObjectStatus::gone || look.status == ObjectStatus::missed;
      });
      if (then->status == ObjectStatus::seen || missed) continue;
      const bool same = seen[i].observation.place == seen[i + 1].observation.place;
      (same ? again : elsewhere) += 1;
      EXPECT_EQ(smoothed->probability > then->probability, same);
      EXPECT_NE(smoothed->probability, then->probability);
    }
    // Nothing was seen after the last look.
    const AsOf now{.at = scenes_end(store)};
    const Snapshot snapshot(store, now);
    EXPECT_EQ(snapshot.belief(row.id)->probability, store.belief(row.id, now)->probability);
  }
  EXPECT_GT(again, 3U) << elsewhere << " were seen elsewhere next";
}

TEST_P(Agreement, NamesakesAreWhatTheNameFinds) {
  generate(GetParam());
  const Store store = Store::open_read(file_);
  size_t gone = 0, namesakes = 0;
  for (const SceneRow& scene : store.scenes()) {
    // All objects are searched where a transaction time is given.
    const Snapshot snapshot(store, {.at = scene.time}), searched(store, {scene.time, kEverKnown});
    std::vector<std::string> names = snapshot.known_names();
    names.insert(names.end(), {"small", "small thing", "unheard-of"});
    std::vector<Id> present;
    for (const BeliefRow& belief : snapshot.beliefs()) {
      const bool there = belief.status != ObjectStatus::gone;
      if (there) present.push_back(belief.object);
      gone += there ? 0 : 1;
      for (const std::string& name : names) {
        std::vector<const BeliefRow*> others;
        try {
          for (const Id id : searched.find_objects(name))
            if (const BeliefRow* other = searched.belief(id);
                id != belief.object && !(there && other->status == ObjectStatus::gone))
              others.push_back(other);
        } catch (const UnknownName&) {  // has no namesakes
        }
        namesakes += others.size();
        for (const auto such : {+[](const BeliefRow&) { return true; },
                                +[](const BeliefRow& row) { return row.place == Id{1}; },
                                +[](const BeliefRow& row) { return row.object % 2 == 0; }})
          EXPECT_EQ(snapshot.has_namesake(name, belief.object, such),
                    std::ranges::any_of(others, [&](const BeliefRow* other) { return such(*other); }))
              << name << " " << belief.object;
      }
    }
    EXPECT_EQ(snapshot.present_objects(), present);
    EXPECT_EQ(searched.present_objects(), present);
  }
  EXPECT_GT(gone, 0U);
  EXPECT_GT(namesakes, 0U);
}

INSTANTIATE_TEST_SUITE_P(GeneratedDays, Agreement, testing::Range<uint64_t>(1, 9));

}  // namespace
}  // namespace loci::memory
