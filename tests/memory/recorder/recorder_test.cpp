#include "memory/recorder/recorder.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/feature_structures.h"
#include "perception/cas/json.h"
#include "perception/types/scene_cas.h"
#include "tests/memory/belief/synthetic_scene.h"
#include "tests/memory/recorder/memory_dump.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;
using belief::SyntheticKitchen;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class RecorderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("loci_recorder_" + std::to_string(getpid()));
    make_folder(folder);
    kitchen.objects = {{"mug", SyntheticKitchen::on_table(0, 0)},
                       {"box", SyntheticKitchen::on_table(0.3, 0.1), {0.2, 0.1, 0.1}, {0.2F, 0.2F, 0.8F}}};
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  /// The scene as a pipeline would hand it over.
  SceneRecord record(double seconds, std::optional<double> to_next = {}) const {
    const belief::Scene scene = kitchen.scene(seconds, to_next);
    SceneRecord record;
    record.row.time = scene.time;
    record.row.joints = {{"drawer_1_joint", seconds > 500 ? 0.3 : 0.0}};
    record.view = scene.view;
    record.seconds_to_next = scene.seconds_to_next;
    PlaceRow table;
    table.name = "table_1";
    table.class_name = "table";
    table.height = 0.7;
    table.outline = {{-0.4, -0.2}, {0.4, -0.2}, {0.4, 0.3}, {-0.4, 0.3}};
    record.places = {table};
    for (const belief::Observation& o : scene.observations) {
      ObservationRecord observation;
      observation.evidence = o;
      observation.evidence.texture = print_on(o.box, o.descriptors[0].values[0] > 0.5F ? 1 : 2);
      observation.row.position = o.box.centre;
      observation.row.size = o.box.size;
      observation.row.hsv = HsvColor{double(10 * o.descriptors[0].values[0]), 0.5, 0.5};
      observation.row.color = "red";
      perception::types::ColorHistogram histogram = perception::types::ColorHistogram::create(*cas);
      histogram.histogram.set(std::vector<float>(400, 0.25F));
      observation.annotations.push_back({"loci.annotation.ColorHistogram", "red", 0.5, histogram});
      record.observations.push_back(observation);
    }
    return record;
  }

  /// The n-th scene of a story: a video, things that are moved, taken, hidden.
  SceneRecord story(int n) {
    if (n == 12) kitchen.object("mug").centre = SyntheticKitchen::on_table(-0.3, 0.1);
    if (n == 13) kitchen.objects.pop_back();
    if (n < 10) return record(1 + n / 30.0, 1 / 30.0);
    return record(100.0 * n);
  }
  static constexpr int kScenes = 16;

  std::filesystem::path folder;
  SyntheticKitchen kitchen;
  std::shared_ptr<perception::cas::Cas> cas =
      std::make_shared<perception::cas::Cas>(perception::types::type_system());
};

TEST_F(RecorderTest, GoesOnAsIfItHadNeverBeenStopped) {
  {
    Store store = Store::open_write(folder / "whole.loci");
    Recorder recorder(store, store.begin_run("test", "{}"));
    for (int n = 0; n < kScenes; ++n) recorder.record(story(n));
  }
  SetUp();
  // The numbers of observations in the synthetic scenes are replaced by the memory's, so a fresh kitchen will
  // do.
  for (int n = 0; n < kScenes; ++n) {
    Store store = Store::open_write(folder / "stopped.loci");
    Recorder recorder(store, store.begin_run("test", "{}"));
    recorder.record(story(n));
  }
  EXPECT_EQ(memory_dump(folder / "whole.loci"), memory_dump(folder / "stopped.loci"));
}

TEST_F(RecorderTest, MemoryIsSoundAndTellsWhatHappened) {
  Store store = Store::open_write(folder / "day.loci");
  {
    Recorder recorder(store, store.begin_run("test", "{}"));
    for (int n = 0; n < kScenes; ++n) recorder.record(story(n));
  }
  NoProgress progress;
  EXPECT_THAT(store.verify(progress).problems, IsEmpty());
  std::vector<std::string> events;
  for (const EventRow& event : store.events())
    events.push_back(to_text(event.kind) +
                     (event.object ? " " + object_name(*event.object) : " " + *event.joint));
  EXPECT_THAT(events, ElementsAre("appeared object_1", "appeared object_2", "joint_changed drawer_1_joint",
                                  "moved object_1", "gone object_2"));
  const std::vector<BeliefRow> beliefs = store.beliefs();
  ASSERT_EQ(beliefs.size(), 2U);
  EXPECT_EQ(beliefs[0].status, ObjectStatus::seen);
  EXPECT_EQ(beliefs[1].status, ObjectStatus::gone);
  EXPECT_NEAR(beliefs[0].position->x(), -0.3, 0.01);
  // Confirmed in the third frame, but believed and seen from the first on.
  EXPECT_EQ(store.observations_of(1).size(), static_cast<size_t>(kScenes));
  EXPECT_EQ(store.belief_history(1).front().clock.valid_from, kSecond);
  EXPECT_GT(store.visibility_of_place(store.places().front().id).front().fraction.value_or(0), 0.8);
}

