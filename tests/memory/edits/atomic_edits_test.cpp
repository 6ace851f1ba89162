// An edit and its reasoning are one change: when the reasoning fails, the memory is as it was.

#include <gmock/gmock.h>
#include <unistd.h>

#include "memory/edits/edits.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/facts.h"
#include "memory/recorder/checkpoint.h"
#include "tests/memory/recorder/memory_dump.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class AtomicEdits : public testing::Test {
 protected:
  void SetUp() override {
    Warnings warnings;
    ingest(fs::path(LOCI_SOURCE_DIR) / "apps/samples/detections.jsonl", file_, {}, {}, silent_, warnings);
    Store store = Store::open_write(file_);
    teach(store, "object_1", "mug");
    split_object(store, 1, store.observations_of(1).back().time);
    // A belief that cannot be read is the failure: the present one, and that to which undo returns.
    SceneTransaction rows(store, store.begin_run("test", "{}"));
    rows.set_checkpoint("belief", "no belief", store.last_scene()->id);
    for (const auto& [name, kept] : store.checkpoints(kKeptBeliefs))
      if (name.ends_with("/belief")) rows.set_checkpoint(name, "no belief", kept.scene);
    rows.commit();
  }
  void TearDown() override { fs::remove(file_); }

  /// All rows, and the runs, which the dump leaves out.
  std::string state() const {
    std::string text = memory_dump(file_);
    for (const RunRow& run : Store::open_read(file_).runs())
      text += std::to_string(run.id) + (run.finished ? " finished\n" : " begun\n");
    return text;
  }
  void expect_unchanged(const char* what, const std::function<void(Store&)>& edit) {
    const std::string before = state();
    try {
      Store store = Store::open_write(file_);
      edit(store);
      FAIL() << what << " was not refused";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("loci-memory reason -m " + file_.string())) << what;
    }
    EXPECT_EQ(state(), before) << what;
    EXPECT_THAT(Store::open_read(file_).verify(silent_).problems, testing::IsEmpty()) << what;
  }

  fs::path file_ = fs::temp_directory_path() / ("loci_atomic_edits_" + std::to_string(::getpid()) + ".loci");
  NoProgress silent_;
};

TEST_F(AtomicEdits, AFailedEditLeavesTheMemoryAsItWas) {
  const Store read = Store::open_read(file_);
  const std::string place = read.places().front().name;
  expect_unchanged("teach", [](Store& store) { teach(store, "object_1", "bowl"); });
  expect_unchanged("say", [](Store& store) { say(store, "object_1", "alias", "tea mug"); });
  expect_unchanged("retract", [](Store& store) { say(store, "object_1", "class", ""); });
  expect_unchanged("name", [&](Store& store) { name_part(store, place, "bench"); });
  expect_unchanged("undo", [](Store& store) { undo(store); });
}

TEST_F(AtomicEdits, AWriterGoesOnAfterAFailedEdit) {
  Store store = Store::open_write(file_);
  EXPECT_THROW(teach(store, "object_1", "bowl"), Error);
  set_fact(store, "object_1", "owner", "Ada");
  EXPECT_EQ(ask(store, FactsQuestion{"object_1", "owner", {}}).facts.size(), 1U);
  EXPECT_THAT(store.verify(silent_).problems, testing::IsEmpty());
}

}  // namespace
}  // namespace loci::memory
