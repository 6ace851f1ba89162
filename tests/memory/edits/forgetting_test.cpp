// What is forgotten on request is gone: from rows, answers, images and the bytes of the file.

#include <SQLiteCpp/SQLiteCpp.h>
#include <sys/wait.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/edits/edits.h"
#include "memory/edits/forget.h"
#include "memory/questions/contents.h"
#include "memory/questions/events.h"
#include "memory/questions/facts.h"
#include "memory/questions/location.h"
#include "memory/questions/objects.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "memory/store/erasure/retention.h"
#include "memory/store/rows/merge.h"
#include "tests/memory/edits/random_edits.h"
#include "tests/memory/questions/day_fixture.h"
#include "tests/support/random_memory.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using loci::testing_support::RandomMemory;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing_support::day_time;
using testing_support::edit_at_random;
using testing_support::SyntheticDay;

std::vector<std::string> problems(const fs::path& file) {
  NoProgress quiet;
  return Store::open_read(file).verify(quiet).problems;
}

std::vector<std::string> left(const fs::path& file, const ForgottenTokens& tokens) {
  NoProgress quiet;
  return find_forgotten(file, tokens, quiet);
}

template <class Change>
auto edit(const fs::path& file, Change change, TimeNs now = SyntheticDay::kKnownSecond + 86400 * kSecond) {
  Store store = Store::open_write(file, {.now = now});
  return change(store);
}

/// All that questions can tell, now, at times of the memory, and as it was known before.
std::string everything(const fs::path& file) {
  const Store store = Store::open_read(file);
  const TimeWriter times(store);
  std::string all;
  std::vector<AsOf> when = {{}};
  for (const SceneRow& scene : store.scenes()) {
    when.push_back({.at = scene.time});
    when.push_back({.known_at = scene.known_from});
  }
  for (const AsOf& as_of : when) {
    all += to_text(ask(store, ObjectsQuestion{{}, as_of}), times);
    all += to_text(ask(store, ChangesQuestion{.as_of = as_of}), times);
    all += to_text(ask(store, FactsQuestion{"", "", as_of}));
    for (const PlaceRow& place : store.places())
      all += to_text(ask(store, ContentsQuestion{place.name, as_of, {}}), times);
  }
  all += to_text(ask(store, TimelineQuestion{}), times) + to_text(ask(store, ScenesQuestion{}), times);
  for (const BeliefRow& belief : store.beliefs())
    all += to_text(ask(store, HistoryQuestion{object_name(belief.object)}), times) +
           to_text(ask(store, WhereQuestion{object_name(belief.object), {}}), times);
  for (const Edit& done : edits(store).done) all += done.text + "\n";
  for (const Edit& undone : edits(store).undone) all += undone.text + "\n";
  for (const RunRow& run : store.runs()) all += run.configuration + "\n";
  return all;
}

/// Whether a text has the name of an object as a word.
bool names(const std::string& text, Id object) {
  const std::string name = object_name(object);
  for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
    if (at + name.size() == text.size() ||
        std::isdigit(static_cast<unsigned char>(text[at + name.size()])) == 0)
      return true;
  return false;
}

class Forgetting : public testing_support::DayFixture {
 protected:
  void SetUp() override {
    DayFixture::SetUp();
    store_.reset();  // readers are in the way
  }
  size_t observations_of(Id object) { return Store::open_read(file_).observations_of(object).size(); }
};

TEST_F(Forgetting, LeavesAnObjectThatWasSplitOff) {
  const Edit split = edit(file_, [](Store& store) { return split_object(store, 1, day_time("09:15")); });
  const Id made = Store::open_read(file_).max_object_id();
  const std::string where = to_text(ask(Store::open_read(file_), WhereQuestion{object_name(made), {}}),
                                    TimeWriter(Store::open_read(file_)));
  ASSERT_EQ(observations_of(made), 2U);
  const ForgetResult result = forget(file_, {.object = 1});
  EXPECT_EQ(result.observations, 1) << "what belongs to it now, not what once did";
  EXPECT_EQ(observations_of(made), 2U);
  EXPECT_THAT(problems(file_), IsEmpty());
  const Store store = Store::open_read(file_);
  EXPECT_EQ(to_text(ask(store, WhereQuestion{object_name(made), {}}), TimeWriter(store)), where);
  EXPECT_FALSE(names(everything(file_), 1));
  EXPECT_THAT(edits(store).done, IsEmpty()) << "it cannot be undone any more";
}

