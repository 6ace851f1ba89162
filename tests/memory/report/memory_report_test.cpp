#include "memory/report/memory_report.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "mapping/base/text/html.h"
#include "mapping/image/hsv.h"
#include "tests/memory/questions/synthetic_day.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::Not;

class MemoryReport : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    testing_support::TemporaryFolder::SetUp();
    const testing_support::SyntheticDay day(file_);
    store_.emplace(Store::open_read(file_));
  }
  void TearDown() override {
    store_.reset();
    testing_support::TemporaryFolder::TearDown();
  }
  std::string report(const std::optional<std::string>& page = {}, const ReportOptions& options = {}) const {
    NoProgress progress;
    return memory_report(*store_, page, options, progress);
  }
  std::optional<Store> store_;
};

size_t count(const std::string& text, const std::string& part) {
  size_t number = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
  return number;
}

TEST_F(MemoryReport, NamesEveryObjectAndWhatHappened) {
  const std::string page = report();
  for (const char* part :
       {"object_1", "object_2", "object_3", "object_4", "table_1", "counter_1", "drawer_1"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_THAT(page, HasSubstr("$ loci-memory on counter_1"));
}

TEST_F(MemoryReport, HasEverySection) {
  const std::string page = report();
  for (const char* id : {"questions", "plan", "timeline", "objects", "statistics", "decisions", "log"})
    EXPECT_EQ(count(page, std::string("<section id=\"") + id + "\">"), 1U) << id;
  EXPECT_THAT(page, HasSubstr(">counter_1</title>"));  // the plan
  EXPECT_EQ(count(page, "<details><summary>scene "), 6U);
  EXPECT_THAT(page, HasSubstr("Observations per scene"));
  EXPECT_EQ(count(page, "<article class=\"card\""), 4U);
}

TEST_F(MemoryReport, DrawsObjectsInTheirColoursAndHasTicksAndAZone) {
  const std::string page = report();
  EXPECT_THAT(page, Not(HasSubstr("hsl(")));
  EXPECT_GE(count(page, "class=\"tick\""), 3U);
  EXPECT_THAT(page, HasSubstr(">UTC</text>"));
  EXPECT_THAT(page, Not(testing::ContainsRegex("<title>[^<]*out_of_view")));
  for (const BeliefRow& belief : store_->beliefs()) {
    if (!belief.hsv) continue;
    const auto rgb = mapping::rgb8_from_hsv(belief.hsv->hue, belief.hsv->saturation, belief.hsv->value);
    EXPECT_THAT(page, HasSubstr(fmt::format("fill=\"#{:02x}{:02x}{:02x}\"", rgb[0], rgb[1], rgb[2])));
  }
}

TEST_F(MemoryReport, NeedsNoOtherFile) {
  const std::string page = report();
  for (const char* from : {"src=\"http", "href=\"http", "url(", "@import"})
    EXPECT_THAT(page, Not(HasSubstr(from)));
}

TEST_F(MemoryReport, NamesItsPercentagesAndItsLines) {
  const std::string page = report();
  EXPECT_THAT(page, HasSubstr("still there: "));
  EXPECT_THAT(page, HasSubstr("<th>identity, at least</th>"));
  EXPECT_THAT(page, HasSubstr("Narrow: nobody looked"));
}

TEST_F(MemoryReport, SaysWhatItLeavesOut) {
  const std::string page = report({}, {.objects = 2, .scenes = 3});
  EXPECT_EQ(count(page, "<article class=\"card\""), 2U);
  EXPECT_EQ(count(page, "<details><summary>scene "), 3U);
  EXPECT_THAT(page, HasSubstr("Of 4 objects the 2 with most observations"));
  EXPECT_THAT(page, HasSubstr("Of 6 scenes the last 3"));
}

TEST_F(MemoryReport, IsRefusedOnAPageOfSomethingElse) {
  EXPECT_THROW(report("<p>my letters</p>"), Error);
}

TEST_F(MemoryReport, GrowsAPageWithoutLosingItsSectionsOrDoublingItsOwn) {
  const std::string map_page = html_page("Map", html_section("top-view", "Top view", "<p>of the room</p>"));
  const std::string once = report(map_page);
  EXPECT_THAT(once, HasSubstr("of the room"));
  EXPECT_EQ(count(once, "Questions and answers"), 1U);
  EXPECT_EQ(report(once), once);
}

}  // namespace
}  // namespace loci::memory
