#include "perception/search/protocol.h"

#include <gmock/gmock.h>

#include "mapping/base/error.h"
#include "perception/search/goggles.pb.h"
#include "tests/perception/search/wire.h"

namespace loci::perception {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using namespace wire;

TEST(SearchProtocol, ARequestIsTheseBytes) {
  const std::string image(
      "\x0a\x07\x0a\x05\x0a\x03"
      "ABC",
      9);
  // LanguageID is field 10; EnableUI is 15697207: (15697207 << 3 | 2) as a varint is ba d3 f0 3b.
  const std::string language(
      "\x52\x11\x22\x02"
      "en\x32\x02"
      "US\xba\xd3\xf0\x3b\x04\x08\x01\x38\x01",
      19);
  EXPECT_EQ(encode(SearchRequest{"ABC", "en", "US", true}), image + language);
}

TEST(SearchProtocol, ARequestByHandIsRead) {
  const std::string bytes =
      wire::text(1, wire::text(1, wire::text(1, "JPEG"))) +
      wire::text(10, wire::number(1, 5) + wire::text(4, "de") + wire::number(5, 6) + wire::text(6, "AT") +
                         wire::text(wire::kEnableUi, wire::number(1, 1) + wire::number(7, 1))) +
      wire::text(wire::kDevice,
                 wire::text(1, "id") + wire::number(7, 77) +
                     wire::text(9, wire::text(1, "loci") + wire::text(2, "1") + wire::text(4, "robot")));
  const SearchRequest request = decode_request(bytes);
  EXPECT_EQ(request.jpeg, "JPEG");
  EXPECT_EQ(request.language, "de");
  EXPECT_EQ(request.country, "AT");
  EXPECT_TRUE(request.details);
  EXPECT_FALSE(decode_request(wire::text(1, wire::text(1, wire::text(1, "JPEG")))).details);
}

TEST(SearchProtocol, EveryNumberOfTheTableIsWhereTheSchemaHasIt) {
  const std::string ui =
      wire::text(1, wire::coords(1, 2, 3, 4)) +
      wire::text(3, wire::text(1, "high") + wire::text(2, "show") + wire::text(3, "site") +
                        wire::text(4, "showhigh")) +
      wire::text(6, "en") + wire::text(7, "result") + wire::text(8, "more") + wire::text(9, "describes") +
      wire::text(14, wire::text(1, wire::text(1, "http://a") + wire::text(2, "Visit"))) +
      wire::text(15, wire::text(1, wire::text(1, "City") + wire::text(2, "Munich")) +
                         wire::text(3, wire::text(1, "Net weight") + wire::text(2, "500 g"))) +
      wire::text(19, "http://more") + wire::text(20, "http://buy") +
      wire::text(21, wire::text(3, wire::text(1, "1-2 EUR") + wire::fixed64(2, 1) + wire::fixed64(3, 2)) +
                         wire::text(4, "A. Uthor") + wire::text(5, "Press") + wire::text(6, "2014") +
                         wire::text(7, "9783161484100") + wire::text(8, "cid") +
                         wire::text(9, wire::text(1, "id") + wire::text(2, "http://shop") +
                                           wire::text(3, "Shop") + wire::text(5, wire::text(1, "3 EUR"))) +
                         wire::text(10, "Maker") +
                         wire::text(13, wire::number(1, 0) + wire::text(2, "Food") + wire::number(3, 11) +
                                            wire::text(4, "Essen")) +
                         wire::text(13, wire::number(1, 1) + wire::text(2, "Milk"))) +
      wire::text(22, wire::text(1, "uebersetzt") +
                         wire::text(2, wire::text(1, wire::coords(5, 6, 7, 8)) + wire::text(2, "word") +
                                           wire::text(3, wire::coords(5, 6, 1, 8)))) +
      wire::text(23, wire::text(1, wire::text(2, "Ann") + wire::text(3, "http://ann") +
                                       wire::text(4, "http://ann.jpg")) +
                         wire::text(4, "my cup") + wire::text(5, "http://abuse")) +
      wire::text(24, "Paris") + wire::text(29, wire::text(1, wire::text(3, wire::text(2, "Group")))) +
      wire::text(30, wire::text(1, "said"));
  const std::string one =
      wire::text(1, "Title") + wire::text(2, "Product") + wire::text(wire::kUiInfo, ui) +
      wire::text(wire::kSearchQuery, wire::text(2, "http://query")) +
      wire::text(wire::kDirectResult, wire::text(1, "direct") + wire::text(3, "described"));
  const SearchAnswer answer = decode_response(wire::text(1, one));
  EXPECT_THAT(answer.unknown, ElementsAre());
  ASSERT_EQ(answer.results.size(), 1U);
  const SearchResult& result = answer.results[0];
  EXPECT_EQ(result.category, SearchCategory::kProduct);
  EXPECT_EQ(result.title, "Title");
  EXPECT_EQ(result.region, cv::Rect(1, 2, 3, 4));
  EXPECT_EQ(result.language, "en");
  EXPECT_EQ(result.text, "result");
  EXPECT_EQ(result.description, "describes");
  EXPECT_EQ(result.preview_url, "show");
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"additional_info", "more"},
                                                        {"image_url", "high"},
                                                        {"image_site", "site"},
                                                        {"price", "1-2 EUR"},
                                                        {"authors", "A. Uthor"},
                                                        {"publisher", "Press"},
                                                        {"year", "2014"},
                                                        {"isbn", "9783161484100"},
                                                        {"product_id", "cid"},
                                                        {"store", "Shop"},
                                                        {"manufacturer", "Maker"},
                                                        {"category", "Milk"},
                                                        {"city", "Munich"},
                                                        {"weight", "500 g"},
                                                        {"uploader", "Ann"},
                                                        {"uploader_url", "http://ann"},
                                                        {"uploader_image", "http://ann.jpg"},
                                                        {"user_text", "my cup"},
                                                        {"location", "Paris"},
                                                        {"comment", "said"}})
    EXPECT_EQ(result.property(key), value) << key;
  EXPECT_THAT(result.links,
              ElementsAre(Pair("Shop", "http://shop"), Pair("Visit", "http://a"), Pair("more", "http://more"),
                          Pair("buy", "http://buy"), Pair("report abuse", "http://abuse"),
                          Pair("search", "http://query")));
  ASSERT_EQ(result.words.size(), 1U);
  EXPECT_EQ(result.words[0].text, "word");
  EXPECT_EQ(result.words[0].region, cv::Rect(5, 6, 7, 8));
  EXPECT_THAT(result.words[0].characters, ElementsAre(cv::Rect(5, 6, 1, 8)));
  EXPECT_THAT(result.translations, ElementsAre("uebersetzt"));
}

