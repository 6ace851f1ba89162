#include "memory/recorder/map_entry.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "memory/recorder/recorder.h"
#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory {
namespace {

using belief::SyntheticKitchen;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A mug on a table, and a shelf that stays; a day begins with the table at x = 0.
class MapEntry : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("loci_map_entry_" + std::to_string(getpid()));
    make_folder(folder_);
    kitchen_.objects = {{"mug", SyntheticKitchen::on_table(0.05, 0)}};
    store_ = Store::open_write(folder_ / "day.loci");
    const Id map = add_map(*store_, room(0));
    Recorder recorder(*store_, store_->begin_run("test", "{}"));
    for (int second = 0; second < 10; ++second) recorder.record(record(second, map));
  }
  void TearDown() override {
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// The URDF of the room with the table at x.
  std::filesystem::path room(double x) const {
    const std::filesystem::path path = folder_ / fmt::format("room_{:.0f}.urdf", 100 * x);
    const auto link = [](const std::string& name) {
      return fmt::format(
          R"(<link name="{}"><visual><geometry><box size="0.8 0.5 0.02"/></geometry></visual></link>)", name);
    };
    const auto joint = [](const std::string& name, double at, double y) {
      return fmt::format(R"(<joint name="{0}_joint" type="fixed"><parent link="map"/><child link="{0}"/>)"
                         R"(<origin xyz="{1} {2} 0.7"/></joint>)",
                         name, at, y);
    };
    write_file_atomically(
        path, fmt::format(R"(<robot name="room"><link name="map"/>{}{}{}{}</robot>)", link("table_1"),
                          link("shelf_1"), joint("table_1", x, 0), joint("shelf_1", 0, 2)));
    return path;
  }

  SceneRecord record(double seconds, std::optional<Id> map, double table_x = 0) const {
    const belief::Scene scene = kitchen_.scene(seconds);
    SceneRecord record;
    record.row.time = scene.time;
    record.row.map = map;
    record.view = scene.view;
    for (const double y : {0.0, 2.0}) {
      PlaceRow place;
      place.name = y == 0 ? "table_1" : "shelf_1";
      place.class_name = y == 0 ? "table" : "shelf";
      place.map = map;
      place.height = 0.7;
      const double x = y == 0 ? table_x : 0;
      place.outline = {{x - 0.4, y - 0.25}, {x + 0.4, y - 0.25}, {x + 0.4, y + 0.25}, {x - 0.4, y + 0.25}};
      record.places.push_back(place);
    }
    for (const belief::Observation& o : scene.observations) {
      record.observations.emplace_back().evidence = o;
      record.observations.back().row.position = o.box.centre;
      record.observations.back().row.size = o.box.size;
    }
    return record;
  }

  std::vector<EventKind> events_after(TimeNs time) const {
    std::vector<EventKind> kinds;
    for (const EventRow& event : store_->events())
      if (event.clock.valid_from > time) kinds.push_back(event.kind);
    return kinds;
  }

  static constexpr TimeNs kEvening = 100 * kSecond;
  std::filesystem::path folder_;
  SyntheticKitchen kitchen_;
  std::optional<Store> store_;
};

TEST_F(MapEntry, ObjectsRideOnFurnitureThatMoved) {
  enter_map(*store_, room(0.3), kEvening, "test");
  EXPECT_NEAR(store_->belief(1, {.at = kEvening})->position->x(), 0.35, 0.02);
  EXPECT_NEAR(store_->belief(1, {.at = kEvening - 1})->position->x(), 0.05, 0.02);
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::place_moved));
  const std::vector<MapPeriod> periods = map_periods(*store_);
  ASSERT_EQ(periods.size(), 2U);
  EXPECT_EQ(periods[0].name, "room_0.urdf");
  EXPECT_EQ(periods[1].from, kEvening);
  EXPECT_THAT(periods[1].moved, ElementsAre("table_1"));
}

