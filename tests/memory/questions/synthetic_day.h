#pragma once

#include <map>
#include <string>

#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory::testing_support {

inline TimeNs day_time(const std::string& clock) {
  return parse_time("2026-05-01T" + clock + ":00Z");
}

/// A day in a small memory, written scene by scene like the recorder does. A camera above looks straight down
/// at a table (1.0 x 0.8 m), or at a counter two metres beside it.
///
///   1  08:00  table    red object_1 and blue object_2 appear
///   2  08:30  counter  green object_3 appears
///   3  09:00  table    object_1 is gone
///   4  09:30  counter  object_1 is there                      (from here on known a day later)
///   5  10:00  table    something tall stands before object_2
///   6  10:30  counter  drawer_1 opens, yellow object_4 in it
class SyntheticDay {
 public:
  static constexpr TimeNs kKnownFirst = 1'900'000'000 * kSecond;
  static constexpr TimeNs kKnownSecond = kKnownFirst + 86400 * kSecond;

  explicit SyntheticDay(const std::filesystem::path& file) {
    {
      Store store = Store::open_write(file, {.now = kKnownFirst});
      begin(store);
      appear(store);
      counter_alone(store);
      red_is_gone(store);
      store.finish_run(run_);
    }
    Store store = Store::open_write(file, {.now = kKnownSecond});
    run_ = store.begin_run("loci-perceive run", "{}");
    red_is_on_the_counter(store);
    blue_is_hidden(store);
    drawer_opens(store);
    store.add_fact({.object = 1,
                    .key = "alias",
                    .value = "tea cup",
                    .clock = {.valid_from = day_time("08:00"), .source = "Ada"}},
                   run_);
    store.finish_run(run_);
  }

 private:
  void begin(Store& store) {
    run_ = store.begin_run("loci-perceive run", "{}");
    recording_ = store.add_recording({.fingerprint = "f", .name = "day", .kind = "loci", .frames = 6});
    table_ = store.add_place({.name = "table_1",
                              .class_name = "table",
                              .height = 0.75,
                              .outline = {{0, 0}, {1, 0}, {1, 0.8}, {0, 0.8}}},
                             run_);
    counter_ = store.add_place({.name = "counter_1",
                                .class_name = "counter",
                                .height = 0.75,
                                .outline = {{3, 0}, {4, 0}, {4, 0.8}, {3, 0.8}}},
                               run_);
    drawer_ = store.add_place({.name = "drawer_1_bottom",
                               .class_name = "drawer_bottom",
                               .container = true,
                               .joint = "drawer_1_joint"},
                              run_);
  }

  /// A scene with a camera 2 m above the middle of a place. `pole` = pixels of the thumbnail that see
  /// something tall.
  Id look(SceneTransaction& scene, int64_t frame, const std::string& clock, Id place, bool pole = false) {
    const double x = place == table_ ? 0.5 : 3.5;
    Isometry3d map_from_camera = Isometry3d::Identity();
    map_from_camera.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    map_from_camera.translation() = Vector3d(x, 0.4, 2.75);
    std::vector<float> depth(80 * 60, 2.0F);
    // Around (0.7, 0.5): 0.2 m right and 0.1 m up of the middle.
    for (size_t v = 21; pole && v < 33; ++v)
      for (size_t u = 41; u < 53; ++u) depth[v * 80 + u] = 1.2F;
    const Id blob = scene.add_blob(encode_depth_thumbnail(depth), kDepthThumbnailMedia);
    const Id id = scene.add_scene({.recording = recording_,
                                   .frame_index = frame,
                                   .time = day_time(clock),
                                   .camera = SceneCamera{640, 480, 585, 585, 319.5, 239.5, 0.5, 5.0},
                                   .map_from_camera = map_from_camera,
                                   .depth = blob,
                                   .depth_width = 80,
                                   .depth_height = 60});
    for (const Id other : {table_, counter_})
      scene.add_visibility({.scene = id,
                            .place = other,
                            .status = other == place ? ObjectStatus::seen : ObjectStatus::out_of_view,
                            .fraction = other == place ? 0.95 : 0.0});
    return id;
  }

  /// An object seen at a spot.
  Id see(SceneTransaction& scene, Id scene_id, int64_t number, std::optional<Id> object,
         const std::string& color, Id place, const Vector3d& at, Explanation explanation) {
    const Id seen = scene.add_observation({.scene = scene_id,
                                           .number = number,
                                           .place = place,
                                           .position = at,
                                           .size = Vector3d(0.08, 0.08, 0.1),
                                           .color = color});
    const Id id = object ? *object : scene.add_object({});
    scene.add_association({.scene = scene_id,
                           .observation = seen,
                           .object = id,
                           .explanation = explanation,
                           .probability = 0.96,
                           .chosen = true});
    scene.add_visibility({.scene = scene_id, .object = id, .status = ObjectStatus::seen, .probability = 1});
    believe(scene, scene_id, id, ObjectStatus::seen, 0.98, place, at, color, scene_id);
    last_seen_[id] = scene_id;
    return seen;
  }

