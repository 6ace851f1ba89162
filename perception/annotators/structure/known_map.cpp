#include "perception/annotators/structure/known_map.h"

#include <fnmatch.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "mapping/base/text/csv.h"
#include "mapping/world/urdf.h"

namespace loci::perception {
namespace {

bool matches(const std::string& text, const std::vector<std::string>& patterns) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
    return fnmatch(pattern.c_str(), text.c_str(), 0) == 0;
  });
}

struct Facet {
  std::array<Vector3d, 3> corners;  ///< map frame
  double area = 0;
  double height = 0;
};

/// The triangles of a link that look up.
std::vector<Facet> upper_facets(const KnownMap& map, const mapping::Link& link,
                                const Isometry3d& map_from_link) {
  std::vector<Facet> facets;
  Warnings ignored;  // Missing meshes were warned about when the map was loaded.
  for (const mapping::Visual& visual : link.visuals) {
    const Isometry3d map_from_visual = map_from_link * visual.link_from_visual;
    const mapping::TriangleMesh mesh = triangulate(visual.geometry, map.meshes, ignored);
    for (const auto& triangle : mesh.triangles) {
      Facet facet;
      for (size_t i = 0; i < 3; ++i)
        facet.corners[i] = map_from_visual * mesh.vertices[triangle[i]].cast<double>();
      const Vector3d normal =
          (facet.corners[1] - facet.corners[0]).cross(facet.corners[2] - facet.corners[0]);
      facet.area = normal.norm() / 2;
      facet.height = (facet.corners[0].z() + facet.corners[1].z() + facet.corners[2].z()) / 3;
      if (facet.area > 0 && normal.z() > 0.95 * normal.norm()) facets.push_back(facet);
    }
  }
  return facets;
}

/// The highest level at which a good part of what looks up lies.
std::optional<double> top_height(const std::vector<Facet>& facets) {
  std::map<int, double> area_at;
  for (const Facet& facet : facets) area_at[static_cast<int>(std::lround(facet.height * 100))] += facet.area;
  double most = 0;
  for (const auto& [level, area] : area_at) most = std::max(most, area);
  for (auto it = area_at.rbegin(); it != area_at.rend(); ++it)
    if (it->second >= 0.3 * most && it->second > 1e-4) return it->first / 100.0;
  return std::nullopt;
}

using Corners = std::vector<cv::Point2f>;

/// The outer outline of the triangles whose corners follow each other, where they are one piece but for
/// narrow joints; empty otherwise. Cut-outs within do not count.
Corners union_of(const Corners& triangles) {
  constexpr float kJoint = 0.05f, kMaxCells = 4000;  // metres; cells across
  const cv::Rect2f extent = cv::boundingRect(triangles);
  const float cell = std::max(0.005f, std::max(extent.width, extent.height) / kMaxCells);
  const int reach = static_cast<int>(std::ceil(kJoint / cell)), border = reach + 1;
  const cv::Point2f origin = extent.tl() - cv::Point2f(1, 1) * (cell * static_cast<float>(border));
  cv::Mat mask = cv::Mat::zeros(static_cast<int>(extent.height / cell) + 2 * border + 1,
                                static_cast<int>(extent.width / cell) + 2 * border + 1, CV_8U);
  for (size_t i = 0; i < triangles.size(); i += 3) {
    std::array<cv::Point, 3> pixels;
    for (size_t k = 0; k < 3; ++k) pixels[k] = (triangles[i + k] - origin) / cell;
    cv::fillConvexPoly(mask, pixels.data(), 3, cv::Scalar(255));
  }
  // The square has the axes of the surface and leaves the inner corners as they are.
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U));
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  if (contours.size() != 1) return {};
  Corners outline;
  cv::approxPolyDP(cv::Mat(contours[0]), contours[0], 0.01 / static_cast<double>(cell), true);
  for (const cv::Point& pixel : contours[0]) {
    const cv::Point2f rough = cv::Point2f(pixel) * cell + origin;
    const auto nearest = std::ranges::min_element(
        triangles, {}, [&](const cv::Point2f& corner) { return cv::norm(corner - rough); });
    outline.push_back(cv::norm(*nearest - rough) < 0.02 ? *nearest : rough);
  }
  return outline;
}

