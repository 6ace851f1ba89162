// Two homes that a detector without classes looks at: what people say in one is known in the other.

#include "memory/catalogue/catalogue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

#include "mapping/base/json.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/answers.h"
#include "memory/questions/facts.h"
#include "memory/recorder/carried_belief.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci {
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
  EXPECT_EQ(made.entries[0].sightings, 3U);
  EXPECT_FALSE(made.entries[0].looks.empty());
  EXPECT_TRUE(made.entries[1].facts.empty()) << "a state is an episode";
  const Json json = to_json(made);
  EXPECT_EQ(to_json(catalogue_from(json, "test")), json);
  EXPECT_EQ(json.dump().find("2026-05-01"), std::string::npos);
  EXPECT_EQ(json.at("things").at(0).count("position"), 0U);
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

TEST_F(CatalogueTest, HabitsComeAlongOnce) {
  Catalogue made = catalogue();
  made.handling["mug"] = {30, 10};
  Store store = Store::open_write(home("second", 30, {kGreenCan}));
  import_catalogue(store, made);
  import_catalogue(store, made);
  EXPECT_NEAR(load_belief(store).habits.kinds().at("mug").found, 30, 1e-9);
}

TEST_F(CatalogueTest, RefusesItsOwnHomeAndWhatIsNone) {
  const Catalogue made = catalogue();
  Store store = Store::open_write(folder_ / "first.loci");
  EXPECT_THROW(import_catalogue(store, made), Error);
  EXPECT_THROW(catalogue_from(Json::array(), "test"), Error);
  EXPECT_THROW(catalogue_from(Json{{"format", "loci-catalogue"}, {"version", 2}}, "test"), Error);
  EXPECT_THROW(catalogue_from(Json{{"format", "loci-catalogue"}, {"version", 1}}, "test"), Error);
}

}  // namespace
}  // namespace loci
