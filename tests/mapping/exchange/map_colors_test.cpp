#include "mapping/exchange/map_colors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh_files.h"
#include "tests/mapping/exchange/photographed_map.h"

namespace loci::mapping::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::Pair;

cv::Mat decoded(const std::string& bytes) {
  return decode_image({bytes.begin(), bytes.end()}, "texture");
}

fs::path folder_with(const std::map<std::string, std::string>& files) {
  const fs::path folder = fs::path(testing::TempDir()) / "loci_map_colors";
  fs::create_directories(folder / "textures");
  for (const auto& [name, bytes] : files) write_file_atomically(folder / name, bytes);
  return folder;
}

/// Index of the channel that a pixel has most of: blue, green, red.
int hue_at(const cv::Mat& image, double column, double row) {
  const cv::Vec3b color =
      image.at<cv::Vec3b>(static_cast<int>(row * image.rows), static_cast<int>(column * image.cols));
  return static_cast<int>(std::max_element(color.val, color.val + 3) - color.val);
}

TEST(Textures, AreThePartsOfThePhotoThatShowTheFronts) {
  InterpretedMap map = photographed_map();
  const std::map<std::string, std::string> files = add_textures(map);
  EXPECT_THAT(
      files, ElementsAre(Pair("textures/door_1.jpg", testing::_), Pair("textures/door_1.obj", testing::_),
                         Pair("textures/drawer_1.jpg", testing::_), Pair("textures/drawer_1.obj", testing::_),
                         Pair("textures/textures.mtl", testing::_)));
  const cv::Mat door = decoded(files.at("textures/door_1.jpg"));
  EXPECT_NEAR(door.cols, 150, 3);
  EXPECT_NEAR(door.rows, 175, 3);
  EXPECT_EQ(hue_at(door, 0.25, 0.5), 2) << "red on the left";
  EXPECT_EQ(hue_at(door, 0.75, 0.5), 0) << "blue on the right";
  EXPECT_EQ(hue_at(door, 0.5, 0.05), 1) << "green above";
  const Link& drawer = *map.world.find_link("drawer_1_front");
  ASSERT_EQ(drawer.visuals.size(), 2U);
  EXPECT_LT((*drawer.visuals[0].material->color - Rgba(0.78F, 0.78F, 0, 1)).norm(), 0.05F);
  EXPECT_EQ(drawer.collisions.size(), 1U) << "simulators push the panel";
  const World read = parse_urdf(urdf_text(map.world), "map.urdf");
  EXPECT_EQ(std::get<Mesh>(read.find_link("door_1")->visuals[1].geometry).uri, "textures/door_1.obj");
}

TEST(Textures, StandUprightBeforeThePanel) {
  InterpretedMap map = photographed_map();
  const fs::path folder = folder_with(add_textures(map));
  Warnings warnings;
  const size_t link = map.world.link_index("door_1");
  const Visual& visual = map.world.links[link].visuals.back();
  const auto parts = load_mesh_parts(std::get<Mesh>(visual.geometry), {{}, folder}, warnings);
  ASSERT_TRUE(warnings.empty()) << warnings.texts().front();
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].texture, folder / "textures/door_1.jpg");
  const Isometry3d map_from_visual = root_from_links(map.world, {})[link] * visual.link_from_visual;
  for (size_t i = 0; i < parts[0].vertices.size(); ++i) {
    const Eigen::Vector2f at = parts[0].texture_coordinates[i];
    const Vector3d corner(at.x() < 0.5F ? -0.3 : 0.3, 1.399, at.y() < 0.5F ? 0.1 : 0.8);
    EXPECT_LT((map_from_visual * parts[0].vertices[i].cast<double>() - corner).norm(), 0.008);
  }
  const TriangleMesh mesh = triangulate(visual.geometry, {{}, folder}, warnings);
  EXPECT_GT(mesh.colors.at(0)[0], mesh.colors[0][1]) << "readers without textures show the mean colour";
}

TEST(Textures, OfLargeFrontsAreBounded) {
  InterpretedMap map = photographed_map();
  FacePhoto& photo = map.photos[0];
  cv::resize(photo.color, photo.color, {}, 8, 8, cv::INTER_NEAREST);
  photo.pixel_m /= 8;
  const cv::Mat door = decoded(add_textures(map).at("textures/door_1.jpg"));
  EXPECT_EQ(std::max(door.cols, door.rows), kMaxTextureSide);
}

TEST(Textures, WithoutPhotosThereAreNone) {
  InterpretedMap map = photographed_map();
  map.photos.clear();
  const std::string before = urdf_text(map.world);
  EXPECT_TRUE(add_textures(map).empty());
  EXPECT_EQ(urdf_text(map.world), before);
}

/// The photographed map with its textures; and one that an update wrote anew, its panels `wider_m` wider.
struct UpdatedPair {
  InterpretedMap before = photographed_map(), map;
  fs::path folder;

