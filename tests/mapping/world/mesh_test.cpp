#include "mapping/world/mesh.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/world/mesh_files.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// Signed volume: positive when triangles are counter-clockwise seen from outside.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.vertices[a].cast<double>().dot(
        mesh.vertices[b].cast<double>().cross(mesh.vertices[c].cast<double>()));
  return sum / 6;
}

/// Whether every edge is met once in each direction.
bool closed(const TriangleMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end() || back->second != 1) return false;
  }
  return true;
}

fs::path folder_with(const std::string& name, const std::string& text) {
  const fs::path folder = fs::path(testing::TempDir()) / "loci_mesh_test" / "shapes";
  fs::create_directories((folder / name).parent_path());
  write_file_atomically(folder / name, text);
  return folder;
}

const std::string kTetrahedron =
    "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 3 2\nf 1 2 4\nusemtl blue\nf 1 4 3\nf "
    "2 3 4\n";

TEST(Mesh, PrimitivesAreClosedAndWoundOutwards) {
  Warnings warnings;
  const TriangleMesh box = triangulate(Box{{1, 2, 3}}, {}, warnings);
  EXPECT_TRUE(closed(box));
  EXPECT_NEAR(volume(box), 6, 1e-6);
  const TriangleMesh cylinder = triangulate(Cylinder{0.5, 2}, {}, warnings, 64);
  EXPECT_TRUE(closed(cylinder));
  EXPECT_NEAR(volume(cylinder), kPi * 0.25 * 2, 0.01);
  const TriangleMesh sphere = triangulate(Sphere{2}, {}, warnings, 64);
  EXPECT_TRUE(closed(sphere));
  EXPECT_NEAR(volume(sphere), 4.0 / 3 * kPi * 8, 0.3);
}

