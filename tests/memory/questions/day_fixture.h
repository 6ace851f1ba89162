#pragma once

#include <gmock/gmock.h>

#include "memory/questions/time_parser.h"
#include "tests/memory/questions/synthetic_day.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory::testing_support {

/// A test that asks the memory of the synthetic day.
class DayFixture : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    const SyntheticDay day(file_);
    store_.emplace(Store::open_read(file_));
  }
  void TearDown() override {
    store_.reset();
    TemporaryFolder::TearDown();
  }
  static AsOf at(const std::string& clock) { return {.at = day_time(clock)}; }
  /// One more scene, which shows object_1 at a place.
  void see_red_at(const std::string& place_name, const std::string& clock,
                  const std::optional<EventRow>& event = {}) {
    store_.reset();
    {
      Store store = Store::open_write(file_, {.now = SyntheticDay::kKnownSecond + kSecond});
      const Id run = store.begin_run("test", "{}");
      Id place = 0;
      for (const PlaceRow& row : store.places())
        if (row.name == place_name) place = row.id;
      SceneTransaction scene(store, run);
      const Id id = scene.add_scene({.time = day_time(clock)});
      const Id seen = scene.add_observation({.scene = id, .number = 0, .place = place, .color = "red"});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = 1,
                             .explanation = Explanation::move,
                             .probability = 0.96,
                             .chosen = true});
      scene.add_belief({.object = 1,
                        .scene = id,
                        .status = ObjectStatus::seen,
                        .probability = 0.98,
                        .place = place,
                        .last_scene = id,
                        .color = "red"});
      if (event) {
        EventRow row = *event;
        row.scene = id;
        row.object = 1;
        row.observation = seen;
        row.place = place;
        scene.add_event(row);
      }
      scene.commit();
      store.finish_run(run);
    }
    store_.emplace(Store::open_read(file_));
  }
  template <class Answer>
  std::string text(const Answer& answer) const {
    return to_text(answer, TimeWriter(*store_));
  }

  std::optional<Store> store_;
};

}  // namespace loci::memory::testing_support
