#include "perception/cas/xmi.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <limits>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "perception/cas/json.h"

namespace loci::perception::cas {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kTypes = R"(<?xml version="1.0"?>
<typeSystemDescription xmlns="http://uima.apache.org/resourceSpecifier"><types>
  <typeDescription><name>Bare</name><supertypeName>uima.cas.TOP</supertypeName><features>
    <featureDescription><name>text</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription>
  </features></typeDescription>
  <typeDescription><name>my.test.Thing</name><supertypeName>uima.cas.TOP</supertypeName><features>
    FEATURES
    <featureDescription><name>shared</name><rangeTypeName>uima.cas.FSArray</rangeTypeName>
      <multipleReferencesAllowed>true</multipleReferencesAllowed></featureDescription>
    <featureDescription><name>shared_list</name><rangeTypeName>uima.cas.StringList</rangeTypeName>
      <multipleReferencesAllowed>true</multipleReferencesAllowed></featureDescription>
  </features></typeDescription>
  <typeDescription><name>other.test.Thing</name><supertypeName>my.test.Thing</supertypeName></typeDescription>
</types></typeSystemDescription>)";

std::shared_ptr<const TypeSystem> all_ranges() {
  std::string features;
  for (const char* range :
       {"Boolean",    "Byte",        "Short",        "Integer",     "Long",       "Float",
        "Double",     "String",      "BooleanArray", "ByteArray",   "ShortArray", "IntegerArray",
        "LongArray",  "FloatArray",  "DoubleArray",  "StringArray", "FSArray",    "FSList",
        "StringList", "IntegerList", "FloatList",    "TOP"})
    features += std::string("<featureDescription><name>a_") + range + "</name><rangeTypeName>uima.cas." +
                range + "</rangeTypeName></featureDescription>";
  std::string text = kTypes;
  return TypeSystem::load({{"types.xml", text.replace(text.find("FEATURES"), 8, features)}}, {}, {});
}

std::unique_ptr<Cas> read(const std::shared_ptr<const TypeSystem>& system, const std::string& xml,
                          bool lenient = false, Warnings* warnings = nullptr) {
  auto cas = std::make_unique<Cas>(system);
  Warnings ignored;
  from_xmi(*cas, xml, "a.xmi", {lenient}, warnings != nullptr ? *warnings : ignored);
  return cas;
}

/// JSON → XMI → JSON.
void expect_survives(const Cas& cas) {
  const std::string before = to_json(cas).dump(1);
  const std::string xmi = to_xmi(cas);
  EXPECT_EQ(to_json(*read(cas.shared_type_system(), xmi)).dump(1), before) << xmi;
}

std::string refusal(const std::shared_ptr<const TypeSystem>& system, const std::string& content) {
  try {
    read(system,
         "<?xml version=\"1.0\"?>\n<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\" "
         "xmlns:cas=\"http:///uima/cas.ecore\" xmlns:n=\"http:///uima/noNamespace.ecore\" "
         "xmlns:t=\"http:///my/test.ecore\" xmi:version=\"2.0\">\n" +
             content + "</xmi:XMI>");
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "no error";
}

class ReferenceCases : public testing::TestWithParam<const char*> {};

TEST_P(ReferenceCases, SurviveInAllDirections) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/uima_xmi" / GetParam();
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  const auto system = TypeSystem::load({folder / "typesystem.xml"});
  const auto cas = read(system, read_file(folder / "cas.xmi"));
  expect_survives(*cas);
  Cas again(system);
  from_json(again, to_json(*cas));
  EXPECT_EQ(to_json(again), to_json(*cas));
  EXPECT_EQ(to_json(*read(system, to_xmi(again))), to_json(*cas));
}

INSTANTIATE_TEST_SUITE_P(Uima, ReferenceCases,
                         testing::Values("casWithArrays", "casWithSofaDataURI", "casWithText",
                                         "casWithTextAndAnnotations", "casWithoutTextButWithAnnotations",
                                         "emptyCas"));

