#include "mapping/render/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <unordered_map>

#include "mapping/base/text/text.h"
#include "mapping/render/scene_parts.h"
#include "mapping/render/triangles.h"

namespace loci::mapping {

using Eigen::Vector3f;
using render_detail::ScenePart;

namespace {

/// Link and material of a triangle.
struct TriangleMaterial {
  uint32_t link = 0;
  std::array<uint8_t, 3> color{};
  bool glossy = false;
};

/// Links that keep their places to each other: one Embree scene, and an instance of it in the whole.
struct Body {
  size_t base_link = 0;  ///< the body's frame is that of this link
  std::vector<Vector3f> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<TriangleMaterial> surfaces;  ///< by triangle
  Isometry3d map_from_body = Isometry3d::Identity();
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();  ///< of map_from_body
  RTCScene scene = nullptr;
  RTCGeometry instance = nullptr;
};

void append(Body& body, const TriangleMesh& mesh, const Isometry3d& body_from_mesh,
            const std::optional<Rgba>& color, size_t link, bool glossy) {
  const auto first = static_cast<uint32_t>(body.vertices.size());
  for (const Vector3f& vertex : mesh.vertices)
    body.vertices.push_back((body_from_mesh * vertex.cast<double>()).cast<float>());
  const auto colors = render_detail::triangle_colors(mesh, color);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    body.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    body.surfaces.push_back({static_cast<uint32_t>(link), colors[colors.size() == 1 ? 0 : i], glossy});
  }
}

/// By link of a world: the topmost link that it is fixed to.
std::vector<size_t> base_links(const World& world) {
  std::unordered_map<std::string, const Joint*> parents;
  std::unordered_map<std::string, size_t> index;
  for (const Joint& joint : world.joints) parents[joint.child] = &joint;
  for (size_t i = 0; i < world.links.size(); ++i) index[world.links[i].name] = i;
  std::vector<size_t> bases;
  for (const Link& link : world.links) {
    const std::string* base = &link.name;
    for (auto joint = parents.find(*base); joint != parents.end() && joint->second->type == JointType::fixed;
         joint = parents.find(*base))
      base = &joint->second->parent;
    bases.push_back(index.at(*base));
  }
  return bases;
}

}  // namespace

bool glossy_material(const std::string& name) {
  const std::string lower = lower_case(name);
  for (const char* word : {"glossy", "glass", "mirror", "chrome"})
    if (lower.find(word) != std::string::npos) return true;
  return false;
}

struct RayScene::Impl {
  RTCDevice device = rtcNewDevice("threads=1");  // Trees are built in one order: the same hits every time.
  RTCScene scene = rtcNewScene(device);
  render_detail::SceneParts parts;
  std::deque<Body> bodies;  ///< by instance id; stays where it is, Embree reads it

  Impl() { rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST); }
  ~Impl() {
    rtcReleaseScene(scene);
    for (Body& body : bodies) {
      rtcReleaseGeometry(body.instance);
      rtcReleaseScene(body.scene);
    }
    rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void add_body(Body body);
  static int link_around(const Vector3d& point, const RayScene& scene);
  void place(Body& body);
  /// Calls use(corners in the map frame, link) for all triangles.
  template <class Use>
  void for_each_triangle(const Use& use) const;
};

void RayScene::Impl::add_body(Body added) {
  if (added.triangles.empty()) return;
  Body& body = bodies.emplace_back(std::move(added));
  body.vertices.emplace_back(Vector3f::Zero());  // Embree reads 16 bytes at a time.
  const RTCGeometry triangles = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, body.vertices.data(), 0,
                             sizeof(Vector3f), body.vertices.size() - 1);
  rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, body.triangles.data(), 0,
                             sizeof body.triangles[0], body.triangles.size());
  rtcCommitGeometry(triangles);
  body.scene = rtcNewScene(device);
  rtcSetSceneFlags(body.scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(body.scene, triangles);
  rtcReleaseGeometry(triangles);
  rtcCommitScene(body.scene);
  body.instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(body.instance, body.scene);
  rtcAttachGeometryByID(scene, body.instance, static_cast<unsigned>(bodies.size() - 1));
  place(body);
}

/// The link that is seen from behind in all four directions, near by: a cupboard, but not a room.
int RayScene::Impl::link_around(const Vector3d& point, const RayScene& scene) {
  constexpr float near = 1;
  int around = -1;
  for (const Vector3f& direction :
       {Vector3f(1, 0, 0), Vector3f(0, 1, 0), Vector3f(-1, 0, 0), Vector3f(0, -1, 0)}) {
    const RayHit hit = scene.cast(point.cast<float>(), direction, near);
    if (!hit.from_behind || (around >= 0 && hit.link != around)) return -1;
    around = hit.link;
  }
  return around;
}

