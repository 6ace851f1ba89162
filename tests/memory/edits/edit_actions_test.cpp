// Edits by their declarations.

#include "memory/edits/edit_actions.h"

#include "mapping/base/text/json.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;

class EditActions : public testing_support::DayFixture {
 protected:
  Edit edit(const Query& query) {
    store_.reset();
    Store store = Store::open_write(file_);
    return make_edit(store, query);
  }
  std::string refusal(const Query& query) {
    try {
      edit(query);
    } catch (const Error& error) {
      return error.what();
    }
    return "not refused";
  }
};

TEST_F(EditActions, DoWhatTheirFunctionsDo) {
  EXPECT_THAT(edit({"say", {{"about", "table_1"}, {"key", "alias"}, {"value", "desk"}}}).text,
              HasSubstr("desk"));
  EXPECT_THAT(edit({"label", {{"scene", "1"}, {"observation", "0"}, {"class", "mug"}}}).text,
              HasSubstr("mug"));
  EXPECT_THAT(edit({"undo", {}}).text, HasSubstr("mug"));
  EXPECT_NO_THROW(edit({"label", {{"scene", "1"}, {"observation", "0"}, {"class", ""}}}));  // retracted
  EXPECT_NO_THROW(edit({"undo", {}}));
  const Json list = to_json(edits(Store::open_read(file_)));
  EXPECT_EQ(list["done"].size(), 1U);
  EXPECT_EQ(list["undone"].size(), 1U);
}

TEST_F(EditActions, RefuseWhatTheyDoNotTake) {
  EXPECT_THAT(refusal({"erase", {}}), HasSubstr("'erase' is no edit"));
  EXPECT_THAT(refusal({"merge", {{"one", "object_1"}}}), HasSubstr("'merge' needs 'other'"));
  EXPECT_THAT(refusal({"undo", {{"twice", "yes"}}}), HasSubstr("does not take 'twice'"));
  EXPECT_THAT(refusal({"label", {{"scene", "first"}, {"observation", "0"}, {"class", "mug"}}}),
              HasSubstr("first"));
  EXPECT_THAT(refusal({"label", {{"scene", ""}, {"observation", "1"}, {"class", "mug"}}}),
              HasSubstr("'label' needs 'scene'"));
  EXPECT_THAT(refusal({"label", {{"scene", "1"}, {"observation", ""}, {"class", "mug"}}}),
              HasSubstr("'label' needs 'observation'"));
  EXPECT_THAT(refusal({"split", {{"object", "object_1"}, {"time", ""}}}), HasSubstr("'split' needs 'time'"));
  EXPECT_THAT(refusal({"merge", {{"one", ""}, {"other", "object_1"}}}), HasSubstr("'merge' needs 'one'"));
  EXPECT_THAT(refusal({"merge", {{"one", "zebra"}, {"other", "object_1"}}}), HasSubstr("zebra"));
  EXPECT_THAT(refusal({"split", {{"object", "object_1"}, {"time", "soon"}}}), HasSubstr("soon"));
}

}  // namespace
}  // namespace loci::memory