TEST_F(MapEntry, WhatIsSeenOnTheMovedTableHasNotMoved) {
  const Id map = add_map(*store_, room(0.3));
  kitchen_.object("mug").centre.x() += 0.3;
  Recorder recorder(*store_, store_->begin_run("test", "{}"));
  recorder.record(record(100, map, 0.3));
  recorder.record(record(101, map, 0.3));
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::place_moved));
  EXPECT_EQ(store_->observations_of(1).size(), 12U);
  // The table is where the second map has it: the scene saw all of it.
  for (const VisibilityRow& row : store_->visibility(store_->last_scene()->id)) {
    if (row.place) {
      EXPECT_GT(row.fraction.value_or(0), 0.6);
    }
  }
}

TEST_F(MapEntry, AScenePerceivedWithoutAMapLeavesTheRoomAsItWas) {
  enter_map(*store_, room(0.3), kEvening, "test");
  SceneRecord look = record(101, std::nullopt);
  look.observations.clear();
  look.places.clear();
  look.view = {};
  look.view.has_camera = false;
  look.view.observed.emplace();
  Recorder(*store_, store_->begin_run("test", "{}")).record(look);
  EXPECT_NEAR(store_->belief(1)->position->x(), 0.35, 0.02);
  EXPECT_EQ(store_->map_at()->name, "room_30.urdf");
  // Opened again, too: the map is the scene's, not the program's.
  look.row.time += kSecond;
  Recorder(*store_, store_->begin_run("test", "{}")).record(look);
  EXPECT_NEAR(store_->belief(1)->position->x(), 0.35, 0.02);
  EXPECT_EQ(store_->last_scene()->map, store_->maps().back().id);
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::place_moved));
}

TEST_F(MapEntry, WithoutTheNewMapTheSameMugHasMoved) {
  const Id map = store_->maps().front().id;
  kitchen_.object("mug").centre.x() += 0.3;
  Recorder recorder(*store_, store_->begin_run("test", "{}"));
  recorder.record(record(100, map));
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::moved));
}

TEST_F(MapEntry, WhatStandsOnATableThatAFrameShowsElsewhereHasNotMoved) {
  const Id map = store_->maps().front().id;
  kitchen_.object("mug").centre.x() += 0.3;
  std::optional<Recorder> recorder(std::in_place, *store_, store_->begin_run("test", "{}"));
  for (const int second : {100, 101, 102}) {
    SceneRecord seen = record(second, map);
    seen.moved_places = {{"table_1", Isometry3d(Eigen::Translation3d(0.3, 0, 0))}};
    if (second == 102) recorder.emplace(*store_, store_->begin_run("test", "{}"));  // A later run.
    recorder->record(seen);
  }
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::place_moved));
  const EventRow event = store_->events().back();
  EXPECT_NEAR(event.from_position->x(), 0, 1e-9);
  EXPECT_NEAR(event.position->x(), 0.3, 1e-9);
  EXPECT_EQ(store_->observations_of(1).size(), 13U);
  EXPECT_NEAR(store_->belief(1)->position->x(), 0.35, 0.02);
  for (const VisibilityRow& row : store_->visibility(store_->last_scene()->id)) {
    if (row.place) {
      EXPECT_GT(row.fraction.value_or(0), 0.6);
    }
  }
  // The new map says the same: nothing more has happened.
  enter_map(*store_, room(0.3), 200 * kSecond, "test");
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::place_moved));
  EXPECT_NEAR(store_->belief(1)->position->x(), 0.35, 0.02);
}

TEST_F(MapEntry, WhatStoodOnATableThatIsNotFoundIsNotObserved) {
  const Id map = store_->maps().front().id;
  kitchen_.objects.clear();
  Recorder recorder(*store_, store_->begin_run("test", "{}"));
  for (int second = 100; second < 110; ++second) {
    SceneRecord seen = record(second, map);
    seen.places.clear();
    seen.moved_places = {{"table_1", Isometry3d::Identity(), false}};
    recorder.record(seen);
  }
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre());
  EXPECT_GT(store_->belief(1)->probability, 0.9);
  // As soon as it is known to stand there, the mug is gone.
  for (int second = 110; second < 120; ++second) recorder.record(record(second, map));
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre(EventKind::gone));
}

