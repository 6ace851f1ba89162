#include "tests/gui/large_memory.h"

#include <cmath>
#include <opencv2/core.hpp>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/image/image_io.h"
#include "mapping/render/render.h"
#include "mapping/simulation/scenario.h"
#include "mapping/world/urdf.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"

namespace loci::gui::test {
namespace {

constexpr int kViewpoints = 12, kMovedPerScene = 10, kThumbnailStep = 4;
constexpr TimeNs kBetweenScenes = 60 * kSecond;

struct View {
  Isometry3d map_from_camera;
  std::string image, depth;
};

std::vector<View> views_of(const mapping::RenderScene& scene, const mapping::PinholeCamera& camera,
                           const Vector3d& middle) {
  std::vector<View> views;
  mapping::RenderOptions options;
  options.colors = true;
  for (int i = 0; i < kViewpoints; ++i) {
    const double angle = 2 * kPi * i / kViewpoints;
    View view;
    view.map_from_camera =
        mapping::looking_at(middle + Vector3d(std::cos(angle), std::sin(angle), 1.2),
                            middle + Vector3d(3 * std::cos(angle), 3 * std::sin(angle), 0.4));
    const mapping::RenderedView seen = scene.render(camera, view.map_from_camera, options);
    const auto image = mapping::encode_image(seen.color, ".jpg");
    view.image.assign(image.begin(), image.end());
    std::vector<float> depth;
    for (int y = kThumbnailStep / 2; y < camera.height; y += kThumbnailStep)
      for (int x = kThumbnailStep / 2; x < camera.width; x += kThumbnailStep)
        depth.push_back(seen.depth.at<float>(y, x));
    view.depth = memory::encode_depth_thumbnail(depth);
    views.push_back(std::move(view));
  }
  return views;
}

memory::BeliefRow belief_of(memory::Id object, memory::Id scene, const Vector3d& position, Random& random) {
  memory::BeliefRow row;
  row.object = object;
  row.scene = scene;
  row.status = memory::ObjectStatus::seen;
  row.probability = 0.9;
  row.position = position;
  row.size = Vector3d(0.08, 0.08, 0.15);
  row.hsv = memory::HsvColor{random.uniform(0, 360), 0.7, 0.7};
  row.fade_s = 3600;
  row.fade_to = 0.3;
  return row;
}

}  // namespace

void write_large_memory(const std::filesystem::path& path, const std::filesystem::path& package,
                        const std::string& urdf, int objects, int scenes) {
  const mapping::World world = mapping::read_urdf(package / urdf);
  std::filesystem::create_directory_symlink(package, path.parent_path() / package.filename());
  mapping::RenderScene rendered;
  Warnings warnings;
  rendered.add(world, {{package.parent_path()}, package}, Isometry3d::Identity(), warnings);
  const mapping::PinholeCamera camera;
  const Vector3d middle(1.5, 1.5, 0.3);
  const std::vector<View> views = views_of(rendered, camera, middle);
  memory::Store store = memory::Store::open_write(path);
  const memory::Id run = store.begin_run("test", "{}");
  const memory::Id map = store.add_map(urdf, read_file(package / urdf), "");
  Random random(1);
  std::vector<Vector3d> positions;
  std::vector<memory::Id> ids;
  for (int i = 0; i < scenes; ++i) {
    memory::SceneTransaction t(store, run);
    const View& view = views[static_cast<size_t>(i) % views.size()];
    memory::SceneRow row;
    row.time = parse_time("2026-05-01T07:00:00Z") + i * kBetweenScenes;
    row.map = map;
    row.camera =
        memory::SceneCamera{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, 0.5, 5};
    row.map_from_camera = view.map_from_camera;
    row.image = t.add_blob(view.image, "image/jpeg");
    row.depth = t.add_blob(view.depth, memory::kDepthThumbnailMedia);
    row.depth_width = camera.width / kThumbnailStep;
    row.depth_height = camera.height / kThumbnailStep;
    const memory::Id scene = t.add_scene(row);
    for (int k = 0; k < (i == 0 ? objects : kMovedPerScene); ++k) {
      const Vector3d offset(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(0, 1));
      auto index = static_cast<size_t>(k);
      if (i == 0) {
        memory::ObjectRow object;
        object.clock.valid_from = row.time;
        ids.push_back(t.add_object(object));
        positions.push_back(middle + offset);
      } else {
        index = static_cast<size_t>(i * kMovedPerScene + k) % ids.size();
        positions[index] += 0.1 * offset;
      }
      memory::BeliefRow belief = belief_of(ids[index], scene, positions[index], random);
      belief.clock.valid_from = row.time;
      t.add_belief(belief);
    }
    t.commit();
  }
  store.finish_run(run);
}

}  // namespace loci::gui::test