TEST(Xmi, ArraysHaveTheElementsThatUimaWrote) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/uima_xmi/casWithArrays";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  const auto cas = read(TypeSystem::load({folder / "typesystem.xml"}), read_file(folder / "cas.xmi"));
  const FeatureStructure annotations =
      cas->select("FsArrayHolder", "_InitialView").front().get<FeatureStructure>("fsArray");
  ASSERT_EQ(annotations.array_size(), 2U);
  EXPECT_EQ(annotations.element(1).get<int32_t>("begin"), 1);
  const Selection floats = cas->select("FloatArrayHolder", "_InitialView");
  ASSERT_EQ(floats.size(), 2U);
  const Buffer<float> values = floats[0].array<float>("floatArray").empty()
                                   ? floats[1].array<float>("floatArray")
                                   : floats[0].array<float>("floatArray");
  ASSERT_EQ(values.size(), 8U);
  EXPECT_EQ(values[6], std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(values[7], std::numeric_limits<float>::max());
}

TEST(Xmi, HoldsEveryRange) {
  Cas cas(all_ranges());
  const FeatureStructure thing = cas.create("other.test.Thing");
  const FeatureStructure bare = cas.create("Bare");
  bare.set("text", std::string(" <a & \"b\">\n\ttab\r 'end' ") + "\xf0\x9f\x99\x82");
  thing.set("a_Boolean", true);
  thing.set("a_Byte", -128);
  thing.set("a_Short", -300);
  thing.set("a_Integer", std::numeric_limits<int32_t>::min());
  thing.set("a_Long", std::numeric_limits<int64_t>::min());
  thing.set("a_Float", std::numeric_limits<float>::quiet_NaN());
  thing.set("a_Double", -0.1);
  thing.set("a_String", "");
  thing.set_array("a_BooleanArray", Buffer<bool>::copy(std::array{true, false}));
  thing.set_array("a_ByteArray", std::vector<uint8_t>{0, 127, 128, 255});
  thing.set_array("a_ShortArray", std::vector<int16_t>{});
  thing.set_array("a_IntegerArray", std::vector<int32_t>(200, 7));
  thing.set_array("a_LongArray", std::vector<int64_t>{1LL << 60});
  thing.set_array("a_FloatArray", std::vector<float>{0.1F, -std::numeric_limits<float>::infinity()});
  thing.set_array("a_DoubleArray", std::vector<double>{1e300, 5e-324});
  thing.set_array("a_StringArray", std::vector<std::string>{"", "   ", " a b ", "\n", "<x/>"});
  thing.set("a_FSArray", cas.create_array({bare, FeatureStructure(), thing}));
  thing.list("a_FSList").assign({bare, thing});
  thing.list("a_StringList").assign_values<std::string>({" ", "b"});
  thing.list("a_IntegerList").assign_values<int32_t>({1, -2});
  thing.list("a_FloatList").assign_values<float>({});
  thing.set("a_TOP", cas.create_array({bare}));
  thing.set("shared", cas.create_array({FeatureStructure()}));
  thing.list("shared_list").assign_values<std::string>({"x"});
  cas.view("_InitialView").add_to_index(thing);
  expect_survives(cas);
}

TEST(Xmi, HoldsViewsOfAllKinds) {
  Cas cas(all_ranges());
  cas.view("without a sofa").add_to_index(cas.create("Bare"));
  cas.view("empty");
  cas.view("text").set_sofa_text("one\ntwo", "text/plain");
  cas.view("uri").set_sofa_uri("file:///a?b&c", "image/png");
  cas.view("array").set_sofa_data(cas.create_array(Buffer<uint8_t>(std::vector<uint8_t>{1, 2})), "x/y");
  cas.view("_InitialView");
  cas.view("numbered").sofa().set("sofaNum", 2);
  cas.view("renamed").sofa().set("sofaID", "another");
  cas.view("unnamed").sofa().clear("sofaID");
  const FeatureStructure stray = cas.create("uima.cas.Sofa");
  const FeatureStructure annotation = cas.create("uima.tcas.Annotation");
  annotation.set("sofa", stray);
  for (const char* name : {"text", "uri"}) cas.view(name).add_to_index(annotation);
  expect_survives(cas);
}

TEST(Xmi, HoldsWhatXmlCannotSay) {
  Cas cas(all_ranges());
  const FeatureStructure one = cas.create("my.test.Thing"), two = cas.create("my.test.Thing");
  one.set("a_String", std::string("a\0b\x01", 4));
  two.set("a_String", "\xff\xfe");
  one.set_array("a_StringArray", std::vector<std::string>{"fine", "\x02"});
  const FeatureStructure array = cas.create_array(Buffer<int32_t>(std::vector<int32_t>{1, 2}));
  one.set("a_IntegerArray", array);
  two.set("a_IntegerArray", array);
  one.list("a_FSList").assign({one, two});
  two.set("a_FSList", one.get<FeatureStructure>("a_FSList").get<FeatureStructure>("tail"));
  const FeatureStructure loop = cas.create("uima.cas.NonEmptyStringList");
  loop.set("tail", loop);
  two.set("a_StringList", loop);
  const FeatureStructure open = cas.create("uima.cas.NonEmptyIntegerList");
  open.set("head", 3);
  one.set("a_IntegerList", open);
  for (const FeatureStructure& each : {one, two}) cas.view("v").add_to_index(each);
  expect_survives(cas);
}

