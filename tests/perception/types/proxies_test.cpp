#include <gmock/gmock.h>

#include "mapping/base/text/json.h"
#include "perception/cas/json.h"
#include "perception/types/scene_cas.h"
#include "tests/perception/types/generated.h"

namespace loci::perception {
namespace {

using types::as;
using types::SceneCas;
using types::try_as;

/// A proxy extended by hand: two scales over one stored value.
class Thermometer : public tests::Temperature {
 public:
  using tests::Temperature::Temperature;
  double fahrenheit() const { return degrees.get() * 9 / 5 + 32; }
  void set_fahrenheit(double value) const { degrees.set((value - 32) * 5 / 9); }
};

TEST(Proxies, ReadAndWriteAsInTheListing) {
  cas::Cas cas(types::type_system());
  types::Scene scene = SceneCas(cas).create_scene();
  scene.timestamp.set(5);
  EXPECT_EQ(SceneCas(cas).scene().timestamp.get(), 5);
}

TEST(Proxies, ListsAreLikeVectors) {
  cas::Cas cas(types::type_system());
  const types::Scene scene = types::Scene::create(cas);
  const types::Cluster one = types::Cluster::create(cas);
  const types::Cluster two = types::Cluster::create(cas);
  EXPECT_TRUE(scene.clusters.empty());
  scene.clusters.push_back(one);
  scene.clusters.push_back(two);
  std::vector<types::Cluster> seen;
  for (types::Cluster each : scene.clusters) seen.push_back(each);
  EXPECT_EQ(seen, (std::vector{one, two}));
  EXPECT_EQ(scene.clusters[1], two);
  EXPECT_TRUE(scene.clusters.erase(one));
  EXPECT_EQ(scene.clusters.size(), 1U);
}

TEST(Proxies, AnnotationsAreFilteredByTypeWithSubtypes) {
  cas::Cas cas(types::type_system());
  const types::Cluster cluster = types::Cluster::create(cas);
  const auto location = types::TFLocationAnnotation::create(cas);
  const auto color = types::ColorAnnotation::create(cas);
  cluster.annotations.push_back(color);
  cluster.annotations.push_back(location);
  const auto found = cluster.annotations.filter<types::LocationAnnotation>();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], location);
  EXPECT_EQ(cluster.annotations.first<types::ColorAnnotation>(), color);
  EXPECT_FALSE(cluster.annotations.first<types::SizeAnnotation>());
}

TEST(Proxies, ConversionFromAFeatureStructureIsChecked) {
  cas::Cas cas(types::type_system());
  const cas::FeatureStructure structure = cas.create("loci.scene.Scene");
  EXPECT_NO_THROW(types::as<types::Identifiable>(structure));
  EXPECT_THROW(types::as<types::Cluster>(structure), Error);
  EXPECT_FALSE(types::try_as<types::Cluster>(structure));
}

TEST(Proxies, GrowByHandWithoutTouchingGeneratedFiles) {
  cas::Cas cas(types::type_system_with({LOCI_SOURCE_DIR "/tests/data/climate.xml"}));
  const Thermometer thermometer = types::as<Thermometer>(tests::Temperature::create(cas));
  thermometer.set_fahrenheit(212);
  EXPECT_DOUBLE_EQ(thermometer.degrees.get(), 100);
  thermometer.degrees.set(0);
  EXPECT_DOUBLE_EQ(thermometer.fahrenheit(), 32);
  types::Cluster::create(cas).annotations.push_back(thermometer);
}

TEST(Proxies, OfAUsersTypesHaveListsAndAllowedValues) {
  cas::Cas cas(types::type_system_with({LOCI_SOURCE_DIR "/tests/data/climate.xml"}));
  const auto temperature = tests::Temperature::create(cas);
  temperature.shown_in.set("celsius");
  EXPECT_THROW(temperature.shown_in.set("kelvin"), Error);
  EXPECT_EQ(temperature.shown_in.get(), "celsius");
  temperature.history.push_back(tests::Temperature::create(cas));
  temperature.history.push_back(temperature);
  EXPECT_EQ(temperature.history.to_vector().size(), 2U);
  temperature.remarks.push_back("warm");
  temperature.remarks.push_back("warmer");
  EXPECT_THAT(temperature.remarks.get(), testing::ElementsAre("warm", "warmer"));

  cas::Cas other(cas.shared_type_system());
  const Json json = cas::to_json(temperature);
  const auto back = types::as<tests::Temperature>(cas::from_json(other, json));
  EXPECT_EQ(back.history[1], back) << "a cycle through a list comes back";
  EXPECT_EQ(cas::to_json(back).dump(), json.dump());
}

