#include "tests/gui/sample_memory.h"

#include <algorithm>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/render/render.h"
#include "mapping/simulation/scenario.h"
#include "mapping/world/urdf.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"

namespace loci::gui::test {
namespace {

constexpr int kThumbnailStep = 4;
const std::filesystem::path kKitchen = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";

struct SampleObject {
  memory::Id object;
  Vector3d centre, size;
  memory::HsvColor hsv;
  const char* color;
  cv::Scalar bgr;
};

mapping::TriangleMesh box_mesh(const SampleObject& object) {
  Warnings warnings;
  mapping::TriangleMesh mesh = triangulate(mapping::Box{object.size}, {}, warnings);
  const mapping::Rgba color(static_cast<float>(object.bgr[2] / 255), static_cast<float>(object.bgr[1] / 255),
                            static_cast<float>(object.bgr[0] / 255), 1);
  mesh.colors.assign(mesh.triangles.size(), color);
  return mesh;
}

/// Writes scene after scene of one run.
class Writer {
 public:
  Writer(const std::filesystem::path& path)
      : store_(memory::Store::open_write(path)),
        world_(mapping::read_urdf(kKitchen)),
        run_(store_.begin_run("test", "{}")) {
    map_ = store_.add_map("kitchen.urdf", read_file(kKitchen), "");
    for (const char* name : {"counter_1", "table_1"}) {
      memory::PlaceRow row;
      row.name = name;
      row.map = map_;
      places_[name] = store_.add_place(row, run_);
    }
  }
  ~Writer() { store_.finish_run(run_); }

  /// Draws what the camera sees, adds the scene with one observation per object; returns the scene's id.
  memory::Id add_scene(memory::SceneTransaction& transaction, TimeNs time, const Isometry3d& map_from_camera,
                       const std::vector<SampleObject>& objects, const JointState& joints) {
    const mapping::PinholeCamera camera;
    mapping::RenderScene scene;
    Warnings warnings;
    scene.add(world_, {{}, kKitchen.parent_path()}, Isometry3d::Identity(), warnings);
    scene.set_joints(0, joints);
    for (const SampleObject& object : objects)
      scene.add("thing_" + std::to_string(object.object), box_mesh(object),
                Isometry3d(Eigen::Translation3d(object.centre)));
    mapping::RenderOptions options;
    options.colors = true;
    const mapping::RenderedView view = scene.render(camera, map_from_camera, options);
    depth_ = view.depth;
    memory::SceneRow row;
    row.time = time;
    row.map = map_;
    row.camera =
        memory::SceneCamera{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, 0.5, 5};
    row.map_from_camera = map_from_camera;
    row.joints = joints;
    const auto image = mapping::encode_image(view.color, ".png");
    row.image =
        transaction.add_blob({reinterpret_cast<const char*>(image.data()), image.size()}, "image/png");
    std::vector<float> depth;
    for (int y = kThumbnailStep / 2; y < camera.height; y += kThumbnailStep)
      for (int x = kThumbnailStep / 2; x < camera.width; x += kThumbnailStep)
        depth.push_back(view.depth.at<float>(y, x));
    row.depth = transaction.add_blob(memory::encode_depth_thumbnail(depth), memory::kDepthThumbnailMedia);
    row.depth_width = camera.width / kThumbnailStep;
    row.depth_height = camera.height / kThumbnailStep;
    // Above the middle the map explains all; the region of interest is below.
    std::string kinds(depth.size(), static_cast<char>(mapping::PixelKind::map_explained));
    std::fill(kinds.begin() + static_cast<ptrdiff_t>(kinds.size() / 2), kinds.end(),
              static_cast<char>(mapping::PixelKind::region_of_interest));
    row.pixel_kinds = transaction.add_blob(kinds, memory::kPixelKindsMedia);
    const memory::Id id = transaction.add_scene(row);
    transaction.add_log({.scene = id, .annotator = "NormalEstimator", .milliseconds = 2.5});
    transaction.add_log({.scene = id,
                         .number = 1,
                         .annotator = "KnownStructureFilter",
                         .level = "warning",
                         .text = "a drawer stands open",
                         .milliseconds = 7.5});
    return id;
  }

