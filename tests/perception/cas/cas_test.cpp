#include "perception/cas/cas.h"

#include <gmock/gmock.h>

#include <limits>

namespace loci::perception::cas {
namespace {

using testing::ElementsAre;

const char* const kTypes = R"(<typeSystemDescription><types>
<typeDescription><name>Mood</name><supertypeName>uima.cas.String</supertypeName>
  <allowedValues><value><string>good</string></value><value><string>bad</string></value></allowedValues></typeDescription>
<typeDescription><name>Thing</name><supertypeName>uima.cas.TOP</supertypeName><features>
  <featureDescription><name>size</name><rangeTypeName>uima.cas.Double</rangeTypeName></featureDescription>
  <featureDescription><name>name</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription>
  <featureDescription><name>mood</name><rangeTypeName>Mood</rangeTypeName></featureDescription>
  <featureDescription><name>count</name><rangeTypeName>uima.cas.Short</rangeTypeName></featureDescription>
  <featureDescription><name>ratio</name><rangeTypeName>uima.cas.Float</rangeTypeName></featureDescription>
  <featureDescription><name>flag</name><rangeTypeName>uima.cas.Boolean</rangeTypeName></featureDescription>
  <featureDescription><name>part</name><rangeTypeName>Part</rangeTypeName></featureDescription>
  <featureDescription><name>points</name><rangeTypeName>uima.cas.FloatArray</rangeTypeName></featureDescription>
  <featureDescription><name>parts</name><rangeTypeName>uima.cas.FSArray</rangeTypeName><elementType>Part</elementType></featureDescription>
  <featureDescription><name>chain</name><rangeTypeName>uima.cas.FSList</rangeTypeName><elementType>Part</elementType></featureDescription>
  <featureDescription><name>words</name><rangeTypeName>uima.cas.StringList</rangeTypeName></featureDescription>
</features></typeDescription>
<typeDescription><name>Part</name><supertypeName>Thing</supertypeName></typeDescription>
<typeDescription><name>Screw</name><supertypeName>Part</supertypeName></typeDescription>
</types></typeSystemDescription>)";

class CasTest : public testing::Test {
 protected:
  FeatureStructure thing(double size, const char* type = "Thing") {
    const FeatureStructure made = cas.create(type);
    made.set("size", size);
    return made;
  }
  static std::vector<double> sizes(const Selection& selection) {
    std::vector<double> found;
    for (const FeatureStructure& each : selection) found.push_back(each.get<double>("size"));
    return found;
  }
  Cas cas{TypeSystem::load({{"things.xml", kTypes}}, {}, {})};
};

TEST_F(CasTest, UnsetFeaturesReadAsNothingAndSaySo) {
  const FeatureStructure made = cas.create("Thing");
  EXPECT_EQ(made.get<double>("size"), 0);
  EXPECT_EQ(made.get<std::string>("name"), "");
  EXPECT_TRUE(made.get<FeatureStructure>("part").is_null());
  EXPECT_EQ(made.array<float>("points").size(), 0U);
  EXPECT_FALSE(made.is_set("size"));
  made.set("size", 0.0);
  EXPECT_TRUE(made.is_set("size"));
  made.clear("size");
  EXPECT_FALSE(made.is_set("size"));
}

TEST_F(CasTest, ValuesMustFitTheRange) {
  const FeatureStructure made = cas.create("Thing");
  EXPECT_THROW(made.set("size", 1), Error) << "an integer";
  EXPECT_THROW(made.set("count", 40000), Error);
  EXPECT_THROW(made.set("count", 1.0), Error);
  EXPECT_THROW(made.set("flag", "true"), Error);
  EXPECT_THROW(made.set("nmae", "x"), Error);
  EXPECT_THROW(made.get<int32_t>("size"), Error);
  EXPECT_THROW(made.get<float>("size"), Error) << "would lose";
  EXPECT_THROW(made.get<int8_t>("name"), Error);
  made.set("count", 300);
  EXPECT_EQ(made.get<int64_t>("count"), 300);
  EXPECT_THROW(made.get<int8_t>("count"), Error);
  made.set("ratio", 0.1);
  EXPECT_EQ(made.get<float>("ratio"), 0.1F);
  made.set("flag", true);
  EXPECT_TRUE(made.get<bool>("flag"));
}

TEST_F(CasTest, StringSubtypesAllowTheirValuesOnly) {
  const FeatureStructure made = cas.create("Thing");
  made.set("mood", "good");
  try {
    made.set("mood", "so so");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("good, bad"));
  }
  EXPECT_EQ(made.get<std::string>("mood"), "good");
}

