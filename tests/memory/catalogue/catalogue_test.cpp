// Two homes that a detector without classes looks at: what people say in one is known in the other.

#include "memory/catalogue/catalogue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "mapping/base/text/json.h"
#include "memory/edits/edits.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/facts.h"
#include "memory/questions/location.h"
#include "memory/recorder/checkpoint.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::Contains;
using testing::Not;

constexpr const char* kRedMug = R"("size": [0.08, 0.11, 0.1], "color": [2, 0.85, 0.8])";
constexpr const char* kBlueBox = R"("size": [0.19, 0.07, 0.28], "color": [215, 0.8, 0.7])";
constexpr const char* kGreenCan = R"("size": [0.07, 0.07, 0.12], "color": [120, 0.9, 0.5])";

class CatalogueTest : public testing_support::TemporaryFolder {
 protected:
  /// A memory of things side by side that are seen `times` times from a minute of the day on.
  std::filesystem::path home(const std::string& name, int minute, const std::vector<std::string>& things,
                             int times = 3) {
    std::string detections;
    for (size_t i = 0; i < things.size(); ++i)
      detections += fmt::format(R"({}{{"position": [{}, 2, 0.8], {}, "place": "table_1"}})", i > 0 ? "," : "",
                                0.4 * double(i), things[i]);
    const std::filesystem::path lines = folder_ / (name + ".jsonl"), memory = folder_ / (name + ".loci");
    std::ofstream file(lines, std::ios::app);
    for (int i = 0; i < times; ++i)
      file << fmt::format("{{\"time\": \"2026-05-01T08:{:02}:00Z\", \"detections\": [{}]}}\n", minute + i,
                          detections);
    file.close();
    IngestOptions options;
    options.resume = true;
    options.noise_m = 0.005;
    ingest(lines, memory, options, {}, silent_, warnings_);
    return memory;
  }

  static std::vector<std::string> facts(const std::filesystem::path& memory) {
    std::vector<std::string> list;
    for (const Fact& fact : ask(Store::open_read(memory), FactsQuestion{}).facts)
      list.push_back(fact.about + " " + fact.key + " " + fact.value + " " + fact.source);
    return list;
  }

  /// Of a home in which Ada's red mug stands beside a blue box.
  Catalogue catalogue() {
    const std::filesystem::path memory = home("first", 0, {kRedMug, kBlueBox});
    Store store = Store::open_write(memory);
    set_fact(store, "object_1", "class", "mug");
    set_fact(store, "object_1", "owner", "Ada");
    set_fact(store, "object_2", "class", "cereal");
    set_fact(store, "object_2", "state", "open");
    return catalogue_of(store);
  }

  NoProgress silent_;
  Warnings warnings_;
};

TEST_F(CatalogueTest, HoldsWhatThingsAreAndNoEpisodes) {
  const Catalogue made = catalogue();
  ASSERT_EQ(made.entries.size(), 2U);
  EXPECT_EQ(made.entries[0].class_name, "mug");
  EXPECT_EQ(made.entries[0].observations, 3U);
  EXPECT_FALSE(made.entries[0].views.empty());
  EXPECT_TRUE(made.entries[1].facts.empty()) << "a state is an episode";
  const Json json = to_json(made);
  EXPECT_EQ(to_json(catalogue_from(json, "test")), json);
  EXPECT_EQ(json.dump().find("2026-05-01"), std::string::npos);
  EXPECT_EQ(json.at("objects").at(0).count("position"), 0U);
}