  void believe(SceneTransaction& scene, Id scene_id, Id object, ObjectStatus status, double probability,
               Id place, const Vector3d& at, const std::string& color, Id last_scene) {
    scene.add_belief({.object = object,
                      .scene = scene_id,
                      .status = status,
                      .probability = probability,
                      .place = place,
                      .position = at,
                      .last_scene = last_scene,
                      .color = color,
                      .size = Vector3d(0.08, 0.08, 0.1)});
  }

  void not_seen(SceneTransaction& scene, Id scene_id, Id object, ObjectStatus status) {
    scene.add_visibility({.scene = scene_id, .object = object, .status = status, .probability = 0.9});
  }

  void appear(Store& store) {
    SceneTransaction scene(store, run_);
    const Id id = look(scene, 0, "08:00", table_);
    const Id red = see(scene, id, 0, {}, "red", table_, red_spot_, Explanation::appear);
    const Id blue = see(scene, id, 1, {}, "blue", table_, blue_spot_, Explanation::appear);
    scene.add_annotation({.scene = id, .observation = red, .type = "loci.Text", .value = "Darjeeling"});
    scene.add_event(
        {.scene = id, .kind = EventKind::appeared, .object = 1, .observation = red, .place = table_});
    scene.add_event(
        {.scene = id, .kind = EventKind::appeared, .object = 2, .observation = blue, .place = table_});
    scene.commit();
  }

  void counter_alone(Store& store) {
    SceneTransaction scene(store, run_);
    const Id id = look(scene, 1, "08:30", counter_);
    const Id green = see(scene, id, 0, {}, "green", counter_, {3.2, 0.2, 0.8}, Explanation::appear);
    scene.add_event(
        {.scene = id, .kind = EventKind::appeared, .object = 3, .observation = green, .place = counter_});
    for (const Id object : {Id{1}, Id{2}}) not_seen(scene, id, object, ObjectStatus::out_of_view);
    believe(scene, id, 1, ObjectStatus::out_of_view, 0.95, table_, red_spot_, "red", last_seen_[1]);
    believe(scene, id, 2, ObjectStatus::out_of_view, 0.95, table_, blue_spot_, "blue", last_seen_[2]);
    scene.commit();
  }

  void red_is_gone(Store& store) {
    SceneTransaction scene(store, run_);
    const Id id = look(scene, 2, "09:00", table_);
    see(scene, id, 0, 2, "blue", table_, blue_spot_, Explanation::stay);
    not_seen(scene, id, 1, ObjectStatus::missed);
    not_seen(scene, id, 3, ObjectStatus::out_of_view);
    believe(scene, id, 1, ObjectStatus::gone, 0.04, table_, red_spot_, "red", last_seen_[1]);
    scene.add_association({.scene = id,
                           .object = 1,
                           .explanation = Explanation::disappear,
                           .probability = 0.93,
                           .chosen = true});
    scene.add_event({.scene = id,
                     .kind = EventKind::gone,
                     .object = 1,
                     .from_place = table_,
                     .from_position = red_spot_,
                     .probability = 0.93,
                     .since = day_time("08:00")});
    scene.commit();
  }

  void red_is_on_the_counter(Store& store) {
    SceneTransaction scene(store, run_);
    const Id id = look(scene, 3, "09:30", counter_);
    const Id red = see(scene, id, 0, 1, "red", counter_, {3.6, 0.4, 0.8}, Explanation::move);
    see(scene, id, 1, 3, "green", counter_, {3.2, 0.2, 0.8}, Explanation::stay);
    scene.add_event({.scene = id,
                     .kind = EventKind::moved,
                     .object = 1,
                     .observation = red,
                     .place = counter_,
                     .from_place = table_,
                     .position = Vector3d(3.6, 0.4, 0.8),
                     .from_position = red_spot_,
                     .probability = 0.9,
                     .since = day_time("08:00")});
    scene.commit();
  }

  void blue_is_hidden(Store& store) {
    SceneTransaction scene(store, run_);
    const Id id = look(scene, 4, "10:00", table_, true);
    not_seen(scene, id, 2, ObjectStatus::hidden);
    believe(scene, id, 2, ObjectStatus::hidden, 0.85, table_, blue_spot_, "blue", last_seen_[2]);
    scene.add_event(
        {.scene = id, .kind = EventKind::hidden, .object = 2, .place = table_, .probability = 0.9});
    scene.commit();
  }

  void drawer_opens(Store& store) {
    SceneTransaction scene(store, run_);
    const Id id = look(scene, 5, "10:30", counter_);
    scene.add_event({.scene = id,
                     .kind = EventKind::joint_changed,
                     .place = drawer_,
                     .joint = "drawer_1_joint",
                     .joint_position = 0.35,
                     .from_joint_position = 0});
    const Id yellow = see(scene, id, 0, {}, "yellow", drawer_, {3.5, -0.3, 0.5}, Explanation::appear);
    scene.add_event(
        {.scene = id, .kind = EventKind::appeared, .object = 4, .observation = yellow, .place = drawer_});
    see(scene, id, 1, 1, "red", counter_, {3.6, 0.4, 0.8}, Explanation::stay);
    scene.commit();
  }

  Id run_ = 0, recording_ = 0, table_ = 0, counter_ = 0, drawer_ = 0;
  Vector3d red_spot_{0.3, 0.3, 0.8}, blue_spot_{0.7, 0.5, 0.8};
  std::map<Id, Id> last_seen_;
};

}  // namespace loci::memory::testing_support
