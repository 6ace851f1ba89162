#include "mapping/render/render.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/base/parallel.h"
#include "mapping/render/rasterizer.h"
#include "mapping/render/scene_parts.h"

namespace loci {

using render_detail::Chunk;
using render_detail::kNoTriangle;
using render_detail::PlacedChunk;
using render_detail::Raster;

namespace {

constexpr size_t kChunkTriangles = 1024;

void bound(Chunk& chunk) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : chunk.vertices) box.extend(vertex.cast<double>());
  chunk.centre = box.center();
  for (const Eigen::Vector3f& vertex : chunk.vertices)
    chunk.radius = std::max(chunk.radius, (vertex.cast<double>() - chunk.centre).norm());
}

/// Cuts a mesh into chunks in the order of its triangles, which in files mostly follows the surface.
void append_chunks(const TriangleMesh& mesh, const Isometry3d& link_from_mesh,
                   const std::optional<Rgba>& color, size_t link, uint32_t& triangle_count,
                   std::vector<Chunk>& chunks) {
  std::vector<Eigen::Vector3f> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    vertices.push_back((link_from_mesh * vertex.cast<double>()).cast<float>());
  const std::vector<std::array<uint8_t, 3>> colors = render_detail::triangle_colors(mesh, color);
  const bool own_colors = colors.size() == mesh.triangles.size();
  std::vector<uint32_t> local(vertices.size(), kNoTriangle);
  for (size_t begin = 0; begin < mesh.triangles.size(); begin += kChunkTriangles) {
    const size_t end = std::min(begin + kChunkTriangles, mesh.triangles.size());
    Chunk chunk;
    chunk.link = link;
    chunk.first_triangle = triangle_count;
    if (!own_colors) chunk.colors = colors;
    std::vector<uint32_t> used;
    for (size_t i = begin; i < end; ++i) {
      std::array<uint32_t, 3> triangle{};
      for (size_t k = 0; k < 3; ++k) {
        uint32_t& index = local[mesh.triangles[i][k]];
        if (index == kNoTriangle) {
          index = static_cast<uint32_t>(chunk.vertices.size());
          chunk.vertices.push_back(vertices[mesh.triangles[i][k]]);
          used.push_back(mesh.triangles[i][k]);
        }
        triangle[k] = index;
      }
      chunk.triangles.push_back(triangle);
      if (own_colors) chunk.colors.push_back(colors[i]);
    }
    for (const uint32_t vertex : used) local[vertex] = kNoTriangle;
    triangle_count += static_cast<uint32_t>(end - begin);
    bound(chunk);
    chunks.push_back(std::move(chunk));
  }
}

}  // namespace

struct RenderScene::Impl {
  render_detail::SceneParts parts;
  std::vector<Chunk> chunks;
  uint32_t triangle_count = 0;

  std::vector<PlacedChunk> visible_chunks(const std::vector<Isometry3d>& camera_from_links) const;
  void shade(const Raster& raster, const PinholeCamera& camera,
             const std::vector<Isometry3d>& camera_from_links, const RenderOptions& options, size_t row_begin,
             size_t row_end, RenderedView& view) const;
};

/// Nearest first, so that what is near hides what is behind before that is drawn.
std::vector<PlacedChunk> RenderScene::Impl::visible_chunks(
    const std::vector<Isometry3d>& camera_from_links) const {
  std::vector<std::pair<double, size_t>> sorted;
  sorted.reserve(chunks.size());
  for (size_t i = 0; i < chunks.size(); ++i) {
    const Chunk& chunk = chunks[i];
    if (!parts.part_of_link(chunk.link).visible) continue;
    const double z = (camera_from_links[chunk.link] * chunk.centre).z();
    if (z + chunk.radius > 0) sorted.emplace_back(z - chunk.radius, i);
  }
  std::ranges::sort(sorted);
  std::vector<PlacedChunk> placed;
  placed.reserve(sorted.size());
  for (const auto& [z, i] : sorted) placed.push_back({&chunks[i], &camera_from_links[chunks[i].link]});
  return placed;
}

void RenderScene::Impl::shade(const Raster& raster, const PinholeCamera& camera,
                              const std::vector<Isometry3d>& camera_from_links, const RenderOptions& options,
                              size_t row_begin, size_t row_end, RenderedView& view) const {
  const Chunk* chunk = nullptr;
  uint32_t shown = kNoTriangle;
  Eigen::Matrix3d camera_from_link;
  Vector3d normal = Vector3d::Zero();
  for (size_t row = row_begin; row < row_end; ++row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < camera.width; ++u) {
      const size_t pixel = row * static_cast<size_t>(camera.width) + static_cast<size_t>(u);
      const uint32_t triangle = raster.triangle[pixel];
      if (triangle == kNoTriangle) continue;
      if (triangle != shown) {
        if (!chunk || triangle < chunk->first_triangle ||
            triangle - chunk->first_triangle >= chunk->triangles.size()) {
          chunk = &*std::prev(std::ranges::upper_bound(chunks, triangle, {}, &Chunk::first_triangle));
          if (options.normals) camera_from_link = camera_from_links[chunk->link].linear();
        }
        if (options.normals) {
          const auto& [a, b, c] = chunk->triangles[triangle - chunk->first_triangle];
          const Vector3d origin = chunk->vertices[a].cast<double>();
          normal = camera_from_link * (chunk->vertices[b].cast<double>() - origin)
                                          .cross(chunk->vertices[c].cast<double>() - origin)
                                          .normalized();
        }
        shown = triangle;
      }
      view.depth.at<float>(v, u) = 1.f / raster.inverse_depth[pixel];
      view.link.at<int32_t>(v, u) = static_cast<int32_t>(chunk->link);
      if (options.normals) {
        const Vector3d towards = normal.dot(camera.unproject(u, v, 1)) > 0 ? Vector3d(-normal) : normal;
        view.normal.at<cv::Vec3f>(v, u) = {static_cast<float>(towards.x()), static_cast<float>(towards.y()),
                                           static_cast<float>(towards.z())};
      }
      if (options.colors) {
        const auto& rgb =
            chunk->colors.size() == 1 ? chunk->colors[0] : chunk->colors[triangle - chunk->first_triangle];
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
    append_chunks(mesh, visual.link_from_visual, visual.material ? visual.material->color : std::nullopt,
                  first_link + link, impl_->triangle_count, impl_->chunks);
  };
  render_detail::for_each_visual(world, search, warnings, append);
  return number;
}

size_t RenderScene::add(const std::string& name, const TriangleMesh& mesh, const Isometry3d& map_from_mesh) {
  const size_t number = impl_->parts.add(name, map_from_mesh);
  append_chunks(mesh, Isometry3d::Identity(), std::nullopt, impl_->parts.part(number).first_link,
                impl_->triangle_count, impl_->chunks);
  return number;
}

void RenderScene::set_joints(size_t part, const JointState& state) {
  impl_->parts.set_joints(part, state);
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
  const std::vector<PlacedChunk> chunks = impl_->visible_chunks(camera_from_links);
  const size_t pixels = static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
  Raster raster{std::vector<float>(pixels, 0.f), std::vector<uint32_t>(pixels, kNoTriangle)};
  parallel_for(static_cast<size_t>(camera.height), threads, [&](size_t begin, size_t end) {
    render_detail::draw_rows(chunks, camera, options.near_m, options.far_m, static_cast<int>(begin),
                             static_cast<int>(end), raster);
    impl_->shade(raster, camera, camera_from_links, options, begin, end, view);
  });
  return view;
}

}  // namespace loci
