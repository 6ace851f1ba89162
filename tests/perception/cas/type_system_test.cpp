#include "perception/cas/type_system.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "mapping/base/files.h"

namespace loci::perception::cas {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string type(const std::string& name, const std::string& super, const std::string& inside = "") {
  return "<typeDescription><name>" + name + "</name><supertypeName>" + super + "</supertypeName>" + inside +
         "</typeDescription>\n";
}

std::string feature(const std::string& name, const std::string& range, const std::string& element = "") {
  return "<featureDescription><name>" + name + "</name><rangeTypeName>" + range + "</rangeTypeName>" +
         (element.empty() ? "" : "<elementType>" + element + "</elementType>") + "</featureDescription>\n";
}

std::string features(const std::string& inside) {
  return "<features>" + inside + "</features>";
}

std::string allowed(const std::vector<std::string>& values) {
  std::string text = "<allowedValues>";
  for (const std::string& value : values) text += "<value><string>" + value + "</string></value>";
  return text + "</allowedValues>";
}

std::string system_xml(const std::string& types) {
  return "<typeSystemDescription>\n<types>\n" + types + "</types></typeSystemDescription>";
}

std::shared_ptr<const TypeSystem> load(const std::string& types) {
  return TypeSystem::load({{"test.xml", system_xml(types)}}, {}, {});
}

std::string refusal(const std::string& types) {
  try {
    load(types);
  } catch (const Error& error) {
    return error.what();
  }
  return "loaded";
}

const std::string kTop = "uima.cas.TOP";

TEST(TypeSystem, BringsUimasTypesAlong) {
  const auto system = TypeSystem::builtin();
  for (const char* name : {"TOP",
                           "Integer",
                           "Float",
                           "String",
                           "Boolean",
                           "Byte",
                           "Short",
                           "Long",
                           "Double",
                           "ArrayBase",
                           "FSArray",
                           "BooleanArray",
                           "ByteArray",
                           "ShortArray",
                           "IntegerArray",
                           "LongArray",
                           "FloatArray",
                           "DoubleArray",
                           "StringArray",
                           "ListBase",
                           "FSList",
                           "EmptyFSList",
                           "NonEmptyFSList",
                           "StringList",
                           "NonEmptyStringList",
                           "IntegerList",
                           "EmptyIntegerList",
                           "FloatList",
                           "NonEmptyFloatList",
                           "Sofa",
                           "AnnotationBase"})
    EXPECT_TRUE(system->find(std::string("uima.cas.") + name)) << name;
  const Type document = system->type("uima.tcas.DocumentAnnotation");
  EXPECT_TRUE(is_a(document, system->type("uima.tcas.Annotation")));
  EXPECT_TRUE(is_a(document, system->top()));
  EXPECT_FALSE(is_a(system->type("uima.tcas.Annotation"), document));
  EXPECT_EQ(document.features().size(), 4U);
}

TEST(TypeSystem, FeaturesAreInheritedAndComeFirst) {
  const auto system = load(type("B", "A", features(feature("second", "uima.cas.Long"))) +
                           type("A", kTop, features(feature("first", "uima.cas.Integer"))));
  const Type b = system->type("B");
  ASSERT_EQ(b.features().size(), 2U);
  EXPECT_EQ(b.features()[0].name(), "first");
  EXPECT_EQ(b.feature("first").owner(), system->type("A"));
  EXPECT_EQ(b.own_features().size(), 1U);
  EXPECT_EQ(system->subtypes(system->type("A")).size(), 2U);
}

TEST(TypeSystem, TwoDeclarationsMergeWhenTheyAgree) {
  const auto system =
      load(type("A", kTop, features(feature("one", "uima.cas.Integer"))) +
           type("A", kTop, features(feature("one", "uima.cas.Integer") + feature("two", "A"))) +
           type("uima.tcas.DocumentAnnotation", "uima.tcas.Annotation",
                features(feature("language", "uima.cas.String") + feature("pages", "uima.cas.Long"))));
  EXPECT_EQ(system->type("A").features().size(), 2U);
  EXPECT_TRUE(system->type("uima.tcas.DocumentAnnotation").find_feature("pages"));
}

TEST(TypeSystem, TwoDeclarationsThatDisagreeAreRefused) {
  EXPECT_THAT(refusal(type("A", kTop) + type("A", "uima.tcas.Annotation")), HasSubstr("test.xml:4"));
  EXPECT_THAT(refusal(type("A", kTop, features(feature("x", "uima.cas.Integer"))) +
                      type("A", kTop, features(feature("x", "uima.cas.Long")))),
              HasSubstr("'x' of type A"));
  EXPECT_THAT(refusal(type("A", kTop, features(feature("x", "uima.cas.FSArray", "A"))) +
                      type("A", kTop, features(feature("x", "uima.cas.FSArray", "uima.cas.Sofa")))),
              HasSubstr("elements"));
  EXPECT_THAT(
      refusal(type("S", "uima.cas.String", allowed({"a"})) + type("S", "uima.cas.String", allowed({"b"}))),
      HasSubstr("allowed values"));
  EXPECT_THAT(refusal(type("uima.tcas.Annotation", kTop)), HasSubstr("built-in"));
}

TEST(TypeSystem, InheritedFeaturesMayBeRepeatedButNotChanged) {
  EXPECT_NO_THROW(load(type("A", "uima.tcas.Annotation", features(feature("begin", "uima.cas.Integer")))));
  EXPECT_THAT(refusal(type("A", "uima.tcas.Annotation", features(feature("begin", "uima.cas.Long")))),
              HasSubstr("inherits"));
}

TEST(TypeSystem, BadOnesAreRefusedWithFileAndLine) {
  const std::vector<std::pair<std::string, std::string>> table = {
      {type("A", "B") + type("B", "C") + type("C", "A"), "inherits from itself"},
      {type("A", "A"), "inherits from itself"},
      {type("A", "Missing"), "Missing"},
      {type("A", kTop, features(feature("x", "Missing"))), "Missing"},
      {type("A", kTop, features(feature("x", "uima.cas.Strnig"))), "did you mean 'uima.cas.String'"},
      {type("A", kTop, features(feature("x", "uima.cas.FSList", "Missing"))), "Missing"},
      {type("A", "uima.cas.FloatArray"), "cannot inherit"},
      {type("A", "uima.cas.Integer"), "cannot inherit"},
      {type("A", "uima.cas.String", allowed({"x"})) + type("B", "A", allowed({"x"})), "cannot inherit"},
      {type("A", kTop, allowed({"x"})), "allowed values"},
      {type("A", "uima.cas.String", features(feature("x", "uima.cas.Long"))), "features"},
      {"<typeDescription><supertypeName>A</supertypeName></typeDescription>", "without <name>"},
      {"<typeDescription><name>A</name><fetures/></typeDescription>", "did you mean 'features'"},
      {type("A", kTop, "<features><featureDescription><name>x</name></featureDescription></features>"),
       "without <rangeTypeName>"},
      {"<typeDescription>", "well-formed"},
      {type("a.1A", kTop), "'1A' in type a.1A is not a name"},
      {type("A", kTop, features(feature("x y", "uima.cas.Long"))), "'x y' in feature x y is not a name"},
  };
  for (const auto& [types, expected] : table) {
    EXPECT_THAT(refusal(types), HasSubstr(expected)) << types;
    EXPECT_THAT(refusal(types), testing::ContainsRegex("test.xml:[0-9]+")) << types;
  }
  EXPECT_THROW(TypeSystem::load({{"x", "<other/>"}}, {}, {}), Error);
  EXPECT_THROW(TypeSystem::load({{"x", ""}}, {}, {}), Error);
  EXPECT_THROW(TypeSystem::load({fs::path("/nowhere/x.xml")}), Error);
}

TEST(TypeSystem, FeaturesAddedToATypeOfUimaAreListed) {
  const auto system = load(
      type("uima.tcas.Annotation", "uima.cas.AnnotationBase", features(feature("z", "uima.cas.Integer"))));
  EXPECT_THAT(types_text(*system), HasSubstr("1 types with 1 features"));
  EXPECT_THAT(types_text(*system), HasSubstr("uima.tcas.Annotation"));
}

TEST(TypeSystem, TypedArraysOfUima3AreFsArrays) {
  const auto system =
      load(type("A", kTop, features(feature("all", "A[]") + feature("some", "uima.cas.FSArray", "A[]"))));
  const Feature all = system->type("A").feature("all");
  EXPECT_EQ(all.range().name(), "uima.cas.FSArray");
  EXPECT_EQ(all.element_type().name(), "A");
  EXPECT_EQ(system->type("A").feature("some").element_type().name(), "A");
}

TEST(TypeSystem, EndlessHierarchiesAreRefused) {
  std::string types;
  for (int i = 0; i < 5000; ++i) types += type(fmt::format("T{}", i), fmt::format("T{}", i + 1));
  EXPECT_THAT(refusal(types), HasSubstr("levels"));
}

class ImportedTypes : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "org" / "lib");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& imports, const std::string& types) const {
    std::ofstream(folder_ / name) << "<typeSystemDescription>\n<imports>" << imports << "</imports>\n<types>"
                                  << types << "</types></typeSystemDescription>";
  }
  const fs::path folder_ = fs::temp_directory_path() / fmt::format("loci_type_imports_{}", ::getpid());
};

