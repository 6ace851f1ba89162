#include "mapping/render/render.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>

#include "mapping/base/text/json.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

const PinholeCamera kCamera{160, 120, 146, 150, 79.3, 61.7};

World world_of(const std::string& links) {
  return parse_urdf("<robot name=\"w\">" + links + "</robot>", "test.urdf");
}

std::string link(const std::string& name, const std::string& geometry, const std::string& origin = "0 0 0",
                 const std::string& rpy = "0 0 0") {
  return "<link name=\"" + name + "\"><visual><origin xyz=\"" + origin + "\" rpy=\"" + rpy +
         "\"/><geometry>" + geometry + "</geometry></visual></link>";
}

RenderScene scene_of(const World& world) {
  RenderScene scene;
  Warnings warnings;
  scene.add(world, {}, Isometry3d::Identity(), warnings);
  return scene;
}

/// A square in its own z = 0 plane.
TriangleMesh square(double half) {
  const float h = static_cast<float>(half);
  TriangleMesh mesh;
  mesh.vertices = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Isometry3d at(double x, double y, double z, const Vector3d& rpy = Vector3d::Zero()) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation_from_rpy(rpy);
  pose.translation() = Vector3d(x, y, z);
  return pose;
}

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

bool same_view(const RenderedView& a, const RenderedView& b) {
  return same_bytes(a.depth, b.depth) && same_bytes(a.link, b.link) && same_bytes(a.normal, b.normal) &&
         same_bytes(a.color, b.color);
}

RenderOptions everything() {
  RenderOptions options;
  options.normals = options.colors = true;
  return options;
}

TEST(Render, TiltedPlaneHasAnalyticDepthAndNormalEverywhere) {
  const Isometry3d pose = at(0.1, -0.2, 2, {0.5, -0.7, 0.3});
  RenderScene scene;
  scene.add("plane", square(50), pose);
  const RenderedView view = scene.render(kCamera, Isometry3d::Identity(), everything());
  Vector3d normal = pose.linear().col(2);
  if (normal.z() > 0) normal = -normal;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const double z = normal.dot(pose.translation()) / normal.dot(kCamera.unproject(u, v, 1));
      if (z < 0 || z > 20) continue;
      ASSERT_NEAR(view.depth.at<float>(v, u), z, 2e-6 * z) << u << " " << v;
      const cv::Vec3f n = view.normal.at<cv::Vec3f>(v, u);
      ASSERT_LT((Vector3d(n[0], n[1], n[2]) - normal).norm(), 1e-6);
    }
}

TEST(Render, PixelCentresAreAtIntegers) {
  RenderScene scene;
  // A square whose image covers [49.6, 60.4] × [39.4, 50.6]: pixels 50 to 60 and 40 to 50.
  PinholeCamera camera{100, 100, 100, 100, 0, 0};
  TriangleMesh mesh = square(1);
  for (Eigen::Vector3f& p : mesh.vertices)
    p = {p.x() > 0 ? 0.604f : 0.496f, p.y() > 0 ? 0.506f : 0.394f, 1.f};
  scene.add("square", mesh, Isometry3d::Identity());
  const RenderedView view = scene.render(camera, Isometry3d::Identity());
  for (int v = 0; v < 100; ++v)
    for (int u = 0; u < 100; ++u)
      EXPECT_EQ(view.link.at<int32_t>(v, u) == 0, u >= 50 && u <= 60 && v >= 40 && v <= 50) << u << " " << v;
}

