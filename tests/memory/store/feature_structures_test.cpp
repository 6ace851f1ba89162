#include "memory/store/feature_structures.h"

#include <gtest/gtest.h>

#include "mapping/base/text/json.h"
#include "perception/cas/json.h"
#include "perception/types/scene_cas.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

/// A type that only this test knows.
constexpr const char* kOwnTypes = R"(<?xml version="1.0"?>
<typeSystemDescription xmlns="http://uima.apache.org/resourceSpecifier"><types>
<typeDescription><name>my.Flavour</name><description>how it tastes, &lt;really&gt;</description>
  <supertypeName>uima.cas.String</supertypeName>
  <allowedValues><value><string>sweet</string></value><value><string>sour</string></value></allowedValues></typeDescription>
<typeDescription><name>my.Taste</name><description/><supertypeName>uima.cas.TOP</supertypeName><features>
  <featureDescription><name>flavour</name><description/><rangeTypeName>my.Flavour</rangeTypeName></featureDescription>
  <featureDescription><name>spectrum</name><description/><rangeTypeName>uima.cas.FloatArray</rangeTypeName></featureDescription>
  <featureDescription><name>strength</name><description/><rangeTypeName>uima.cas.Double</rangeTypeName></featureDescription>
  <featureDescription><name>next</name><description/><rangeTypeName>uima.cas.FSArray</rangeTypeName>
    <elementType>my.Taste</elementType></featureDescription>
</features></typeDescription></types></typeSystemDescription>)";

class FeatureStructureStore : public testing_support::TemporaryFolder {};

TEST_F(FeatureStructureStore, BringsAUsersOwnTypeBackIdenticalFromTheFileAlone) {
  Json before;
  Id id = 0;
  {
    const auto types = perception::cas::TypeSystem::load({{"own.xml", kOwnTypes}}, {}, {});
    perception::cas::Cas cas(types);
    const auto taste = cas.create("my.Taste"), other = cas.create("my.Taste");
    taste.set("flavour", "sour");
    taste.set("strength", 0.1);
    taste.set_array("spectrum", std::vector<float>(1000, 0.25F));
    taste.set("next", cas.create_array({other, taste}));
    before = perception::cas::to_json(taste);
    Store store = Store::open_write(file_);
    SceneTransaction scene(store, store.begin_run("test", "{}"));
    const Id scene_id = scene.add_scene({.time = 1});
    FeatureStructureWriter writer(scene, scene_id);
    id = writer.add(taste);
    writer.add(taste);
    scene.commit();
  }
  const Store store = Store::open_read(file_);
  const auto rows = store.feature_structures(1, "my.Taste");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].blobs, rows[1].blobs);
  EXPECT_EQ(rows[0].blobs.size(), 1U);
  const auto types = read_type_system(store, rows[0].type_system);
  perception::cas::Cas cas(types);
  const perception::cas::FeatureStructure back = read_feature_structure(store, id, cas);
  EXPECT_EQ(perception::cas::to_json(back), before);
  EXPECT_THROW(back.set("flavour", "salty"), Error);
  NoProgress quiet;
  EXPECT_TRUE(store.verify(quiet).problems.empty());
}

TEST_F(FeatureStructureStore, TypeSystemsAreStoredOnceAndReadBackEqual) {
  const auto types = perception::cas::TypeSystem::load({{"own.xml", kOwnTypes}}, {}, {});
  const std::string xml = type_system_xml(*types);
  EXPECT_EQ(type_system_xml(*perception::cas::TypeSystem::load({{"again.xml", xml}}, {}, {})), xml);
  Store store = Store::open_write(file_);
  SceneTransaction scene(store, store.begin_run("test", "{}"));
  EXPECT_EQ(scene.add_type_system(xml), scene.add_type_system(xml));
}

TEST_F(FeatureStructureStore, TheProjectsOwnTypeSystemReadsBackEqual) {
  const auto own = perception::types::type_system();
  const std::string xml = type_system_xml(*own);
  EXPECT_EQ(type_system_xml(*perception::cas::TypeSystem::load({{"again.xml", xml}}, {}, {})), xml);
}

}  // namespace
}  // namespace loci::memory