TEST_F(ImportedTypes, AreFoundByLocationAndByNameAndReadOnce) {
  write("a.xml", R"(<import location="org/b.xml"/><import name="org.lib.c"/>)", type("A", "B"));
  write("org/b.xml", R"(<import location="../a.xml"/>)", type("B", "C"));
  write("org/lib/c.xml", R"(<import location="../../a.xml"/>)", type("C", kTop));
  const auto system = TypeSystem::load({folder_ / "a.xml"}, {folder_});
  EXPECT_TRUE(is_a(system->type("A"), system->type("C")));
}

TEST_F(ImportedTypes, AreRefusedWhenTheyAreNotThere) {
  write("a.xml", R"(<import location="b.xml"/>)", "");
  write("c.xml", R"(<import name="org.d"/>)", "");
  for (const char* name : {"a.xml", "c.xml"}) {
    try {
      TypeSystem::load({folder_ / name}, {folder_});
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string(name) + ":2"));
    }
  }
}

// Type systems of other projects (shared data).

fs::path shared(const std::string& relative) {
  return fs::path(LOCI_SHARED_DIR) / "data" / relative;
}

TEST(SharedTypeSystems, AllOfRoboSherlockLoad) {
  if (!fs::exists(shared("uima_types"))) GTEST_SKIP() << "needs uima_types of the shared data folder";
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(shared("uima_types/robosherlock"))) {
    EXPECT_NO_THROW(TypeSystem::load({entry.path()})) << entry.path();
    all.push_back(entry.path());
  }
  const auto system = TypeSystem::load(all);
  const Type hypothesis = system->type("rs.scene.ObjectHypothesis");
  EXPECT_TRUE(is_a(hypothesis, system->type("rs.core.Identifiable")));
  EXPECT_EQ(hypothesis.feature("annotations").element_type().name(), "rs.core.Annotation");
}

