// A memory that version 1.0 of the format made (forty scenes of nine things on three tables, ingested), and
// what the program of that time answered.

#include <gmock/gmock.h>
#include <unistd.h>
#include <zstd.h>

#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "memory/questions/answers.h"
#include "memory/questions/words.h"
#include "memory/recorder/forget.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

class EarlierFormat : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("loci_format_" + std::to_string(getpid()));
    make_folder(folder);
    file = folder / "format_1_0.loci";
    const std::string packed = read_file(data / "format_1_0.loci.zst");
    std::string bytes(ZSTD_getFrameContentSize(packed.data(), packed.size()), '\0');
    ASSERT_EQ(ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()), bytes.size());
    write_file_atomically(file, bytes);
  }
  void TearDown() override { fs::remove_all(folder); }

  Json told(const std::string& name) const {
    return parse_json(read_file(data / ("format_1_0." + name + ".json")), name);
  }

  void expect_answers_as_then() const {
    const Store store = Store::open_read(file);
    EXPECT_EQ(to_json(ask(store, ObjectsQuestion{})), told("objects"));
    EXPECT_EQ(to_json(ask(store, ContentsQuestion{.place = "table_1"})), told("on_table_1"));
    EXPECT_EQ(to_json(ask(store, ChangesQuestion{})), told("changes"));
    EXPECT_EQ(ask(store, WhereQuestion{"mug", {}}).objects.size(), told_mugs);
    NoProgress silent;
    EXPECT_THAT(store.verify(silent).problems, ::testing::IsEmpty());
  }

  const fs::path data = fs::path(LOCI_SOURCE_DIR) / "tests/data/memory";
  const size_t told_mugs = 4;
  fs::path folder, file;
};

TEST_F(EarlierFormat, IsReadAsItIs) {
  const std::string before = read_file(file);
  EXPECT_EQ(Store::open_read(file).minor(), 0);
  expect_answers_as_then();
  EXPECT_EQ(read_file(file), before);
}

TEST_F(EarlierFormat, AnswersTheSameWhenMigrated) {
  { Store::open_write(file); }
  EXPECT_EQ(Store::open_read(file).minor(), 1);
  expect_answers_as_then();
}

TEST_F(EarlierFormat, IsForgottenForGood) {
  {
    Store store = Store::open_write(file);
    const Id run = store.begin_run("test", "{}");
    ASSERT_FALSE(store.objects_annotated("bottle").empty());
    for (const Id object : store.objects_annotated("bottle")) forget(store, {.object = object}, run);
    // Alternatives to what was believed may have been called so too.
    const TimeNs last = *store.last_scene_time();
    forget(store, {.from = 0, .to = last}, run);
  }
  for (const char* end : {"", "-wal", "-shm"}) {
    const fs::path part = file.string() + end;
    if (!fs::exists(part)) continue;
    EXPECT_EQ(read_file(part).find("bottle"), std::string::npos) << part;
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

}  // namespace
}  // namespace loci