TEST(Render, BoxHasAnalyticDepth) {
  const Vector3d half(0.2, 0.3, 0.25);
  const Isometry3d pose = at(0.1, 0.05, 1.5, {0.4, 0.6, -0.2});
  World world = world_of(link("box", "<box size=\"0.4 0.6 0.5\"/>"));
  world.links[0].visuals[0].link_from_visual = pose;
  const RenderedView view = scene_of(world).render(kCamera, Isometry3d::Identity());
  int hits = 0;
  const Isometry3d box_from_camera = pose.inverse();
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d origin = box_from_camera.translation();
      const Vector3d ray = box_from_camera.linear() * kCamera.unproject(u, v, 1);
      double enter = 0, leave = 1e9;
      for (int k = 0; k < 3; ++k) {
        const double a = (-half[k] - origin[k]) / ray[k], b = (half[k] - origin[k]) / ray[k];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (std::abs(leave - enter) < 1e-5) continue;  // The silhouette itself.
      const float depth = view.depth.at<float>(v, u);
      ASSERT_EQ(std::isnan(depth), enter > leave);
      if (enter > leave) continue;
      ASSERT_NEAR(depth, enter, 1e-5);
      ++hits;
    }
  EXPECT_GT(hits, 1000);
}

TEST(Render, SphereIsWithinItsTessellation) {
  const double radius = 0.3;
  const Vector3d centre(0.05, -0.1, 1.2);
  const RenderedView view = scene_of(world_of(link("ball", "<sphere radius=\"0.3\"/>", "0.05 -0.1 1.2")))
                                .render(kCamera, Isometry3d::Identity(), everything());
  // 32 segments: facets lie inside the sphere by at most r (1 - cos²(π/32)).
  const double sag = radius * (1 - std::pow(std::cos(kPi / 32), 2));
  int hits = 0;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const float z = view.depth.at<float>(v, u);
      const Vector3d ray = kCamera.unproject(u, v, 1);
      const double distance = centre.cross(ray.normalized()).norm();
      if (distance > radius) {
        EXPECT_TRUE(std::isnan(z));
      } else if (distance < radius - sag) {
        const Vector3d p = z * ray - centre;
        EXPECT_LE(p.norm(), radius + 1e-6);
        EXPECT_GE(p.norm(), radius - sag - 1e-6);
        const cv::Vec3f n = view.normal.at<cv::Vec3f>(v, u);
        EXPECT_GT(Vector3d(n[0], n[1], n[2]).dot(p.normalized()), std::cos(2 * kPi / 32));
        ++hits;
      }
    }
  EXPECT_GT(hits, 3000);
}

TEST(Render, NearAndFarCutOffWhatLiesBeyond) {
  // A floor 1 m below the camera, from far behind it to far ahead: depth by row is 1 / slope.
  RenderScene scene;
  scene.add("floor", square(1000), at(0, 1, 0, {kPi / 2, 0, 0}));
  RenderOptions options;
  options.near_m = 3;
  options.far_m = 10;
  const RenderedView view = scene.render(kCamera, Isometry3d::Identity(), options);
  for (int v = 0; v < kCamera.height; ++v) {
    const double slope = (v - kCamera.cy) / kCamera.fy, z = slope > 0 ? 1 / slope : 1e9;
    for (int u = 0; u < kCamera.width; ++u) {
      const float depth = view.depth.at<float>(v, u);
      if (z < 2.999 || z > 10.001)
        ASSERT_TRUE(std::isnan(depth)) << u << " " << v;
      else
        ASSERT_NEAR(depth, z, 1e-5 * z);
    }
  }
}

TEST(Render, CameraInsideABoxSeesItsWalls) {
  const RenderedView view = scene_of(world_of(link("room", "<box size=\"4 4 4\"/>")))
                                .render(kCamera, at(0.3, 0.2, -0.5, {0.1, 0.5, 0.2}));
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) ASSERT_EQ(view.link.at<int32_t>(v, u), 0) << u << " " << v;
}