TEST_F(Forgetting, OfASplitOffObjectLeavesTheOther) {
  edit(file_, [](Store& store) { return split_object(store, 1, day_time("09:15")); });
  const Id made = Store::open_read(file_).max_object_id();
  forget(file_, {.object = made});
  EXPECT_EQ(observations_of(1), 1U);
  EXPECT_THAT(problems(file_), IsEmpty());
  const std::string all = everything(file_);
  EXPECT_FALSE(names(all, made));
  EXPECT_THAT(all, Not(HasSubstr("3.6"))) << "where object_1 was believed to be by what is forgotten";
}

TEST_F(Forgetting, TakesAlongWhatWasMergedIntoTheObject) {
  edit(file_, [](Store& store) { return say(store, "object_4", "owner", "Grace Hopper"); });
  edit(
      file_, [](Store& store) { return merge_objects(store, 4, 2); },
      SyntheticDay::kKnownSecond + 2 * 86400 * kSecond);
  const ForgetResult result = forget(file_, {.object = 2});
  EXPECT_EQ(result.objects, 2);
  EXPECT_THAT(result.tokens.texts, testing::Contains(HasSubstr("Grace Hopper")));
  EXPECT_THAT(problems(file_), IsEmpty());
  EXPECT_THAT(left(file_, result.tokens), IsEmpty());
  const std::string all = everything(file_);
  EXPECT_FALSE(names(all, 2));
  EXPECT_FALSE(names(all, 4));
  EXPECT_THAT(all, Not(HasSubstr("Grace")));
}

TEST_F(Forgetting, LeavesAnObjectWhoseMergeWasUndone) {
  const std::string before = everything(file_);
  edit(file_, [](Store& store) { return merge_objects(store, 4, 2); });
  edit(
      file_, [](Store& store) { return undo(store); }, SyntheticDay::kKnownSecond + 2 * 86400 * kSecond);
  forget(file_, {.object = 2});
  EXPECT_EQ(observations_of(4), 1U);
  EXPECT_THAT(problems(file_), IsEmpty());
  const Store store = Store::open_read(file_);
  EXPECT_EQ(ask(store, WhereQuestion{"object_4", {}}).objects.at(0).place->name, "drawer_1_bottom");
  EXPECT_FALSE(names(everything(file_), 2));
}

TEST_F(Forgetting, TakesLabelsAndTheirEditsAway) {
  edit(file_, [](Store& store) { return label_observation(store, 1, 0, "grandmother's teapot"); });
  edit(file_, [](Store& store) { return label_observation(store, 1, 1, "blue mug"); });
  const ForgetResult result = forget(file_, {.object = 1});
  EXPECT_THAT(left(file_, result.tokens), IsEmpty());
  EXPECT_EQ(read_file(file_).find("teapot"), std::string::npos);
  const EditList list = edits(Store::open_read(file_));
  ASSERT_EQ(list.done.size(), 1U) << "the edit of another object stays, and can be undone";
  edit(file_, [](Store& store) { return undo(store); });
  EXPECT_THAT(problems(file_), IsEmpty());
}

TEST_F(Forgetting, NumbersOfObjectsAreNotGivenAgain) {
  const ForgetResult result = forget(file_, {.object = 4});
  EXPECT_EQ(result.object_ids, std::set<Id>{4});
  edit(file_, [](Store& store) { return split_object(store, 1, day_time("09:15")); });
  EXPECT_EQ(Store::open_read(file_).max_object_id(), 5);
  EXPECT_EQ(observations_of(5), 2U);
  const Store store = Store::open_read(file_);
  EXPECT_THAT(
      [&] {
        ask(store, WhereQuestion{"object_4", {}});
      },
      testing::ThrowsMessage<Error>(HasSubstr("forgotten on request")));
  EXPECT_EQ(SQLite::Database(file_.string()).execAndGet("SELECT count(*) FROM object WHERE id = 4").getInt(),
            0);
}