TEST_F(CatalogueTest, WhatFitsIsKnownByNameInAnotherHomeAndFoundByQuestions) {
  const Catalogue made = catalogue();
  const std::filesystem::path other = home("second", 30, {kGreenCan, kRedMug});
  Store store = Store::open_write(other);
  const CatalogueResult result = import_catalogue(store, made);
  EXPECT_EQ(result.added, 2U);
  EXPECT_THAT(facts(other), Contains("object_2 class mug catalogue"));
  EXPECT_THAT(facts(other), Contains("object_2 owner Ada catalogue"));
  EXPECT_EQ(facts(other).size(), 2U) << "nothing is known of the can";
  for (const Fact& fact : ask(store, FactsQuestion{}).facts) {
    ASSERT_TRUE(fact.probability.has_value());
    EXPECT_GT(*fact.probability, 0.5);
    EXPECT_LT(*fact.probability, 1.0);
  }
  const WhereAnswer where = ask(store, WhereQuestion{"Ada's mug", {}});
  ASSERT_EQ(where.objects.size(), 1U);
  EXPECT_EQ(where.objects[0].object.name, "object_2");
}

TEST_F(CatalogueTest, TakenInAgainItChangesNothing) {
  const Catalogue made = catalogue();
  Store store = Store::open_write(home("second", 30, {kRedMug}));
  import_catalogue(store, made);
  const size_t runs = store.runs().size();
  const CatalogueResult again = import_catalogue(store, made);
  EXPECT_EQ(again.added + again.changed + again.taken_back, 0U);
  EXPECT_EQ(again.known.size(), 2U);
  EXPECT_EQ(store.runs().size(), runs);
}

TEST_F(CatalogueTest, WhatIsSeenLaterIsComparedToo) {
  const Catalogue made = catalogue();
  const std::filesystem::path other = home("second", 30, {kGreenCan});
  {
    Store store = Store::open_write(other);
    EXPECT_EQ(import_catalogue(store, made).added, 0U);
  }
  home("second", 40, {kGreenCan, kRedMug});
  EXPECT_THAT(facts(other), Contains("object_2 class mug catalogue"));
}

TEST_F(CatalogueTest, WhatPeopleSayComesFirst) {
  const Catalogue made = catalogue();
  const std::filesystem::path other = home("second", 30, {kRedMug});
  Store store = Store::open_write(other);
  import_catalogue(store, made);
  set_fact(store, "object_1", "class", "flower pot");
  apply_catalogues(store);
  EXPECT_THAT(facts(other), Contains("object_1 class flower pot user"));
  EXPECT_THAT(facts(other), Not(Contains("object_1 class mug catalogue")));
}

TEST_F(CatalogueTest, OfTwoAlikeOnlyOneCanBeAdasButBothAreMugs) {
  const Catalogue made = catalogue();
  const std::filesystem::path other = home("second", 30, {kRedMug, kRedMug, kRedMug});
  Store store = Store::open_write(other);
  import_catalogue(store, made);
  size_t mugs = 0, owned = 0;
  for (const Fact& fact : ask(store, FactsQuestion{}).facts) (fact.key == "class" ? mugs : owned) += 1;
  EXPECT_EQ(mugs, 3U);
  EXPECT_EQ(owned, 0U) << "a third each";
}

constexpr const char* kWhiteBox = R"("size": [0.07, 0.1, 0.2], "color": [0, 0.02, 0.9])";

std::string saying(const char* look, const char* words) {
  return fmt::format("{}, {}", look, words);
}

TEST_F(CatalogueTest, TwoThingsThatLookAlikeAreKnownByTheirWords) {
  const std::filesystem::path memory =
      home("first", 0, {saying(kWhiteBox, R"("text": "H-MILCH")"), saying(kWhiteBox, R"("text": "Mehl")")});
  {
    Store store = Store::open_write(memory);
    set_fact(store, "object_1", "owner", "Ada");
    set_fact(store, "object_2", "owner", "Bob");
  }
  const Catalogue made = catalogue_of(Store::open_read(memory));
  EXPECT_EQ(made.entries[0].terms.at("text").at("H-MILCH"), 1.0);
  const std::filesystem::path other =
      home("second", 30, {saying(kWhiteBox, R"("text": "mehl")"), saying(kWhiteBox, R"("text": "H-Milch")")});
  Store store = Store::open_write(other);
  const CatalogueResult result = import_catalogue(store, made);
  EXPECT_THAT(facts(other), Contains("object_1 owner Bob catalogue"));
  EXPECT_THAT(facts(other), Contains("object_2 owner Ada catalogue"));
  EXPECT_EQ(import_catalogue(store, catalogue_from(to_json(made), "test")).added, 0U);
  for (const CatalogueResult::Match& match : result.known) EXPECT_EQ(match.by, "appearance and terms");
}