TEST_F(CasTest, ReferencesMustBeOfTheRangeOrASubtype) {
  const FeatureStructure made = cas.create("Thing");
  EXPECT_THROW(made.set("part", cas.create("Thing")), Error);
  made.set("part", cas.create("Screw"));
  EXPECT_TRUE(made.get<FeatureStructure>("part").is_a("Part"));
  made.set("part", FeatureStructure());
  EXPECT_FALSE(made.is_set("part"));
  Cas other(cas.shared_type_system());
  EXPECT_THROW(made.set("part", other.create("Part")), Error);
  EXPECT_THROW(made.set("points", cas.create_array(Buffer<double>(std::vector<double>{1}))), Error);
}

TEST_F(CasTest, FeaturesOfOtherTypesAreRefused) {
  const Feature size = cas.type_system().type("Thing").feature("size");
  EXPECT_EQ(cas.create("Screw").get<double>(size), 0);
  EXPECT_THROW(cas.create("uima.cas.Sofa").get<double>(size), Error);
}

TEST_F(CasTest, OnlyStructuresAndArraysCanBeCreated) {
  EXPECT_THROW(cas.create("uima.cas.Integer"), Error);
  EXPECT_THROW(cas.create("Mood"), Error);
  EXPECT_THROW(cas.create("Thnig"), Error);
  EXPECT_THROW(FeatureStructure().type(), Error);
}

TEST_F(CasTest, ArraysAliasTheMemoryTheyAreGiven) {
  std::vector<float> values = {1, 2, 3};
  const float* memory = values.data();
  const FeatureStructure made = cas.create("Thing");
  made.set_array("points", std::move(values));
  EXPECT_EQ(made.array<float>("points").data(), memory);
  const Buffer<float> kept = made.array<float>("points");
  made.set_array("points", std::vector<float>{9});
  EXPECT_THAT(kept, ElementsAre(1, 2, 3)) << "buffers outlive the feature";
  EXPECT_THROW(made.array<double>("points"), Error);
}

TEST_F(CasTest, ListsOfBothKindsBehaveLikeVectors) {
  for (const char* name : {"parts", "chain"}) {
    const FeatureStructure made = cas.create("Thing");
    const List list = made.list(name);
    EXPECT_TRUE(list.empty());
    const FeatureStructure one = cas.create("Part"), two = cas.create("Screw"), three = cas.create("Part");
    list.push_back(one);
    list.push_back(two);
    list.push_back(three);
    EXPECT_THAT(list.structures(), ElementsAre(one, two, three)) << name;
    EXPECT_EQ(list.at(1), two);
    EXPECT_THROW(list.at(3), Error);
    EXPECT_THROW(list.push_back(made), Error) << "a Thing is no Part";
    EXPECT_TRUE(list.erase(two));
    EXPECT_FALSE(list.erase(two));
    EXPECT_THAT(list.structures(), ElementsAre(one, three));
    list.assign({three, two});
    EXPECT_THAT(list.structures(), ElementsAre(three, two));
    list.clear();
    EXPECT_EQ(list.size(), 0U);
  }
}

