#include "mapping/base/json.h"

#include <gmock/gmock.h>

#include "mapping/base/error.h"

namespace loci {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(JsonText, IsNotParsedWhereItIsNestedTooDeeply) {
  const auto nested = [](int depth) {
    return std::string(static_cast<size_t>(depth), '[') + std::string(static_cast<size_t>(depth), ']');
  };
  EXPECT_NO_THROW(parse_json(nested(kMaxJsonDepth), "x"));
  for (const std::string& text : {nested(kMaxJsonDepth + 1), nested(200'000), std::string(200'000, '['),
                                  "{\"a\": \"\\\"[\",\n\"b\": " + nested(kMaxJsonDepth) + "}"})
    EXPECT_THAT([&] { parse_json(text, "x"); }, ThrowsMessage<Error>(HasSubstr("nested too deeply")));
  EXPECT_NO_THROW(parse_json("[\"" + std::string(1000, '[') + "\\\"" + std::string(1000, '{') + "\"]", "x"))
      << "brackets in a text nest nothing";
}

TEST(JsonText, NamesTheLineOfAMistake) {
  EXPECT_THAT([] { parse_json("{\n\"a\": 1,\n?}", "file.json"); },
              ThrowsMessage<Error>(HasSubstr("file.json:3")));
}

}  // namespace
}  // namespace loci
