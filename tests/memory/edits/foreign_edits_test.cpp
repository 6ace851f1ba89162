// Edits in a memory that somebody else wrote: JSON of any type in their rows is no crash, and no exception of
// the JSON library.

#include <SQLiteCpp/SQLiteCpp.h>

#include "mapping/base/text/json.h"
#include "memory/edits/edits.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/names/taxonomy.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::day_time;

/// All places of a value, as JSON pointers.
void add_pointers(const Json& value, const std::string& pointer, std::vector<std::string>& all) {
  all.push_back(pointer);
  if (value.is_object())
    for (const auto& [key, member] : value.items()) add_pointers(member, pointer + "/" + key, all);
  if (value.is_array())
    for (size_t i = 0; i < value.size(); ++i) add_pointers(value[i], pointer + "/" + std::to_string(i), all);
}

class ForeignEdits : public testing_support::DayFixture {
 protected:
  void SetUp() override {
    DayFixture::SetUp();
    store_.reset();
    Store store = Store::open_write(file_);
    label_observation(store, 1, 0, "mug");
    split_object(store, 1, day_time("09:30"));
    merge_objects(store, 2, 3);
    undo(store);
    undo(store);
    redo(store);
    say(store, "object_2", "alias", "bowl");
    const std::string part =
        R"({"text": "x", "part": {"of": "link", "name": "a", "before": "", "after": "b"}})";
    store.finish_run(store.begin_run(kEditProgram, part));
    store.finish_run(store.begin_run(
        "loci-memory taxonomy", R"({"mug": {"synonyms": ["cup"], "is": ["vessel"], "properties": []}})"));
  }

  static void configure(const fs::path& file, Id run, const std::string& configuration) {
    SQLite::Database database(file.string(), SQLite::OPEN_READWRITE);
    SQLite::Statement update(database, "UPDATE run SET configuration = ? WHERE id = ?");
    update.bind(1, configuration);
    update.bind(2, run);
    update.exec();
  }

  /// Everything that reads configurations, until it is refused; why.
  std::string refusal(const fs::path& file) {
    try {
      {
        const Store store = Store::open_read(file);
        edits(store);
        known_identities(store);
        part_names(store, {});
        Taxonomy::of(store, {});
      }
      Store store = Store::open_write(file);
      undo(store);
      redo(store);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
};

TEST_F(ForeignEdits, ValuesOfAnyTypeAreRefusedWithTableRowAndColumn) {
  const fs::path copy = folder_ / "copy.loci";
  const std::vector<RunRow> runs = Store::open_read(file_).runs();
  int refused = 0, tried = 0;
  for (const RunRow& run : runs) {
    const Json configuration = Json::parse(run.configuration);
    std::vector<std::string> pointers;
    add_pointers(configuration, "", pointers);
    for (const std::string& pointer : pointers)
      for (const char* value : {"null", "-1", "1e300", "\"x\"", "[7]", "{\"a\": []}"}) {
        Json changed = configuration;
        changed[Json::json_pointer(pointer)] = Json::parse(value);
        fs::copy_file(file_, copy, fs::copy_options::overwrite_existing);
        configure(copy, run.id, changed.dump());
        const std::string why = refusal(copy);
        ++tried;
        if (why.empty()) continue;
        ++refused;
        EXPECT_THAT(why, AllOf(HasSubstr("copy.loci"), Not(HasSubstr("json.exception")))) << changed;
        if (why.find("configuration") != std::string::npos) {
          EXPECT_THAT(why, HasSubstr("run " + std::to_string(run.id))) << changed;
        }
      }
  }
  EXPECT_GT(tried, 100);
  EXPECT_GT(refused, 30);
}

}  // namespace
}  // namespace loci::memory