  explicit UpdatedPair(double wider_m) {
    folder = folder_with(add_textures(before));
    map.world = FurnishedMap().world;
    map.semantics = FurnishedMap().semantics;
    for (Link& link : map.world.links)
      if (link.name == "door_1") std::get<Box>(link.visuals[0].geometry).size.y() += wider_m;
    keep_textures(before.world, map);
  }
  const Link& door() const { return *map.world.find_link("door_1"); }
};

TEST(Textures, StayWhenAFrontIsWrittenAnew) {
  const UpdatedPair same(0);
  EXPECT_EQ(urdf_text(same.map.world), urdf_text([&] {
              World world = same.before.world;
              world.name = same.map.world.name;
              return world;
            }()));
  const UpdatedPair wider(0.03);
  ASSERT_EQ(wider.door().visuals.size(), 2U);
  Warnings warnings;
  const TriangleMesh mesh = triangulate(wider.door().visuals[1].geometry, {{}, wider.folder}, warnings);
  Eigen::AlignedBox3f extent;
  for (const Eigen::Vector3f& vertex : mesh.vertices) extent.extend(vertex);
  EXPECT_NEAR(extent.sizes().y(), std::get<Box>(wider.door().visuals[0].geometry).size.y(), 1e-4);
  EXPECT_EQ(UpdatedPair(0.2).door().visuals.size(), 1U) << "another front";
}

TEST(Textures, ArePhotosAgain) {
  UpdatedPair pair(0);
  Warnings warnings;
  pair.map.photos = photos_of_textures(pair.map, pair.folder, warnings);
  EXPECT_TRUE(warnings.empty());
  ASSERT_EQ(pair.map.photos.size(), 2U);
  for (const Front& front : fronts_of(pair.map.world, pair.map.semantics)) {
    const cv::Mat again = photo_of(pair.map, front), first = photo_of(pair.before, front);
    ASSERT_EQ(again.empty(), first.empty()) << front.name;
    if (front.name != "door_1") continue;
    EXPECT_NEAR(again.cols, first.cols, 2);
    EXPECT_NEAR(again.rows, first.rows, 2);
    EXPECT_EQ(hue_at(again, 0.25, 0.5), 2) << "red on the left";
    EXPECT_EQ(hue_at(again, 0.75, 0.5), 0) << "blue on the right";
    EXPECT_EQ(hue_at(again, 0.5, 0.05), 1) << "green above";
  }
}

TEST(Textures, ADamagedOneIsNamedAndLeftOut) {
  UpdatedPair pair(0);
  write_file_atomically(pair.folder / "textures/door_1.jpg", "damaged");
  Warnings warnings;
  EXPECT_EQ(photos_of_textures(pair.map, pair.folder, warnings).size(), 1U);
  EXPECT_FALSE(warnings.empty());
}

/// The counter's top in brown with a white object on it.
ScanSet colored_scan() {
  ScanSet scans;
  Scan& scan = scans.scans.emplace_back();
  for (int i = 0; i < 400; ++i) {
    ScanPoint point;
    const bool object = i < 150;
    point.position = {0.005F * static_cast<float>(i % 100), 1.6F, object ? 0.95F : 0.902F};
    point.r = object ? 255 : 150;
    point.g = object ? 255 : 100;
    point.b = object ? 255 : 50;
    scan.points.push_back(point);
  }
  return scans;
}

TEST(LinkColors, AreTheMedianOfThePointsOnALink) {
  InterpretedMap map = photographed_map(), other = map;
  color_links(colored_scan(), 1, map);
  color_links(colored_scan(), 2, other);
  const Material& counter = *map.world.find_link("counter_1")->visuals[0].material;
  EXPECT_LT((*counter.color - Rgba(150, 100, 50, 255) / 255).norm(), 0.01F);
  for (const char* unseen : {"floor", "door_1", "door_1_handle"})
    EXPECT_EQ(map.world.find_link(unseen)->visuals[0].material->color,
              photographed_map().world.find_link(unseen)->visuals[0].material->color)
        << unseen;
  EXPECT_EQ(urdf_text(map.world), urdf_text(other.world));
}

TEST(LinkColors, OfFrontsWithAPhotoStay) {
  const UpdatedPair pair(0);
  InterpretedMap map = pair.map;
  ScanSet scans = colored_scan();
  for (ScanPoint& point : scans.scans[0].points) point.position = {point.position.x() / 2, 1.4F, 0.45F};
  color_links(scans, 1, map);
  EXPECT_EQ(*map.world.find_link("door_1")->visuals[0].material->color,
            *pair.door().visuals[0].material->color);
}

