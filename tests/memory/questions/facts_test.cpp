#include "memory/questions/facts.h"

#include <gmock/gmock.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/questions/contents.h"
#include "memory/questions/location.h"
#include "memory/questions/names/taxonomy.h"
#include "memory/sentences/natural_language.h"
#include "tests/memory/questions/synthetic_day.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing_support::SyntheticDay;

class Facts : public testing_support::TemporaryFolder {
 protected:
  static constexpr TimeNs kLater = SyntheticDay::kKnownSecond + 3600 * kSecond;

  void SetUp() override {
    testing_support::TemporaryFolder::SetUp();
    const SyntheticDay day(file_);
  }
  /// Opened for writing `hours` after the day.
  Store open(int hours) const { return Store::open_write(file_, {.now = kLater + hours * 3600 * kSecond}); }
  std::vector<Id> who(const std::string& subject, const AsOf& as_of = {}) const {
    std::vector<Id> ids;
    for (const ObjectBelief& state : ask(Store::open_read(file_), WhereQuestion{subject, as_of}).objects)
      ids.push_back(state.object.id);
    std::sort(ids.begin(), ids.end());
    return ids;
  }
  void load_taxonomy() const {
    const std::string file = file_.string() + ".yaml";
    write_file_atomically(file,
                          "mug: {synonyms: [cup], is: [crockery]}\n"
                          "crockery: {synonyms: [dishes]}\n"
                          "milk: {properties: [perishable]}\n");
    Store store = open(5);
    Taxonomy::read(file).save(store);
  }
};

TEST_F(Facts, ANameOfAPlaceIsUnderstoodAndTheOldAnswersStay) {
  {
    Store store = open(0);
    set_fact(store, "table_1", "alias", "couch table");
  }
  const Store store = Store::open_read(file_);
  const auto answer =
      ask(store, NaturalLanguageQuestion{{"Is there anything on the couch table?"}, {}}).at(0);
  EXPECT_THAT(answer.notes, testing::IsEmpty());
  EXPECT_EQ(answer.answer->get<ContentsAnswer>().places.at(0).place.name, "table_1");
  EXPECT_EQ(ask(store, FactsQuestion{"table_1", "", {.at = {}, .known_at = kLater - 1}}).facts.size(), 0U);
}

TEST_F(Facts, ANewOwnerSupersedesTheOldOneAndNothingIsOverwritten) {
  {
    Store store = open(0);
    set_fact(store, "red", "owner", "Ada");
  }
  {
    Store store = open(1);
    set_fact(store, "object_1", "owner", "Ben");
  }
  EXPECT_THAT(who("Ben's tea cup"), ElementsAre(1));
  EXPECT_THAT(who("bens tea cup"), ElementsAre(1)) << "as it is typed";
  EXPECT_THROW(who("Ada's"), Error);
  EXPECT_THAT(who("Ada's", {.at = {}, .known_at = kLater + 1}), ElementsAre(1));
  {
    Store store = open(2);
    const FactsAnswer removed = remove_fact(store, "object_1", "owner", "");
    EXPECT_TRUE(removed.facts.empty());
    EXPECT_EQ(to_text(removed), "Removed: " + removed.retracted.at(0).about + " owner Ben\n");
    EXPECT_EQ(to_json(removed)["retracted"][0]["value"], "Ben");
  }
  EXPECT_THROW(who("Ben's"), Error);
  Store store = open(3);
  EXPECT_THROW(remove_fact(store, "object_1", "owner", ""), Error);
  NoProgress quiet;
  EXPECT_THAT(store.verify(quiet).problems, testing::IsEmpty());
}

TEST_F(Facts, SayingTheSameAgainChangesNothing) {
  Store store = open(0);
  set_fact(store, "blue", "class", "mug");
  const size_t runs = store.runs().size();
  EXPECT_EQ(set_fact(store, "blue", "class", "mug").facts.size(), 1U);
  EXPECT_EQ(store.runs().size(), runs);
}

TEST_F(Facts, ClassesOfDetectorsAreFoundByTheirWords) {
  {
    Store store = open(0);
    set_fact(store, "blue", "class", "flower_cup");
  }
  EXPECT_THAT(who("flower cup"), ElementsAre(2));
  EXPECT_THAT(who("flower_cup"), ElementsAre(2));
}