TEST(Mesh, ObjIsReadWithItsMaterialsAndScale) {
  folder_with("t.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  const fs::path folder = folder_with("t.obj", kTetrahedron);
  Warnings warnings;
  const TriangleMesh mesh = load_mesh({"t.obj", {2, 3, 4}}, {{}, folder}, warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(volume(mesh), 24.0 / 6, 1e-6);
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(std::ranges::count(mesh.colors, Rgba(1, 0, 0, 1)), 2);
  EXPECT_EQ(std::ranges::count(mesh.colors, Rgba(0, 0, 1, 1)), 2);
}

TEST(Mesh, ATexturedMaterialHasTheMeanColourOfItsImage) {
  folder_with("t.mtl", "newmtl red\nKd 1 1 1\nmap_Kd t.png\n");
  const fs::path folder = folder_with(
      "t.obj",
      "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n");
  cv::Mat image(2, 2, CV_8UC3, cv::Scalar(0, 0, 255));
  image.row(1).setTo(cv::Scalar(0, 0, 0));
  write_image(folder / "t.png", image);
  Warnings warnings;
  const std::vector<MeshPart> parts = load_mesh_parts({"t.obj"}, {{}, folder}, warnings);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].texture, folder / "t.png");
  ASSERT_EQ(parts[0].texture_coordinates.size(), 3U);
  EXPECT_EQ(parts[0].texture_coordinates[2], Eigen::Vector2f(0, 1)) << "v upwards";
  const TriangleMesh mesh = load_mesh({"t.obj"}, {{}, folder}, warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_LT((mesh.colors.at(0) - Rgba(0.5F, 0, 0, 1)).norm(), 0.01F);
  fs::remove(folder / "t.png");
  EXPECT_EQ(load_mesh({"t.obj"}, {{}, folder}, warnings).colors.at(0), Rgba(1, 1, 1, 1));
}

TEST(Mesh, ImagesOutsideOfThePackageAreNotRead) {
  const fs::path folder = folder_with(
      "a/b/c/t.obj",
      "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n");
  const cv::Mat image(2, 2, CV_8UC3, cv::Scalar(0, 0, 255));
  for (const char* name : {"private.png", "a/shared.png"}) write_image(folder / name, image);
  const auto texture = [&](const std::string& name) {
    folder_with("a/b/c/t.mtl", "newmtl red\nKd 1 1 1\nmap_Kd " + name + "\n");
    Warnings warnings;
    return load_mesh_parts({"a/b/c/t.obj"}, {{}, folder}, warnings).at(0).texture;
  };
  EXPECT_EQ(texture("../../shared.png").filename(), "shared.png");
  EXPECT_EQ(texture("../../../private.png"), "");
  EXPECT_EQ(texture("../c/../../../private.png"), "");
  EXPECT_EQ(texture((folder / "private.png").string()), "");
}

TEST(Mesh, NamesOfFilesFollowTheUrdf) {
  World world;
  Link& link = world.links.emplace_back();
  for (const char* uri : {"textures/a.obj", "package://p/b.dae", "/c.stl"})
    link.visuals.push_back({"", Isometry3d::Identity(), Mesh{uri}, {}});
  move_mesh_names(world, "maps/old", "maps");
  const auto uri = [&](size_t i) { return std::get<Mesh>(world.links[0].visuals[i].geometry).uri; };
  EXPECT_EQ(uri(0), "old/textures/a.obj");
  EXPECT_EQ(uri(1), "package://p/b.dae");
  EXPECT_EQ(uri(2), "/c.stl");
  move_mesh_names(world, "", "maps");  // the folder of "map.urdf"
  EXPECT_EQ(uri(0), "../old/textures/a.obj");
}

TEST(Mesh, MirroredMeshStaysWoundOutwards) {
  const fs::path folder = folder_with("t.obj", kTetrahedron);
  Warnings warnings;
  EXPECT_NEAR(volume(load_mesh({"t.obj", {1, 1, -1}}, {{}, folder}, warnings)), 1.0 / 6, 1e-6);
}

TEST(Mesh, StlHasNoColourOfItsOwn) {
  const fs::path folder = folder_with("t.stl",
                                      "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 "
                                      "0\nvertex 0 1 0\nendloop\nendfacet\nendsolid t\n");
  Warnings warnings;
  const TriangleMesh mesh = load_mesh({"t.stl"}, {{}, folder}, warnings);
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_TRUE(mesh.colors.empty());
}

TEST(Mesh, PackagesAreFoundBelowPathsByNameAndAroundTheUrdf) {
  const fs::path folder = folder_with("t.obj", kTetrahedron);
  const Mesh mesh{"package://shapes/t.obj"};
  for (const MeshSearch& search : {MeshSearch{{folder.parent_path()}, {}}, MeshSearch{{folder}, {}},
                                   MeshSearch{{folder / ""}, {}}, MeshSearch{{}, folder / "urdf"}}) {
    Warnings warnings;
    EXPECT_EQ(load_mesh(mesh, search, warnings).triangles.size(), 4u);
    EXPECT_TRUE(warnings.empty());
  }
  Warnings warnings;
  EXPECT_EQ(load_mesh({"file://" + (folder / "t.obj").string()}, {}, warnings).triangles.size(), 4u);
}

TEST(Mesh, MissingAndBrokenFilesAreWarnedAboutByName) {
  const fs::path folder = folder_with("broken.dae", "<COLLADA><oops");
  for (const std::string uri : {"package://none/cup.stl", "cup.stl", "broken.dae"}) {
    Warnings warnings;
    EXPECT_TRUE(load_mesh({uri}, {{}, folder}, warnings).triangles.empty());
    ASSERT_EQ(warnings.texts().size(), 1u);
    EXPECT_THAT(warnings.texts()[0], testing::HasSubstr(uri));
  }
}

TEST(Mesh, ColladaKeepsItsOwnAxes) {
  const std::string collada = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="cm" meter="0.01"/><up_axis>UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 0 300</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  for (const std::string up : {"Z_UP", "Y_UP"}) {
    std::string text = collada;
    text.replace(text.find("<up_axis>UP"), 11, "<up_axis>" + up);
    const fs::path folder = folder_with("axes.dae", text);
    Warnings warnings;
    const TriangleMesh mesh = load_mesh({"axes.dae"}, {{}, folder}, warnings);
    ASSERT_EQ(mesh.vertices.size(), 3u) << (warnings.empty() ? "" : warnings.texts()[0]);
    EXPECT_TRUE(mesh.vertices[1].isApprox(Eigen::Vector3f(1, 0, 0), 1e-6f)) << up;
    EXPECT_TRUE(mesh.vertices[2].isApprox(Eigen::Vector3f(0, 0, 3), 1e-6f)) << up;
  }
}

}  // namespace
}  // namespace loci::mapping