TEST_F(Forgetting, IsRefusedWhileTheMemoryIsRead) {
  const std::string before = everything(file_);
  {
    const Store reader = Store::open_read(file_);
    reader.scenes();
    for (const ForgetRequest& request :
         {ForgetRequest{.object = 1}, ForgetRequest{.from = 0, .to = day_time("23:00")}})
      EXPECT_THAT(
          [&] { forget(file_, request); },
          testing::ThrowsMessage<Error>(AllOf(HasSubstr("is reading this memory"), Not(HasSubstr("\n")))));
    EXPECT_THAT([&] { retain(file_, {.images_s = 0}); },
                testing::ThrowsMessage<Error>(HasSubstr("is reading this memory")));
    const fs::path copy = folder_ / "copy.loci";
    forget(file_, {.object = 1}, copy);
    EXPECT_FALSE(names(everything(copy), 1));
  }
  EXPECT_EQ(everything(file_), before);
  forget(file_, {.object = 1});
  EXPECT_FALSE(names(everything(file_), 1));
}

TEST_F(Forgetting, NeverWritesOverTheMemoryOrAnotherFile) {
  const std::string before = read_file(file_);
  fs::create_symlink(file_, folder_ / "link.loci");
  write_file_atomically(folder_ / "other", "precious");
  for (const fs::path& output :
       {file_, folder_ / "." / "memory.loci", folder_ / "link.loci", folder_ / "other"}) {
    EXPECT_THROW(forget(file_, {.object = 1}, output), Error) << output;
    EXPECT_THROW(retain(file_, {.images_s = 0}, output), Error) << output;
  }
  EXPECT_EQ(everything(file_).empty(), false);
  EXPECT_EQ(read_file(file_), before);
  EXPECT_EQ(read_file(folder_ / "other"), "precious");
  forget(folder_ / "link.loci", {.object = 1});
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.loci"));
  EXPECT_FALSE(names(everything(file_), 1));
}

TEST_F(Forgetting, AnIntervalReadsAsForgotten) {
  edit(file_, [](Store& store) { return say(store, "table_1", "owner", "Ada Lovelace"); });
  // The morning: the first scene, after which object_1 is seen to be gone, and then elsewhere.
  const ForgetResult result = forget(file_, {.from = day_time("07:55"), .to = day_time("08:05")});
  EXPECT_THAT(problems(file_), IsEmpty());
  EXPECT_THAT(left(file_, result.tokens), IsEmpty());
  const Store store = Store::open_read(file_);
  const TimeWriter times(store);
  const std::string scenes = to_text(ask(store, ScenesQuestion{}), times);
  EXPECT_THAT(scenes, HasSubstr("forgotten on request"));
  EXPECT_TRUE(ask(store, ScenesQuestion{}).scenes.at(0).forgotten);
  EXPECT_FALSE(ask(store, ScenesQuestion{}).scenes.at(1).forgotten);
  EXPECT_THAT(store.facts(), testing::Each(testing::Field(&FactRow::place, testing::Eq(std::nullopt))))
      << "what was stated about a place to hold from then on";
  for (const EventRow& event : store.events()) {
    EXPECT_FALSE(event.since && *event.since >= day_time("07:55") && *event.since <= day_time("08:05"));
    if (event.object == 1) {
      EXPECT_FALSE(event.from_place) << to_text(event.kind) << ": where it had been was seen then";
    }
  }
  EXPECT_EQ(store.objects().front().clock.valid_from, day_time("09:30"));
  EXPECT_EQ(ask(store, WhereQuestion{"object_1", {}}).objects.at(0).place->name, "counter_1");
}

TEST_F(Forgetting, OfEverythingOfNothingAndToTheEndOfADay) {
  const ForgetResult nothing = forget(file_, {.from = day_time("11:00"), .to = day_time("12:00")});
  EXPECT_EQ(nothing.observations, 0);
  EXPECT_THAT(nothing.erased, IsEmpty());
  EXPECT_THAT(problems(file_), IsEmpty());
  EXPECT_EQ(observations_of(1), 3U);
  // Both ends belong to it.
  const TimeNs midnight = parse_time("2026-05-02T00:00:00Z");
  const ForgetResult evening = forget(file_, {.from = day_time("10:30"), .to = midnight});
  EXPECT_EQ(evening.observations, 2);
  EXPECT_EQ(evening.object_ids, std::set<Id>{4});
  EXPECT_THAT(problems(file_), IsEmpty());
  EXPECT_THAT([&] { forget(file_, {.from = midnight, .to = day_time("10:30")}); },
              testing::ThrowsMessage<Error>(HasSubstr("after the second")));
  const ForgetResult all = forget(file_, {.from = 0, .to = midnight});
  EXPECT_THAT(problems(file_), IsEmpty());
  EXPECT_THAT(left(file_, all.tokens), IsEmpty());
  const Store store = Store::open_read(file_);
  EXPECT_THAT(store.objects(), IsEmpty());
  EXPECT_THAT(store.events(), IsEmpty());
  EXPECT_EQ(store.scenes().size(), 6U) << "so that the recording is not taken in again";
}

