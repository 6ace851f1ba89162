#include "mapping/world/semantic_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci::mapping {
namespace {

const char* kText =
    R"({"version": 1, "frame": "map", "map_from_input": [1, 2, 3, 0, 0, 0, 1], "links": {"drawer_3_handle":
  {"class": "handle", "confidence": 0.97, "geometry": {"centre": [1, 2, 3]}, "evidence": {"inliers": 412},
   "aliases": ["the top one"], "appliance": "fridge", "joint_evidence": "prior"}}, "made_by": "somebody"})";

TEST(SemanticMap, ReadsLinksAndKeepsWhatItDoesNotKnow) {
  const SemanticMap map = semantic_map_from_json(parse_json(kText, "m.json"), "m.json");
  const SemanticLink& link = map.links.at("drawer_3_handle");
  EXPECT_EQ(link.class_name, "handle");
  EXPECT_EQ(link.confidence, 0.97);
  EXPECT_EQ(link.evidence["inliers"], 412);
  EXPECT_EQ(link.aliases, std::vector<std::string>{"the top one"});
  EXPECT_EQ(link.appliance, "fridge");
  EXPECT_EQ(link.extra["joint_evidence"], "prior");
  EXPECT_EQ(map.map_from_input->translation(), Vector3d(1, 2, 3));
  EXPECT_EQ(map.extra["made_by"], "somebody");
}

TEST(SemanticMap, RoundTripIsEqualText) {
  const SemanticMap map = semantic_map_from_json(parse_json(kText, "m.json"), "m.json");
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "loci_map.semantic.json";
  write_semantic_map(map, path);
  EXPECT_EQ(to_json(read_semantic_map(path)).dump(), to_json(map).dump());
}

TEST(SemanticMap, RefusesWrongTypesWithTheirKey) {
  const std::vector<std::pair<std::string, std::string>> table = {
      {"[]", "JSON object"},
      {R"({"links": {}})", "version"},
      {R"({"version": 2, "links": {}})", "reads version 1"},
      {R"({"version": "1", "links": {}})", "version: must be a whole number"},
      {R"({"version": 1})", "links"},
      {R"({"version": 1, "links": []})", "links: must be an object"},
      {R"({"version": 1, "links": {"a": 3}})", "links.a: must be an object"},
      {R"({"version": 1, "links": {"a": {}}})", "links.a: has no class"},
      {R"({"version": 1, "links": {"a": {"class": 3}}})", "links.a.class: must be a text"},
      {R"({"version": 1, "links": {"a": {"class": "wall", "confidence": 2}}})", "from 0 to 1"},
      {R"({"version": 1, "links": {"a": {"class": "wall", "aliases": "x"}}})", "links.a.aliases"},
      {R"({"version": 1, "links": {}, "map_from_input": [1]})", "map_from_input"},
  };
  for (const auto& [text, reason] : table) {
    try {
      semantic_map_from_json(parse_json(text, "m.json"), "m.json");
      ADD_FAILURE() << "accepted " << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(reason));
    }
  }
}

TEST(SemanticMap, SidecarLiesBesideTheUrdf) {
  EXPECT_EQ(sidecar_path("maps/kitchen.urdf"), "maps/kitchen.semantic.json");
}

}  // namespace
}  // namespace loci::mapping