TEST(SceneCas, KeepsImagesInTheirViews) {
  cas::Cas cas(types::type_system());
  const SceneCas scene_cas(cas);
  EXPECT_FALSE(scene_cas.has(SceneCas::kDepth));
  EXPECT_THROW(scene_cas.image(SceneCas::kDepth), Error);
  const types::Mat depth = types::Mat::create(cas);
  scene_cas.set_image(SceneCas::kDepth, depth);
  EXPECT_EQ(scene_cas.image(SceneCas::kDepth), depth);
  EXPECT_FALSE(scene_cas.has(SceneCas::kColor));
}

TEST(SceneCas, AddsClustersToSceneAndIndex) {
  cas::Cas cas(types::type_system());
  const SceneCas scene_cas(cas);
  EXPECT_THROW(scene_cas.scene(), Error);
  scene_cas.create_scene();
  EXPECT_THROW(scene_cas.create_scene(), Error);
  scene_cas.add_cluster(types::Cluster::create(cas));
  EXPECT_EQ(scene_cas.clusters().size(), 1U);
  EXPECT_EQ(types::select<types::Cluster>(cas).size(), 1U);
}

TEST(SceneCas, ReplacesACameraOfTheSameName) {
  cas::Cas cas(types::type_system());
  const SceneCas scene_cas(cas);
  scene_cas.create_scene();
  for (const int width : {640, 320}) {
    const auto camera = types::CameraInfo::create(cas);
    camera.name.set("depth");
    camera.width.set(width);
    scene_cas.set_camera(camera);
  }
  EXPECT_EQ(scene_cas.scene().cameras.size(), 1U);
  EXPECT_EQ(scene_cas.camera("depth").width.get(), 320);
  EXPECT_THROW(scene_cas.camera("color"), Error);
}

TEST(SceneCas, LogsWithLevelsOfTheTypeSystem) {
  cas::Cas cas(types::type_system());
  const SceneCas scene_cas(cas);
  scene_cas.create_scene();
  scene_cas.log("NormalEstimator", "info", "300000 normals", 12.5);
  scene_cas.log("ColorHistogram", "warning", "no colour image");
  EXPECT_THROW(scene_cas.log("X", "loud", "!"), Error);
  const auto entries = scene_cas.scene().log.get().entries.to_vector();
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].milliseconds.get(), 12.5);
  EXPECT_FALSE(entries[1].milliseconds.is_set());
}

/// Another look at the same CAS than SceneCas.
class LogCas {
 public:
  explicit LogCas(cas::Cas& cas) : scene_(SceneCas(cas).scene()) {}
  size_t lines() const { return scene_.log.get() ? scene_.log.get().entries.size() : 0; }

 private:
  types::Scene scene_;
};

TEST(SceneCas, IsOneOfSeveralFacadesOverOneCas) {
  cas::Cas cas(types::type_system());
  SceneCas(cas).create_scene();
  EXPECT_EQ(LogCas(cas).lines(), 0U);
  SceneCas(cas).log("A", "info", "done");
  EXPECT_EQ(LogCas(cas).lines(), 1U);
}

TEST(Types, InTheProgramAreThoseOfTheFiles) {
  const auto from_files = cas::TypeSystem::load({LOCI_SOURCE_DIR "/perception/types/belief.xml"});
  ASSERT_EQ(from_files->types().size(), types::type_system()->types().size());
  for (const cas::Type& type : from_files->types())
    EXPECT_EQ(types::type_system()->type(type.name()).features().size(), type.features().size())
        << type.name();
}

TEST(Types, OfOursMayGetMoreFeaturesFromAUser) {
  const std::string more =
      "<typeSystemDescription><imports><import name=\"loci.core\"/></imports><types><typeDescription>"
      "<name>loci.core.Identifiable</name><supertypeName>uima.cas.TOP</"
      "supertypeName><features><featureDescription>"
      "<name>owner</name><rangeTypeName>uima.cas.String</rangeTypeName></featureDescription></features>"
      "</typeDescription></types></typeSystemDescription>";
  auto sources = types::type_sources();
  sources.push_back({"more.xml", more});
  cas::Cas cas(cas::TypeSystem::load(sources, {}, {}));
  const auto scene = types::Scene::create(cas);
  scene.structure().set("owner", "me");
  scene.timestamp.set(7);
  EXPECT_EQ(scene.timestamp.get(), 7);
  EXPECT_EQ(scene.structure().get<std::string>("owner"), "me");
}

TEST(TypeSystemDocs, EveryTypeAndFeatureOfOursIsDescribed) {
  for (const cas::Type& type : types::type_system()->types()) {
    if (type.is_builtin()) continue;
    EXPECT_FALSE(type.description().empty()) << type.name();
    for (const cas::Feature& feature : type.own_features())
      EXPECT_FALSE(feature.description().empty()) << type.name() << "." << feature.name();
  }
}

}  // namespace
}  // namespace loci::perception
