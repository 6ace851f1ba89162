#include "mapping/base/html.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

std::string base64_of(const std::string& text) {
  return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

TEST(Html, Base64MeetsTheVectorsOfRfc4648) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(Html, TextIsEscapedInTables) {
  EXPECT_EQ(html_escape("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_NE(html_table({"h"}, {{"<b>"}}).find("&lt;b&gt;"), std::string::npos);
}

}  // namespace
}  // namespace loci