/// The outline of triangles, counter-clockwise: their convex hull where they nearly fill it or come in
/// pieces, and where they go round a corner what they cover.
Corners outline_of(const Corners& triangles) {
  constexpr double kFills = 0.97;
  Corners hull, joined = union_of(triangles);
  cv::convexHull(triangles, hull);
  const bool fills = joined.size() < 4 || cv::contourArea(joined) > kFills * cv::contourArea(hull);
  Corners& outline = fills ? hull : joined;
  if (outline.size() >= 3 && cv::contourArea(outline, true) < 0) std::ranges::reverse(outline);
  return outline;
}

/// The drawer whose bottom a link is.
std::optional<SupportSurface::Drawer> drawer_of(const KnownMap& map, const mapping::Link& link,
                                                const std::vector<Isometry3d>& map_from_links,
                                                double bottom) {
  if (!map.class_of(link.name).starts_with("drawer")) return std::nullopt;
  const mapping::Joint* joint = map.world.parent_joint(link.name);
  while (joint != nullptr && joint->type != mapping::JointType::prismatic)
    joint = map.world.parent_joint(joint->parent);
  if (joint == nullptr) return std::nullopt;
  const size_t front = map.world.link_index(joint->child);
  double top = bottom;
  Warnings ignored;  // Missing meshes were warned about when the map was loaded.
  for (const mapping::Visual& visual : map.world.links[front].visuals)
    for (const Eigen::Vector3f& vertex : triangulate(visual.geometry, map.meshes, ignored).vertices)
      top = std::max(top, (map_from_links[front] * (visual.link_from_visual * vertex.cast<double>())).z());
  return SupportSurface::Drawer{joint->name, top - bottom};
}

std::optional<SupportSurface> surface_of(const KnownMap& map, const mapping::Link& link,
                                         const Isometry3d& map_from_link) {
  constexpr double kMinFilled = 0.1;  // of the outline
  const std::vector<Facet> facets = upper_facets(map, link, map_from_link);
  const auto level = top_height(facets);
  if (!level) return std::nullopt;
  Isometry3d map_from_top = Isometry3d::Identity();
  if (map_from_link.linear()(2, 2) > 0.95) map_from_top.linear() = map_from_link.linear();
  Corners corners;
  double height = 0;
  double area = 0;
  for (const Facet& facet : facets) {
    if (std::abs(facet.height - *level) > 0.015) continue;
    height += facet.area * facet.height;
    area += facet.area;
    for (const Vector3d& corner : facet.corners) {
      const Vector3d p = map_from_top.linear().transpose() * corner;
      corners.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
  }
  const Corners outline = outline_of(corners);
  // On the ends of legs, or on a frame, nothing can stand.
  if (outline.size() < 3 || area < kMinFilled * cv::contourArea(outline)) return std::nullopt;
  Eigen::AlignedBox2d extent;
  for (const cv::Point2f& p : outline) extent.extend(Vector2d(p.x, p.y));
  SupportSurface surface;
  surface.link = link.name;
  surface.class_name = map.class_of(link.name);
  map_from_top.translation() = map_from_top.linear() * Vector3d(extent.center().x(), extent.center().y(), 0);
  map_from_top.translation().z() = height / area;
  surface.link_from_top = map_from_link.inverse() * map_from_top;
  for (const cv::Point2f& p : outline) surface.outline.push_back(Vector2d(p.x, p.y) - extent.center());
  return surface;
}

}  // namespace

JointState KnownRobot::joints_at(TimeNs time) const {
  if (rows.empty()) return {};
  const auto after = std::ranges::upper_bound(rows, time, {}, &Row::time_ns);
  return after == rows.begin() ? rows.front().joints : std::prev(after)->joints;
}

std::vector<KnownRobot::Row> KnownRobot::read_joints(const std::filesystem::path& path,
                                                     const mapping::World& world) {
  const CsvTable table = CsvTable::read(path);
  const size_t joint = table.require_column("joint"), position = table.require_column("position");
  const int time = table.column("time_ns");
  std::map<TimeNs, JointState> changes;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& name = table.cell(row, joint);
    if (!world.find_joint(name))
      throw Error("the robot has no joint '" + name + "'", table.location(row),
                  "names are those of its URDF");
    changes[time < 0 ? 0 : table.integer(row, static_cast<size_t>(time))][name] = table.number(row, position);
  }
  std::vector<Row> rows;
  JointState joints;
  for (const auto& [at, changed] : changes) {
    for (const auto& [name, value] : changed) joints[name] = value;
    rows.push_back({at, joints});
  }
  return rows;
}