TEST(Render, SharedEdgesBelongToExactlyOneTriangle) {
  // A fan of slivers around a vertex on a pixel centre, edges through many pixel centres: each triangle drawn
  // alone must cover what the others leave, once.
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0.f, 0.f, 1.f);
  const PinholeCamera camera{64, 64, 32, 32, 32, 32};
  const int count = 48;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * kPi * i / count;
    mesh.vertices.emplace_back(static_cast<float>(3 * std::cos(a)), static_cast<float>(3 * std::sin(a)), 1.f);
  }
  std::vector<int> covered(64 * 64, 0);
  for (uint32_t i = 0; i < count; ++i) {
    TriangleMesh one;
    one.vertices = mesh.vertices;
    one.triangles = {{0, 1 + i, 1 + (i + 1) % count}};
    if (i % 3 == 0) std::swap(one.triangles[0][1], one.triangles[0][2]);
    RenderScene scene;
    scene.add("sliver", one, Isometry3d::Identity());
    const RenderedView view = scene.render(camera, Isometry3d::Identity());
    for (int p = 0; p < 64 * 64; ++p)
      covered[static_cast<size_t>(p)] += view.link.at<int32_t>(p / 64, p % 64) == 0;
  }
  EXPECT_EQ(std::ranges::count(covered, 1), 64 * 64);
}

TEST(Render, NearestSurfaceWinsAndTiesGoToTheLowerLink) {
  RenderScene scene;
  scene.add("behind", square(5), at(0, 0, 2));
  scene.add("twin", square(5), at(0, 0, 2));
  scene.add("front", square(0.1), at(0, 0, 1));
  const RenderedView view = scene.render(kCamera, Isometry3d::Identity());
  EXPECT_EQ(view.link.at<int32_t>(62, 79), 2);
  EXPECT_EQ(view.link.at<int32_t>(5, 5), 0);
  EXPECT_FLOAT_EQ(view.depth.at<float>(62, 79), 1);
}

TEST(Render, JointsPosesAndVisibilityMoveWhatIsSeen) {
  World world =
      world_of(link("body", "<box size=\"9 9 0.1\"/>") + link("drawer", "<box size=\"0.4 0.4 0.1\"/>") +
               "<joint name=\"slide\" type=\"prismatic\"><parent link=\"body\"/><child link=\"drawer\"/>"
               "<origin xyz=\"0 0 -0.1\"/><axis xyz=\"0 0 -1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" "
               "velocity=\"1\"/></joint>");
  RenderScene scene;
  Warnings warnings;
  const size_t part = scene.add(world, {}, at(0, 0, 3), warnings);
  const auto depth = [&] { return scene.render(kCamera, Isometry3d::Identity()).depth.at<float>(62, 79); };
  EXPECT_NEAR(depth(), 2.85, 1e-6);
  scene.set_joints(part, {{"slide", 0.5}});
  EXPECT_NEAR(depth(), 2.35, 1e-6);
  EXPECT_NEAR(scene.map_from_link(1).translation().z(), 2.4, 1e-12);
  scene.set_pose(part, at(0, 0, 4));
  EXPECT_NEAR(depth(), 3.35, 1e-6);
  scene.set_visible(part, false);
  EXPECT_TRUE(std::isnan(depth()));
  EXPECT_THROW(scene.set_joints(part, {{"slid", 0.5}}), Error);
}

TEST(Render, NamesRepeatOnlyWithTheirWorld) {
  const World world = world_of(link("box", "<sphere radius=\"1\"/>"));
  RenderScene scene;
  Warnings warnings;
  scene.add("floor", square(1), at(0, 0, 1));
  scene.add(world, {}, at(0, 0, 1), warnings);
  EXPECT_EQ(scene.link_names(), (std::vector<std::string>{"floor", "box"}));
  World other = world;
  other.name = "robot";
  scene.add(other, {}, at(0, 0, 1), warnings);
  EXPECT_EQ(scene.link_names(), (std::vector<std::string>{"floor", "w/box", "robot/box"}));
  scene.add(other, {}, at(0, 0, 1), warnings);
  EXPECT_EQ(scene.link_names(), (std::vector<std::string>{"floor", "w/box", "robot#2/box", "robot#3/box"}));
}

