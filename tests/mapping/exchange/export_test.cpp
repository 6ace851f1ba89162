#include <gmock/gmock.h>
#include <octomap/OcTree.h>
#include <tinyxml2.h>

#include <cstring>
#include <filesystem>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/exchange/formats/occupancy_grid.h"
#include "mapping/exchange/formats/owl.h"
#include "mapping/exchange/formats/ply.h"
#include "mapping/exchange/link_graph.h"
#include "tests/mapping/exchange/furnished_map.h"

namespace loci::mapping::test {
namespace {

using ::testing::HasSubstr;

std::vector<WorldTriangle> triangles_of(const World& world) {
  Warnings warnings;
  return loci::mapping::triangles_of(world, {}, warnings);
}

// OWL

struct Ontology {
  tinyxml2::XMLDocument document;
  std::map<std::string, const tinyxml2::XMLElement*> individuals;  ///< by name after the #
  std::set<std::string> declared;

  explicit Ontology(const std::string& text) {
    EXPECT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS);
    for (const auto* node = document.RootElement()->FirstChildElement(); node;
         node = node->NextSiblingElement()) {
      const std::string about = node->Attribute("rdf:about");
      if (std::strcmp(node->Name(), "owl:NamedIndividual") == 0)
        individuals[about.substr(about.find('#') + 1)] = node;
      else
        declared.insert(about);
    }
  }

  std::string class_of(const std::string& name) const {
    const std::string type = individuals.at(name)->FirstChildElement("rdf:type")->Attribute("rdf:resource");
    return type.substr(type.find('#') + 1);
  }

  std::set<std::string> related(const std::string& name, const std::string& property) const {
    std::set<std::string> names;
    const std::string element = "knowrob:" + property;
    for (const auto* node = individuals.at(name)->FirstChildElement(element.c_str()); node;
         node = node->NextSiblingElement(element.c_str())) {
      const std::string uri = node->Attribute("rdf:resource");
      names.insert(uri.substr(uri.find('#') + 1));
    }
    return names;
  }

