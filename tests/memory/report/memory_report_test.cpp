#include "memory/report/memory_report.h"

#include <gmock/gmock.h>

#include "mapping/base/html.h"
#include "tests/memory/questions/synthetic_day.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci {
namespace {

using testing::HasSubstr;
using testing::Not;

class MemoryReport : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    const testing_support::SyntheticDay day(file_);
    store_.emplace(Store::open_read(file_));
  }
  void TearDown() override {
    store_.reset();
    TemporaryFolder::TearDown();
  }
  std::optional<Store> store_;
};

size_t count(const std::string& text, const std::string& part) {
  size_t number = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
  return number;
}

TEST_F(MemoryReport, NamesEveryObjectAndWhatHappened) {
  const std::string page = memory_report(*store_);
  for (const char* part :
       {"object_1", "object_2", "object_3", "object_4", "table_1", "counter_1", "drawer_1"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_THAT(page, HasSubstr("$ loci-memory on counter_1"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST_F(MemoryReport, GrowsAPageWithoutLosingItsSectionsOrDoublingItsOwn) {
  const std::string map_page = html_page("Map", html_section("top-view", "Top view", "<p>of the room</p>"));
  const std::string once = memory_report(*store_, map_page);
  EXPECT_THAT(once, HasSubstr("of the room"));
  EXPECT_EQ(count(once, "Questions and answers"), 1U);
  EXPECT_EQ(memory_report(*store_, once), once);
}

}  // namespace
}  // namespace loci
