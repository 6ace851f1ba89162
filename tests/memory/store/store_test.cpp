#include "memory/store/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "mapping/base/time_limits.h"
#include "memory/store/format.h"
#include "memory/store/rows/schema_check.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class StoreTest : public testing_support::TemporaryFolder {
 protected:
  static std::string message(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  /// One scene with one red thing on a table.
  static Id add_one_scene(Store& store, Id run, int64_t frame, TimeNs time) {
    SceneTransaction scene(store, run);
    const Id table = scene.add_place({.name = "table_1", .class_name = "table"});
    const Id id = scene.add_scene({.recording = 1, .frame_index = frame, .time = time});
    const Id seen = scene.add_observation(
        {.scene = id, .number = 0, .place = table, .position = Vector3d(1, 2, 0.8), .color = "red"});
    const Id object = scene.add_object({});
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = object,
                           .explanation = Explanation::appear,
                           .probability = 0.9,
                           .chosen = true});
    scene.add_event(
        {.scene = id, .kind = EventKind::appeared, .object = object, .observation = seen, .place = table});
    scene.add_belief(
        {.object = object, .scene = id, .status = ObjectStatus::seen, .place = table, .last_scene = id});
    scene.commit();
    return id;
  }

  Id add_to_new_memory() {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    store.add_recording({.fingerprint = "abc", .name = "rec", .kind = "loci"});
    return add_one_scene(store, run, 0, 1000);
  }

  Id make_memory() {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    store.add_recording({.fingerprint = "abc", .name = "rec", .kind = "loci"});
    add_one_scene(store, run, 0, 1000);
    store.finish_run(run);
    return run;
  }
};

TEST_F(StoreTest, TellsTheTimesOfItsFirstAndLastScenes) {
  Store store = Store::open_write(file_);
  EXPECT_THAT(store.scene_times_at_ends(2), testing::IsEmpty());
  const Id run = store.begin_run("test", "{}");
  store.add_recording({.fingerprint = "abc", .name = "rec", .kind = "loci"});
  Id last = 0;
  for (int64_t frame = 0; frame < 5; ++frame) last = add_one_scene(store, run, frame, 1000 * (frame + 1));
  EXPECT_THAT(store.scene_times_at_ends(1), testing::ElementsAre(1000, 5000));
  EXPECT_THAT(store.scene_times_at_ends(2), testing::ElementsAre(1000, 2000, 4000, 5000));
  EXPECT_THAT(store.scene_times_at_ends(4), testing::ElementsAre(1000, 2000, 3000, 4000, 5000));
  EXPECT_EQ(store.scene(last).run, run);
}

TEST_F(StoreTest, WhatNobodyLooksAtIsOutOfViewAndFades) {
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    store.add_recording({.fingerprint = "abc", .name = "rec", .kind = "loci"});
    const Id scene = add_one_scene(store, run, 0, kHour);
    SceneTransaction rows(store, run);
    BeliefRow row = *store.belief(1);
    row.scene = scene;
    row.fade_s = 3600;
    row.fade_to = 0.4;
    row.clock = {.valid_from = kHour};
    rows.add_belief(row);
    rows.commit();
  }
  const Store store = Store::open_read(file_);
  for (const std::optional<TimeNs> at : {std::optional<TimeNs>(), std::optional(kHour + 30 * kSecond)}) {
    EXPECT_EQ(store.belief(1, {.at = at})->status, ObjectStatus::seen) << "a scene stands for its minute";
    EXPECT_NEAR(store.belief(1, {.at = at})->probability, 1, 0.01);
  }
  const BeliefRow later = *store.belief(1, {.at = 29 * kHour});
  EXPECT_EQ(later.status, ObjectStatus::out_of_view);
  EXPECT_NEAR(later.probability, 0.4, 1e-3);
}

TEST_F(StoreTest, TheSchemaHasItsDigest) {
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  database.exec(kMemoryFormat.schema);
  EXPECT_EQ(schema_digest(database), kMemoryFormat.schema_digest);
}