  double number(const std::string& name, const std::string& property) const {
    return individuals.at(name)->FirstChildElement(("knowrob:" + property).c_str())->DoubleText(-1);
  }
};

TEST(Owl, LinksAreIndividualsOfTheirOwnNames) {
  const FurnishedMap map;
  const Ontology owl(owl_text(map.world, map.semantics, "kitchen", 0));
  const std::map<std::string, std::string> classes = {{"counter_1", "CounterTop"},
                                                      {"drawer_1_front", "Drawer"},
                                                      {"drawer_1_handle", "Handle"},
                                                      {"door_1", "Door"},
                                                      {"front_1", "FurnitureFront"},
                                                      {"drawer_1_bottom", "DrawerBottom"},
                                                      {"drawer_1_front_joint", "PrismaticJoint"},
                                                      {"door_1_joint", "HingedJoint"}};
  for (const auto& [name, class_name] : classes) {
    ASSERT_TRUE(owl.individuals.contains(name)) << name;
    EXPECT_EQ(owl.class_of(name), class_name) << name;
    EXPECT_EQ(owl.related(name, "describedInMap"), std::set<std::string>{"kitchen"}) << name;
  }
  for (const auto& [name, link] : map.semantics.links) EXPECT_TRUE(owl.individuals.contains(name)) << name;
}

TEST(Owl, TellsPartsPosesAndJoints) {
  const FurnishedMap map;
  const Ontology owl(owl_text(map.world, map.semantics, "kitchen", 0));
  EXPECT_TRUE(owl.related("drawer_1_front", "properPhysicalParts").contains("drawer_1_handle"));
  EXPECT_TRUE(owl.related("counter_1", "prismaticallyConnectedTo").contains("drawer_1_front"));
  EXPECT_TRUE(owl.related("counter_1", "hingedTo").contains("door_1"));
  EXPECT_NEAR(owl.number("pose_drawer_1_front", "m03"), -0.8, 1e-9);
  EXPECT_NEAR(owl.number("pose_drawer_1_front", "m13"), 1.4, 1e-9);
  EXPECT_NEAR(owl.number("pose_drawer_1_front", "m23"), 0.74, 1e-9);
  EXPECT_NEAR(owl.number("drawer_1_front", "widthOfObject"), 0.6, 1e-9);
  EXPECT_NEAR(owl.number("drawer_1_front", "depthOfObject"), 0.5, 1e-9);
  EXPECT_NEAR(owl.number("front_1", "depthOfObject"), 0.02, 1e-9);
  EXPECT_NEAR(owl.number("drawer_1_front_joint", "maxJointValue"), 0.42, 1e-9);
  EXPECT_NEAR(owl.number("direction_drawer_1_front_joint", "vectorY"), -1, 1e-9);
  EXPECT_NEAR(owl.number("door_1_joint", "turnRadius"), std::hypot(0.3, 0.035), 1e-9);
}

TEST(Owl, DeclaresAllThatItUsesAndPointsNowhereElse) {
  const FurnishedMap map;
  const Ontology owl(owl_text(map.world, map.semantics, "kitchen", 0));
  for (const auto& [name, node] : owl.individuals)
    for (const auto* property = node->FirstChildElement(); property;
         property = property->NextSiblingElement()) {
      const char* resource = property->Attribute("rdf:resource");
      if (resource == nullptr) continue;
      const std::string uri = resource;
      const bool known =
          owl.declared.contains(uri) || owl.individuals.contains(uri.substr(uri.find('#') + 1));
      EXPECT_TRUE(known) << name << " -> " << uri;
    }
}

TEST(Owl, AppliancesHaveTheirClass) {
  SemanticLink link;
  link.class_name = "cabinet";
  EXPECT_EQ(knowrob_class(link), "Cupboard");
  link.appliance = "fridge";
  EXPECT_EQ(knowrob_class(link), "Refrigerator");
}

// PLY

TEST(Ply, HoldsEveryTriangleWithItsColour) {
  World world;
  world.root = "map";
  Link link;
  link.name = "map";
  link.visuals.push_back({"", Isometry3d(Eigen::Translation3d(1, 0, 0)), Box{Vector3d(2, 2, 2)},
                          Material{"red", Rgba(1, 0, 0.2F, 1), ""}});
  world.links = {link};
  const std::string ply = ply_text(triangles_of(world));
  EXPECT_THAT(ply, HasSubstr("element vertex 36\n"));
  EXPECT_THAT(ply, HasSubstr("element face 12\n"));
  const size_t start = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size() - start, 36U * 15 + 12U * 13);
  float x = 0;
  std::memcpy(&x, ply.data() + start, sizeof x);
  EXPECT_TRUE(x == 0 || x == 2) << x;
  EXPECT_EQ(static_cast<uint8_t>(ply[start + 12]), 255);
  EXPECT_EQ(static_cast<uint8_t>(ply[start + 13]), 0);
  EXPECT_EQ(static_cast<uint8_t>(ply[start + 14]), 51);
}

TEST(Ply, HoldsTheReturnsOfScansInTheMapFrame) {
  ScanSet scans;
  Scan scan;
  scan.map_from_scan.translation() = Vector3d(0, 0, 1);
  scan.points.resize(2);
  scan.points[0].position = {1, 2, 3};
  scan.points[0].g = 7;
  scan.points[1].returned = false;
  scans.scans = {scan};
  const std::string ply = ply_text(scans);
  EXPECT_THAT(ply, HasSubstr("element vertex 1\n"));
  const size_t start = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size() - start, 19U);
  float z = 0;
  std::memcpy(&z, ply.data() + start + 8, sizeof z);
  EXPECT_EQ(z, 4);
  EXPECT_EQ(ply[start + 17], 7);
}

// Occupancy grid and OctoMap