TEST_F(Facts, WordsThatMeanSeveralThingsAreRefused) {
  Store store = open(0);
  EXPECT_THROW(set_fact(store, "small", "owner", "Ada"), Error);
  EXPECT_THROW(set_fact(store, "nothing", "owner", "Ada"), Error);
  EXPECT_THROW(set_fact(store, "red", "", "Ada"), Error);
}

TEST_F(Facts, ANameThatAPlaceOrAnObjectHasIsRefused) {
  Store store = open(0);
  for (const std::string name : {"table_1", "object_2", "two\nlines"})
    EXPECT_THROW(set_fact(store, "red", "alias", name), Error) << name;
  set_fact(store, "table_1", "alias", "table_1");
}

TEST_F(Facts, ValuesAreTrimmedAndSaySomething) {
  Store store = open(0);
  for (const char* key : {"alias", "owner", "class", "colour"})
    for (const char* value : {"", "   ", "\t", "a\x1b[31m", "a\x7f", "a\xc2\x9b", "two\nlines"})
      EXPECT_THROW(set_fact(store, "object_1", key, value), Error) << key << value;
  EXPECT_EQ(set_fact(store, "object_1", "owner", "  Ada Lovelace ").facts.at(0).value, "Ada Lovelace");
  EXPECT_EQ(set_fact(store, "object_1", "owner", "Zo\xc3\xab").facts.at(0).value, "Zo\xc3\xab");
}

TEST_F(Facts, WhatPeopleSayOfAColourGoesBeforeWhatWasSeen) {
  {
    Store store = open(0);
    set_fact(store, "object_1", "color", "dark blue");
    set_fact(store, "object_1", "size", "large");
    set_fact(store, "object_1", "material", "steel");
  }
  const Store store = Store::open_read(file_);
  const auto reply = [&](const char* sentence) {
    return ask(store, NaturalLanguageQuestion{{sentence}, {}}).at(0).reply.value_or(Reply{});
  };
  const Reply colour = reply("What colour is object_1?");
  EXPECT_THAT(colour.text, testing::HasSubstr("is dark blue"));
  EXPECT_THAT(colour.evidence, testing::Contains("seen: red"));
  EXPECT_EQ(reply("Is object_1 blue?").verdict, Verdict::yes);
  EXPECT_EQ(reply("Is object_1 red?").verdict, Verdict::no);
  EXPECT_THAT(reply("How big is object_1?").text, testing::HasSubstr("is large"));
  EXPECT_THAT(reply("What material is object_1?").text, testing::HasSubstr("is made of steel"));
  EXPECT_THAT(who("blue"), ElementsAre(1, 2));
  EXPECT_THROW(who("red"), Error);
}

TEST_F(Facts, SynonymsKindsPropertiesAndPluralsFindTheSame) {
  {
    Store store = open(0);
    set_fact(store, "blue", "class", "mug");
    set_fact(store, "green", "class", "milk");
  }
  EXPECT_THAT(who("cup"), ElementsAre(2)) << "English";
  EXPECT_THROW(who("perishable items"), Error);
  load_taxonomy();
  for (const char* word : {"mug", "cup", "cups", "crockery", "dishes", "blue cup", "all my cups"})
    EXPECT_THAT(who(word), ElementsAre(2)) << word;
  EXPECT_THAT(who("perishable items"), ElementsAre(3));
  EXPECT_THAT(who("tea cup"), ElementsAre(1)) << "a name goes before a kind";
  EXPECT_THROW(who("perishable items", {.at = {}, .known_at = kLater + 3600 * kSecond}), Error)
      << "not known then";
}

TEST_F(Facts, ATaxonomyThatContradictsItselfIsRefused) {
  const std::string file = file_.string() + ".yaml";
  for (const char* text :
       {"a: {is: [b]}\nb: {is: [a]}\n", "a: {synonyms: [c]}\nb: {synonyms: [c]}\n", "a: {kind: [b]}\n"}) {
    write_file_atomically(file, text);
    EXPECT_THROW(Taxonomy::read(file), Error) << text;
  }
  EXPECT_TRUE(
      Taxonomy::read(LOCI_SOURCE_DIR "/apps/samples/household.yaml").meanings("perishable").contains("milk"));
}

TEST_F(Facts, NamesThatAreNoUtf8AreRefused) {
  Store store = open(1);
  EXPECT_THROW(set_fact(store, "object_1", "alias", "caf\xe9"), Error);
  EXPECT_NO_THROW(set_fact(store, "object_1", "alias", "caf\xc3\xa9"));
}

}  // namespace
}  // namespace loci::memory