TEST_F(Forgetting, TakesWhatIsStatedAboutAPlace) {
  for (const auto& [key, value] :
       {std::pair{"owner", "Ada Lovelace"}, {"alias", "the tea altar"}, {"owner", "Grace Hopper"}})
    edit(file_, [&, k = key, v = value](Store& store) { return say(store, "table_1", k, v); });
  edit(file_, [&](Store& store) { return say(store, "counter_1", "owner", "Ada Byron"); });
  fs::copy_file(file_, folder_ / "older.loci");
  const Id table = Store::open_read(file_).places().front().id;
  const ForgetResult result = forget(file_, {.place = table});
  EXPECT_EQ(result.tokens.texts.size(), 3U);
  EXPECT_THAT(left(file_, result.tokens), IsEmpty());
  EXPECT_THAT(left(folder_ / "older.loci", result.tokens), Not(IsEmpty()));
  EXPECT_THAT(everything(file_),
              AllOf(Not(HasSubstr("Lovelace")), Not(HasSubstr("altar")), HasSubstr("Ada Byron")));
  EXPECT_THAT(problems(file_), IsEmpty());
  NoProgress quiet;
  merge(file_, folder_ / "older.loci", folder_ / "merged.loci", std::nullopt, quiet);
  EXPECT_THAT(left(folder_ / "merged.loci", result.tokens), IsEmpty());
}

TEST_F(Forgetting, AMergeWithAnOlderCopyDoesNotBringItBack) {
  edit(file_, [](Store& store) { return label_observation(store, 1, 0, "grandmother's teapot"); });
  const fs::path older = folder_ / "older.loci";
  fs::copy_file(file_, older);
  const ForgetResult one = forget(file_, {.object = 1});
  const ForgetResult hour = forget(file_, {.from = day_time("08:20"), .to = day_time("08:40")});
  NoProgress quiet;
  int number = 0;
  for (const auto& [first, second] : {std::pair(file_, older), std::pair(older, file_)}) {
    const fs::path merged = folder_ / fmt::format("merged_{}.loci", ++number);
    const MergeResult result = merge(first, second, merged, std::nullopt, quiet);
    EXPECT_GT(result.forgotten, 0);
    EXPECT_THAT(problems(merged), IsEmpty());
    EXPECT_THAT(left(merged, one.tokens), IsEmpty());
    EXPECT_THAT(left(merged, hour.tokens), IsEmpty());
    EXPECT_THAT(everything(merged), AllOf(Not(HasSubstr("teapot")), Not(HasSubstr("tea cup"))));
    const Store store = Store::open_read(merged);
    EXPECT_EQ(store.objects().size(), 3U);
    EXPECT_EQ(store.forgotten().size(), 2U) << "and a third copy is merged likewise";
    EXPECT_THAT(to_text(ask(store, ScenesQuestion{}), TimeWriter(store)), HasSubstr("forgotten on request"));
  }
}