  /// An observation of an object in the last scene that is believed to be the object; returns its id. In the
  /// first scene no points are kept.
  memory::Id add_object_observation(memory::SceneTransaction& transaction, memory::Id scene,
                                    const std::string& place, const SampleObject& object,
                                    const Isometry3d& map_from_camera, const std::string& explanation) {
    const mapping::PinholeCamera camera;
    Eigen::AlignedBox2d area;
    for (int i = 0; i < 8; ++i) {
      const Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
      area.extend(
          camera.project(map_from_camera.inverse() * (object.centre + corner.cwiseProduct(object.size))));
    }
    memory::ObservationRow row;
    row.scene = scene;
    row.number = number_++;
    row.place = place_id(place);
    row.position = object.centre;
    row.map_from_box = Isometry3d(Eigen::Translation3d(object.centre));
    row.size = object.size;
    row.hsv = object.hsv;
    row.color = object.color;
    row.roi = {static_cast<int>(area.min().x()), static_cast<int>(area.min().y()),
               static_cast<int>(area.sizes().x()), static_cast<int>(area.sizes().y())};
    // An ellipse stands for the shape of it.
    cv::Mat mask(std::max(1, (*row.roi)[3]), std::max(1, (*row.roi)[2]), CV_8U, cv::Scalar(0));
    cv::ellipse(mask, cv::Point(mask.cols / 2, mask.rows / 2), cv::Size(mask.cols / 2, mask.rows / 2), 0, 0,
                360, cv::Scalar(255), cv::FILLED);
    const auto outline = mapping::encode_image(mask, ".png");
    row.mask =
        transaction.add_blob({reinterpret_cast<const char*>(outline.data()), outline.size()}, "image/png");
    if (scene > 1) {
      std::vector<float> depth;
      for (int y = 0; y < mask.rows; ++y)
        for (int x = 0; x < mask.cols; ++x)
          if (mask.at<uint8_t>(y, x) != 0)
            depth.push_back(depth_.at<float>(y + (*row.roi)[1], x + (*row.roi)[0]));
      row.cloud = transaction.add_blob(memory::encode_cluster_depth(depth), memory::kClusterDepthMedia);
    }
    const auto crop = mapping::encode_image(cv::Mat(40, 30, CV_8UC3, object.bgr), ".png");
    row.crop = transaction.add_blob({reinterpret_cast<const char*>(crop.data()), crop.size()}, "image/png");
    const memory::Id observation = transaction.add_observation(row);
    memory::AssociationRow association;
    association.scene = scene;
    association.observation = observation;
    association.object = object.object;
    association.explanation = memory::parse_state<memory::Explanation>(explanation);
    association.probability = 0.97;
    association.chosen = true;
    transaction.add_association(association);
    return observation;
  }

  /// What a scene showed of an object.
  void add_object_visibility(memory::SceneTransaction& transaction, memory::Id scene, memory::Id object,
                             const std::string& status) {
    transaction.add_visibility({.scene = scene,
                                .object = object,
                                .status = memory::parse_state<memory::ObjectStatus>(status),
                                .probability = 0.95});
  }
  void add_place_visibility(memory::SceneTransaction& transaction, memory::Id scene, const std::string& place,
                            double fraction) {
    transaction.add_visibility({.scene = scene,
                                .place = place_id(place),
                                .status = memory::ObjectStatus::seen,
                                .fraction = fraction});
  }

  memory::Id add_object(memory::SceneTransaction& transaction, TimeNs time) {
    memory::ObjectRow row;
    row.clock.valid_from = time;
    return transaction.add_object(row);
  }

  void add_belief(memory::SceneTransaction& transaction, TimeNs time, memory::Id scene,
                  const SampleObject& object, const std::string& place, const std::string& status,
                  double probability, std::optional<memory::Id> last_scene,
                  std::optional<memory::Id> last_observation) {
    memory::BeliefRow row;
    row.object = object.object;
    row.scene = scene;
    row.status = memory::parse_state<memory::ObjectStatus>(status);
    row.probability = probability;
    row.place = place_id(place);
    row.position = object.centre;
    row.last_scene = last_scene;
    row.last_observation = last_observation;
    row.hsv = object.hsv;
    row.color = object.color;
    row.size = object.size;
    row.clock.valid_from = time;
    transaction.add_belief(row);
  }

  void add_event(memory::SceneTransaction& transaction, TimeNs time, memory::Id scene,
                 const std::string& kind, memory::Id object, const std::string& place,
                 const std::string& from = {}) {
    memory::EventRow row;
    row.scene = scene;
    row.kind = memory::parse_state<memory::EventKind>(kind);
    row.object = object;
    row.place = place_id(place);
    if (!from.empty()) row.from_place = place_id(from);
    row.clock.valid_from = time;
    transaction.add_event(row);
  }

  memory::Store& store() { return store_; }
  memory::Id run() const { return run_; }

