#include "perception/cas/graph.h"

#include <gmock/gmock.h>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "perception/cas/json.h"

namespace loci::perception::cas {
namespace {

const char* const kTypes = R"(<typeSystemDescription><types>
<typeDescription><name>Thing</name><supertypeName>uima.cas.TOP</supertypeName><features>
  <featureDescription><name>name</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription>
  <featureDescription><name>big</name><rangeTypeName>uima.cas.Boolean</rangeTypeName></featureDescription>
  <featureDescription><name>count</name><rangeTypeName>uima.cas.Short</rangeTypeName></featureDescription>
  <featureDescription><name>weight</name><rangeTypeName>uima.cas.Float</rangeTypeName></featureDescription>
  <featureDescription><name>twin</name><rangeTypeName>Thing</rangeTypeName></featureDescription>
  <featureDescription><name>parts</name><rangeTypeName>uima.cas.FSArray</rangeTypeName><elementType>Thing</elementType></featureDescription>
  <featureDescription><name>chain</name><rangeTypeName>uima.cas.FSList</rangeTypeName><elementType>Thing</elementType></featureDescription>
  <featureDescription><name>points</name><rangeTypeName>uima.cas.FloatArray</rangeTypeName></featureDescription>
  <featureDescription><name>words</name><rangeTypeName>uima.cas.StringArray</rangeTypeName></featureDescription>
</features></typeDescription>
</types></typeSystemDescription>)";

/// Two things that refer to each other, with values of every kind.
class Copy : public testing::Test {
 protected:
  Copy() {
    one.set("name", "one");
    one.set("big", true);
    one.set("count", 7);
    one.set("weight", 0.25F);
    one.set("twin", two);
    two.set("twin", one);
    one.list("parts").assign({two, one});
    one.list("chain").assign({two, two});
    one.set_array("points", std::vector<float>{1, 2, 3});
    one.set_array("words", std::vector<std::string>{"a", "b"});
  }
  std::shared_ptr<const TypeSystem> types = TypeSystem::load({{"things.xml", kTypes}}, {}, {});
  Cas cas{types}, other{types};
  FeatureStructure one = cas.create("Thing"), two = cas.create("Thing");
};

TEST_F(Copy, IsTheSameInAnotherCas) {
  other.create("Thing");  // Ids differ.
  Copier copy(cas, other);
  const FeatureStructure made = copy(one);
  EXPECT_EQ(&made.cas(), &other);
  EXPECT_EQ(to_json(made), to_json(one));
  EXPECT_EQ(made.array<float>("points").data(), one.array<float>("points").data()) << "memory is shared";
  const size_t size = other.size();
  EXPECT_EQ(copy(two), made.get<FeatureStructure>("twin"));
  EXPECT_EQ(other.size(), size) << "once is enough";
}

TEST_F(Copy, GoesRoundWhatAnotherStandsInFor) {
  const FeatureStructure known = other.create("Thing");
  Copier copy(cas, other);
  copy.stand_in(two, known);
  const FeatureStructure made = copy(one);
  EXPECT_EQ(made.get<FeatureStructure>("twin"), known);
  EXPECT_EQ(made.list("parts").at(0), known);
}

TEST_F(Copy, LeavesOutWhatWasDeleted) {
  two.remove();
  Copier copy(cas, other);
  const FeatureStructure made = copy(one);
  EXPECT_FALSE(made.get<FeatureStructure>("twin"));
  EXPECT_EQ(to_json(made), to_json(one));
}

TEST_F(Copy, StaysWithinOneTypeSystem) {
  Cas stranger(TypeSystem::load({{"things.xml", kTypes}}, {}, {}));
  EXPECT_THROW(Copier(cas, stranger), Error);
}

}  // namespace
}  // namespace loci::perception::cas
