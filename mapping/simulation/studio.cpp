#include "mapping/simulation/studio.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/parallel.h"

namespace loci::mapping {
namespace {

constexpr int kSamples = 2;  ///< per pixel and direction, for colour

/// The same camera with more pixels; pixel centres are at integers.
PinholeCamera finer(const PinholeCamera& camera, int factor) {
  const double shift = 0.5 * (factor - 1);
  return {camera.width * factor, camera.height * factor,     camera.fx * factor,
          camera.fy * factor,    camera.cx * factor + shift, camera.cy * factor + shift};
}

/// Light from above and a little from the camera, as in a room with a ceiling lamp and pale walls.
class Shader {
 public:
  explicit Shader(const Isometry3d& map_from_camera)
      : light_((map_from_camera.linear().transpose() * Vector3d(0.12, -0.10, 1).normalized()).cast<float>()) {
  }

  float shade(const cv::Vec3f& normal) const {
    const Eigen::Vector3f n(normal[0], normal[1], normal[2]);
    if (n.isZero()) return 1;
    return 0.60F + 0.38F * std::max(0.0F, n.dot(light_)) + 0.16F * std::max(0.0F, -n.z());
  }

 private:
  Eigen::Vector3f light_;
};

void shrink_row(const RenderedView& fine, const Shader& shader, int v, cv::Mat& image) {
  const cv::Vec3f nothing(230, 228, 224);
  for (int u = 0; u < image.cols; ++u) {
    cv::Vec3f sum(0, 0, 0);
    for (int y = v * kSamples; y < (v + 1) * kSamples; ++y) {
      for (int x = u * kSamples; x < (u + 1) * kSamples; ++x) {
        const cv::Vec3b& color = fine.color.at<cv::Vec3b>(y, x);
        sum += fine.link.at<int>(y, x) < 0
                   ? nothing
                   : cv::Vec3f(color[0], color[1], color[2]) * shader.shade(fine.normal.at<cv::Vec3f>(y, x));
      }
    }
    for (int k = 0; k < 3; ++k)
      image.at<cv::Vec3b>(v, u)[k] = cv::saturate_cast<uint8_t>(sum[k] / (kSamples * kSamples));
  }
}

TriangleMesh floor_mesh(double height) {
  constexpr float reach = 20;
  const auto z = static_cast<float>(height);
  TriangleMesh mesh;
  mesh.vertices = {{-reach, -reach, z}, {reach, -reach, z}, {reach, reach, z}, {-reach, reach, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.colors.assign(2, Rgba(0.55F, 0.5F, 0.45F, 1));
  return mesh;
}

std::string look_key(const std::string& name, const ObjectState& object) {
  const Rgba accent = object.accent.value_or(Rgba(-1, -1, -1, -1));
  return fmt::format("{} {} {} {} {} {} {}", name, object.color.x(), object.color.y(), object.color.z(),
                     accent.x(), accent.y(), accent.z());
}

}  // namespace

Studio::Studio(const Scenario& scenario, const World& world, const MeshSearch& search,
               const ScenarioPlay& play, Warnings& warnings)
    : scenario_(scenario), play_(play) {
  background_.push_back(scene_.add(world, search, Isometry3d::Identity(), warnings));
  if (scenario.floor)
    background_.push_back(scene_.add("scenario_floor", floor_mesh(*scenario.floor), Isometry3d::Identity()));
}

const Studio::Part& Studio::part_for(const std::string& name, const ObjectState& object) {
  const std::string key = look_key(name, object);
  if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
  ObjectSpec spec = scenario_.objects.at(name);
  spec.color = object.color;
  spec.accent = object.accent;
  Part part;
  part.number = scene_.add(name, build_object(spec).mesh, Isometry3d::Identity());
  part.link = static_cast<int>(scene_.link_names().size()) - 1;
  return parts_.emplace(key, part).first->second;
}

void Studio::arrange(const WorldState& state) {
  scene_.set_joints(background_.front(), state.joints);
  visible_.clear();
  for (const auto& [name, object] : state.objects) visible_[name] = part_for(name, object);
  for (const auto& [key, part] : parts_) scene_.set_visible(part.number, false);
  const auto poses = play_.map_from_objects(state);
  for (const auto& [name, part] : visible_) {
    scene_.set_pose(part.number, poses.at(name));
    scene_.set_visible(part.number, true);
  }
}

RenderedView Studio::depth_view(const PinholeCamera& camera, const Isometry3d& map_from_camera,
                                int threads) const {
  RenderOptions options;
  options.normals = true;
  return scene_.render(camera, map_from_camera, options, threads);
}

cv::Mat Studio::color_image(const PinholeCamera& camera, const Isometry3d& map_from_camera,
                            int threads) const {
  RenderOptions options;
  options.normals = options.colors = true;
  const RenderedView fine = scene_.render(finer(camera, kSamples), map_from_camera, options, threads);
  const Shader shader(map_from_camera);
  cv::Mat image(camera.height, camera.width, CV_8UC3);
  parallel_for(static_cast<size_t>(camera.height), threads, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) shrink_row(fine, shader, static_cast<int>(v), image);
  });
  return image;
}

std::map<std::string, SeenObject> Studio::seen_objects(const RenderedView& view, const PinholeCamera& camera,
                                                       const Isometry3d& map_from_camera, int threads) {
  std::map<int, SeenObject> by_link;
  for (int v = 0; v < view.link.rows; ++v) {
    for (int u = 0; u < view.link.cols; ++u) {
      const int link = view.link.at<int>(v, u);
      if (link < 0) continue;
      SeenObject& seen = by_link[link];
      if (seen.pixels++ == 0) {
        seen.box[0] = seen.box[2] = u;
        seen.box[1] = v;
      }
      seen.box[0] = std::min(seen.box[0], u);
      seen.box[2] = std::max(seen.box[2], u);
      seen.box[3] = v;
    }
  }
  for (const size_t part : background_) scene_.set_visible(part, false);
  for (const auto& [name, part] : visible_) scene_.set_visible(part.number, false);
  std::map<std::string, SeenObject> seen;
  for (const auto& [name, part] : visible_) {
    scene_.set_visible(part.number, true);
    const RenderedView alone = scene_.render(camera, map_from_camera, {}, threads);
    scene_.set_visible(part.number, false);
    seen[name] = by_link[part.link];
    for (int v = 0; v < alone.link.rows; ++v)
      seen[name].unhidden_pixels += static_cast<int>(
          std::count(alone.link.ptr<int>(v), alone.link.ptr<int>(v) + alone.link.cols, part.link));
  }
  for (const size_t part : background_) scene_.set_visible(part, true);
  for (const auto& [name, part] : visible_) scene_.set_visible(part.number, true);
  return seen;
}

}  // namespace loci::mapping
