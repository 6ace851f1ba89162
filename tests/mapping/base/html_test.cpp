#include "mapping/base/text/html.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

TEST(Html, TextIsEscapedInTables) {
  EXPECT_EQ(html_escape("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_NE(html_table({"h"}, {{"<b>"}}).find("&lt;b&gt;"), std::string::npos);
}

TEST(Html, TheKindOfAnImageIsEscaped) {
  const std::string html = html_image({}, "image/png\"><script>alert(1)</script>", "x");
  EXPECT_EQ(html.find("<script>"), std::string::npos) << html;
}

}  // namespace
}  // namespace loci