TEST_F(Forgetting, LeavesATombstoneThatTellsNothing) {
  forget(file_, {.object = 1});
  SQLite::Database database(file_.string());
  EXPECT_GT(database.execAndGet("SELECT id FROM forgotten").getInt64(), 1'000'000) << "a random id";
  SQLite::Statement signatures(database, "SELECT signature FROM forgotten_signature");
  int count = 0;
  while (signatures.executeStep()) {
    EXPECT_EQ(signatures.getColumn(0).getString().size(), 64U);
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST_F(Forgetting, IsProvenByTokensThatFindWhatIsLeft) {
  fs::copy_file(file_, folder_ / "older.loci");
  const ForgetResult result = forget(file_, {.object = 1});
  EXPECT_THAT(result.tokens.texts, testing::IsSupersetOf({"Darjeeling", "tea cup"}));
  EXPECT_THAT(left(file_, result.tokens), IsEmpty());
  EXPECT_THAT(left(folder_ / "older.loci", result.tokens), Not(IsEmpty()));
  const ForgottenTokens read =
      tokens_from_json(parse_json(to_json(result.tokens).dump(), "tokens"), "tokens");
  EXPECT_EQ(read.texts, result.tokens.texts);
  EXPECT_EQ(read.numbers, result.tokens.numbers);
  EXPECT_THAT([] { tokens_from_json(Json::array(), "list"); },
              testing::ThrowsMessage<Error>(HasSubstr("no file of tokens")));
  // A free page still has it.
  {
    SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
    database.exec(
        "PRAGMA secure_delete = OFF; CREATE TABLE scratch (text TEXT); INSERT INTO scratch VALUES "
        "('Darjeeling'); DROP "
        "TABLE scratch; PRAGMA wal_checkpoint(TRUNCATE)");
  }
  EXPECT_THAT(left(file_, result.tokens), testing::Contains(HasSubstr("'Darjeeling' is in the bytes")));
}

TEST_F(Forgetting, KilledAtAnyMomentLeavesTheOldOrTheNewMemory) {
  const fs::path original = folder_ / "original.loci";
  fs::copy_file(file_, original);
  const std::string before = everything(file_);
  const ForgetResult result = forget(file_, {.object = 1});
  const std::string after = everything(file_);
  int old_ones = 0;
  for (int attempt = 0; attempt < 12; ++attempt) {
    fs::copy_file(original, file_, fs::copy_options::overwrite_existing);
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        forget(file_, {.object = 1});
      } catch (...) {
      }
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(4000 * attempt));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string now = everything(file_);
    old_ones += now == before ? 1 : 0;
    EXPECT_TRUE(now == before || now == after) << attempt;
    EXPECT_THAT(problems(file_), IsEmpty());
    if (now == after) {
      EXPECT_THAT(left(file_, result.tokens), IsEmpty());
    }
  }
  EXPECT_GT(old_ones, 0);
  forget(original, {.object = 2});
  edit(file_, [](Store& store) { return store.begin_run("test", "{}"); });
  EXPECT_FALSE(fs::exists(file_.string() + ".partial")) << "the next writer removes what a killed one left";
}

// ---- Random memories.

class RandomForgetting : public testing_support::TemporaryFolder {
 protected:
  /// Whether an image of the memory shows a cube where it stood.
  bool shows(const Store& store, const RandomMemory::Cube& cube, const RandomMemory::Sight& sight) {
    const SceneRow scene = store.scene(sight.scene);
    if (!scene.image) return false;
    const std::string bytes = store.blob(*scene.image).bytes;
    const cv::Mat image = mapping::decode_image({bytes.begin(), bytes.end()}, "image");
    cv::Mat same;
    cv::inRange(image(sight.pixels), cube.color - cv::Scalar::all(2), cube.color + cv::Scalar::all(2), same);
    return cv::countNonZero(same) > 0;
  }
};