TEST_F(CatalogueTest, WhatHasNoLooksIsKnownByItsWordsAlone) {
  const char* milk = R"("class": {"carton": 0.9}, "text": "MILFINA H-Milch")";
  const char* soup = R"("class": {"can": 0.9}, "text": "Tomatensuppe")";
  const std::filesystem::path memory = home("first", 0, {milk, soup});
  {
    Store store = Store::open_write(memory);
    set_fact(store, "object_1", "owner", "Ada");
  }
  const std::filesystem::path other = home("second", 30, {soup, milk});
  Store store = Store::open_write(other);
  const CatalogueResult result = import_catalogue(store, catalogue_of(Store::open_read(memory)));
  EXPECT_THAT(facts(other), Contains("object_2 owner Ada catalogue"));
  EXPECT_THAT(facts(other), Not(Contains("object_1 owner Ada catalogue")));
  ASSERT_FALSE(result.known.empty());
  for (const CatalogueResult::Match& match : result.known) EXPECT_EQ(match.by, "terms");
}

TEST_F(CatalogueTest, WordsThatAgreeMakeItSurerAndOthersLessSure) {
  const auto sure = [&](const std::string& name, const char* text) {
    const std::filesystem::path memory =
        home("first " + name, 0, {saying(kRedMug, R"("text": "Best Dad")"), kBlueBox});
    {
      Store store = Store::open_write(memory);
      set_fact(store, "object_1", "owner", "Ada");
    }
    Store store = Store::open_write(home("second " + name, 30, {saying(kRedMug, text)}));
    const CatalogueResult result = import_catalogue(store, catalogue_of(Store::open_read(memory)));
    for (const CatalogueResult::Match& match : result.known)
      if (match.key == "owner") return match.probability;
    return 0.0;
  };
  const double none = sure("none", R"("score": 0.9)"), same = sure("same", R"("text": "Best dad")"),
               other = sure("other", R"("text": "Ibiza")");
  EXPECT_GT(same, none);
  EXPECT_LT(other, none);
  EXPECT_GT(none, 0.5);
}

TEST(CatalogueTerms, CountByKindAndOnlyWhereBothHaveThem) {
  const ObjectTerms milk = {{"product", {{"Milfina H-Milch", 0.8}, {"Milfina Sahne", 0.2}}}};
  EXPECT_GT(terms_log_ratio(milk, {{"product", {{"milfina h-milch", 1.0}}}}), 2.0);
  EXPECT_LT(terms_log_ratio(milk, {{"product", {{"Tomatensuppe", 1.0}}}}), -1.5);
  EXPECT_EQ(terms_log_ratio(milk, {{"text", {{"Milfina", 1.0}}}}), 0.0);
  const ObjectTerms code = {{"barcode", {{"4006381333931", 1.0}}}, {"text", {{"Milfina", 1.0}}}};
  EXPECT_GT(terms_log_ratio(code, code), terms_log_ratio(code, {{"text", {{"milfina", 0.5}}}}));
  EXPECT_GT(terms_log_ratio({{"text", {{"MILFINA 1,5 % H-Milch", 1}}}}, {{"text", {{"H-Milch Milfina", 1}}}}),
            1.5)
      << "texts are read in pieces";
}

TEST_F(CatalogueTest, HabitsComeAlongOnce) {
  Catalogue made = catalogue();
  made.handling["mug"] = {30, 10};
  Store store = Store::open_write(home("second", 30, {kGreenCan}));
  import_catalogue(store, made);
  import_catalogue(store, made);
  EXPECT_NEAR(load_belief(store).interaction.statistics().by_class.at("mug").found, 30, 1e-9);
}

