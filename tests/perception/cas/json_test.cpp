#include "perception/cas/json.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "mapping/base/text/json.h"

namespace loci::perception::cas {
namespace {

const char* const kTypes = R"(<typeSystemDescription><types>
<typeDescription><name>All</name><supertypeName>uima.cas.TOP</supertypeName><features>
<featureDescription><name>boolean</name><rangeTypeName>uima.cas.Boolean</rangeTypeName></featureDescription>
<featureDescription><name>byte</name><rangeTypeName>uima.cas.Byte</rangeTypeName></featureDescription>
<featureDescription><name>short</name><rangeTypeName>uima.cas.Short</rangeTypeName></featureDescription>
<featureDescription><name>integer</name><rangeTypeName>uima.cas.Integer</rangeTypeName></featureDescription>
<featureDescription><name>long</name><rangeTypeName>uima.cas.Long</rangeTypeName></featureDescription>
<featureDescription><name>float</name><rangeTypeName>uima.cas.Float</rangeTypeName></featureDescription>
<featureDescription><name>double</name><rangeTypeName>uima.cas.Double</rangeTypeName></featureDescription>
<featureDescription><name>string</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription>
<featureDescription><name>booleans</name><rangeTypeName>uima.cas.BooleanArray</rangeTypeName></featureDescription>
<featureDescription><name>bytes</name><rangeTypeName>uima.cas.ByteArray</rangeTypeName></featureDescription>
<featureDescription><name>shorts</name><rangeTypeName>uima.cas.ShortArray</rangeTypeName></featureDescription>
<featureDescription><name>integers</name><rangeTypeName>uima.cas.IntegerArray</rangeTypeName></featureDescription>
<featureDescription><name>longs</name><rangeTypeName>uima.cas.LongArray</rangeTypeName></featureDescription>
<featureDescription><name>floats</name><rangeTypeName>uima.cas.FloatArray</rangeTypeName></featureDescription>
<featureDescription><name>doubles</name><rangeTypeName>uima.cas.DoubleArray</rangeTypeName></featureDescription>
<featureDescription><name>strings</name><rangeTypeName>uima.cas.StringArray</rangeTypeName></featureDescription>
<featureDescription><name>structures</name><rangeTypeName>uima.cas.FSArray</rangeTypeName></featureDescription>
<featureDescription><name>list</name><rangeTypeName>uima.cas.FSList</rangeTypeName></featureDescription>
<featureDescription><name>string_list</name><rangeTypeName>uima.cas.StringList</rangeTypeName></featureDescription>
<featureDescription><name>integer_list</name><rangeTypeName>uima.cas.IntegerList</rangeTypeName></featureDescription>
<featureDescription><name>float_list</name><rangeTypeName>uima.cas.FloatList</rangeTypeName></featureDescription>
<featureDescription><name>any</name><rangeTypeName>uima.cas.TOP</rangeTypeName></featureDescription>
<featureDescription><name>other</name><rangeTypeName>All</rangeTypeName></featureDescription>
</features></typeDescription></types></typeSystemDescription>)";

std::shared_ptr<const TypeSystem> type_system() {
  static const auto system = TypeSystem::load({{"all.xml", kTypes}}, {}, {});
  return system;
}

template <typename T>
Buffer<T> buffer(std::initializer_list<T> values) {
  return Buffer<T>::copy({values.begin(), values.size()});
}

FeatureStructure make_all(Cas& cas) {
  const FeatureStructure all = cas.create("All");
  all.set("boolean", true);
  all.set("byte", -128);
  all.set("short", -32768);
  all.set("integer", std::numeric_limits<int32_t>::min());
  all.set("long", std::numeric_limits<int64_t>::min() + 1);
  all.set("float", 0.1F);
  all.set("double", 0.1);
  all.set("string", "Käse \"und\" \n Brot");
  all.set_array("booleans", buffer<bool>({true, false, true}));
  all.set_array("bytes", buffer<uint8_t>({0, 255}));
  all.set_array("shorts", buffer<int16_t>({-5, 5}));
  all.set_array("integers", buffer<int32_t>({1, -2}));
  all.set_array("longs", buffer<int64_t>({std::numeric_limits<int64_t>::max()}));
  all.set_array("floats", buffer<float>({0.3F, std::nanf(""), -0.0F}));
  all.set_array("doubles", buffer<double>({kPi, -std::numeric_limits<double>::infinity(), 5e-324}));
  all.set_array("strings", buffer<std::string>({"", "two"}));
  all.set("structures", cas.create_array({all, FeatureStructure(), cas.create("All")}));
  all.list("list").push_back(all);
  all.list("string_list").assign_values(std::vector<std::string>{"x", "y"});
  all.list("integer_list").assign_values(std::vector<int32_t>{7});
  all.list("float_list").assign_values(std::vector<float>{0.5F});
  all.set("any", cas.create_array(buffer<float>({1})));
  all.set("other", all);
  return all;
}

struct Blobs : BlobSink, BlobSource {
  std::string put(std::string_view bytes) override {
    const std::string key = std::to_string(std::hash<std::string_view>()(bytes));
    kept[key] = std::make_shared<std::string>(bytes);
    return key;
  }
  Bytes get(const std::string& key) override {
    const auto found = kept.find(key);
    if (found == kept.end()) throw Error("no blob " + key);
    return {found->second, *found->second};
  }
  std::map<std::string, std::shared_ptr<std::string>> kept;
};

TEST(CasJson, EveryKindComesBackIdentical) {
  Cas cas(type_system());
  const Json json = to_json(make_all(cas));
  Cas other(type_system());
  const FeatureStructure back = from_json(other, parse_json(json.dump(), "text"));
  EXPECT_EQ(to_json(back).dump(), json.dump());
  EXPECT_EQ(back.get<int64_t>("long"), std::numeric_limits<int64_t>::min() + 1);
  EXPECT_EQ(back.get<float>("float"), 0.1F);
  EXPECT_EQ(back.get<std::string>("string"), "Käse \"und\" \n Brot");
  EXPECT_EQ(back.get<FeatureStructure>("other"), back);
  EXPECT_TRUE(std::isnan(back.array<float>("floats")[1]));
  EXPECT_TRUE(std::signbit(back.array<float>("floats")[2]));
  EXPECT_EQ(back.array<double>("doubles")[2], 5e-324);
  EXPECT_TRUE(back.array<bool>("booleans")[2]);
  EXPECT_EQ(back.list("string_list").values<std::string>().size(), 2U);
}

TEST(CasJson, FloatsHaveAsFewDigitsAsBringThemBack) {
  Cas cas(type_system());
  const FeatureStructure all = cas.create("All");
  all.set("float", 0.1F);
  EXPECT_THAT(to_json(all).dump(), testing::HasSubstr("\"float\":0.1}"));
  for (uint32_t bits = 1; bits < 0x7f800000U; bits += 9973 * 101) {
    const float value = std::bit_cast<float>(bits);
    all.set("float", value);
    Cas other(type_system());
    EXPECT_EQ(from_json(other, parse_json(to_json(all).dump(), "")).get<float>("float"), value);
  }
}

TEST(CasJson, SharedArraysStayShared) {
  Cas cas(type_system());
  const FeatureStructure one = cas.create("All"), two = cas.create("All");
  const FeatureStructure array = cas.create_array(buffer<float>({1, 2, 3}));
  one.set("floats", array);
  two.set("floats", array);
  one.set("other", two);
  Cas other(type_system());
  const FeatureStructure back = from_json(other, to_json(one));
  EXPECT_EQ(back.get<FeatureStructure>("floats"),
            back.get<FeatureStructure>("other").get<FeatureStructure>("floats"));
}

TEST(CasJson, LargeArraysGoToTheSinkAndAreUsedWithoutCopying) {
  Cas cas(type_system());
  const FeatureStructure all = cas.create("All");
  all.set_array("doubles", std::vector<double>(33, 0.25));
  all.set_array("floats", std::vector<float>(64, 0.25F));  // 256 bytes: stays
  Blobs blobs;
  const Json json = to_json(all, &blobs);
  EXPECT_EQ(blobs.kept.size(), 1U);
  Cas other(type_system());
  const FeatureStructure back = from_json(other, json, &blobs);
  EXPECT_EQ(static_cast<const void*>(back.array<double>("doubles").data()),
            blobs.kept.begin()->second->data());
  EXPECT_EQ(to_json(back, &blobs).dump(), json.dump());
  EXPECT_THROW(from_json(other, json), Error);

  const Json plain = to_json(all);
  EXPECT_THAT(plain.dump(), testing::HasSubstr("base64"));
  EXPECT_EQ(to_json(from_json(other, plain)).dump(), plain.dump());
}

TEST(CasJson, TextThatIsNoUtf8ComesBack) {
  Cas cas(type_system());
  const FeatureStructure all = cas.create("All");
  const std::string odd("\xff\x00 end \xc3", 8);
  all.set("string", odd);
  all.set_array("strings", std::vector<std::string>{odd, "#1"});
  Cas other(type_system());
  const FeatureStructure back = from_json(other, parse_json(to_json(all).dump(), ""));
  EXPECT_EQ(back.get<std::string>("string"), odd);
  EXPECT_EQ(back.array<std::string>("strings")[0], odd);
  EXPECT_EQ(back.array<std::string>("strings")[1], "#1");
}

TEST(CasJson, TextDoesNotDependOnTheOrderOfCreation) {
  std::vector<std::string> texts;
  for (const bool reverse : {false, true}) {
    Cas cas(type_system());
    std::vector<FeatureStructure> made;
    for (int i = 0; i < 5; ++i) made.push_back(cas.create("All"));
    if (reverse) std::reverse(made.begin(), made.end());
    for (int i = 0; i < 5; ++i) made[static_cast<size_t>(i)].set("integer", i == 4 ? 0 : i);
    made[0].set("structures",
                cas.create_array({made[4], made[1]}));  // 0 and 4 differ only in who refers to them
    for (const int i : reverse ? std::vector{3, 1, 4, 0, 2} : std::vector{0, 1, 2, 3, 4})
      cas.view(i % 2 == 0 ? "even" : "odd").add_to_index(made[static_cast<size_t>(i)]);
    for (const char* view : reverse ? std::array{"odd", "even"} : std::array{"even", "odd"})
      cas.view(view).set_sofa_text("a text");
    texts.push_back(to_json(cas).dump());
  }
  EXPECT_EQ(texts[0], texts[1]);
}

TEST(CasJson, AWholeCasHasViewsSofasAndIndexes) {
  Cas cas(type_system());
  const FeatureStructure all = make_all(cas);
  cas.view("color").set_sofa_data(cas.create_array(buffer<uint8_t>({1, 2})), "image/raw");
  cas.view("text").set_sofa_text("Hello");
  cas.view("far").set_sofa_uri("file:///x", "text/uri");
  cas.view("color").add_to_index(all);
  cas.view("empty");
  const Json json = to_json(cas);
  Cas other(type_system());
  EXPECT_TRUE(from_json(other, json).is_null());
  EXPECT_EQ(to_json(other).dump(), json.dump());
  EXPECT_EQ(other.view_names(), cas.view_names());
  EXPECT_EQ(other.view("color").sofa_data().elements<uint8_t>()[1], 2);
  EXPECT_EQ(other.view("text").sofa().get<std::string>("sofaString"), "Hello");
  EXPECT_EQ(other.select("All", "color").size(), 1U);
  EXPECT_THROW(from_json(other, json), Error) << "views with a sofa are not overwritten";
}

TEST(CasJson, DeletedStructuresAreNull) {
  Cas cas(type_system());
  const FeatureStructure one = cas.create("All"), two = cas.create("All");
  one.set("other", two);
  one.set("structures", cas.create_array({two, one}));
  two.remove();
  Cas other(type_system());
  const FeatureStructure back = from_json(other, to_json(one));
  EXPECT_FALSE(back.is_set("other"));
  EXPECT_TRUE(back.get<FeatureStructure>("structures").element(0).is_null());
}

TEST(CasJson, WhatDoesNotFitIsRefusedWithItsPlace) {
  const std::vector<std::pair<std::string, std::string>> table = {
      {R"({})", "structures"},
      {R"({"structures": [], "root": "#1"})", "#1"},
      {R"({"structures": [{"id": 1, "type": "None", "features": {}}], "root": "#1"})", "None"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"x": 1}}], "root": "#1"})", "#1.x"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"byte": 128}}], "root": "#1"})", "#1.byte"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"long": 9223372036854775808}}], "root": "#1"})",
       "#1.long"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"integer": 1.5}}], "root": "#1"})",
       "#1.integer"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"floats": "#1"}}], "root": "#1"})",
       "#1.floats"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"other": 5}}], "root": "#1"})", "#1.other"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"doubles": {"base64": "AAA="}}}], "root": "#1"})",
       "#1.doubles"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {}}, {"id": 1, "type": "All", "features": {}}]})",
       "twice"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"float": 1e300}}], "root": "#1"})",
       "#1.float"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {"floats": [1, -1e39]}}], "root": "#1"})",
       "#1.floats"},
      {R"({"structures": [{"id": 1, "type": "All", "features": {}, "extra": 4}], "root": "#1"})", "extra"},
      {R"({"structures": [], "views": [], "more": 1})", "more"},
  };
  for (const auto& [text, expected] : table) {
    Cas cas(type_system());
    try {
      from_json(cas, parse_json(text, ""));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(expected)) << text;
    }
  }
}

TEST(CasJson, DamagedTextIsRefusedOrReadButNeverCrashes) {
  Cas cas(type_system());
  const std::string text = to_json(make_all(cas)).dump();
  std::mt19937_64 random(7);
  const auto below = [&](size_t limit) { return static_cast<size_t>(random() % limit); };
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = text;
    for (size_t k = 0; k <= below(3); ++k) {
      const size_t at = below(damaged.size());
      if (below(2) == 0)
        damaged[at] = text[below(text.size())];
      else
        damaged.erase(at, 1 + below(20));
    }
    Cas other(type_system());
    try {
      to_json(from_json(other, parse_json(damaged, "damaged")));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace loci::perception::cas