TEST_F(RandomForgetting, TakesAllOfAnObjectAndNothingOfOthers) {
  for (unsigned seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(seed);
    fs::remove(file_);
    RandomMemory random(file_, seed);
    edit_at_random(file_, random);
    ASSERT_THAT(problems(file_), IsEmpty());
    std::map<Id, std::set<Id>> observed;
    std::map<std::string, std::set<Id>> objects_with_mark;
    {
      const Store store = Store::open_read(file_);
      for (const BeliefRow& belief : store.beliefs()) {
        for (const ObjectObservation& one : store.observations_of(belief.object))
          observed[belief.object].insert(one.observation.id);
        for (const RandomMemory::Cube& cube : random.cubes)
          for (const Id object : store.objects_annotated(cube.mark))
            objects_with_mark[cube.mark].insert(object);
      }
    }
    std::erase_if(observed, [](const auto& one) { return one.second.empty(); });
    const Id object =
        std::next(observed.begin(), int(random.draw(0, double(observed.size()) - 0.001)))->first;
    const fs::path older = folder_ / "older.loci", merged = folder_ / "merged.loci";
    fs::copy_file(file_, older, fs::copy_options::overwrite_existing);

    ForgetResult result = forget(file_, {.object = object});
    EXPECT_EQ(result.observation_ids, observed[object]);
    // A cube that a person split into two objects is still to be seen as the other one.
    for (const auto& [mark, objects] : objects_with_mark)
      if (objects.contains(object) && objects.size() > 1) result.tokens.images.clear();
    EXPECT_THAT(problems(file_), IsEmpty());
    EXPECT_THAT(left(file_, result.tokens), IsEmpty());
    EXPECT_THAT(left(older, result.tokens), Not(IsEmpty())) << "the proof would find it";
    const std::string all = everything(file_);
    for (const Id gone : result.object_ids) EXPECT_FALSE(names(all, gone)) << gone;
    {
      const Store store = Store::open_read(file_);
      for (const auto& [other, ids] : observed) {
        if (other == object) continue;
        std::set<Id> still;
        for (const ObjectObservation& one : store.observations_of(other)) still.insert(one.observation.id);
        EXPECT_EQ(still, ids) << other;
      }
    }
    fs::remove(merged);
    NoProgress quiet;
    merge(older, file_, merged, std::nullopt, quiet);
    EXPECT_THAT(problems(merged), IsEmpty());
    EXPECT_THAT(left(merged, result.tokens), IsEmpty());
  }
}

TEST_F(RandomForgetting, CutsAnObjectOutOfScenesThatDidNotDetectIt) {
  int undetected = 0;
  for (unsigned seed = 100; seed < 112; ++seed) {
    SCOPED_TRACE(seed);
    fs::remove(file_);
    RandomMemory random(file_, seed);
    const RandomMemory::Cube& cube = random.cubes.front();
    if (cube.object == 0) continue;
    const ForgetResult result = forget(file_, {.object = cube.object});
    EXPECT_GT(result.erased.at("image region"), 0);
    const Store store = Store::open_read(file_);
    int before_it_moved_unseen = 0;
    for (const RandomMemory::Sight& sight : random.sights[cube.mark]) {
      undetected += sight.detected ? 0 : 1;
      // A spot where it was never detected is not known.
      bool known = false;
      for (const RandomMemory::Sight& other : random.sights[cube.mark])
        known = known || (other.detected && other.pixels == sight.pixels);
      if (!known)
        ++before_it_moved_unseen;
      else
        EXPECT_FALSE(shows(store, cube, sight))
            << "scene " << sight.scene << (sight.detected ? "" : " undetected");
    }
    EXPECT_LE(before_it_moved_unseen, 4);
    for (const RandomMemory::Cube& other : random.cubes)
      if (other.object != 0 && other.object != cube.object) {
        EXPECT_TRUE(std::ranges::any_of(random.sights[other.mark], [&](const auto& sight) {
          return shows(store, other, sight);
        })) << "others stay";
      }
  }
  EXPECT_GT(undetected, 5);
}

TEST_F(RandomForgetting, OfAnIntervalLeavesNothingOfIt) {
  for (unsigned seed = 200; seed < 210; ++seed) {
    SCOPED_TRACE(seed);
    fs::remove(file_);
    RandomMemory random(file_, seed);
    edit_at_random(file_, random);
    const TimeNs from = RandomMemory::kStart + int64_t(random.draw(0, 12)) * 600 * kSecond,
                 to = from + 1500 * kSecond;
    const ForgetResult result = forget(file_, {.from = from, .to = to});
    EXPECT_THAT(problems(file_), IsEmpty());
    EXPECT_THAT(left(file_, result.tokens), IsEmpty());
    const Store store = Store::open_read(file_);
    for (const BeliefRow& belief : store.beliefs()) {
      EXPECT_FALSE(belief.clock.valid_from >= from && belief.clock.valid_from <= to);
      const auto last = store.observations_of(belief.object);
      ASSERT_FALSE(last.empty());
      EXPECT_EQ(belief.last_observation, last.back().observation.id) << belief.object;
    }
    for (const SceneRow& scene : store.scenes({}, from, to)) {
      EXPECT_FALSE(scene.image || scene.depth || scene.map_from_camera);
      EXPECT_THAT(store.observations(scene.id), IsEmpty());
    }
  }
}