std::shared_ptr<KnownMap> KnownMap::load(const std::filesystem::path& urdf,
                                         const std::vector<std::filesystem::path>& package_paths,
                                         Warnings& warnings) {
  mapping::World world = mapping::read_urdf(urdf);
  mapping::SemanticMap semantics;
  if (const auto sidecar = mapping::sidecar_path(urdf); std::filesystem::exists(sidecar))
    semantics = mapping::read_semantic_map(sidecar);
  else
    warnings.add("the map has no sidecar " + sidecar.string() + ": classes are taken from the links' names");
  auto map = make(std::move(world), std::move(semantics), {package_paths, urdf.parent_path()}, warnings);
  map->path = urdf;
  return map;
}

std::shared_ptr<KnownMap> KnownMap::make(mapping::World world, mapping::SemanticMap semantics,
                                         mapping::MeshSearch meshes, Warnings& warnings) {
  auto map = std::make_shared<KnownMap>();
  map->world = std::move(world);
  map->semantics = std::move(semantics);
  map->meshes = std::move(meshes);
  map->part = map->scene.add(map->world, map->meshes, Isometry3d::Identity(), warnings);
  return map;
}

std::shared_ptr<KnownMap> KnownMap::robots_only(Warnings& warnings) {
  mapping::World world;
  world.name = world.root = "map";
  world.links.emplace_back().name = "map";
  return make(std::move(world), {}, {}, warnings);
}

bool KnownMap::has_geometry() const {
  return std::ranges::any_of(world.links, [](const mapping::Link& link) { return !link.visuals.empty(); });
}

void KnownMap::add_robot(const std::filesystem::path& urdf, const std::filesystem::path& joints,
                         const std::vector<std::filesystem::path>& package_paths, Warnings& warnings) {
  KnownRobot robot;
  robot.world = mapping::read_urdf(urdf);
  if (!joints.empty()) robot.rows = KnownRobot::read_joints(joints, robot.world);
  robot.part = scene.add(robot.world, {package_paths, urdf.parent_path()}, Isometry3d::Identity(), warnings);
  robots.push_back(std::move(robot));
}

void KnownMap::place_robots(TimeNs time, const JointState& joints, const std::string& camera_link,
                            const Isometry3d& map_from_camera) {
  for (const KnownRobot& robot : robots) {
    JointState state = robot.joints_at(time);
    for (const auto& [name, position] : joints)
      if (robot.world.find_joint(name)) state[name] = position;
    scene.set_joints(robot.part, state);
    Isometry3d map_from_root = Isometry3d::Identity();
    if (robot.world.find_link(camera_link))
      map_from_root = map_from_camera *
                      root_from_links(robot.world, state)[robot.world.link_index(camera_link)].inverse();
    scene.set_pose(robot.part, map_from_root);
    scene.set_visible(robot.part, true);
  }
}

void KnownMap::hide_robots() {
  for (const KnownRobot& robot : robots) scene.set_visible(robot.part, false);
}

bool KnownMap::robot_has_joint(const std::string& joint) const {
  return std::ranges::any_of(
      robots, [&](const KnownRobot& robot) { return robot.world.find_joint(joint) != nullptr; });
}

std::string KnownMap::class_of(const std::string& link) const {
  const auto it = semantics.links.find(link);
  if (it != semantics.links.end() && !it->second.class_name.empty()) return it->second.class_name;
  std::string name;
  std::stringstream words(link);
  for (std::string word; std::getline(words, word, '_');) {
    const bool number = !word.empty() && std::all_of(word.begin(), word.end(),
                                                     [](unsigned char c) { return std::isdigit(c) != 0; });
    if (number) continue;
    if (!name.empty()) name += '_';
    name += word;
  }
  return name;
}

std::vector<SupportSurface> KnownMap::support_surfaces(const std::vector<std::string>& patterns) const {
  std::vector<SupportSurface> surfaces;
  const std::vector<Isometry3d> map_from_links = root_from_links(world, {});
  for (size_t i = 0; i < world.links.size(); ++i) {
    const mapping::Link& link = world.links[i];
    if (!matches(link.name, patterns) && !matches(class_of(link.name), patterns)) continue;
    auto surface = surface_of(*this, link, map_from_links[i]);
    if (!surface) continue;
    const auto& names = scene.link_names();
    const auto at = std::find(names.begin(), names.end(), link.name);
    if (at == names.end()) continue;
    surface->link_id = static_cast<size_t>(at - names.begin());
    surface->drawer = drawer_of(*this, link, map_from_links,
                                (map_from_links[i] * surface->link_from_top).translation().z());
    surfaces.push_back(std::move(*surface));
  }
  return surfaces;
}

}  // namespace loci::perception