TEST(SearchProtocol, UnknownFieldsSurviveARoundTripAndAreReported) {
  const std::string bytes =
      wire::text(
          1, wire::text(1, "Title") +
                 wire::text(wire::kUiInfo, wire::number(2, 7) +
                                               wire::text(99, wire::text(3, "inside") + wire::number(4, 5))) +
                 wire::text(wire::kStructuredCopy, wire::text(1, "copy"))) +
      wire::text(wire::kAlternatives, wire::fixed64(2, 9) + wire::text(6, "3af9")) + wire::fixed32(50, 8);
  goggles::GogglesResponse message;
  ASSERT_TRUE(message.ParseFromString(bytes));
  goggles::GogglesResponse again;
  ASSERT_TRUE(again.ParseFromString(message.SerializeAsString()));
  EXPECT_EQ(again.SerializeAsString().size(), bytes.size());
  EXPECT_THAT(decode_response(again.SerializeAsString()).unknown,
              ElementsAre("50: fixed32 8", "info[0].16766290.1: text 'copy'", "info[0].ui_info.2: varint 7",
                          "info[0].ui_info.99.3: text 'inside'", "info[0].ui_info.99.4: varint 5",
                          "alternatives.2: fixed64 9", "alternatives.6: text '3af9'"));
}

TEST(SearchProtocol, AFieldOfAnotherKindThanTheTableSaysIsUnknown) {
  EXPECT_THAT(decode_response(wire::text(1, wire::number(1, 3) + wire::text(2, "Logo"))).unknown,
              ElementsAre("info[0].1: varint 3"));
}

TEST(SearchProtocol, WhatIsLostWhenEncodedAgainIsToldByItsLength) {
  EXPECT_THAT(decode_response(wire::text(1, wire::text(1, "twice") + wire::text(1, "said"))).unknown,
              ElementsAre(HasSubstr("encoded again it has 8 bytes instead of 15")));
}

TEST(SearchProtocol, AlternativesAreResultsToo) {
  const std::string bytes =
      wire::info("A", "Logo", "") +
      wire::text(wire::kAlternatives, wire::text(1, wire::text(1, "B")) + wire::text(7, wire::text(1, "C")));
  const SearchAnswer answer = decode_response(bytes);
  ASSERT_EQ(answer.results.size(), 3U);
  EXPECT_EQ(answer.results[1].title, "B");
  EXPECT_EQ(answer.results[2].title, "C");
}

TEST(SearchProtocol, TheCategoryFollowsFromTheNameOrFromWhatIsThere) {
  const auto category = [](const std::string& name, const std::string& ui) {
    return decode_response(wire::info("T", name, ui)).results.at(0).category;
  };
  EXPECT_EQ(category("Product", ""), SearchCategory::kProduct);
  EXPECT_EQ(category("EAN-13 Barcode", ""), SearchCategory::kBarcode);
  EXPECT_EQ(category("QR Code", ""), SearchCategory::kBarcode);
  EXPECT_EQ(category("User Submitted Result", ""), SearchCategory::kUserSubmitted);
  EXPECT_EQ(category("Similar Image", ""), SearchCategory::kSimilarImage);
  EXPECT_EQ(category("www.example.org", wire::text(3, wire::text(2, "http://p"))),
            SearchCategory::kSimilarImage);
  EXPECT_EQ(category("www.example.org", wire::text(21, wire::text(7, "978"))), SearchCategory::kBook);
  EXPECT_EQ(category("www.example.org", wire::text(21, wire::text(10, "Maker"))), SearchCategory::kProduct);
  EXPECT_EQ(category("www.example.org", wire::text(22, wire::text(2, wire::text(2, "w")))),
            SearchCategory::kText);
  EXPECT_EQ(category("www.example.org", wire::text(23, wire::text(4, "t"))), SearchCategory::kUserSubmitted);
  EXPECT_EQ(category("www.example.org", wire::text(24, "Paris")), SearchCategory::kLandmark);
  EXPECT_EQ(category("www.example.org", ""), SearchCategory::kOther);
}