 private:
  memory::Id place_id(const std::string& name) const { return places_.at(name); }

  memory::Store store_;
  mapping::World world_;
  memory::Id run_;
  memory::Id map_ = 0;
  cv::Mat depth_;  ///< of the last scene
  std::map<std::string, memory::Id> places_;
  int64_t number_ = 0;
};

}  // namespace

SampleMemory write_sample_memory(const std::filesystem::path& path) {
  SampleMemory sample{path, parse_time("2026-05-01T07:00:00Z"), parse_time("2026-05-01T07:30:00Z"),
                      parse_time("2026-05-01T08:00:00Z")};
  Writer writer(path);
  const Isometry3d at_counter = mapping::looking_at({1.7, 1.4, 1.5}, {1.75, 2.65, 0.9});
  const Isometry3d at_table = mapping::looking_at({2.0, 1.7, 1.5}, {2.0, 0.62, 0.74});
  SampleObject cup{0, {1.5, 2.5, 0.95}, {0.09, 0.12, 0.10}, {4, 0.85, 0.8}, "red", {30, 35, 205}};
  SampleObject box{0, {1.9, 2.55, 1.00}, {0.10, 0.06, 0.20}, {215, 0.75, 0.75}, "blue", {190, 105, 48}};
  SampleObject tin{0, {2.2, 2.5, 0.95}, {0.07, 0.07, 0.11}, {110, 0.7, 0.6}, "green", {45, 150, 60}};
  memory::Id cup_seen = 0;
  memory::Id box_seen = 0;
  memory::Id first_scene = 0;
  {
    memory::SceneTransaction t(writer.store(), writer.run());
    cup.object = writer.add_object(t, sample.first);
    box.object = writer.add_object(t, sample.first);
    first_scene = writer.add_scene(t, sample.first, at_counter, {cup, box}, {});
    cup_seen = writer.add_object_observation(t, first_scene, "counter_1", cup, at_counter, "appear");
    box_seen = writer.add_object_observation(t, first_scene, "counter_1", box, at_counter, "appear");
    writer.add_belief(t, sample.first, first_scene, cup, "counter_1", "seen", 0.99, first_scene, cup_seen);
    writer.add_belief(t, sample.first, first_scene, box, "counter_1", "seen", 0.99, first_scene, box_seen);
    writer.add_event(t, sample.first, first_scene, "appeared", cup.object, "counter_1");
    writer.add_event(t, sample.first, first_scene, "appeared", box.object, "counter_1");
    t.commit();
  }
  box.centre = {2.0, 0.7, 0.85};
  {
    memory::SceneTransaction t(writer.store(), writer.run());
    const memory::Id scene =
        writer.add_scene(t, sample.second, at_table, {cup, box}, {{"drawer_2_front_joint", 0.35}});
    box_seen = writer.add_object_observation(t, scene, "table_1", box, at_table, "move");
    writer.add_belief(t, sample.second, scene, cup, "counter_1", "out_of_view", 0.9, first_scene, cup_seen);
    writer.add_belief(t, sample.second, scene, box, "table_1", "seen", 0.98, scene, box_seen);
    writer.add_object_visibility(t, scene, cup.object, "out_of_view");
    writer.add_place_visibility(t, scene, "table_1", 0.9);
    writer.add_event(t, sample.second, scene, "moved", box.object, "table_1", "counter_1");
    t.commit();
  }
  {
    memory::SceneTransaction t(writer.store(), writer.run());
    tin.object = writer.add_object(t, sample.third);
    const memory::Id scene = writer.add_scene(t, sample.third, at_counter, {box, tin}, {});
    const memory::Id tin_seen =
        writer.add_object_observation(t, scene, "counter_1", tin, at_counter, "appear");
    writer.add_belief(t, sample.third, scene, cup, "counter_1", "gone", 0.04, first_scene, cup_seen);
    writer.add_belief(t, sample.third, scene, box, "table_1", "out_of_view", 0.93, scene, box_seen);
    writer.add_belief(t, sample.third, scene, tin, "counter_1", "seen", 0.99, scene, tin_seen);
    writer.add_object_visibility(t, scene, cup.object, "missed");
    writer.add_place_visibility(t, scene, "counter_1", 0.8);
    writer.add_event(t, sample.third, scene, "gone", cup.object, "counter_1", "counter_1");
    writer.add_event(t, sample.third, scene, "appeared", tin.object, "counter_1");
    t.commit();
  }
  return sample;
}

}  // namespace loci::gui::test