void RayScene::Impl::place(Body& body) {
  body.map_from_body = parts.map_from_link(body.base_link);
  body.rotation = body.map_from_body.linear().cast<float>();
  const Eigen::Matrix<float, 3, 4> matrix = body.map_from_body.matrix().topRows<3>().cast<float>();
  rtcSetGeometryTransform(body.instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
  rtcCommitGeometry(body.instance);
}

template <class Use>
void RayScene::Impl::for_each_triangle(const Use& use) const {
  std::vector<Vector3d> placed;
  for (const Body& body : bodies) {
    placed.clear();
    for (const Vector3f& vertex : body.vertices) placed.push_back(body.map_from_body * vertex.cast<double>());
    for (size_t i = 0; i < body.triangles.size(); ++i) {
      const auto& [a, b, c] = body.triangles[i];
      use(placed[a], placed[b], placed[c], static_cast<int>(body.surfaces[i].link));
    }
  }
}

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

size_t RayScene::add(const World& world, const MeshSearch& search, const Isometry3d& map_from_root,
                     Warnings& warnings) {
  const size_t number = impl_->parts.add(world, map_from_root);
  const ScenePart& part = impl_->parts.part(number);
  const std::vector<size_t> bases = base_links(world);
  std::vector<Body> added(world.links.size());  // By base link; most stay empty.
  for (size_t link = 0; link < added.size(); ++link) added[link].base_link = part.first_link + link;
  const auto use = [&](size_t link, const Visual& visual, const TriangleMesh& mesh) {
    const Isometry3d base_from_link =
        part.part_from_links[bases[link]].inverse() * part.part_from_links[link];
    append(added[bases[link]], mesh, base_from_link * visual.link_from_visual,
           visual.material ? visual.material->color : std::nullopt, part.first_link + link,
           visual.material && glossy_material(visual.material->name));
  };
  render_detail::for_each_visual(world, search, warnings, use);
  for (Body& body : added) impl_->add_body(std::move(body));
  rtcCommitScene(impl_->scene);
  return number;
}

size_t RayScene::add(const std::string& name, const TriangleMesh& mesh, const Isometry3d& map_from_mesh) {
  const size_t number = impl_->parts.add(name, map_from_mesh);
  Body body;
  body.base_link = impl_->parts.part(number).first_link;
  append(body, mesh, Isometry3d::Identity(), std::nullopt, body.base_link, false);
  impl_->add_body(std::move(body));
  rtcCommitScene(impl_->scene);
  return number;
}

void RayScene::set_joints(size_t part, const JointState& state) {
  impl_->parts.set_joints(part, state);
  const ScenePart& moved = impl_->parts.part(part);
  for (Body& body : impl_->bodies)
    if (body.base_link >= moved.first_link && body.base_link < moved.first_link + moved.world->links.size())
      impl_->place(body);
  rtcCommitScene(impl_->scene);
}

const std::vector<std::string>& RayScene::link_names() const {
  return impl_->parts.names();
}

Isometry3d RayScene::map_from_link(size_t link) const {
  return impl_->parts.map_from_link(link);
}

Eigen::AlignedBox3d RayScene::bounds() const {
  Eigen::AlignedBox3d box;
  impl_->for_each_triangle([&](const Vector3d& a, const Vector3d& b, const Vector3d& c, int) {
    box.extend(a).extend(b).extend(c);
  });
  return box;
}

RayHit RayScene::cast(const Vector3f& origin, const Vector3f& direction, float range_max) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray{};
  ray.ray.org_x = origin.x();
  ray.ray.org_y = origin.y();
  ray.ray.org_z = origin.z();
  ray.ray.dir_x = direction.x();
  ray.ray.dir_y = direction.y();
  ray.ray.dir_z = direction.z();
  ray.ray.tfar = range_max;
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &ray);
  RayHit hit;
  hit.distance = std::numeric_limits<float>::infinity();
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const Body& body = impl_->bodies[ray.hit.instID[0]];
  const TriangleMaterial& surface = body.surfaces[ray.hit.primID];
  hit.distance = ray.ray.tfar;
  hit.link = static_cast<int>(surface.link);
  hit.normal = (body.rotation * Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z)).normalized();
  hit.from_behind = hit.normal.dot(direction) > 0;
  if (hit.from_behind) hit.normal = -hit.normal;
  hit.color = surface.color;
  hit.glossy = surface.glossy;
  return hit;
}

int RayScene::link_in_cylinder(const Vector2d& centre, double radius, double z_min, double z_max) const {
  int found = -1;
  const auto look = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c, int link) {
    if (found >= 0 || std::max({a.z(), b.z(), c.z()}) < z_min || std::min({a.z(), b.z(), c.z()}) > z_max)
      return;
    const auto inside = render_detail::between_heights({a, b, c}, z_min, z_max);
    if (!inside.empty() && render_detail::distance_from_above(inside, centre) < radius) found = link;
  };
  impl_->for_each_triangle(look);
  return found >= 0 ? found : Impl::link_around({centre.x(), centre.y(), (z_min + z_max) / 2}, *this);
}

NearestSurface RayScene::nearest(const Vector3d& point, double radius) const {
  NearestSurface best;
  best.distance = radius;
  const auto look = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c, int link) {
    const Vector3d on = render_detail::nearest_of_triangle(point, a, b, c);
    const double distance = (on - point).norm();
    if (distance < best.distance) best = {link, distance, on};
  };
  impl_->for_each_triangle(look);
  return best;
}

}  // namespace loci::mapping