TEST(SearchProtocol, ResultsOfEveryCategoryComeBackAsTheyWere) {
  std::vector<SearchResult> results;
  for (int i = 0; i <= static_cast<int>(SearchCategory::kUserSubmitted); ++i) {
    SearchResult result;
    result.category = static_cast<SearchCategory>(i);
    result.title = "Größe " + std::to_string(i);
    result.region = {i, 2, 30, 40};
    result.language = "en";
    result.text = "text";
    result.description = "description";
    result.preview_url = "http://p";
    result.links = {{"name", "http://l"}};
    result.properties = {{"isbn", "1"},    {"manufacturer", "m"}, {"price", "2 EUR"}, {"category", "milk"},
                         {"store", "s"},   {"location", "here"},  {"uploader", "u"},  {"user_text", "t"},
                         {"comment", "c"}, {"volume", "1 l"}};
    result.words = {{"word", {1, 2, 3, 4}, {{1, 2, 1, 4}}}};
    result.translations = {"other"};
    results.push_back(result);
  }
  const SearchAnswer answer = decode_response(encode(results));
  EXPECT_THAT(answer.unknown, ElementsAre());
  ASSERT_EQ(answer.results.size(), results.size());
  for (size_t i = 0; i < results.size(); ++i) {
    const SearchResult &before = results[i], &after = answer.results[i];
    EXPECT_EQ(after.category, before.category);
    EXPECT_EQ(after.title, before.title);
    EXPECT_EQ(after.region, before.region);
    EXPECT_EQ(after.links, before.links);
    for (const auto& [key, value] : before.properties) EXPECT_EQ(after.property(key), value) << key;
    EXPECT_EQ(after.words.at(0).characters, before.words[0].characters);
    EXPECT_EQ(after.translations, before.translations);
  }
  EXPECT_TRUE(decode_response(encode(results, false)).results[0].description.empty());
}

TEST(SearchProtocol, GarbageIsRefusedAndBadTextMended) {
  EXPECT_THROW(decode_response("\xff\xff\xff this is no message"), Error);
  EXPECT_THROW(decode_request("<html></html>"), Error);
  EXPECT_THROW(decode_response(wire::info("T", "Logo", "").substr(0, 5)), Error);
  EXPECT_EQ(decode_response(wire::text(1, wire::text(1, "a\xffz"))).results.at(0).title, "a\xEF\xBF\xBDz");
}

TEST(SearchProtocol, PlacesThatCannotBeAreBounded) {
  const cv::Rect region =
      decode_response(
          wire::info("T", "Logo", wire::text(1, wire::coords(-2147483647, 2147483647, -5, 2147483647))))
          .results.at(0)
          .region;
  EXPECT_GE(region.x, -(1 << 20));
  EXPECT_LE(region.y, 1 << 20);
  EXPECT_EQ(region.width, 0);
  EXPECT_LE(region.height, 1 << 20);
}

TEST(SearchProtocol, DescriptiveTermsAreTheWordsThatAnAnswerRepeats) {
  SearchResult text, product, similar;
  text.title = text.text = "Kaba Traubenzucker und Vitamine";
  product.title = "Kaba Banane";
  product.properties = {{"manufacturer", "Kaba"}, {"image_url", "http://www.kaba.de/kaba/kaba.jpg"}};
  product.links = {{"Translate", "http://t"}, {"Translate", "http://u"}};
  similar.title = "kaba Vitamine 4";
  const std::vector<RankedWord> terms = terms_of({{text, product, similar}, {}}, 2);
  ASSERT_EQ(terms.size(), 2U);
  EXPECT_EQ(terms[0].word, "Kaba");
  EXPECT_EQ(terms[0].count, 4);
  EXPECT_EQ(terms[1].word, "Vitamine");
  EXPECT_EQ(terms[1].count, 2);
}

TEST(SearchProtocol, DeepAndManyUnknownFieldsAreListedUpToALimit) {
  std::string nested = wire::number(1, 1);
  for (int i = 0; i < 20000; ++i) nested = wire::text(3, nested);
  EXPECT_LT(decode_response(wire::text(99, nested)).unknown.size(), 10U);
  std::string many;
  for (int i = 0; i < 20000; ++i) many += wire::number(99, 1);
  EXPECT_LE(decode_response(many).unknown.size(), 1001U);
}
}  // namespace
}  // namespace loci::perception
