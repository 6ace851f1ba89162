// Memories that overlap, perceived in parts, in other ways or corrected apart, merge into a sound one.

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "memory/store/rows/merge.h"
#include "tests/memory/edits/random_edits.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using loci::testing_support::RandomMemory;
using testing::IsEmpty;
using testing_support::edit_at_random;

class MergeProperties : public testing_support::TemporaryFolder {
 protected:
  std::vector<std::string> problems(const fs::path& file) {
    return Store::open_read(file).verify(quiet_).problems;
  }

  /// What a memory observed, and of which objects: by frame.
  static std::map<int64_t, std::vector<std::string>> decisions(const fs::path& file) {
    const Store store = Store::open_read(file);
    std::map<int64_t, std::vector<std::string>> all;
    for (const SceneRow& scene : store.scenes()) {
      std::vector<std::string>& here = all[*scene.frame_index];
      std::map<Id, Id> object_of;
      for (const AssociationRow& row : store.associations(scene.id))
        if (row.chosen && row.observation) object_of[*row.observation] = row.object.value_or(0);
      for (const ObservationRow& row : store.observations(scene.id))
        here.push_back(fmt::format("{} at {} {}: object {}", row.number, row.position->x(), row.position->y(),
                                   object_of[row.id]));
    }
    return all;
  }

  static std::map<std::string, int64_t> counts(const fs::path& file) {
    SQLite::Database database(file.string());
    std::map<std::string, int64_t> rows;
    for (const char* table : {"run", "scene", "observation", "object", "association", "event", "belief",
                              "visibility", "fact", "annotation", "blob"})
      rows[table] = database.execAndGet(fmt::format("SELECT count(*) FROM {}", table)).getInt64();
    return rows;
  }

  /// A memory of the same day, perceived in some way and corrected by somebody.
  RandomMemory perceive(const fs::path& file, unsigned seed, std::mt19937& random, int way) {
    RandomMemory::Perception perception;
    perception.every = 1 + int(random() % 3);
    perception.backwards = random() % 2 == 0;
    if (random() % 2 == 0) perception.confused_from = int(random() % 12);
    // Some programs are given the transaction time.
    perception.now = RandomMemory::kStart + (random() % 3 == 0 ? 0 : way * 3600 * kSecond);
    RandomMemory memory(file, seed, 5, 4 + int(random() % 11), perception);
    edit_at_random(file, memory, int(random() % 6), 10 * way);
    return memory;
  }

  void expect_merged(const fs::path& first, const fs::path& second) {
    const fs::path out = folder_ / "merged.loci", again = folder_ / "again.loci";
    for (const fs::path& made : {out, again}) fs::remove(made);
    const MergeResult result = merge(first, second, out, std::nullopt, quiet_);
    EXPECT_THAT(problems(out), IsEmpty());
    auto merged = decisions(out), of_first = decisions(first), of_second = decisions(second);
    EXPECT_EQ(result.scenes, int64_t(merged.size() - of_first.size()));
    for (const auto& [frame, observations] : of_first)
      EXPECT_EQ(merged[frame], observations) << "of frame " << frame << " the first memory's hold";
    for (const auto& [frame, observations] : of_second)
      EXPECT_TRUE(of_first.contains(frame) || merged[frame].size() == observations.size()) << frame;
    merge(out, second, again, std::nullopt, quiet_);
    EXPECT_EQ(counts(again), counts(out)) << "merging again adds nothing";
    // All that is listed as an edit can be undone.
    for (int day = 200; !edits(Store::open_read(out)).done.empty(); ++day) {
      Store store = Store::open_write(out, {.now = RandomMemory::kStart + day * 86400 * kSecond});
      undo(store);
      ASSERT_THAT(store.verify(quiet_).problems, IsEmpty());
    }
  }

  NoProgress quiet_;
};

TEST_F(MergeProperties, TheSameDayPerceivedTwiceIsOneDay) {
  const fs::path a = folder_ / "a.loci", b = folder_ / "b.loci";
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    for (const fs::path& file : {a, b}) fs::remove(file);
    std::mt19937 random(seed);
    perceive(a, seed, random, 1);
    perceive(b, seed, random, 2);
    expect_merged(a, b);
    expect_merged(b, a);
    expect_merged(a, a);
    if (HasFailure()) return;
  }
}

TEST_F(MergeProperties, CopiesThatWereCorrectedApartAreOne) {
  const fs::path a = folder_ / "a.loci", b = folder_ / "b.loci";
  for (unsigned seed = 100; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    for (const fs::path& file : {a, b}) fs::remove(file);
    std::mt19937 random(seed);
    RandomMemory memory = perceive(a, seed, random, 1);
    fs::copy_file(a, b);
    edit_at_random(a, memory, 4, 40);
    edit_at_random(b, memory, 4, 60);
    expect_merged(a, b);
    expect_merged(b, a);
    if (HasFailure()) return;
  }
}

TEST_F(MergeProperties, ACorrectionThatStaysBehindIsReportedAndIsNoEdit) {
  const fs::path a = folder_ / "a.loci", b = folder_ / "b.loci", out = folder_ / "out.loci";
  const RandomMemory memory(a, 3);
  fs::copy_file(a, b);
  {
    Store store = Store::open_write(b, {.now = RandomMemory::kStart + 86400 * kSecond});
    label_observation(store, store.observations_of(1).front().observation.scene, 0, "gizmo");
    say(store, "object_1", "owner", "Ada");
  }
  const MergeResult result = merge(a, b, out, std::nullopt, quiet_);
  ASSERT_EQ(result.left_edits.size(), 1U);
  EXPECT_THAT(result.left_edits[0], testing::HasSubstr("is a gizmo"));
  const Store store = Store::open_read(out);
  const EditList list = edits(store);
  ASSERT_EQ(list.done.size(), 1U);
  EXPECT_THAT(list.done[0].text, testing::HasSubstr("owner is Ada"));
  EXPECT_THAT(store.objects_annotated("gizmo"), IsEmpty());
}

}  // namespace
}  // namespace loci::memory
