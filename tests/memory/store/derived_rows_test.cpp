// What is derived while rows are added: the same as from all rows at once, and the same answers as from a
// walk through the history.

#include <gmock/gmock.h>

#include "mapping/base/math/random.h"
#include "memory/store/scene_transaction.h"
#include "memory/store/store.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::IsEmpty;

class DerivedRows : public testing_support::TemporaryFolder {
 protected:
  static constexpr Id kObjects = 3, kPlaces = 3;

  /// Scenes with objects on places, now and then one that lies before others.
  void SetUp() override {
    testing_support::TemporaryFolder::SetUp();
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    for (Id place = 1; place <= kPlaces; ++place)
      store.add_place({.name = "table_" + std::to_string(place), .class_name = "table"}, run);
    TimeNs time = kSecond;
    for (int n = 0; n < 300; ++n) {
      time += kSecond * static_cast<TimeNs>(random_.index(3));  // several of one time
      const bool late = random_.uniform() < 0.05;
      add_scene(store, run, late ? time / 2 : time, n == 0);
    }
    last_ = time;
  }

  void add_scene(Store& store, Id run, TimeNs time, bool first) {
    SceneTransaction scene(store, run);
    const Id id = scene.add_scene({.time = time});
    for (Id object = 1; object <= kObjects; ++object) {
      if (first) {
        scene.add_object({});
        scene.add_belief({.object = object, .scene = id, .status = ObjectStatus::seen});
      }
      const ObjectStatus status = random_.uniform() < 0.5 ? ObjectStatus::missed : ObjectStatus::hidden;
      if (random_.uniform() < 0.3) scene.add_visibility({.scene = id, .object = object, .status = status});
      if (random_.uniform() < 0.4) continue;
      std::optional<Id>& place = place_of_[object];
      if (random_.uniform() < 0.15) place = 1 + static_cast<Id>(random_.index(kPlaces));
      if (random_.uniform() < 0.05) place.reset();
      const Id seen = scene.add_observation({.scene = id, .number = object, .place = place});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = object,
                             .explanation = Explanation::stay,
                             .probability = 1,
                             .chosen = true});
    }
    scene.commit();
  }

  TimeNs some_time() { return static_cast<TimeNs>(random_.uniform() * static_cast<double>(last_)); }

  Random random_{7};
  std::map<Id, std::optional<Id>> place_of_;
  TimeNs last_ = 0;
};

TEST_F(DerivedRows, AreWhatTheOtherRowsSay) {
  NoProgress silent;
  EXPECT_THAT(Store::open_read(file_).verify(silent).problems, IsEmpty());
}

TEST_F(DerivedRows, FollowAnObjectThatIsTakenForAnotherObservationOfAScene) {
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    for (int n = 0; n < 100; ++n) {
      AssociationRow row{.object = 1, .explanation = Explanation::stay, .probability = 1, .chosen = true};
      row.clock.valid_from = last_ + n * kSecond;
      for (int64_t number = 0; number < 3; ++number) {
        SceneTransaction scene(store, run);
        if (number == 0) row.scene = scene.add_scene({.time = row.clock.valid_from});
        const Id place = 1 + static_cast<Id>(random_.index(kPlaces));
        row.observation = scene.add_observation({.scene = row.scene, .number = number, .place = place});
        row.clock.supersedes = scene.add_association(row);
        scene.commit();
      }
    }
  }
  NoProgress silent;
  EXPECT_THAT(Store::open_read(file_).verify(silent).problems, IsEmpty());
}

TEST_F(DerivedRows, FindTheSightingsOnAPlaceThatAWalkFinds) {
  const Store store = Store::open_read(file_);
  int found = 0;
  for (int n = 0; n < 300; ++n) {
    const Id object = 1 + static_cast<Id>(random_.index(kObjects));
    std::vector<Id> places = {1 + static_cast<Id>(random_.index(kPlaces))};
    if (random_.uniform() < 0.3) places.push_back(1 + static_cast<Id>(random_.index(kPlaces)));
    const TimeNs time = some_time();
    AsOf as_of;
    if (random_.uniform() < 0.3) as_of.at = some_time();
    std::optional<TimeNs> before, after;
    for (const ObjectObservation& sighting : store.observations_of(object, as_of)) {
      if (std::ranges::count(places, sighting.observation.place.value_or(0)) == 0) continue;
      if (sighting.time < time) before = sighting.time;
      if (sighting.time > time && !after) after = sighting.time;
    }
    const auto time_of = [](const std::optional<ObjectObservation>& sighting) {
      return sighting ? std::optional(sighting->time) : std::nullopt;
    };
    EXPECT_EQ(time_of(store.last_observation_before(object, time, places, as_of)), before);
    EXPECT_EQ(time_of(store.first_observation_after(object, time, places, as_of)), after);
    found += before && after ? 1 : 0;
  }
  EXPECT_GT(found, 50);
}

TEST_F(DerivedRows, CountTheLooksThatAWalkCounts) {
  const Store store = Store::open_read(file_);
  for (int n = 0; n < 100; ++n) {
    const Id object = 1 + static_cast<Id>(random_.index(kObjects));
    const TimeNs after = some_time();
    std::optional<TimeNs> until;
    if (random_.uniform() < 0.5) until = some_time();
    AsOf as_of;
    if (random_.uniform() < 0.5) as_of.at = some_time();
    const auto counts = [&](TimeNs time) {
      return time > after && time <= until.value_or(time) && time <= as_of.at.value_or(time);
    };
    size_t scenes = 0, missed = 0, hidden = 0;
    for (const SceneRow& scene : store.scenes()) scenes += counts(scene.time) ? 1 : 0;
    for (const VisibilityRow& row : store.visibility_of_object(object))
      if (counts(row.time)) ++(row.status == ObjectStatus::missed ? missed : hidden);
    const Store::VisibilityCounts looks = store.visibility_since(object, after, until, as_of);
    EXPECT_EQ(looks.missed, missed);
    EXPECT_EQ(looks.hidden, hidden);
    EXPECT_EQ(looks.out_of_view, scenes - missed - hidden);
  }
}

TEST_F(DerivedRows, TellWhatWentLastFromAPlace) {
  {
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, 1);
    const Id id = scene.add_scene({.time = last_ + 10 * kSecond});
    for (Id object = 1; object <= kObjects; ++object) {
      BeliefRow row{
          .object = object, .scene = id, .status = ObjectStatus::gone, .place = object == 2 ? 2 : 1};
      row.position = Vector3d(1, 2, 3);
      row.clock.valid_from = last_ + (10 + object) * kSecond;
      scene.add_belief(row);
    }
    scene.commit();
  }
  const Store store = Store::open_read(file_);
  EXPECT_THAT(store.objects_at(1), IsEmpty());
  EXPECT_THAT(store.objects_gone_from(1, 10).objects, testing::ElementsAre(3, 1));
  EXPECT_THAT(store.objects_gone_from(1, 1).objects, testing::ElementsAre(3));
  EXPECT_EQ(store.objects_gone_from(1, 1).in_all, 2U);
  EXPECT_THAT(store.objects_gone_from(1, 10, {.at = last_ + 11 * kSecond}).objects, testing::ElementsAre(1));
}

}  // namespace
}  // namespace loci::memory
