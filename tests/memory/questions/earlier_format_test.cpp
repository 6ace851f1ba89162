// Memories that earlier versions of the format made, and what the programs of that time answered: 1.0 (forty
// scenes of nine things on three tables, ingested), 1.1 to 1.4 (apps/samples/detections.jsonl, ingested).

#include <gmock/gmock.h>
#include <unistd.h>
#include <zstd.h>

#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "memory/questions/answers.h"
#include "memory/questions/words.h"
#include "memory/recorder/forget.h"
#include "memory/recorder/recorder.h"
#include "memory/store/schema.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

struct Earlier {
  int minor;
  size_t told_mugs;
};

class EarlierFormat : public ::testing::TestWithParam<Earlier> {
 protected:
  void SetUp() override {
    name = "format_1_" + std::to_string(GetParam().minor);
    folder = fs::temp_directory_path() / ("loci_" + name + "_" + std::to_string(getpid()));
    make_folder(folder);
    file = folder / (name + ".loci");
    const std::string packed = read_file(data / (name + ".loci.zst"));
    std::string bytes(ZSTD_getFrameContentSize(packed.data(), packed.size()), '\0');
    ASSERT_EQ(ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()), bytes.size());
    write_file_atomically(file, bytes);
  }
  void TearDown() override { fs::remove_all(folder); }

  Json told(const std::string& question) const {
    return parse_json(read_file(data / (name + "." + question + ".json")), question);
  }

  void expect_answers_as_then() const {
    const Store store = Store::open_read(file);
    EXPECT_EQ(to_json(ask(store, ObjectsQuestion{})), told("objects"));
    EXPECT_EQ(to_json(ask(store, ContentsQuestion{.place = "table_1"})), told("on_table_1"));
    EXPECT_EQ(to_json(ask(store, ChangesQuestion{})), told("changes"));
    EXPECT_EQ(ask(store, WhereQuestion{"mug", {}}).objects.size(), GetParam().told_mugs);
    NoProgress silent;
    EXPECT_THAT(store.verify(silent).problems, ::testing::IsEmpty());
  }

  const fs::path data = fs::path(LOCI_SOURCE_DIR) / "tests/data/memory";
  std::string name;
  fs::path folder, file;
};

TEST_P(EarlierFormat, IsReadAsItIs) {
  const std::string before = read_file(file);
  EXPECT_EQ(Store::open_read(file).minor(), GetParam().minor);
  expect_answers_as_then();
  EXPECT_EQ(read_file(file), before);
}

TEST_P(EarlierFormat, AnswersTheSameWhenMigrated) {
  { Store::open_write(file); }
  EXPECT_EQ(Store::open_read(file).minor(), kMemoryMinor);
  expect_answers_as_then();
}

TEST_P(EarlierFormat, GoesOnWithTheBeliefThatItHolds) {
  Store store = Store::open_write(file);
  const std::optional<SceneRow> last = store.last_scene();
  SceneRecord next;
  next.row.time = last->time + 60 * kSecond;
  Recorder recorder(store, store.begin_run("test", "{}"));
  EXPECT_EQ(recorder.belief().last_scene, last->time);
  size_t believed = 0;
  for (const BeliefRow& row : store.beliefs()) believed += row.status == ObjectStatus::gone ? 0 : 1;
  EXPECT_EQ(std::ranges::count_if(recorder.belief().objects,
                                  [](const belief::ProtoObject& object) {
                                    return object.id != 0 && object.status == belief::Status::present;
                                  }),
            static_cast<std::ptrdiff_t>(believed));
  recorder.record(next);
  NoProgress silent;
  EXPECT_THAT(store.verify(silent).problems, ::testing::IsEmpty());
}

TEST_P(EarlierFormat, IsForgottenForGood) {
  const std::string called = GetParam().minor == 0 ? "bottle" : "cereal";
  {
    Store store = Store::open_write(file);
    const Id run = store.begin_run("test", "{}");
    ASSERT_FALSE(store.objects_annotated(called).empty());
    for (const Id object : store.objects_annotated(called)) forget(store, {.object = object}, run);
    // Alternatives to what was believed may have been called so too.
    const TimeNs last = *store.last_scene_time();
    forget(store, {.from = 0, .to = last}, run);
  }
  for (const char* end : {"", "-wal", "-shm"}) {
    const fs::path part = file.string() + end;
    if (!fs::exists(part)) continue;
    EXPECT_EQ(read_file(part).find(called), std::string::npos) << part;
  }
  const Store store = Store::open_read(file);
  NoProgress silent;
  EXPECT_THAT(store.verify(silent).problems, ::testing::IsEmpty());
  EXPECT_THAT(
      [&] {
        ask(store, WhereQuestion{"object_1", {}});
      },
      ::testing::ThrowsMessage<Error>(::testing::HasSubstr("forgotten")));
}

INSTANTIATE_TEST_SUITE_P(Formats, EarlierFormat,
                         ::testing::Values(Earlier{0, 4}, Earlier{1, 1}, Earlier{2, 1}, Earlier{3, 1},
                                           Earlier{4, 1}),
                         [](const auto& tested) { return "1_" + std::to_string(tested.param.minor); });

}  // namespace
}  // namespace loci::memory
