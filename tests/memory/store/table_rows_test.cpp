// Rows as they are, from one memory into another.

#include "memory/store/rows/table_rows.h"

#include <gmock/gmock.h>

#include "tests/memory/store/temporary_folder.h"
#include "tests/support/random_memory.h"

namespace loci::memory {
namespace {

using loci::testing_support::RandomMemory;
using testing::IsEmpty;

class TableRows : public testing_support::TemporaryFolder {
 protected:
  /// Whether the copy has all of the memory then.
  bool copy_new_rows() const {
    const TableReader reader(file_);
    TableWriter writer(copy_);
    for (const TableLayout& table : table_layouts()) {
      if (!table.appended) writer.clear(table);
      reader.read(table, table.appended ? writer.last_key(table) : std::nullopt, [&](const TableRow& row) {
        writer.add(table, row);
        return true;
      });
    }
    return writer.commit();
  }
  std::filesystem::path copy_ = std::filesystem::path();
};

TEST_F(TableRows, AreCopiedAsTheyAreAdded) {
  copy_ = folder_ / "copy.loci";
  RandomMemory(file_, 4);
  ASSERT_TRUE(copy_new_rows());
  for (int i = 0; i < 3; ++i) {
    {
      Store store = Store::open_write(file_);
      SceneTransaction scene(store, store.begin_run("test", "{}"));
      const Id id = scene.add_scene({.time = RandomMemory::kStart + (100000 + i) * kSecond});
      const Id seen = scene.add_observation(
          {.scene = id, .number = 0, .place = 1 + i % 2, .position = Vector3d(0.1, 0.1, 0.8)});
      scene.add_annotation({.scene = id, .observation = seen, .type = "loci.Text", .value = "a new word"});
      scene.add_association({.scene = id,
                             .observation = seen,
                             .object = 1,
                             .explanation = Explanation::move,
                             .probability = 1,
                             .chosen = true});
      for (const Id object : {1, 2})
        scene.add_belief(
            {.object = object, .scene = id, .place = 1, .position = Vector3d(0.1, 0.1 * i, 0.8)});
      scene.commit();
    }
    ASSERT_TRUE(copy_new_rows());
    NoProgress silent;
    EXPECT_THAT(Store::open_read(copy_).verify(silent).problems, IsEmpty()) << "derived rows, too";
    EXPECT_EQ(Store::open_read(copy_).objects_with_text("new word"), std::vector<Id>{1});
  }
  EXPECT_TRUE(copy_new_rows()) << "nothing is new";
}

}  // namespace
}  // namespace loci::memory