TEST_F(RecorderTest, WhatComesUpCameAfterTheLastLookWithoutIt) {
  Store store = Store::open_write(folder / "day.loci");
  Recorder recorder(store, store.begin_run("test", "{}"));
  const auto box = kitchen.objects.back();
  const auto look = [&](double seconds, bool with_box) {
    kitchen.objects.resize(1);
    if (with_box) kitchen.objects.push_back(box);
    SceneRecord scene = record(seconds);
    const mapping::PinholeCamera& camera = scene.view.camera;
    scene.row.camera =
        SceneCamera{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, 0.3, 5};
    scene.row.map_from_camera = scene.view.map_from_camera;
    recorder.record(scene);
  };
  look(1000, false);
  look(2000, false);
  look(3000, true);   // the box appears
  look(9000, false);  // and goes
  look(9500, false);
  look(9900, true);  // and is back
  std::map<EventKind, std::optional<TimeNs>> since;
  for (const EventRow& event : store.events())
    if (event.object == 2) since[event.kind] = event.since;
  EXPECT_EQ(since.at(EventKind::appeared), 2000 * kSecond);
  EXPECT_EQ(since.at(EventKind::gone), 3000 * kSecond);
  EXPECT_EQ(since.at(EventKind::reappeared), 9500 * kSecond);
}

TEST_F(RecorderTest, PrintsOfObjectsAreStoredOnceAndForgottenWithThem) {
  const fs::path file = folder / "day.loci";
  const auto prints = [&] {
    std::map<std::string, size_t> sizes;
    for (const auto& [name, checkpoint] : Store::open_read(file).checkpoints("belief_texture/"))
      sizes[name.substr(0, name.rfind('/'))] += checkpoint.bytes.size();
    return sizes;
  };
  {
    Store store = Store::open_write(file);
    Recorder recorder(store, store.begin_run("test", "{}"));
    for (int n = 0; n < kScenes; ++n) recorder.record(story(n));
    for (const belief::ProtoObject& object : load_belief(store).objects)
      for (const belief::TextureView& view : object.textures) EXPECT_EQ(view.texture.size(), 40U);
  }
  const auto before = prints();
  ASSERT_GE(before.size(), 2U);
  EXPECT_LT(before.begin()->second, 3 * 40 * 96U)
      << "two places, from where the mug is seen, and no repetition";
  {
    Store store = Store::open_write(file);
    forget(store, {.object = 1}, store.begin_run("test", "{}"));
  }
  const auto after = prints();
  EXPECT_FALSE(after.contains(before.begin()->first));
  EXPECT_TRUE(after.contains(before.rbegin()->first));
}

TEST_F(RecorderTest, AJointIsComparedWithWhereItWasSeenLastHoweverLongAgo) {
  using Joints = std::map<std::string, double>;
  const std::vector<Joints> seen = {{{"drawer", 0.0}}, {{"drawer", 0.3}}, {}, {{"drawer", 0.3}}, {},
                                    {{"drawer", 0.0}}};
  for (const bool stopped : {false, true}) {
    SetUp();
    Store store = Store::open_write(folder / (stopped ? "stopped.loci" : "whole.loci"));
    std::optional<Recorder> recorder(std::in_place, store, store.begin_run("test", "{}"));
    for (size_t n = 0; n < seen.size(); ++n) {
      if (stopped) recorder.emplace(store, store.begin_run("test", "{}"));
      SceneRecord scene = record(100.0 * static_cast<double>(n + 1));
      scene.row.joints = seen[n];
      recorder->record(scene);
    }
    std::vector<std::pair<double, TimeNs>> moved;  // to where, and in which scene that was seen
    for (const EventRow& event : store.events())
      if (event.kind == EventKind::joint_changed)
        moved.emplace_back(*event.joint_position, event.clock.valid_from);
    EXPECT_THAT(moved, ElementsAre(std::pair(0.3, 200 * kSecond), std::pair(0.0, 600 * kSecond)));
  }
}

TEST_F(RecorderTest, FailedSceneLeavesMemoryAndBeliefAsTheyWere) {
  Store store = Store::open_write(folder / "day.loci");
  Recorder recorder(store, store.begin_run("test", "{}"));
  recorder.record(record(100));
  const std::string before = memory_dump(folder / "day.loci");
  const auto belief_before = belief::stored(recorder.belief());
  EXPECT_THROW(recorder.record(record(50)), Error);
  EXPECT_EQ(memory_dump(folder / "day.loci"), before);
  EXPECT_EQ(belief::stored(recorder.belief()), belief_before);
  recorder.record(record(200));
}

TEST_F(RecorderTest, FeatureStructuresComeBackIdenticalWithTheStoredTypeSystem) {
  Store store = Store::open_write(folder / "day.loci");
  const SceneRecord scene = record(0);
  Recorder(store, store.begin_run("test", "{}")).record(scene);
  const std::vector<FeatureStructureRow> rows = store.feature_structures(store.scenes().front().id);
  ASSERT_EQ(rows.size(), 2U);
  const auto types =
      perception::cas::TypeSystem::load({{"stored", store.type_system(rows[0].type_system)}}, {}, {});
  perception::cas::Cas fresh(types);
  const perception::cas::FeatureStructure back = read_feature_structure(store, rows[0].id, fresh);
  EXPECT_EQ(perception::cas::to_json(back).dump(),
            perception::cas::to_json(scene.observations[0].annotations[0].structure).dump());
}

TEST(RecordingFingerprint, DependsOnContentOnly) {
  const cv::Mat image(4, 4, CV_32F, cv::Scalar(1.0)), other(4, 4, CV_32F, cv::Scalar(2.0));
  const std::vector<FrameDigest> frames = {{0, 1}, {1, 2}};
  EXPECT_EQ(recording_fingerprint(frames, {image}), recording_fingerprint(frames, {image.clone()}));
  EXPECT_NE(recording_fingerprint(frames, {image}), recording_fingerprint(frames, {other}));
  EXPECT_NE(recording_fingerprint(frames, {image}), recording_fingerprint({{0, 1}, {1, 3}}, {image}));
}

}  // namespace
}  // namespace loci::memory
