#include "mapping/render/render.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "mapping/base/parallel.h"
#include "mapping/render/placed_vertices.h"
#include "mapping/render/rasterizer.h"
#include "mapping/render/scene_parts.h"

namespace loci::mapping {

using render_detail::PlacedSurface;
using render_detail::Raster;
using render_detail::Surface;

namespace {

/// A surface that moves with a link.
struct Instance {
  std::shared_ptr<const Surface> surface;
  size_t link = 0;
};

}  // namespace

struct RenderScene::Impl {
  render_detail::SceneParts parts;
  std::vector<Instance> instances;  ///< link ids grow

  void append(const TriangleMesh& mesh, const Isometry3d& link_from_mesh, const std::optional<Rgba>& color,
              size_t link);
  std::vector<PlacedSurface> nearest_first(const std::vector<Isometry3d>& camera_from_links) const;
  void shade(const Raster& raster, const PinholeCamera& camera,
             const std::vector<Isometry3d>& camera_from_links, const RenderOptions& options, size_t row_begin,
             size_t row_end, RenderedView& view) const;
};

void RenderScene::Impl::append(const TriangleMesh& mesh, const Isometry3d& link_from_mesh,
                               const std::optional<Rgba>& color, size_t link) {
  for (auto& surface :
       render_detail::cut_mesh(mesh, link_from_mesh, render_detail::triangle_colors(mesh, color)))
    instances.push_back({std::move(surface), link});
}

std::vector<PlacedSurface> RenderScene::Impl::nearest_first(
    const std::vector<Isometry3d>& camera_from_links) const {
  std::vector<std::pair<float, uint32_t>> sorted;
  sorted.reserve(instances.size());
  for (size_t i = 0; i < instances.size(); ++i) {
    const auto& [surface, link] = instances[i];
    if (!parts.part_of_link(link).visible) continue;
    const Eigen::RowVector3d row = camera_from_links[link].linear().row(2);
    const double z = row.dot(surface->centre) + camera_from_links[link].translation().z();
    const double reach = row.cwiseAbs().dot(surface->half);
    if (z + reach > 0) sorted.emplace_back(static_cast<float>(z - reach), static_cast<uint32_t>(i));
  }
  std::ranges::sort(sorted);
  std::vector<PlacedSurface> placed;
  placed.reserve(sorted.size());
  for (const auto& [z, i] : sorted)
    placed.push_back({instances[i].surface.get(), &camera_from_links[instances[i].link], i});
  return placed;
}

void RenderScene::Impl::shade(const Raster& raster, const PinholeCamera& camera,
                              const std::vector<Isometry3d>& camera_from_links, const RenderOptions& options,
                              size_t row_begin, size_t row_end, RenderedView& view) const {
  uint64_t shown = render_detail::kNothing;
  const Instance* instance = nullptr;
  uint32_t triangle = 0;
  Vector3d normal = Vector3d::Zero();
  cv::Vec3f along;  // the normal
  std::vector<double> ray_x;
  for (int u = 0; u < camera.width; ++u) ray_x.push_back(camera.unproject(u, 0, 1).x());
  for (size_t row = row_begin; row < row_end; ++row) {
    const int v = static_cast<int>(row);
    const double ray_y = camera.unproject(0, v, 1).y();
    const uint64_t* id_of = raster.id.data() + row * static_cast<size_t>(camera.width);
    const float* inverse_depth = raster.inverse_depth.data() + row * static_cast<size_t>(camera.width);
    auto* depth = view.depth.ptr<float>(v);
    auto* link = view.link.ptr<int32_t>(v);
    for (int u = 0; u < camera.width; ++u) {
      const uint64_t id = id_of[u];
      if (id == render_detail::kNothing) continue;
      if (id != shown) {
        instance = &instances[render_detail::instance_of(id)];
        triangle = render_detail::triangle_of(id);
        if (options.normals) {
          normal = camera_from_links[instance->link].linear() * instance->surface->normal(triangle);
          const Eigen::Vector3f single = normal.cast<float>();
          along = {single.x(), single.y(), single.z()};
        }
        shown = id;
      }
      depth[u] = 1.f / inverse_depth[u];
      link[u] = static_cast<int32_t>(instance->link);
      if (options.normals) {
        const bool away = normal.dot(Vector3d(ray_x[static_cast<size_t>(u)], ray_y, 1)) > 0;
        view.normal.ptr<cv::Vec3f>(v)[u] = away ? -along : along;
      }
      if (options.colors) {
        const auto& colors = instance->surface->colors;
        const auto& rgb = colors[colors.size() == 1 ? 0 : triangle];
        view.color.at<cv::Vec3b>(v, u) = {rgb[2], rgb[1], rgb[0]};
      }
    }
  }
}

RenderScene::RenderScene() : impl_(std::make_unique<Impl>()) {}
RenderScene::~RenderScene() = default;
RenderScene::RenderScene(RenderScene&&) noexcept = default;
RenderScene& RenderScene::operator=(RenderScene&&) noexcept = default;

size_t RenderScene::add(const World& world, const MeshSearch& search, const Isometry3d& map_from_root,
                        Warnings& warnings) {
  const size_t number = impl_->parts.add(world, map_from_root);
  const size_t first_link = impl_->parts.part(number).first_link;
  const auto append = [&](size_t link, const Visual& visual, const TriangleMesh& mesh) {
    impl_->append(mesh, visual.link_from_visual, visual.material ? visual.material->color : std::nullopt,
                  first_link + link);
  };
  render_detail::for_each_visual(world, search, warnings, append);
  return number;
}

size_t RenderScene::add(const std::string& name, const TriangleMesh& mesh, const Isometry3d& map_from_mesh) {
  const size_t number = impl_->parts.add(name, map_from_mesh);
  impl_->append(mesh, Isometry3d::Identity(), std::nullopt, impl_->parts.part(number).first_link);
  return number;
}

size_t RenderScene::add_copy(size_t part, const Isometry3d& map_from_part) {
  const size_t number = impl_->parts.add_copy(part, map_from_part);
  const size_t from = impl_->parts.part(part).first_link, to = impl_->parts.part(number).first_link;
  const size_t links = impl_->parts.part(part).world->links.size();
  auto& instances = impl_->instances;
  const auto first = std::ranges::lower_bound(instances, from, {}, &Instance::link);
  const auto last = std::ranges::lower_bound(instances, from + links, {}, &Instance::link);
  std::vector<Instance> copies(first, last);
  for (Instance& copy : copies) copy.link += to - from;
  instances.insert(instances.end(), copies.begin(), copies.end());
  return number;
}

void RenderScene::set_joints(size_t part, const JointState& state) {
  impl_->parts.set_joints(part, state);
}

void RenderScene::set_world(size_t part, const World& world) {
  impl_->parts.set_world(part, world);
}

void RenderScene::set_pose(size_t part, const Isometry3d& map_from_part) {
  impl_->parts.part(part).map_from_part = map_from_part;
}

void RenderScene::set_visible(size_t part, bool visible) {
  impl_->parts.part(part).visible = visible;
}

const std::vector<std::string>& RenderScene::link_names() const {
  return impl_->parts.names();
}

Isometry3d RenderScene::map_from_link(size_t link) const {
  return impl_->parts.map_from_link(link);
}

RenderedView RenderScene::render(const PinholeCamera& camera, const Isometry3d& map_from_camera,
                                 const RenderOptions& options, int threads) const {
  if (camera.width <= 0 || camera.height <= 0 || !(camera.fx > 0) || !(camera.fy > 0))
    throw Error("a camera needs a positive size and focal length");
  if (std::max(camera.width, camera.height) > render_detail::kMaxSide)
    throw Error("images have at most " + std::to_string(render_detail::kMaxSide) + " pixels a side");
  if (!(options.near_m > 0) || !(options.far_m > options.near_m))
    throw Error("rendering needs 0 < near < far");
  RenderedView view;
  view.depth = cv::Mat(camera.height, camera.width, CV_32F, cv::Scalar(std::nanf("")));
  view.link = cv::Mat(camera.height, camera.width, CV_32S, cv::Scalar(-1));
  if (options.normals) view.normal = cv::Mat::zeros(camera.height, camera.width, CV_32FC3);
  if (options.colors) view.color = cv::Mat::zeros(camera.height, camera.width, CV_8UC3);

  const Isometry3d camera_from_map = map_from_camera.inverse();
  std::vector<Isometry3d> camera_from_links;
  camera_from_links.reserve(impl_->parts.names().size());
  for (size_t link = 0; link < impl_->parts.names().size(); ++link)
    camera_from_links.push_back(camera_from_map * impl_->parts.map_from_link(link));
  const std::vector<PlacedSurface> surfaces = impl_->nearest_first(camera_from_links);
  const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  Raster raster{std::vector<float>(pixels, 0.f), std::vector<uint64_t>(pixels, render_detail::kNothing)};
  const render_detail::DrawOptions draw{options.near_m, options.far_m, options.occlusion_culling};
  parallel_for(static_cast<size_t>(camera.height), threads, [&](size_t begin, size_t end) {
    render_detail::draw_rows(surfaces, camera, draw, static_cast<int>(begin), static_cast<int>(end), raster);
    impl_->shade(raster, camera, camera_from_links, options, begin, end, view);
  });
  return view;
}

}  // namespace loci::mapping
