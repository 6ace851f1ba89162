#include "perception/pipeline/condition.h"

#include <gmock/gmock.h>

namespace loci::perception {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ConditionTest : public testing::Test {
 protected:
  ConditionTest() {
    scene.create_scene().frame_index.set(7);
    scene.add_cluster(cluster);
    const auto geometry = types::GeometryAnnotation::create(cas);
    geometry.height.set(0.05);
    geometry.size.get_or_create().x.set(0.3);
    cluster.annotations.push_back(geometry);
    const auto color = types::ColorAnnotation::create(cas);
    color.names.set({"red", "white"});
    cluster.annotations.push_back(color);
    cluster.at_image_border.set(true);
  }
  bool holds(const std::string& text) const {
    const Condition condition = Condition::parse(text, {"p.yaml", 3, "if"});
    condition.check(cas.type_system());
    return condition.holds(scene, cluster);
  }
  std::string refusal(const std::string& text) const {
    try {
      holds(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }
  cas::Cas cas{types::type_system()};
  types::SceneCas scene{cas};
  types::Cluster cluster = types::Cluster::create(cas);
};

TEST_F(ConditionTest, ComparesNumbersTextsAndFlags) {
  EXPECT_TRUE(holds("GeometryAnnotation.height > 0.02"));
  EXPECT_FALSE(holds("GeometryAnnotation.height>=5e-1"));
  EXPECT_TRUE(holds("Geometry.height < 0.1"));
  EXPECT_TRUE(holds("GeometryAnnotation.size.x == 0.3"));
  EXPECT_TRUE(holds("loci.annotation.GeometryAnnotation.height <= 0.05"));
  EXPECT_TRUE(holds("ColorAnnotation.names == 'white'"));
  EXPECT_FALSE(holds("ColorAnnotation.names == \"green\""));
  EXPECT_FALSE(holds("ColorAnnotation.names != \"red\""));
  EXPECT_TRUE(holds("Cluster.at_image_border == true"));
  EXPECT_TRUE(holds("Scene.frame_index != 8"));
  EXPECT_TRUE(holds("Scene.clusters == 1"));
}

TEST_F(ConditionTest, ATextMayContainAnother) {
  EXPECT_TRUE(holds("ColorAnnotation.names ~ 'WHIT'"));
  EXPECT_FALSE(holds("ColorAnnotation.names ~ 'whitest'"));
  EXPECT_FALSE(holds("BarcodeAnnotation.code ~ ''"));
  EXPECT_THAT(refusal("GeometryAnnotation.height ~ 1"), HasSubstr("no text that '~'"));
  EXPECT_THAT(refusal("ColorAnnotation.names ~ 1"), HasSubstr("compared with a text"));
}

TEST_F(ConditionTest, ATypeAloneAsksWhetherThereIsOne) {
  EXPECT_TRUE(holds("ColorAnnotation"));
  EXPECT_FALSE(holds("BarcodeAnnotation"));
  EXPECT_TRUE(holds("Annotation"));
  EXPECT_TRUE(holds("not BarcodeAnnotation"));
}

TEST_F(ConditionTest, WordsBindAsInOtherLanguages) {
  EXPECT_TRUE(holds("ColorAnnotation or BarcodeAnnotation and BarcodeAnnotation"));
  EXPECT_FALSE(holds("(ColorAnnotation or BarcodeAnnotation) and BarcodeAnnotation"));
  EXPECT_TRUE(holds("not BarcodeAnnotation and ColorAnnotation"));
}

TEST_F(ConditionTest, WhatIsUnsetOrAbsentFitsNothing) {
  EXPECT_FALSE(holds("GeometryAnnotation.place == 'x'"));
  EXPECT_TRUE(holds("GeometryAnnotation.place != 'x'"));
  EXPECT_FALSE(holds("BarcodeAnnotation.code == 'x'"));
  EXPECT_TRUE(holds("BarcodeAnnotation.code != 'x'"));
}

TEST_F(ConditionTest, SaysWhatIsWrong) {
  EXPECT_THAT(refusal("GeometryAnnotation.height >"), HasSubstr("expected a number"));
  EXPECT_THAT(refusal("GeometryAnnotation.height > 'x'"),
              HasSubstr("compared with a number, not with a text"));
  EXPECT_THAT(refusal("Geometri.height > 1"), HasSubstr("there is no type 'Geometri'"));
  EXPECT_THAT(refusal("Geometry.hight > 1"), HasSubstr("height"));
  EXPECT_THAT(refusal("(Cluster"), HasSubstr("expected ')'"));
  EXPECT_THAT(refusal("Cluster Cluster"), HasSubstr("expected 'and', 'or'"));
  EXPECT_THAT(refusal("Geometry.size > 1"), HasSubstr("cannot be compared"));
  EXPECT_THAT(refusal(""), HasSubstr("p.yaml:3"));
  EXPECT_THAT(refusal("Cluster.place == 'x"), HasSubstr("closing quote"));
}

TEST_F(ConditionTest, TellsWhatItAsksFor) {
  const Condition condition = Condition::parse("A.x > 1 and (B or not Scene.y == 2)", {});
  EXPECT_THAT(condition.types(), ElementsAre("A", "B", "Scene"));
  EXPECT_FALSE(condition.about_scene());
  EXPECT_TRUE(Condition::parse("Scene.x > 1 or Scene.y > 1", {}).about_scene());
}

TEST_F(ConditionTest, DepthIsLimited) {
  const auto nested = [](size_t levels) {
    std::string text(levels, '(');
    text += "Cluster";
    return text.append(levels, ')');
  };
  EXPECT_TRUE(holds(nested(50)));
  EXPECT_THAT(refusal(nested(100000)), HasSubstr("levels deep"));
  std::string nots;
  for (int i = 0; i < 100000; ++i) nots += "not ";
  EXPECT_THAT(refusal(nots + "Cluster"), HasSubstr("levels deep"));
}

}  // namespace
}  // namespace loci::perception