TEST_F(CatalogueTest, WhatLooksLikeAnExampleIsCalledSoAndTheRestStaysUnknown) {
  const std::filesystem::path memory = home("first", 0, {kRedMug, kBlueBox, kRedMug});
  {
    Store store = Store::open_write(memory);
    set_fact(store, "object_1", "class", "mug");
    set_fact(store, "object_1", kTaughtKey, "mug");
    const CatalogueResult result = apply_catalogues(store);
    ASSERT_EQ(result.known.size(), 1U);
    EXPECT_EQ(result.known[0].object, 3);
    EXPECT_GT(result.known[0].probability, 0.7);
    EXPECT_EQ(apply_catalogues(store).added, 0U);
  }
  EXPECT_THAT(facts(memory), Contains("object_3 class mug catalogue"));
  EXPECT_EQ(ask(Store::open_read(memory), WhereQuestion{"mug"}).objects.size(), 2U);
  // New objects are compared, too.
  home("first", 10, {kRedMug, kBlueBox, kRedMug, kGreenCan, kRedMug});
  EXPECT_THAT(facts(memory), Contains("object_5 class mug catalogue"));
  EXPECT_THAT(facts(memory), Not(Contains("object_2 class mug catalogue")));
  EXPECT_THAT(facts(memory), Not(Contains("object_4 class mug catalogue")));
  // Without its example nothing is left of the class.
  Store store = Store::open_write(memory);
  remove_fact(store, "object_1", kTaughtKey, "");
  EXPECT_EQ(apply_catalogues(store).taken_back, 2U);
}

TEST_F(CatalogueTest, CorrectionsMatchAgain) {
  const std::filesystem::path memory = home("first", 0, {kRedMug, kBlueBox, kRedMug});
  const auto named = [&] { return facts(memory); };
  Store store = Store::open_write(memory);
  set_facts(store, "object_1", {{"class", "mug"}, {kTaughtKey, "mug"}});
  apply_catalogues(store);
  const std::string by_look = "object_3 class mug catalogue";
  ASSERT_THAT(named(), Contains(by_look));
  say(store, "object_1", kTaughtKey, "");
  EXPECT_THAT(named(), Not(Contains(by_look))) << "its example was withdrawn";
  undo(store);
  EXPECT_THAT(named(), Contains(by_look));
  EXPECT_EQ(std::ranges::count(named(), by_look), 1);
  redo(store);
  EXPECT_THAT(named(), Not(Contains(by_look)));
  undo(store);
  EXPECT_EQ(undo(store).text, "object_1: class is mug, taught is mug") << "several facts are one change";
  EXPECT_TRUE(named().empty());
}

TEST_F(CatalogueTest, AnObjectThatIsSplitOffIsComparedWithTheExamples) {
  const std::filesystem::path memory = home("first", 0, {kRedMug, kBlueBox, kRedMug});
  Store store = Store::open_write(memory);
  set_facts(store, "object_1", {{"class", "mug"}, {kTaughtKey, "mug"}});
  apply_catalogues(store);
  split_object(store, 3, store.last_scene()->time);
  EXPECT_THAT(facts(memory), Contains("object_4 class mug catalogue"));
}

TEST_F(CatalogueTest, RefusesItsOwnHomeAndWhatIsNone) {
  const Catalogue made = catalogue();
  Store store = Store::open_write(folder_ / "first.loci");
  EXPECT_THROW(import_catalogue(store, made), Error);
  EXPECT_THROW(catalogue_from(Json::array(), "test"), Error);
  EXPECT_THROW(catalogue_from(Json{{"format", "loci-catalogue"}, {"version", 2}}, "test"), Error);
  EXPECT_THROW(catalogue_from(Json{{"format", "loci-catalogue"}, {"version", 1}}, "test"), Error);
  for (const Json& observations : {Json(-1), Json(1e300), Json("many")}) {
    Json other = to_json(made);
    other["objects"][0]["observations"] = observations;
    EXPECT_THROW(catalogue_from(other, "test"), Error) << observations;
  }
}

}  // namespace
}  // namespace loci::memory