TEST_F(RandomForgetting, RetentionLeavesNoBytesOfOldImages) {
  for (unsigned seed = 300; seed < 306; ++seed) {
    SCOPED_TRACE(seed);
    fs::remove(file_);
    RandomMemory random(file_, seed);
    edit_at_random(file_, random);
    std::map<std::string, std::string> blobs;
    {
      const Store store = Store::open_read(file_);
      for (const SceneRow& scene : store.scenes())
        for (const auto& id : {scene.image, scene.depth}) {
          const BlobRow blob = store.blob(*id);
          blobs[blob.hash] = blob.bytes;
        }
    }
    const std::string before = everything(file_);
    retain(file_, {.images_s = random.draw(0, 6000)});
    EXPECT_THAT(problems(file_), IsEmpty());
    const std::string after = everything(file_);
    EXPECT_EQ(after.substr(0, 2000), before.substr(0, 2000)) << "answers stay";
    const std::string bytes = read_file(file_);
    const Store store = Store::open_read(file_);
    for (const auto& [hash, content] : blobs)
      if (!store.find_blob(hash)) {
        EXPECT_EQ(bytes.find(hash), std::string::npos);
        EXPECT_EQ(bytes.find(content.substr(content.size() / 2, 64)), std::string::npos);
      }
  }
}

/// Edits that name none of the forgotten objects stay, and every edit that stays can be undone.
TEST_F(RandomForgetting, LeavesEditsOfOthersToBeUndone) {
  size_t left_edits = 0;
  for (unsigned seed = 400; seed < 420; ++seed) {
    SCOPED_TRACE(seed);
    fs::remove(file_);
    RandomMemory random(file_, seed);
    int day = 1;
    for (int step = 0; step < 4; ++step, day += 10) {
      edit_at_random(file_, random, 6, day);
      const std::vector<Edit> before = edits(Store::open_read(file_)).done;
      const std::vector<BeliefRow> beliefs = Store::open_read(file_).beliefs();
      if (beliefs.empty()) break;
      const Id object = beliefs.at(size_t(random.draw(0, double(beliefs.size()) - 0.001))).object;
      const ForgetResult result = forget(file_, {.object = object});
      ASSERT_THAT(problems(file_), IsEmpty()) << "object " << object;
      std::vector<std::string> texts;
      for (const Edit& done : edits(Store::open_read(file_)).done) texts.push_back(done.text);
      for (const Edit& done : before) {
        const bool is_label = done.text.starts_with("observation");
        if (is_label || std::ranges::any_of(result.object_ids, [&](Id id) { return names(done.text, id); }))
          continue;
        EXPECT_THAT(texts, testing::Contains(done.text));
        ++left_edits;
      }
    }
    while (!edits(Store::open_read(file_)).done.empty()) {
      edit(
          file_, [](Store& store) { return undo(store); }, RandomMemory::kStart + ++day * 86400 * kSecond);
      ASSERT_THAT(problems(file_), IsEmpty());
    }
  }
  EXPECT_GT(left_edits, 20U);
}

TEST_F(Forgetting, TakesWhereOthersWereSaidToComeFrom) {
  // That object_3 came from where object_2 was observed was believed until the next row.
  const Vector3d at = *Store::open_read(file_).observations_of(2).front().observation.position;
  {
    Store store = Store::open_write(file_, {.now = SyntheticDay::kKnownSecond});
    SceneTransaction rows(store, store.begin_run("hindsight", "{}"));
    const EventRow event{.scene = 4,
                         .kind = EventKind::moved,
                         .object = 3,
                         .from_position = at,
                         .clock = {.valid_from = day_time("09:30")}};
    EventRow later = event;
    later.clock.supersedes = rows.add_event(event);
    later.from_position.reset();
    rows.add_event(later);
    rows.commit();
  }
  const ForgetResult result = forget(file_, {.object = 2});
  EXPECT_THAT(problems(file_), IsEmpty());
  SQLite::Database database(file_.string());
  SQLite::Statement from(database, "SELECT count(*) FROM event WHERE from_x = ? AND from_y = ?");
  from.bind(1, at.x());
  from.bind(2, at.y());
  ASSERT_TRUE(from.executeStep());
  EXPECT_EQ(from.getColumn(0).getInt(), 0);
}

}  // namespace
}  // namespace loci::memory
