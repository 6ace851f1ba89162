#include <gmock/gmock.h>

#include "mapping/base/text/json.h"
#include "perception/cas/cas.h"
#include "perception/cas/json.h"

namespace loci::perception::cas {
namespace {

using testing::ElementsAre;

const char* const kTypes = R"(<typeSystemDescription><types>
<typeDescription><name>Note</name><supertypeName>uima.cas.TOP</supertypeName><features>
  <featureDescription><name>text</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription>
</features></typeDescription>
<typeDescription><name>Thing</name><supertypeName>uima.cas.TOP</supertypeName><features>
  <featureDescription><name>name</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription>
  <featureDescription><name>notes</name><rangeTypeName>uima.cas.FSArray</rangeTypeName><elementType>Note</elementType></featureDescription>
  <featureDescription><name>chain</name><rangeTypeName>uima.cas.FSList</rangeTypeName><elementType>Note</elementType></featureDescription>
  <featureDescription><name>best</name><rangeTypeName>Note</rangeTypeName></featureDescription>
  <featureDescription><name>points</name><rangeTypeName>uima.cas.FloatArray</rangeTypeName></featureDescription>
</features></typeDescription>
</types></typeSystemDescription>)";

class Branch : public testing::Test {
 protected:
  Branch() {
    thing.add_to_index();
    thing.set("name", "cup");
  }
  /// What an annotator does: a note in both lists of the thing.
  static void annotate(Cas& cas, const std::string& text) {
    const FeatureStructure note = cas.create("Note");
    note.set("text", text);
    note.add_to_index();
    const FeatureStructure annotated = cas.select("Thing").front();
    annotated.list("notes").push_back(note);
    annotated.list("chain").push_back(note);
  }
  static std::vector<std::string> texts(const List& list) {
    std::vector<std::string> found;
    for (const FeatureStructure& note : list.structures()) found.push_back(note.get<std::string>("text"));
    return found;
  }
  Cas cas{TypeSystem::load({{"things.xml", kTypes}}, {}, {})};
  FeatureStructure thing = cas.create("Thing");
};

TEST_F(Branch, WorkInABranchIsNotSeenAtHomeUntilItIsMerged) {
  const auto branch = cas.branch();
  annotate(*branch, "red");
  branch->select("Thing").front().set("name", "mug");
  EXPECT_EQ(thing.get<std::string>("name"), "cup");
  EXPECT_TRUE(cas.select("Note").empty());
  cas.merge(*branch);
  EXPECT_EQ(thing.get<std::string>("name"), "mug");
  EXPECT_THAT(texts(thing.list("notes")), ElementsAre("red"));
  EXPECT_EQ(cas.select("Note").size(), 1U);
}

TEST_F(Branch, BranchesMergedInOrderAreWhatTheSameWorkOneAfterTheOtherIs) {
  for (const bool with_earlier : {false, true}) {
    if (with_earlier) annotate(cas, "first");
    const auto one = cas.branch();
    const auto two = cas.branch();
    const auto sequential = cas.branch();
    annotate(*two, "large");
    annotate(*two, "round");
    annotate(*one, "red");
    for (const char* text : {"red", "large", "round"}) annotate(*sequential, text);
    cas.merge(*one);
    cas.merge(*two);
    EXPECT_EQ(to_json(cas).dump(), to_json(*sequential).dump());
  }
}

TEST_F(Branch, OfAFeatureThatBothSetTheLaterStays) {
  const auto one = cas.branch();
  const auto two = cas.branch();
  one->select("Thing").front().set("name", "one");
  two->select("Thing").front().set("name", "two");
  cas.merge(*one);
  cas.merge(*two);
  EXPECT_EQ(thing.get<std::string>("name"), "two");
}

TEST_F(Branch, WhatABranchTookOutOrDeletedIsGoneAtHome) {
  for (const char* text : {"a", "b", "c"}) annotate(cas, text);
  const auto one = cas.branch();
  const auto two = cas.branch();
  annotate(*one, "d");
  const FeatureStructure there = two->select("Thing").front();
  there.list("notes").erase(there.list("notes").at(0));
  two->select("Note")
      .filter([](const auto& n) { return n.template get<std::string>("text") == "b"; })
      .front()
      .remove_from_index();
  two->select("Note").front().remove();
  cas.merge(*one);
  cas.merge(*two);
  EXPECT_THAT(texts(thing.list("notes")), ElementsAre("b", "c", "d"));
  EXPECT_EQ(cas.select("Note").size(), 2U);
}

TEST_F(Branch, ViewsAndTheirSubjectsComeHome) {
  const auto branch = cas.branch();
  branch->view("depth").set_sofa_data(branch->create_array(Buffer<float>({1.F, 2.F})), "depth");
  cas.merge(*branch);
  EXPECT_THAT(cas.view("depth").sofa_data().elements<float>(), ElementsAre(1.F, 2.F));
}

TEST_F(Branch, SharesBuffersWithItsHome) {
  thing.set_array("points", std::vector<float>{1, 2, 3});
  const auto branch = cas.branch();
  EXPECT_EQ(branch->select("Thing").front().array<float>("points").data(),
            thing.array<float>("points").data());
}

TEST_F(Branch, WhatIsHiddenIsPassedOverAndStays) {
  cas.create("Thing").add_to_index();
  const auto branch = cas.branch();
  branch->hide(branch->select("Thing").front());
  ASSERT_EQ(branch->select("Thing").size(), 1U);
  branch->select("Thing").front().set("name", "second");
  cas.merge(*branch);
  ASSERT_EQ(cas.select("Thing").size(), 2U);
  EXPECT_EQ(cas.select("Thing")[0].get<std::string>("name"), "cup");
  EXPECT_EQ(cas.select("Thing")[1].get<std::string>("name"), "second");
}

TEST_F(Branch, UndoneChangesLeaveNoTrace) {
  annotate(cas, "first");
  const std::string before = to_json(cas).dump();
  const size_t size = cas.size();
  cas.begin_changes();
  annotate(cas, "second");
  thing.set("name", "mug");
  cas.select("Note").front().remove();
  cas.view("depth").set_sofa_text("text");
  thing.remove_from_index();
  cas.undo_changes();
  EXPECT_EQ(to_json(cas).dump(), before);
  EXPECT_EQ(cas.size(), size);
  EXPECT_EQ(cas.find_view("depth"), nullptr);
}

TEST_F(Branch, KeptInnerChangesAreUndoneWithTheOuterOnes) {
  const std::string before = to_json(cas).dump();
  cas.begin_changes();
  annotate(cas, "outer");
  cas.begin_changes();
  annotate(cas, "inner");
  cas.keep_changes();
  EXPECT_EQ(texts(thing.list("notes")).size(), 2U);
  cas.undo_changes();
  EXPECT_EQ(to_json(cas).dump(), before);
}

TEST_F(Branch, ChangesAreWhatWasMadeAndWhatWasWrittenTo) {
  const FeatureStructure other = cas.create("Thing");
  cas.begin_changes();
  EXPECT_EQ(other.get<std::string>("name"), "");  // reading is no change
  EXPECT_TRUE(cas.changes().empty());
  thing.set("name", "mug");
  const FeatureStructure note = cas.create("Note");
  EXPECT_THAT(cas.changes(), ElementsAre(thing, note));
}

}  // namespace
}  // namespace loci::perception::cas
