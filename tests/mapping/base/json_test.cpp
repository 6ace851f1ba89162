#include "mapping/base/text/json.h"

#include <gmock/gmock.h>

#include <ctime>
#include <limits>

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

TEST(JsonText, IsWhatTheLibraryReads) {
  for (const char* text : {"null", "-7", "1.5e3", "18446744073709551615", "\"a\\u00e9\"", "[]", "{}",
                           R"({"b": [1, {"c": null}, []], "a": {"x": true, "b": {}}, "": "b"})"})
    EXPECT_EQ(parse_json(text, "x").dump(), Json::parse(text).dump()) << text;
  for (const char* text :
       {"", "[1,]", "{\"a\"}", "{1: 2}", "[1", "1e999", "nul", "[] []", R"({"a": 1, "b": 2, "a": 3})"})
    EXPECT_THROW(parse_json(text, "x"), Error) << text;
}

TEST(JsonText, OfManyKeysIsReadInLinearTime) {
  const auto cpu_time = [](int keys) {
    std::string text = "{";
    for (int i = 0; i < keys; ++i) text += "\"key" + std::to_string(i) + "\": 1,";
    text += "\"last\": 2}";
    std::clock_t best = std::numeric_limits<std::clock_t>::max();
    for (int attempt = 0; attempt < 7; ++attempt) {
      const std::clock_t start = std::clock();
      EXPECT_EQ(parse_json(text, "x").size(), static_cast<size_t>(keys) + 1);
      best = std::min(best, std::clock() - start);
    }
    return static_cast<double>(best);
  };
  EXPECT_LT(cpu_time(160'000), 28 * cpu_time(20'000)) << "64 times as long if each key is compared with all";
}

TEST(JsonText, NamesTheLineOfAMistake) {
  EXPECT_THAT([] { parse_json("{\n\"a\": 1,\n?}", "file.json"); },
              ThrowsMessage<Error>(HasSubstr("file.json:3")));
}

}  // namespace
}  // namespace loci
