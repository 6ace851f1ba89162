#include "memory/wordnet/wordnet.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace loci::memory::wordnet {
namespace {

using Words = std::vector<std::string>;

TEST(Wordnet, FindsBaseFormsByRulesAndExceptions) {
  EXPECT_EQ(base_forms("plates", PartOfSpeech::noun), Words{"plate"});
  EXPECT_EQ(base_forms("knives", PartOfSpeech::noun), Words{"knife"});
  EXPECT_EQ(base_forms("took", PartOfSpeech::verb), Words{"take"});
  EXPECT_EQ(base_forms("nicked", PartOfSpeech::verb), Words{"nick"});
  EXPECT_EQ(std::ranges::count(base_forms("left", PartOfSpeech::verb), "leave"), 1);
  EXPECT_TRUE(base_forms("mlik", PartOfSpeech::noun).empty());
  EXPECT_TRUE(base_forms("", PartOfSpeech::noun).empty());
}

TEST(Wordnet, KnowsEnglishWords) {
  for (const char* word : {"aardvark", "spotted", "bigger", "quickly", "zygotes"})
    EXPECT_TRUE(is_word(word)) << word;
  for (const char* word : {"wher", "mlik", "counterr", "", "zzz", "Milk"})
    EXPECT_FALSE(is_word(word)) << word;
}

TEST(Wordnet, SynonymsShareASense) {
  const auto see = senses("saw", PartOfSpeech::verb), notice = senses("spotted", PartOfSpeech::verb);
  const auto espy = senses("espied", PartOfSpeech::verb);
  EXPECT_TRUE(std::ranges::any_of(notice, [&](Synset one) { return std::ranges::count(espy, one) > 0; }));
  EXPECT_FALSE(see.empty());
}

TEST(Wordnet, RelatesWhatCanBeTouched) {
  EXPECT_EQ(relation_of("pail", "bucket", 0), Relation::synonym);
  EXPECT_EQ(relation_of("bowl", "tableware", 6), Relation::kind);
  EXPECT_EQ(relation_of("banana", "fruit", 6), Relation::kind);
  EXPECT_EQ(relation_of("milk", "drink", 6), Relation::kind);
  EXPECT_EQ(relation_of("milk", "food", 6), Relation::kind);
  EXPECT_EQ(relation_of("tableware", "plate", 6), Relation::none);
  EXPECT_EQ(relation_of("fork", "spoon", 6), Relation::none);
  EXPECT_EQ(relation_of("plate", "food", 6), Relation::none);  // a rare sense
  EXPECT_EQ(relation_of("can", "pot", 6), Relation::none);     // both may be a toilet
}

}  // namespace
}  // namespace loci::memory::wordnet