Occupancy at(const OccupancyGrid& grid, double x, double y) {
  const Vector2d cell = (Vector2d(x, y) - grid.origin) / grid.resolution;
  return grid.at(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
}

/// A scanner in a closed room of 4 m × 4 m: returns from its walls, but none from a dark part of one, and a
/// few through a slit in another, high above the floor beyond.
ScanSet closed_room() {
  ScanSet set;
  set.range_max = 10;
  Scan& scan = set.scans.emplace_back();
  scan.map_from_scan.translation() = Vector3d(0, 0, 1);
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  for (double azimuth = -180; azimuth < 180; azimuth += 0.5)
    for (double elevation = -20; elevation <= 10; elevation += 1) {
      const double a = azimuth * kDegree, e = elevation * kDegree;
      const Vector3d ray(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      ScanPoint point;
      double range = 2 / std::max(std::abs(ray.x()), std::abs(ray.y()));
      if (std::abs(azimuth) < 5) range = 10, point.returned = false;  // dark
      if (std::abs(azimuth - 90) < 4 && elevation > 4) range = 6;     // a slit
      point.position = (range * ray).cast<float>();
      scan.points.push_back(point);
    }
  return set;
}

TEST(Grid, OfScansEndsWhereTheRoomEnds) {
  const OccupancyGrid grid = occupancy_grid(closed_room(), {});
  EXPECT_EQ(at(grid, 0, 0), Occupancy::free);
  EXPECT_EQ(at(grid, -1.8, 1.5), Occupancy::free);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const Vector2d middle = grid.origin + grid.resolution * Vector2d(x + 0.5, y + 0.5);
      EXPECT_TRUE(middle.cwiseAbs().maxCoeff() < 2.1 || grid.at(x, y) != Occupancy::free)
          << middle.transpose();
    }
}

TEST(Grid, FurnitureIsOccupiedFloorIsFreeTheRestUnknown) {
  const FurnishedMap map;
  Warnings warnings;
  const OccupancyGrid grid = occupancy_grid(triangles_of(map.world), {}, warnings);
  EXPECT_EQ(at(grid, 0, 0), Occupancy::free);
  EXPECT_EQ(at(grid, 0, 1.7), Occupancy::occupied);       // the counter's top
  EXPECT_EQ(at(grid, -0.8, 1.375), Occupancy::occupied);  // a handle stands out
  EXPECT_EQ(at(grid, 0, 1.2), Occupancy::free);
  EXPECT_EQ(at(grid, 2.2, 0), Occupancy::unknown);
  EXPECT_TRUE(warnings.empty());
}

TEST(Grid, WorldWithoutFloorStandsOnOne) {
  FurnishedMap map;
  std::erase_if(map.world.joints, [](const Joint& joint) { return joint.child == "floor"; });
  std::erase_if(map.world.links, [](const Link& link) { return link.name == "floor"; });
  Warnings warnings;
  GridOptions above_all;
  above_all.min_height_m = 1;
  const OccupancyGrid grid = occupancy_grid(triangles_of(map.world), above_all, warnings);
  EXPECT_FALSE(warnings.empty());
  EXPECT_EQ(at(grid, 0, 1.7), Occupancy::free);
  EXPECT_EQ(at(grid, 0, 1.1), Occupancy::unknown);
}

TEST(Grid, WhatARobotDrivesOverOrUnderIsNoObstacle) {
  const FurnishedMap map;
  Warnings warnings;
  GridOptions options;
  options.max_height_m = 0.05;
  options.min_height_m = 0.02;
  EXPECT_EQ(at(occupancy_grid(triangles_of(map.world), options, warnings), 0, 1.7), Occupancy::free);
  options.max_height_m = 1.5;
  EXPECT_EQ(at(occupancy_grid(triangles_of(map.world), options, warnings), 0, 1.7), Occupancy::occupied);
  options.min_height_m = 2;
  EXPECT_THROW(occupancy_grid(triangles_of(map.world), options, warnings), Error);
}

TEST(Grid, MapServersImageHasTheHighestRowFirst) {
  OccupancyGrid grid;
  grid.width = 2;
  grid.height = 2;
  grid.origin = Vector2d(-1, 0.5);
  grid.cells = {Occupancy::occupied, Occupancy::free, Occupancy::unknown, Occupancy::free};
  const std::string pgm = pgm_text(grid);
  EXPECT_TRUE(pgm.starts_with("P5\n"));
  const std::string pixels = pgm.substr(pgm.size() - 4);
  EXPECT_EQ(pixels, "\xcd\xfe" + std::string(1, '\0') + "\xfe");
  const std::string yaml = grid_yaml(grid, "floor.pgm");
  EXPECT_THAT(yaml, HasSubstr("image: floor.pgm\n"));
  EXPECT_THAT(yaml, HasSubstr("origin: [-1, 0.5, 0]\n"));
  EXPECT_THAT(yaml, HasSubstr("resolution: 0.05\n"));
}

TEST(Octomap, HoldsEverySurfaceOfTheMap) {
  const FurnishedMap map;
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path path = folder.path() / "surfaces.bt";
  const std::vector<WorldTriangle> triangles = triangles_of(map.world);
  write_surface_tree(triangles, 0.05, path);
  octomap::OcTree tree(0.1);
  ASSERT_TRUE(tree.readBinary(path.string()));
  EXPECT_DOUBLE_EQ(tree.getResolution(), 0.05);
  for (const WorldTriangle& triangle : triangles) {
    const Vector3d middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3;
    // A face on a voxel's border belongs to the voxel on either side.
    const auto occupied = [&](const Vector3d& point) {
      const octomap::OcTreeNode* node = tree.search(point.x(), point.y(), point.z());
      return node != nullptr && tree.isNodeOccupied(node);
    };
    EXPECT_TRUE(occupied(middle + 1e-3 * triangle.normal) || occupied(middle - 1e-3 * triangle.normal));
  }
  EXPECT_EQ(tree.search(0.0, 0.0, 0.5), nullptr);  // nobody said that it is free
}

TEST(Octomap, ColumnsOfATreeAreAGrid) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.55F), true);
  tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.75F), false);
  tree.updateNode(octomap::point3d(0.15F, 0.05F, 0.55F), false);
  tree.updateNode(octomap::point3d(0.25F, 0.05F, 2.55F), true);  // too high
  const OccupancyGrid grid = occupancy_grid(tree, {});
  EXPECT_EQ(at(grid, 0.05, 0.05), Occupancy::occupied);
  EXPECT_EQ(at(grid, 0.15, 0.05), Occupancy::free);
  EXPECT_EQ(at(grid, 0.25, 0.05), Occupancy::unknown);
}

