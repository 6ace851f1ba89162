// A memory as another program finds it: the belief goes on from what is stored, and what is forgotten is gone
// from the file.

#include <gmock/gmock.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "memory/edits/forget.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/location.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/recorder.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

class StoredBelief : public testing::Test {
 protected:
  void SetUp() override {
    make_folder(folder_);
    Warnings warnings;
    ingest(fs::path(LOCI_SOURCE_DIR) / "apps/samples/detections.jsonl", file_, {}, {}, silent_, warnings);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void expect_sound() { EXPECT_THAT(Store::open_read(file_).verify(silent_).problems, IsEmpty()); }

  fs::path folder_ = fs::temp_directory_path() / ("loci_stored_belief_" + std::to_string(::getpid()));
  fs::path file_ = folder_ / "memory.loci";
  NoProgress silent_;
};

TEST_F(StoredBelief, GoesOn) {
  {
    Store store = Store::open_write(file_);
    const std::optional<SceneRow> last = store.last_scene();
    SceneRecord next;
    next.row.time = last->time + 60 * kSecond;
    Recorder recorder(store, store.begin_run("test", "{}"));
    EXPECT_EQ(recorder.belief().last_scene, last->time);
    std::ptrdiff_t believed = 0;
    for (const BeliefRow& row : store.beliefs()) believed += row.status == ObjectStatus::gone ? 0 : 1;
    EXPECT_GT(believed, 0);
    EXPECT_EQ(std::ranges::count_if(recorder.belief().objects,
                                    [](const belief::ProtoObject& object) {
                                      return object.id != 0 && object.status == belief::Status::present;
                                    }),
              believed);
    recorder.record(next);
  }
  expect_sound();
}

TEST_F(StoredBelief, OfAnotherVersionDoesNotStandInTheWayOfForgetting) {
  {
    Store store = Store::open_write(file_);
    SceneTransaction other(store, store.begin_run("test", "{}"));
    other.set_checkpoint("belief", "\xa0\x06\x01", store.last_scene()->id);  // its version alone: 1
    other.commit();
    EXPECT_THAT([&] { load_belief(store); }, testing::ThrowsMessage<Error>(HasSubstr("another version")));
    EXPECT_FALSE(store.checkpoints("belief/").empty());
  }
  EXPECT_TRUE(forget(file_, {.object = 1}).erased.contains(kUnreadableBelief));
  {
    const Store store = Store::open_read(file_);
    EXPECT_FALSE(store.belief(1).has_value());
    EXPECT_EQ(store.checkpoints("belief").size(), 1U) << "objects may be what was forgotten";
    EXPECT_THAT([&] { load_belief(store); }, testing::ThrowsMessage<Error>(HasSubstr("another version")))
        << "a run would go on as if nothing were known";
  }
  EXPECT_FALSE(forget(file_, {.object = 2}).erased.contains(kUnreadableBelief))
      << "there was nothing more to drop";
  expect_sound();
}

TEST_F(StoredBelief, IsForgottenForGood) {
  std::vector<Id> cereals;
  TimeNs last = 0;
  {
    const Store store = Store::open_read(file_);
    cereals = store.objects_annotated("cereal");
    last = *store.last_scene_time();
  }
  ASSERT_FALSE(cereals.empty());
  for (const Id object : cereals) forget(file_, {.object = object});
  // Alternative associations may have had the term too.
  forget(file_, {.from = 0, .to = last});
  for (const char* end : {"", "-wal", "-shm"}) {
    const fs::path part = file_.string() + end;
    if (fs::exists(part)) {
      EXPECT_EQ(read_file(part).find("cereal"), std::string::npos) << part;
    }
  }
  expect_sound();
  const Store store = Store::open_read(file_);
  const auto where = [&] { return ask(store, WhereQuestion{"object_1", {}}); };
  EXPECT_THAT([&] { where(); }, testing::ThrowsMessage<Error>(HasSubstr("forgotten")));
}

}  // namespace
}  // namespace loci::memory
