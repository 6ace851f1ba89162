#include "perception/types/scene_json.h"

#include <gtest/gtest.h>

#include "mapping/base/text/json.h"

namespace loci::perception::types {
namespace {

void relate(const SceneCas& scene, const char* name, const Identifiable& one, const Identifiable& other) {
  const auto relation = Relation::create(scene.cas());
  relation.name.set(name);
  relation.object1.set(one);
  relation.object2.set(other);
  relation.probability.set(0.75);
  scene.scene().relations.push_back(relation);
}

TEST(SceneJson, RelationsNameClustersByNumberAndSupportsByName) {
  cas::Cas cas(type_system());
  const SceneCas scene(cas);
  scene.create_scene();
  const auto support = PlanarSupport::create(cas);
  support.name.set("table_1");
  scene.add_support(support);
  std::vector<Cluster> clusters;
  for (int i = 0; i < 2; ++i) {
    clusters.push_back(Cluster::create(cas));
    clusters.back().centroid.set(Vector::create(cas));
    scene.add_cluster(clusters.back());
  }
  relate(scene, "left-of", clusters[1], clusters[0]);
  relate(scene, "on", clusters[0], support);
  const Json relations = to_json(scene)["relations"];
  ASSERT_EQ(relations.size(), 2U);
  EXPECT_EQ(relations[0],
            parse_json(R"({"name": "left-of", "object1": 2, "object2": 1, "probability": 0.75})", ""));
  EXPECT_EQ(relations[1]["object2"], "table_1");
}

}  // namespace
}  // namespace loci::perception::types