TEST_F(StoreTest, KeepsWhatASceneCommitted) {
  make_memory();
  const Store store = Store::open_read(file_);
  ASSERT_EQ(store.scenes().size(), 1U);
  const SceneRow scene = store.scenes()[0];
  EXPECT_EQ(scene.time, 1000);
  EXPECT_FALSE(scene.map_from_camera.has_value());
  const auto seen = store.observations(scene.id);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].color, std::optional<std::string>("red"));
  EXPECT_TRUE(seen[0].position->isApprox(Vector3d(1, 2, 0.8)));
  EXPECT_FALSE(seen[0].hsv.has_value());
  EXPECT_EQ(store.observations_of(1).size(), 1U);
  EXPECT_EQ(store.events().size(), 1U);
  EXPECT_EQ(store.beliefs().size(), 1U);
  EXPECT_EQ(store.frames(1), (std::set<int64_t>{0}));
  EXPECT_TRUE(store.recording("abc").has_value());
  EXPECT_FALSE(store.recording("other").has_value());
  NoProgress quiet;
  EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
}

TEST_F(StoreTest, RollsBackASceneThatIsNotCommitted) {
  const Id run = make_memory();
  {
    Store store = Store::open_write(file_);
    {
      SceneTransaction scene(store, run);
      scene.add_scene({.time = 5});
      scene.add_place({.name = "shelf_1", .class_name = "shelf"});
    }
    EXPECT_EQ(store.scenes().size(), 1U);
    add_one_scene(store, run, 1, 2000);  // The store goes on.
  }
  const Store store = Store::open_read(file_);
  EXPECT_EQ(store.scenes().size(), 2U);
  EXPECT_EQ(store.places().size(), 1U);
}

TEST_F(StoreTest, ATimeThatCouldNotBeReadAgainIsNotWritten) {
  make_memory();
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    EXPECT_THAT(message([&] { add_one_scene(store, run, 1, kMaxTime + 1); }),
                HasSubstr("time is a time that is too far off"));
    add_one_scene(store, run, 1, kMaxTime);
  }
  EXPECT_EQ(Store::open_read(file_).scenes().back().time, kMaxTime);
}