TEST_F(CasTest, ListsOfValues) {
  const List words = cas.create("Thing").list("words");
  words.push_back_value<std::string>("a");
  words.push_back_value<std::string>("b");
  EXPECT_THAT(words.values<std::string>(), ElementsAre("a", "b"));
  EXPECT_THROW(words.values<float>(), Error);
  EXPECT_THROW(words.structures(), Error);
  EXPECT_THROW(cas.create("Thing").list("points"), Error);
}

TEST_F(CasTest, AListWithoutEndIsAnErrorNotALoop) {
  const FeatureStructure made = cas.create("Thing");
  made.list("chain").push_back(cas.create("Part"));
  const FeatureStructure node = made.get<FeatureStructure>("chain");
  node.set("tail", node);
  EXPECT_THROW(made.list("chain").size(), Error);
}

TEST_F(CasTest, SelectionsIncludeSubtypesInOrderOfIndexing) {
  View& view = cas.view("cloud");
  view.add_to_index(thing(3, "Screw"));
  view.add_to_index(thing(1));
  view.add_to_index(thing(2, "Part"));
  thing(9).add_to_index("depth");
  EXPECT_THAT(sizes(view.select("Thing")), ElementsAre(3, 1, 2));
  EXPECT_THAT(sizes(view.select("Part")), ElementsAre(3, 2));
  EXPECT_EQ(cas.select("Thing", "depth").size(), 1U);
  EXPECT_TRUE(cas.select("Thing", "nowhere").empty());
  EXPECT_THROW(cas.select("Nothing"), Error);
}

TEST_F(CasTest, SelectionsAreFiltered) {
  for (const double size : {3., 1., std::numeric_limits<double>::quiet_NaN(), 2.}) thing(size).add_to_index();
  const auto large =
      cas.select("Thing").filter([](const auto& each) { return each.template get<double>("size") > 1.5; });
  EXPECT_THAT(sizes(large), ElementsAre(3, 2));
}

TEST_F(CasTest, IndexingTwiceIsAsOnceAndCanBeUndone) {
  const FeatureStructure made = thing(1);
  made.add_to_index();
  made.add_to_index();
  EXPECT_EQ(cas.select("Thing").size(), 1U);
  made.remove_from_index();
  EXPECT_TRUE(cas.select("Thing").empty());
  made.remove_from_index();
  Cas other(cas.shared_type_system());
  EXPECT_THROW(cas.view("x").add_to_index(other.create("Thing")), Error);
}

TEST_F(CasTest, DeletionLeavesATombstone) {
  const FeatureStructure made = thing(1), holder = thing(2);
  const FeatureStructure part = cas.create("Part");
  holder.set("part", part);
  made.add_to_index("a");
  made.add_to_index("b");
  made.remove();
  part.remove();
  EXPECT_TRUE(made.is_deleted());
  EXPECT_TRUE(cas.select("Thing", "a").empty());
  EXPECT_TRUE(cas.select("Thing", "b").empty());
  EXPECT_THROW(made.get<double>("size"), Error);
  EXPECT_THROW(made.set("size", 1.0), Error);
  EXPECT_THROW(made.remove(), Error);
  EXPECT_TRUE(holder.get<FeatureStructure>("part").is_deleted());
  EXPECT_NE(cas.create("Thing"), made) << "ids are not used again";
}

TEST_F(CasTest, ViewsHaveSofas) {
  View& view = cas.view("text");
  EXPECT_TRUE(view.existing_sofa().is_null());
  view.set_sofa_text("Hello");
  EXPECT_EQ(view.mime_type(), "text/plain");
  EXPECT_EQ(cas.view("text").sofa().get<std::string>("sofaID"), "text");
  cas.view("cloud").set_sofa_data(cas.create("Thing"), "thing");
  EXPECT_TRUE(cas.view("cloud").sofa_data().is_a("Thing"));
  EXPECT_NE(cas.view("cloud").sofa(), view.sofa());
}

}  // namespace
}  // namespace loci::perception::cas