TEST(Render, MaterialColoursAreGivenUnshaded) {
  const World world = world_of(
      "<link name=\"a\"><visual><origin xyz=\"0 0 1\"/><geometry><box size=\"9 9 0.1\"/></geometry>"
      "<material name=\"m\"><color rgba=\"1 0.5 0 1\"/></material></visual></link>");
  const RenderedView view = scene_of(world).render(kCamera, Isometry3d::Identity(), everything());
  EXPECT_EQ(view.color.at<cv::Vec3b>(60, 60), cv::Vec3b(0, 128, 255));
}

/// Thousands of triangles in many parts, near and far, some through the near plane.
RenderScene clutter(bool reversed) {
  std::vector<std::pair<std::string, Isometry3d>> parts;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-2, 2);
  for (int i = 0; i < 60; ++i)
    parts.emplace_back("ball_" + std::to_string(i), at(place(random), place(random), 2.2 + place(random),
                                                       {place(random), place(random), 0}));
  if (reversed) std::ranges::reverse(parts);
  RenderScene scene;
  Warnings warnings;
  for (const auto& [name, pose] : parts) scene.add(name, triangulate(Sphere{0.35}, {}, warnings), pose);
  return scene;
}

TEST(Render, AnyNumberOfThreadsGivesTheSameBytes) {
  const RenderScene scene = clutter(false);
  const RenderedView one = scene.render(kCamera, Isometry3d::Identity(), everything(), 1);
  for (const int threads : {2, 3, 7, 120})
    EXPECT_TRUE(same_view(one, scene.render(kCamera, Isometry3d::Identity(), everything(), threads)))
        << threads;
}

TEST(Render, OrderOfPartsDoesNotMatter) {
  const RenderScene forth = clutter(false), back = clutter(true);
  const RenderedView a = forth.render(kCamera, Isometry3d::Identity(), everything());
  const RenderedView b = back.render(kCamera, Isometry3d::Identity(), everything());
  EXPECT_TRUE(same_bytes(a.depth, b.depth));
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const int i = a.link.at<int32_t>(v, u), j = b.link.at<int32_t>(v, u);
      ASSERT_EQ(i < 0, j < 0);
      if (i >= 0) {
        ASSERT_EQ(forth.link_names()[static_cast<size_t>(i)], back.link_names()[static_cast<size_t>(j)]);
      }
    }
}

/// Hundreds of closed bodies of many clusters each, some around the camera, some behind others, and a wall.
RenderScene crowd(int count) {
  RenderScene scene;
  Warnings warnings;
  scene.add("ball", triangulate(Sphere{0.12}, {}, warnings, 40), at(0, 0, 1.5));
  scene.add("wall", square(6), at(0, 0, 4, {0.3, -0.2, 0}));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int i = 0; i < count; ++i)
    scene.add_copy(0, at(1.5 * place(random), 1.2 * place(random), 1.4 + 1.5 * place(random),
                         {3 * place(random), 3 * place(random), 3 * place(random)}));
  return scene;
}

TEST(Render, CullingOfWhatIsHiddenChangesNoPixel) {
  const RenderScene scene = crowd(400);
  RenderOptions culled = everything(), all = everything();
  all.occlusion_culling = false;
  for (const Isometry3d& map_from_camera :
       {at(0, 0, 0), at(0.4, -0.2, 0.5, {0.1, 0.6, 0}), at(0, 0, 9, {3, 0, 0})}) {
    const RenderedView expected = scene.render(kCamera, map_from_camera, all);
    for (const int threads : {1, 2, 5})
      EXPECT_TRUE(same_view(expected, scene.render(kCamera, map_from_camera, culled, threads))) << threads;
  }
}

