#include "memory/report/digest_page.h"

#include <gmock/gmock.h>

#include "mapping/base/text/html.h"
#include "tests/memory/questions/day_fixture.h"

namespace loci::memory {
namespace {

class DigestPage : public testing_support::DayFixture {};

TEST_F(DigestPage, HoldsWhatTheAnswerSays) {
  const DigestAnswer answer = ask(*store_, DigestQuestion{});
  const std::string page = digest_page(*store_, answer);
  EXPECT_TRUE(is_html_page(page));
  EXPECT_THAT(page, testing::HasSubstr("Digest of " + answer.day));
  for (const Change& change : answer.changes)
    EXPECT_THAT(page, testing::HasSubstr(html_escape(to_text(change))));
  for (const ObjectBelief& missing : answer.missing)
    EXPECT_THAT(page, testing::HasSubstr(html_escape(to_text(missing.object))));
}

}  // namespace
}  // namespace loci::memory
