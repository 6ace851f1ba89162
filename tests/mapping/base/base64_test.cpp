#include "mapping/base/text/base64.h"

#include <gtest/gtest.h>

#include "mapping/base/error.h"

namespace loci {
namespace {

TEST(Base64, MeetsTheVectorsOfRfc4648) {
  for (const auto& [bytes, text] :
       {std::pair("", ""), {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}}) {
    EXPECT_EQ(base64_from_bytes(bytes), text);
    EXPECT_EQ(bytes_from_base64(text), bytes);
  }
  EXPECT_THROW(bytes_from_base64("Zg="), Error);
}

}  // namespace
}  // namespace loci