// Link graph

TEST(LinkGraph, ShowsLinksAsBoxesAndMovingJointsAsEllipses) {
  const FurnishedMap map;
  const std::string svg = link_graph_svg(map.world, map.semantics, "");
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(svg.c_str()), tinyxml2::XML_SUCCESS);
  size_t boxes = 0, ellipses = 0;
  for (const auto* node = document.RootElement()->FirstChildElement(); node;
       node = node->NextSiblingElement()) {
    boxes += std::strcmp(node->Name(), "rect") == 0 && node->Attribute("rx") != nullptr;
    ellipses += std::strcmp(node->Name(), "ellipse") == 0;
  }
  EXPECT_EQ(boxes, map.world.links.size());
  EXPECT_EQ(ellipses, 2U);
  for (const Link& link : map.world.links) EXPECT_THAT(svg, HasSubstr(">" + link.name + "</text>"));
}

TEST(LinkGraph, BeginsWhereItIsTold) {
  const FurnishedMap map;
  const std::string svg = link_graph_svg(map.world, map.semantics, "drawer_1_front");
  EXPECT_THAT(svg, HasSubstr("drawer_1_handle"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("counter_1")));
  EXPECT_THROW(link_graph_svg(map.world, map.semantics, "drawer_9_front"), Error);
}

ColoredMesh small_mesh() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 8, 7}},
          {{0, 1, 2}, {1, 2, 3}}};
}

TEST(ColoredMeshFiles, PlyComesBackAsItWasWritten) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "room.ply";
  const ColoredMesh mesh = small_mesh();
  write_file_atomically(file, ply_text(mesh));
  const ColoredMesh read = read_ply_mesh(file);
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.colors, mesh.colors);
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(ColoredMeshFiles, DamagedPlyIsRefused) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "damaged_room.ply";
  const std::string whole = ply_text(small_mesh());
  std::string out_of_range = whole, other_count = whole;
  out_of_range[out_of_range.size() - 2] = 1;  // a corner beyond the vertices
  other_count.replace(other_count.find("vertex 4"), 8, "vertex 9");
  for (const std::string& bytes :
       {std::string(), std::string("ply\nelement vertex"), whole.substr(0, whole.size() - 1), whole + "x",
        out_of_range, other_count}) {
    write_file_atomically(file, bytes);
    EXPECT_THROW(read_ply_mesh(file), Error) << bytes.size();
  }
}

TEST(ColoredMeshFiles, GlbHoldsOneMeshThatStandsUpright) {
  const std::string bytes = glb_bytes(small_mesh());
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  uint32_t length = 0, json_length = 0;
  std::memcpy(&length, bytes.data() + 8, 4);
  std::memcpy(&json_length, bytes.data() + 12, 4);
  EXPECT_EQ(length, bytes.size());
  const Json json = parse_json(bytes.substr(20, json_length), "glb");
  EXPECT_EQ(json["accessors"][0]["count"], 4);
  EXPECT_EQ(json["accessors"][2]["count"], 6);
  EXPECT_EQ(json["accessors"][0]["max"], Json({1.0, 1.0, 1.0}));
  const auto turn = json["nodes"][0]["rotation"].get<std::vector<double>>();
  const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  EXPECT_TRUE((rotation * Vector3d::UnitZ()).isApprox(Vector3d::UnitY(), 1e-6)) << "z up becomes y up";
}

}  // namespace
}  // namespace loci::mapping::test