TEST(Xmi, WhatTheTypeSystemDoesNotKnowIsRefusedOrLeftOut) {
  const std::string xml =
      "<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\" xmlns:cas=\"http:///uima/cas.ecore\" "
      "xmlns:n=\"http:///uima/noNamespace.ecore\" xmlns:x=\"http:///un/known.ecore\">\n"
      "<n:Bare xmi:id=\"1\" text=\"t\" more=\"2\"><most>x</most></n:Bare>\n<x:Type xmi:id=\"2\" any=\"1\"/>\n"
      "<cas:FSArray xmi:id=\"3\" elements=\"1 2 0\"/>\n<cas:View members=\"1 2 3\"/></xmi:XMI>";
  EXPECT_THROW(read(all_ranges(), xml), Error);
  Warnings warnings;
  const auto cas = read(all_ranges(), xml, true, &warnings);
  EXPECT_EQ(cas->view("_InitialView").all().size(), 2U);
  const FeatureStructure array = cas->select("uima.cas.FSArray", "_InitialView").front();
  ASSERT_EQ(array.array_size(), 3U);
  EXPECT_TRUE(array.element(0));
  EXPECT_FALSE(array.element(1));
  EXPECT_EQ(warnings.texts().size(), 3U);
}

TEST(Xmi, ValuesMayStandInChildElements) {
  const auto cas =
      read(all_ranges(),
           "<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\" xmlns:cas=\"http:///uima/cas.ecore\" "
           "xmlns:t=\"http:///my/test.ecore\">\n<t:Thing xmi:id=\"1\"><a_Integer>5</a_Integer>"
           "<a_IntegerArray>1</a_IntegerArray><a_IntegerArray>2</a_IntegerArray><a_TOP href=\"#1\"/>"
           "<a_StringArray>  </a_StringArray></t:Thing><cas:View members=\"1\"/></xmi:XMI>");
  const FeatureStructure thing = cas->select("my.test.Thing", "_InitialView").front();
  EXPECT_EQ(thing.get<int32_t>("a_Integer"), 5);
  EXPECT_EQ(thing.array<int32_t>("a_IntegerArray").size(), 2U);
  EXPECT_EQ(thing.get<FeatureStructure>("a_TOP"), thing);
  EXPECT_EQ(thing.array<std::string>("a_StringArray")[0], "  ");
}

TEST(Xmi, BadInputIsOneLineWithItsPlace) {
  const auto system = all_ranges();
  const std::pair<const char*, const char*> cases[] = {
      {"<t:Thing", "no XML"},
      {"<t:Thing xmi:id='1' a_Integer='x'/>", "a.xmi:3"},
      {"<t:Thing xmi:id='1' a_Byte='300'/>", "does not fit"},
      {"<t:Thing xmi:id='1' a_ByteArray='0AF'/>", "no byte"},
      {"<t:Thing xmi:id='1' a_Boolean='yes'/>", "neither true nor false"},
      {"<t:Thing xmi:id='1' a_TOP='7'/>", "refers to 7"},
      {"<t:Thing xmi:id='1'/><t:Thing xmi:id='1'/>", "used twice"},
      {"<u:Thing xmi:id='1'/>", "prefix 'u'"},
      {"<t:None xmi:id='1'/>", "no type my.test.None"},
      {"<t:Thing xmi:id='1' none='1'/>", "no feature 'none'"},
      {"<cas:View sofa='4' members=''/>", "sofa 4"},
      {"<cas:Sofa xmi:id='4' sofaNum='1'/>", "no sofaID"},
  };
  for (const auto& [content, expected] : cases)
    EXPECT_THAT(refusal(system, content), HasSubstr(expected)) << content;
  EXPECT_THROW(read(system, "<html/>"), Error);
}

}  // namespace
}  // namespace loci::perception::cas