TEST(SharedTypeSystems, AllOfUimacppAreCompleteAndLoad) {
  if (!fs::exists(shared("uima_types"))) GTEST_SKIP() << "needs uima_types of the shared data folder";
  for (const auto& entry : fs::directory_iterator(shared("uima_types/uimacpp")))
    EXPECT_NO_THROW(TypeSystem::load({entry.path()})) << entry.path();
  const auto system = TypeSystem::load({shared("uima_types/uimacpp/testTypeSystem_withMultiRefs.xml")});
  const Feature links = system->type("org.apache.uima.testTypeSystem.EntityAnnotation").feature("links");
  EXPECT_TRUE(links.multiple_references_allowed());
  EXPECT_EQ(links.element_type().name(), "org.apache.uima.testTypeSystem.Link");
}

TEST(SharedTypeSystems, WithoutOneOfItsTypesATypeSystemIsRefusedByTheMissingName) {
  if (!fs::exists(shared("uima_types"))) GTEST_SKIP() << "needs uima_types of the shared data folder";
  std::string text = read_file(shared("uima_types/uimacpp/testTypeSystem.xml"));
  const std::string name = "<name>org.apache.uima.testTypeSystem.RelationArgs</name>";
  ASSERT_NE(text.find(name), std::string::npos);
  text.replace(text.find(name), name.size(), "<name>Other</name>");
  try {
    TypeSystem::load({{"partial.xml", text}}, {}, {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("org.apache.uima.testTypeSystem.RelationArgs"));
    EXPECT_THAT(error.what(), testing::ContainsRegex("partial.xml:[0-9]+"));
  }
}

TEST(SharedTypeSystems, ThoseOfUimasXmiCasesLoad) {
  if (!fs::exists(shared("uima_xmi"))) GTEST_SKIP() << "needs uima_xmi of the shared data folder";
  int count = 0;
  for (const auto& entry : fs::directory_iterator(shared("uima_xmi"))) {
    if (!entry.is_directory()) continue;
    EXPECT_NO_THROW(TypeSystem::load({entry.path() / "typesystem.xml"})) << entry.path();
    ++count;
  }
  EXPECT_EQ(count, 6);
}

}  // namespace
}  // namespace loci::perception::cas