TEST_F(MapEntry, ARoomThatReturnsToAnEarlierMapIsAsItWas) {
  enter_map(*store_, room(0.3), kEvening, "test");
  enter_map(*store_, room(0), 2 * kEvening, "test");
  EXPECT_NEAR(store_->belief(1)->position->x(), 0.05, 0.02);
  EXPECT_EQ(store_->map_at()->name, "room_0.urdf");
  EXPECT_EQ(store_->map_at({.at = kEvening})->name, "room_30.urdf");
  EXPECT_EQ(store_->maps().size(), 2U);
}

TEST_F(MapEntry, ACorrectionStandsForTheMapThatItIsOf) {
  enter_map(*store_, room(0.3), kEvening, "test");
  const MapRow first = store_->maps().front();
  const Id once = store_->add_correction(first, store_->blob(first.urdf).bytes);
  EXPECT_EQ(store_->map_at({.at = kEvening - 1})->id, once);
  EXPECT_EQ(store_->map_at()->name, "room_30.urdf");
  const MapRow corrected = store_->maps().back();
  const Id twice = store_->add_correction(corrected, store_->blob(corrected.urdf).bytes);
  EXPECT_EQ(store_->map_at({.at = kEvening - 1})->id, twice);
}

TEST_F(MapEntry, ANewMapThatDiffersByTheErrorOfMapsMovesNothing) {
  enter_map(*store_, room(0.02), kEvening, "test");
  EXPECT_THAT(events_after(50 * kSecond), ElementsAre());
  EXPECT_NEAR(store_->belief(1)->position->x(), 0.05, 0.02);
}

TEST_F(MapEntry, RefusesTheMapOfAnotherRoom) {
  const auto with_walls = [&](double table_x, double width_m) {
    const std::filesystem::path urdf = room(table_x);
    const auto wall = [](double normal_x, double normal_y, double offset) {
      const Vector2d n(normal_x, normal_y), along(-normal_y, normal_x);
      const Vector2d from = offset * n - 2 * along, to = offset * n + 2 * along;
      return fmt::format(
          R"({{"class": "wall", "geometry": {{"normal": [{}, {}, 0], "offset": {}, "outline": [[{}, {}, 0], [{}, {}, 0]]}}}})",
          normal_x, normal_y, offset, from.x(), from.y(), to.x(), to.y());
    };
    std::filesystem::path sidecar = urdf;
    write_file_atomically(
        sidecar.replace_extension(".semantic.json"),
        fmt::format(
            R"({{"version": 1, "frame": "map", "links": {{"wall_1": {}, "wall_2": {}, "wall_3": {}}}}})",
            wall(1, 0, -width_m / 2), wall(-1, 0, -width_m / 2), wall(0, 1, -width_m)));
    return urdf;
  };
  enter_map(*store_, with_walls(0.3, 5), kEvening, "test");
  enter_map(*store_, with_walls(0.6, 5.05), 2 * kEvening, "test");
  EXPECT_EQ(store_->maps().size(), 3U);
  try {
    enter_map(*store_, with_walls(0.9, 8), 3 * kEvening, "test");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("is the map of another room than map 'room_60.urdf'"));
    EXPECT_THAT(error.what(), HasSubstr("0 of its 3 walls"));
  }
  EXPECT_EQ(store_->maps().size(), 3U);
}

TEST_F(MapEntry, RefusesOtherFilesAndTimesBeforeTheLastScene) {
  const auto refusal = [&](const std::filesystem::path& urdf, TimeNs at) -> std::string {
    try {
      enter_map(*store_, urdf, at, "test");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(room(0.3), 5 * kSecond), HasSubstr("perceived with another map"));
  EXPECT_EQ(refusal(room(0), kEvening), "");  // the room is as in this map already
  write_file_atomically(folder_ / "note.urdf", "a table");
  EXPECT_NE(refusal(folder_ / "note.urdf", kEvening), "");
  EXPECT_NE(refusal(folder_ / "none.urdf", kEvening), "");
  EXPECT_EQ(store_->maps().size(), 1U);
  EXPECT_EQ(store_->last_scene_time(), 9 * kSecond);
}

}  // namespace
}  // namespace loci::memory