TEST(LinkColors, ComeFromScansInTheFrameOfTheMap) {
  InterpretedMap map = photographed_map();
  map.semantics.map_from_input = Isometry3d(Eigen::Translation3d(0, 0, 1));
  ScanSet scans = colored_scan();
  scans.levelled = true;
  color_links(scans, 1, map);
  EXPECT_LT(
      (*map.world.find_link("counter_1")->visuals[0].material->color - Rgba(150, 100, 50, 255) / 255).norm(),
      0.01F)
      << "the scans of an update are moved already";
}

struct Glb {
  Json json;
  std::string buffer;

  explicit Glb(const std::string& bytes) {
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    json = parse_json(bytes.substr(20, length), "glb");
    buffer = bytes.substr(28 + length);
  }
  const Json& node(const std::string& name) const {
    for (const Json& node : json["nodes"])
      if (node.value("name", "") == name) return node;
    throw Error("no node " + name);
  }
  std::string view(const Json& number) const {
    const Json& view = json["bufferViews"][number.get<size_t>()];
    return buffer.substr(view.value("byteOffset", size_t{0}), view["byteLength"].get<size_t>());
  }
};

TEST(MapGlb, HasANodePerLinkBelowThatOfItsJoint) {
  InterpretedMap map = photographed_map();
  const fs::path folder = folder_with(add_textures(map));
  Warnings warnings;
  const std::string bytes = glb_bytes(map.world, {{}, folder}, warnings);
  EXPECT_EQ(bytes, glb_bytes(map.world, {{}, folder}, warnings));
  EXPECT_TRUE(warnings.empty());
  const Glb glb(bytes);
  for (const Joint& joint : map.world.joints) {
    const Json& node = glb.node(joint.name);
    EXPECT_EQ(node["extras"]["type"], joint_type_name(joint.type));
    ASSERT_EQ(node["children"].size(), 1U);
    EXPECT_EQ(glb.json["nodes"][node["children"][0].get<size_t>()]["name"], joint.child);
  }
  const auto at = glb.node("door_1_joint")["translation"].get<std::vector<double>>();
  EXPECT_LT(
      (Vector3d(at.data()) - map.world.find_joint("door_1_joint")->parent_from_joint.translation()).norm(),
      1e-9);
  EXPECT_EQ(glb.json["meshes"][glb.node("door_1")["mesh"].get<size_t>()]["primitives"].size(), 2U);
}

TEST(MapGlb, HoldsTexturesAndOpensJoints) {
  InterpretedMap map = photographed_map();
  const std::map<std::string, std::string> files = add_textures(map);
  Warnings warnings;
  const Glb glb(glb_bytes(map.world, {{}, folder_with(files)}, warnings));
  ASSERT_EQ(glb.json["images"].size(), 2U);
  EXPECT_EQ(glb.view(glb.json["images"][1]["bufferView"]), files.at("textures/door_1.jpg"));
  ASSERT_EQ(glb.json["animations"].size(), 2U);
  const Json& opening = glb.json["animations"][0];
  EXPECT_EQ(opening["name"], "drawer_1_front_joint");
  EXPECT_EQ(opening["channels"][0]["target"]["path"], "translation");
  const Json& output = glb.json["accessors"][opening["samplers"][0]["output"].get<size_t>()];
  std::array<float, 6> moved{};
  std::memcpy(moved.data(), glb.view(output["bufferView"]).data(), sizeof moved);
  EXPECT_NEAR(moved[3], 0.42, 1e-6) << "along x of the front's frame";
}

TEST(MapGlb, MakesLargeTexturesSmaller) {
  const fs::path folder = folder_with(
      {{"wide.obj",
        "mtllib wide.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wide\nf 1/1 2/2 3/3\n"},
       {"wide.mtl", "newmtl wide\nKd 1 1 1\nmap_Kd wide.png\n"}});
  write_image(folder / "wide.png", cv::Mat(30, 4000, CV_8UC3, cv::Scalar(10, 20, 30)));
  World world;
  world.name = world.root = "map";
  Link& link = world.links.emplace_back();
  link.name = "map";
  link.visuals.push_back({"", Isometry3d::Identity(), Mesh{"wide.obj"}, {}});
  Warnings warnings;
  const Glb glb(glb_bytes(world, {{}, folder}, warnings));
  EXPECT_EQ(decoded(glb.view(glb.json["images"][0]["bufferView"])).cols, 2048);
  write_file_atomically(folder / "wide.png", "no image");
  const Glb plain(glb_bytes(world, {{}, folder}, warnings));
  EXPECT_FALSE(plain.json.contains("images"));
  EXPECT_EQ(warnings.texts().size(), 1U);
}

TEST(MapGlb, WithoutShapesIsRefused) {
  World world;
  world.root = world.links.emplace_back().name = "map";
  Warnings warnings;
  EXPECT_THROW(glb_bytes(world, {}, warnings), Error);
}

}  // namespace
}  // namespace loci::mapping::test