TEST(Render, CopyIsThePartItselfElsewhere) {
  const World world =
      world_of(link("body", "<box size=\"0.5 0.5 0.1\"/>") + link("drawer", "<box size=\"0.4 0.4 0.1\"/>") +
               "<joint name=\"slide\" type=\"prismatic\"><parent link=\"body\"/><child link=\"drawer\"/>"
               "<origin xyz=\"0 0 -0.1\"/><axis xyz=\"0 0 -1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" "
               "velocity=\"1\"/></joint>");
  RenderScene copied, added;
  Warnings warnings;
  for (RenderScene* scene : {&copied, &added}) scene->add(world, {}, at(-0.4, 0, 3), warnings);
  EXPECT_EQ(copied.add_copy(0, at(0.4, 0, 3, {0, 0.5, 0})),
            added.add(world, {}, at(0.4, 0, 3, {0, 0.5, 0}), warnings));
  for (RenderScene* scene : {&copied, &added}) scene->set_joints(1, {{"slide", 0.7}});
  EXPECT_EQ(copied.link_names(), added.link_names());
  EXPECT_TRUE(same_view(copied.render(kCamera, at(0, 0, 0), everything()),
                        added.render(kCamera, at(0, 0, 0), everything())));
  EXPECT_NEAR(copied.map_from_link(1).translation().z(), 2.9, 1e-12);  // The first one has not moved.
  EXPECT_THROW(copied.add_copy(2, at(0, 0, 0)), Error);
}

TEST(Render, TriangleWithoutNumbersIsLeftOut) {
  TriangleMesh mesh = square(1);
  mesh.vertices[3].x() = std::nanf("");
  RenderScene scene;
  scene.add("half", mesh, at(0, 0, 4));
  const cv::Mat link = scene.render(kCamera, at(0, 0, 0)).link;
  int seen = 0;
  for (int i = 0; i < link.rows * link.cols; ++i) seen += link.ptr<int32_t>()[i] == 0;
  EXPECT_NEAR(seen, kCamera.fx * kCamera.fy / 8, 80);  // Of the square half is left.
}

TEST(Render, ApartmentSeenFromAboveHasItsSupportsAtTheTrueHeights) {
  const std::filesystem::path data = std::filesystem::path(LOCI_SHARED_DIR) / "data";
  const std::filesystem::path folder = data / "iai_apartment";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  RenderScene scene;
  Warnings warnings;
  scene.add(read_urdf(folder / "apartment.urdf"), {{data}, folder}, Isometry3d::Identity(), warnings);
  EXPECT_TRUE(warnings.empty());
  int checked = 0;
  const Json truth = read_json(folder / "truth.json");
  for (const Json& support : truth["support_surfaces"]) {
    if (!support["main"].get<bool>()) continue;
    const double height = support["height"], x0 = support["aabb_min"][0], y0 = support["aabb_min"][1];
    const double x1 = support["aabb_max"][0], y1 = support["aabb_max"][1];
    // 30 cm above each corner, a little inwards: between the surface and what hangs over it.
    int here = 0;
    for (const double x : {x0 + 0.03, x1 - 0.03})
      for (const double y : {y0 + 0.03, y1 - 0.03}) {
        const RenderedView view = scene.render({3, 3, 100, 100, 1, 1}, at(x, y, height + 0.3, {kPi, 0, 0}));
        const int link_id = view.link.at<int32_t>(1, 1);
        if (link_id < 0 || scene.link_names()[static_cast<size_t>(link_id)] != support["link"]) continue;
        EXPECT_NEAR(view.depth.at<float>(1, 1), 0.3, 0.002) << support["name"];
        ++here;
      }
    EXPECT_GE(here, 2) << support["name"];
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

TEST(Render, BadCamerasAndRangesAreRefused) {
  const RenderScene scene = clutter(false);
  EXPECT_THROW(scene.render({0, 0, 1, 1, 0, 0}, Isometry3d::Identity()), Error);
  RenderOptions options;
  options.near_m = 0;
  EXPECT_THROW(scene.render(kCamera, Isometry3d::Identity(), options), Error);
}

}  // namespace
}  // namespace loci::mapping