TEST_F(StoreTest, SurvivesBeingKilledInTheMiddleOfAScene) {
  make_memory();
  const pid_t child = ::fork();
  if (child == 0) {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("killed", "{}");
    add_one_scene(store, run, 1, 2000);
    SceneTransaction scene(store, run);
    scene.add_scene({.recording = 1, .frame_index = 2, .time = 3000});
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  {
    const Store store = Store::open_read(file_);
    EXPECT_EQ(store.frames(1), (std::set<int64_t>{0, 1}));
    NoProgress quiet;
    EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
  }
  Store again = Store::open_write(file_);  // The dead writer's lock has fallen.
  EXPECT_TRUE(again.writable());
}

TEST_F(StoreTest, IsThereAsAWholeOrNotAtAllWhenKilledWhileItIsMade) {
  for (int delay = 0; delay < 20; ++delay) {
    for (const auto& entry : fs::directory_iterator(file_.parent_path())) fs::remove(entry.path());
    const pid_t child = ::fork();
    if (child == 0) {
      { Store store = Store::open_write(file_); }
      for (;;) ::pause();
    }
    ::usleep(static_cast<useconds_t>(500 * delay));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (fs::exists(file_)) {
      EXPECT_EQ(Store::open_read(file_).minor(), kMemoryFormat.minor());
    }
    EXPECT_EQ(add_to_new_memory(), 1);
  }
}

TEST_F(StoreTest, KeepsWhatWasCommittedWhenNothingMoreCanBeWritten) {
  make_memory();
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{fs::file_size(file_) + 100000, fs::file_size(file_) + 100000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string text = message([&] {
      Store store = Store::open_write(file_);
      const Id run = store.begin_run("full", "{}");
      add_one_scene(store, run, 1, 2000);
      SceneTransaction scene(store, run);
      scene.add_blob(std::string(3000000, 'x'), "image/jpeg");  // Media that are not compressed again.
      scene.add_scene({.time = 3000});
      scene.commit();
    });
    ::_exit(text == "no error" || text.find('\n') != std::string::npos ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const Store store = Store::open_read(file_);
  EXPECT_EQ(store.frames(1), (std::set<int64_t>{0, 1}));
  NoProgress quiet;
  EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
}

TEST_F(StoreTest, ACleanCloseLeavesOneFileThatCanBeCopied) {
  make_memory();
  { const Store reader = Store::open_read(file_); }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  fs::copy_file(file_, folder_ / "copy.loci");
  EXPECT_EQ(Store::open_read(folder_ / "copy.loci").scenes().size(), 1U);
}

TEST_F(StoreTest, RefusesASecondWriterButNotReaders) {
  Store writer = Store::open_write(file_);
  EXPECT_THAT(message([&] { Store::open_write(file_); }), HasSubstr("another program is writing"));
  EXPECT_EQ(Store::open_read(file_).scenes().size(), 0U);
}

TEST_F(StoreTest, ReadersSeeWhatTheWriterHasCommitted) {
  make_memory();
  Store writer = Store::open_write(file_);
  const Store reader = Store::open_read(file_);
  add_one_scene(writer, 1, 1, 2000);
  EXPECT_EQ(reader.scenes().size(), 2U);
}

TEST_F(StoreTest, RefusesToWriteWhenOpenForReading) {
  make_memory();
  Store store = Store::open_read(file_);
  EXPECT_THAT(message([&] { store.begin_run("x", "{}"); }), HasSubstr("reading only"));
  EXPECT_THAT(message([&] { SceneTransaction scene(store, 1); }), HasSubstr("reading only"));
}

TEST_F(StoreTest, ReadsFromAFolderWhereNothingCanBeWritten) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  make_memory();
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(Store::open_read(file_).scenes().size(), 1U);
  fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(StoreTest, RefusesANewerMajorVersionAndNamesWhatReadsIt) {
  make_memory();
  {
    SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
    database.exec("PRAGMA user_version = 2003");
    database.exec("UPDATE meta SET value = 'loci 2.4.0' WHERE key = 'written_by'");
  }
  const std::string text = message([&] { Store::open_read(file_); });
  EXPECT_THAT(text, HasSubstr("memory format 2.3"));
  EXPECT_THAT(text, HasSubstr("loci 2.4.0"));
  EXPECT_THAT(message([&] { Store::open_write(file_); }), HasSubstr("memory format 2.3"));
}

TEST_F(StoreTest, ReadsANewerMinorVersionButDoesNotWriteIt) {
  make_memory();
  {
    SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
    database.exec("PRAGMA user_version = " + std::to_string(kMemoryFormat.version + 1));
  }
  EXPECT_EQ(Store::open_read(file_).scenes().size(), 1U);
  EXPECT_THAT(message([&] { Store::open_write(file_); }), HasSubstr("it can only be read"));
}

TEST_F(StoreTest, RefusesWhatIsNoMemory) {
  EXPECT_THAT(message([&] { Store::open_read(file_); }), HasSubstr("no such memory"));
  EXPECT_THAT(message([&] { Store::open_read(folder_); }), HasSubstr("is a folder"));
  write_file_atomically(file_, "");
  EXPECT_THAT(message([&] { Store::open_read(file_); }), HasSubstr("is empty"));
  write_file_atomically(file_, std::string(5000, 'x'));
  EXPECT_THAT(message([&] { Store::open_read(file_); }), HasSubstr("is not a memory"));
  EXPECT_THAT(message([&] { Store::open_write(file_); }), HasSubstr("is not a memory"));
  EXPECT_EQ(read_file(file_), std::string(5000, 'x'));
  fs::remove(file_);
  {
    SQLite::Database(file_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE t (x)");
  }
  EXPECT_THAT(message([&] { Store::open_read(file_); }), HasSubstr("not a memory of loci"));
  EXPECT_THAT(message([&] { Store::open_write(file_); }), HasSubstr("not a memory of loci"));
}

TEST_F(StoreTest, RefusesATruncatedFileInOneLine) {
  make_memory();
  const std::string whole = read_file(file_);
  for (const size_t size : {50UL, 4096UL, whole.size() / 2, whole.size() - 4096}) {
    write_file_atomically(file_, std::string_view(whole).substr(0, size));
    const std::string text = message([&] { Store::open_read(file_).scenes(); });
    EXPECT_THAT(text, HasSubstr("damaged")) << size;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST_F(StoreTest, RowsWithTwoClocksCannotBeChanged) {
  make_memory();
  SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
  for (const char* table : {"association", "event", "object", "belief"})
    EXPECT_THROW(database.exec(std::string("UPDATE ") + table + " SET known_to = 1"), SQLite::Exception);
}

TEST_F(StoreTest, ARowThatSupersedesAnotherEndsItsBeingKnown) {
  const Id run = make_memory();
  Store store = Store::open_write(file_, {.now = now() + 1000 * kSecond});
  const EventRow wrong = store.events()[0];
  const TimeNs before = now() + 500 * kSecond;
  {
    SceneTransaction correction(store, run);
    EventRow right = wrong;
    right.kind = EventKind::moved;
    right.clock.supersedes = wrong.id;
    right.clock.source = "Ada";
    correction.add_event(right);
    correction.commit();
  }
  ASSERT_EQ(store.events().size(), 1U);
  EXPECT_EQ(store.events()[0].kind, EventKind::moved);
  EXPECT_EQ(store.events()[0].clock.source, "Ada");
  ASSERT_EQ(store.events({.at = {}, .known_at = before}).size(), 1U);
  EXPECT_EQ(store.events({.at = {}, .known_at = before})[0].kind, EventKind::appeared);
  EXPECT_EQ(store.events({.at = {}, .known_at = TimeNs{1}}).size(), 0U);
}

TEST_F(StoreTest, WhoSaidSoIsKeptForObjectsAndBeliefs) {
  const Id run = make_memory();
  Store store = Store::open_write(file_);
  EXPECT_EQ(store.objects()[0].clock.source, "perceive");
  EXPECT_EQ(store.beliefs()[0].clock.source, "perceive");
  const std::string source = "somebody with a name that is too long to be kept inside a string";
  {
    SceneTransaction scene(store, run);
    const Id id = scene.add_scene({.time = 2000});
    ObjectRow object;
    object.clock.source = source;
    BeliefRow belief = {.object = scene.add_object(object), .scene = id, .status = ObjectStatus::seen};
    belief.clock.source = source;
    scene.add_belief(belief);
    scene.commit();
  }
  EXPECT_EQ(store.objects().back().clock.source, source);
  EXPECT_EQ(store.beliefs().back().clock.source, source);
}

TEST_F(StoreTest, BlobsAreStoredOnceAndCompressedWhenItHelps) {
  Store store = Store::open_write(file_);
  const Id run = store.begin_run("test", "{}");
  const std::string text(100000, 'a');
  Id first = 0, second = 0;
  {
    SceneTransaction scene(store, run);
    first = scene.add_blob(text, "text/plain");
    second = scene.add_blob(text, "text/plain");
    scene.commit();
  }
  EXPECT_EQ(first, second);
  EXPECT_EQ(store.blob(first).bytes, text);
  SQLite::Database database(file_.string());
  EXPECT_LT(database.execAndGet("SELECT length(content) FROM blob").getInt(), 1000);
}

TEST_F(StoreTest, VerifyFindsADamagedBlobAndAWrongReference) {
  Store store = Store::open_write(file_);
  const Id run = store.begin_run("test", "{}");
  {
    SceneTransaction scene(store, run);
    scene.add_blob("hello", "text/plain");
    scene.add_scene({.time = 7});
    scene.commit();
  }
  SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
  database.exec("UPDATE blob SET content = x'0000000000'");
  database.exec("PRAGMA foreign_keys = OFF");
  database.exec("INSERT INTO observation (scene, number) VALUES (77, 0)");
  NoProgress quiet;
  EXPECT_THAT(store.verify(quiet).problems,
              testing::UnorderedElementsAre(HasSubstr("observation row 1 refers to a scene"),
                                            HasSubstr("blob 1 does not match its hash"),
                                            HasSubstr("table observation is not as it was written"),
                                            HasSubstr("observation has 1 rows, not the 0 counted")));
}

TEST_F(StoreTest, CountsAndFindsSightingsAsTheRowsSay) {
  Store store = Store::open_write(file_);
  const Id run = store.begin_run("test", "{}");
  constexpr int kScenes = 200;
  std::vector<Id> places;
  for (int i = 0; i < kScenes; ++i) {
    SceneTransaction scene(store, run);
    // Two scenes with one time; one scene that comes late.
    const TimeNs time = i == 150 ? 20 : 10 * (1 + i - i % 2);
    places = {scene.add_place({.name = "a", .class_name = "table"}),
              scene.add_place({.name = "b", .class_name = "table"})};
    const Id id = scene.add_scene({.time = time});
    if (i == 0) {
      scene.add_object({});
      scene.add_object({});
    }
    for (const Id object : {Id{1}, Id{2}}) {
      if (object == 2 && i % 3 != 0) continue;
      const Id seen = scene.add_observation(
          {.scene = id, .number = object, .place = places[static_cast<size_t>(i / 20 % 2)]});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = object,
                             .explanation = Explanation::stay,
                             .probability = 0.9,
                             .chosen = true,
                             .clock = {.valid_from = time}});
      scene.add_belief(
          {.object = object, .scene = id, .status = ObjectStatus::seen, .clock = {.valid_from = time}});
    }
    scene.commit();
  }
  NoProgress quiet;
  EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
  for (const Id object : {Id{1}, Id{2}}) {
    const std::vector<ObjectObservation> all = store.observations_of(object);
    for (TimeNs at = 0; at <= 10 * (kScenes + 2); at += 5) {
      size_t count = 0;
      std::optional<TimeNs> before, after;
      for (const ObjectObservation& sighting : all) {
        count += sighting.time <= at ? 1 : 0;
        if (sighting.observation.place != places[1]) continue;
        if (sighting.time < at) before = sighting.time;
        if (sighting.time > at && !after) after = sighting.time;
      }
      ASSERT_EQ(store.count_observations(object, {.at = at}).count, count) << at;
      const auto found_before = store.last_observation_before(object, at, {places[1]});
      const auto found_after = store.first_observation_after(object, at, {places[1]});
      ASSERT_EQ(found_before ? std::optional(found_before->time) : std::nullopt, before) << at;
      ASSERT_EQ(found_after ? std::optional(found_after->time) : std::nullopt, after) << at;
      ASSERT_EQ(store.observations_of(object, {}, at, at + 100).size(),
                static_cast<size_t>(std::ranges::count_if(all, [&](const ObjectObservation& sighting) {
                  return sighting.time >= at && sighting.time <= at + 100;
                })));
    }
    EXPECT_EQ(store.count_observations(object).first_scene, 1);
  }
}

TEST_F(StoreTest, WhatFollowsFromOtherRowsIsMadeAnew) {
  make_memory();
  Store store = Store::open_write(file_);
  {
    SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
    database.exec("UPDATE observation_rank SET valid_from = 7; DELETE FROM stay");
    database.exec("INSERT INTO stay (belief, since, until) VALUES (77, 1, 2)");
  }
  NoProgress quiet;
  const VerifyReport broken = store.verify(quiet);
  EXPECT_EQ(broken.problems.size(), 3U) << "the count of stays among them";
  EXPECT_EQ(broken.problems, broken.derived_problems);
  store.derive();
  EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
}

TEST_F(StoreTest, ViewsForPeopleAnswer) {
  make_memory();
  SQLite::Database database(file_.string());
  EXPECT_EQ(database.execAndGet("SELECT object || place || status || last_seen FROM v_objects").getString(),
            "object_1table_1seen1970-01-01T00:00:00Z");
  EXPECT_EQ(database.execAndGet("SELECT kind FROM v_events").getString(), "appeared");
  EXPECT_EQ(database.execAndGet("SELECT color FROM v_observations").getString(), "red");
  EXPECT_EQ(database.execAndGet("SELECT observations FROM v_scenes").getInt(), 1);
}

TEST_F(StoreTest, ThePageAboutTheMemoryNamesEveryTableColumnAndView) {
  make_memory();
  const auto code = [](const std::string& name) { return std::string("`").append(name).append("`"); };
  const std::string page = read_file(fs::path(LOCI_SOURCE_DIR) / "docs/memory.md");
  SQLite::Database database(file_.string());
  SQLite::Statement tables(
      database,
      "SELECT name, type FROM sqlite_master WHERE type IN ('table', 'view') AND name NOT LIKE 'sqlite%' "
      "AND name NOT LIKE 'stay\\_%' ESCAPE '\\' AND name NOT LIKE 'term\\_text\\_%' ESCAPE '\\'");
  while (tables.executeStep()) {
    const std::string name = tables.getColumn(0).getString();
    if (tables.getColumn(1).getString() == "view") {
      EXPECT_THAT(page, HasSubstr(code(name)));
      if (!name.starts_with("v_")) continue;
      const size_t row = page.find("| " + code(name) + " |");
      ASSERT_NE(row, std::string::npos) << name;
      SQLite::Statement columns(database, "SELECT name FROM pragma_table_info(?)");
      columns.bind(1, name);
      while (columns.executeStep())
        EXPECT_THAT(page.substr(row, page.find('\n', row) - row),
                    HasSubstr(code(columns.getColumn(0).getString())));
      continue;
    }
    const size_t begin = page.find(std::string("### ").append(name).append("\n"));
    ASSERT_NE(begin, std::string::npos) << name;
    const std::string section = page.substr(begin, page.find("\n##", begin + 3) - begin);
    SQLite::Statement columns(database, "SELECT name FROM pragma_table_info(?)");
    columns.bind(1, name);
    while (columns.executeStep())
      EXPECT_THAT(section, HasSubstr(code(columns.getColumn(0).getString()))) << name;
  }
}

TEST(ObjectNames, AreIdsForPeople) {
  EXPECT_EQ(object_name(12), "object_12");
  EXPECT_EQ(object_id("object_12"), std::optional<Id>(12));
  for (const char* text : {"object_", "object_x", "object_0", "object_1x", "12", "cup"})
    EXPECT_FALSE(object_id(text).has_value()) << text;
}

TEST(DepthThumbnailTest, TellsWhatASceneSaysAboutASpot) {
  SceneCamera camera{640, 480, 585, 585, 320, 240, 0.5, 5.0};
  std::vector<float> depth(80 * 60, 2.0F);  // a wall at 2 m
  for (size_t y = 0; y < 60; ++y)
    depth[y * 80 + 20] = depth[y * 80 + 21] = depth[y * 80 + 22] = 1.0F;  // a pole
  for (size_t y = 0; y < 60; ++y)
    for (size_t x = 60; x < 80; ++x) depth[y * 80 + x] = 0;
  depth = decode_depth_thumbnail(encode_depth_thumbnail(depth));
  const DepthThumbnail thumbnail(camera, Isometry3d::Identity(), 80, 60, depth);
  EXPECT_EQ(thumbnail.spot_status({0, 0, 2.0}), SpotStatus::seen);
  EXPECT_EQ(thumbnail.spot_status({0, 0, 1.2}), SpotStatus::seen_empty);
  EXPECT_EQ(thumbnail.spot_status({0, 0, 2.4}), SpotStatus::hidden);
  EXPECT_EQ(thumbnail.spot_status({0, 0, -1}), SpotStatus::out_of_view);
  EXPECT_EQ(thumbnail.spot_status({0, 0, 6}), SpotStatus::out_of_view);
  EXPECT_EQ(thumbnail.spot_status({5, 0, 2}), SpotStatus::out_of_view);
  EXPECT_EQ(thumbnail.spot_status({(21.0 - 40) / 73.1 * 1.5, 0, 1.5}), SpotStatus::hidden);
  EXPECT_EQ(thumbnail.spot_status({0.8, 0, 2}), SpotStatus::no_depth);
}

}  // namespace
}  // namespace loci::memory
