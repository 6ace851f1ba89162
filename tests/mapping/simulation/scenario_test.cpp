#include "mapping/simulation/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "mapping/simulation/play.h"
#include "mapping/world/urdf.h"
#include "tests/mapping/simulation/samples.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ScenarioFile : public testing::Test {
 protected:
  ScenarioFile() { make_folder(folder_); }
  ~ScenarioFile() override { fs::remove_all(folder_); }

  /// The states that a scenario of one scene with these actions leads to.
  WorldState state_after(const std::string& actions, const std::string& more = "") {
    const std::string text = "world: " + world_.string() +
                             "\nobjects:\n  cup: {model: mug}\n  plate: {model: plate}\n" + more +
                             "scenes:\n  - time: \"2026-05-01T07:00:00Z\"\n"
                             "    view: {from: [1.5, 1.2, 1.5], at: [1.5, 2.6, 0.9]}\n    do:\n" +
                             actions;
    write_file_atomically(folder_ / "s.yaml", text);
    const Scenario scenario = read_scenario(folder_ / "s.yaml");
    const World world = read_urdf(scenario.world);
    const ScenarioPlay play(scenario, world, {{}, kSamples});
    poses_ = play.map_from_objects(play.states().back());
    return play.states().back();
  }
  std::string refusal(const std::string& actions, const std::string& more = "") {
    try {
      state_after(actions, more);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path world_ = kSamples / "kitchen.urdf";
  fs::path folder_ =
      fs::path(testing::TempDir()) /
      (std::string("scenario_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::map<std::string, Isometry3d> poses_;
};

TEST_F(ScenarioFile, ObjectStandsOnTheMiddleOfItsSupport) {
  state_after("      - {place: cup, on: table_1, at: [0.1, -0.2]}\n");
  EXPECT_TRUE(poses_.at("cup").translation().isApprox(Vector3d(2.1, 0.42, 0.74), 1e-9));
}

TEST_F(ScenarioFile, ObjectInADrawerMovesWithIt) {
  state_after("      - {place: cup, in: drawer_2}\n");
  const Vector3d closed = poses_.at("cup").translation();
  const WorldState state =
      state_after("      - {place: cup, in: drawer_2}\n      - {open: drawer_2, to: 0.3}\n");
  EXPECT_EQ(state.objects.at("cup").support, "drawer_2_bottom");
  EXPECT_EQ(state.joints.at("drawer_2_front_joint"), 0.3);
  EXPECT_TRUE((poses_.at("cup").translation() - closed).isApprox(Vector3d(0, -0.3, 0), 1e-6));
}

/// A cabinet of 0.5 m depth before x = 0 with the front of a drawer, its lower edge at 0.5 m, and what else
/// belongs to the drawer.
void write_fronts(const fs::path& path, const std::string& front, const std::string& more = "") {
  write_file_atomically(
      path, "<robot name=\"r\"><link name=\"map\"/><link name=\"drawer_1\">" + front + more +
                "</link><joint name=\"drawer_1_joint\" type=\"prismatic\">"
                "<origin xyz=\"0 0 0.6\" rpy=\"0 0 0\"/><parent link=\"map\"/>"
                "<child link=\"drawer_1\"/><axis xyz=\"-1 0 0\"/>"
                "<limit lower=\"-0.4\" upper=\"0\" effort=\"1\" velocity=\"1\"/></joint></robot>");
}
std::string box_of(const std::string& origin, const std::string& size) {
  return "<visual><origin xyz=\"" + origin + "\" rpy=\"0 0 0\"/><geometry><box size=\"" + size +
         "\"/></geometry></visual>";
}

TEST_F(ScenarioFile, ObjectInADrawerThatIsOnlyAFrontLiesBehindItAtItsLowerEdge) {
  world_ = folder_ / "fronts.urdf";
  write_fronts(world_, box_of("-0.01 0 0", "0.02 0.5 0.2"));
  state_after("      - {place: cup, in: drawer_1, at: [0.05, 0.1]}\n");
  EXPECT_TRUE(poses_.at("cup").translation().isApprox(Vector3d(-0.17, 0.1, 0.512), 1e-6));
  EXPECT_THAT(refusal("      - {place: cup, in: drawer_1, at: [0.21, 0]}\n"), HasSubstr("is beside"));
  EXPECT_THAT(refusal("      - {place: milk, in: drawer_1}\n", "  milk: {model: bottle}\n"),
              HasSubstr("'drawer_1' has room for 0.19 m"));
  EXPECT_THAT(refusal("      - {place: milk, in: drawer_1, lying: true}\n", "  milk: {model: bottle}\n"),
              HasSubstr("no error"));
}

TEST_F(ScenarioFile, ObjectInADrawerWhoseLinkHasABoxLiesOnItsBottom) {
  world_ = folder_ / "fronts.urdf";
  write_fronts(world_, box_of("-0.01 0 0", "0.02 0.5 0.2"), box_of("-0.25 0 -0.05", "0.4 0.4 0.02"));
  state_after("      - {place: cup, in: drawer_1}\n");
  EXPECT_TRUE(poses_.at("cup").translation().isApprox(Vector3d(-0.25, 0, 0.56), 1e-6));
}

TEST_F(ScenarioFile, ASolidDrawerHasNoInside) {
  world_ = folder_ / "fronts.urdf";
  write_fronts(world_, box_of("-0.25 0 0", "0.5 0.5 0.2"));
  EXPECT_THAT(refusal("      - {place: cup, in: drawer_1}\n"),
              HasSubstr("give the world a link 'drawer_1_bottom'"));
}

TEST_F(ScenarioFile, WhatOpensIsNamedByItsLinkOrByItsJoint) {
  world_ = folder_ / "other.urdf";
  write_file_atomically(world_, R"(<robot name="r"><link name="map"/><link name="lade"/>
    <joint name="gleiter" type="prismatic"><parent link="map"/><child link="lade"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" effort="1" velocity="1"/></joint></robot>)");
  EXPECT_EQ(state_after("      - {open: lade, to: 0.3}\n").joints.at("gleiter"), 0.3);
  EXPECT_EQ(state_after("      - {open: gleiter, to: 0.2}\n").joints.at("gleiter"), 0.2);
}

TEST_F(ScenarioFile, ObjectOnAnObjectFollowsIt) {
  state_after(
      "      - {place: plate, on: table_1}\n      - {place: cup, on: plate}\n"
      "      - {move: plate, on: counter_1, at: [0.5, 0]}\n");
  EXPECT_NEAR(poses_.at("cup").translation().x(), 2.1, 1e-9);
  EXPECT_GT(poses_.at("cup").translation().z(), 0.90);
  EXPECT_LT(poses_.at("cup").translation().z(), 0.922);
}

TEST_F(ScenarioFile, LyingObjectTouchesItsSupport) {
  const std::string object = "  milk: {model: bottle}\n";
  state_after("      - {place: milk, on: table_1, lying: true}\n", object);
  const Isometry3d pose = poses_.at("milk");
  double lowest = 1;
  ObjectSpec spec;
  spec.model = "bottle";
  for (const auto& vertex : build_object(spec).mesh.vertices)
    lowest = std::min(lowest, (pose * vertex.cast<double>()).z());
  EXPECT_NEAR(lowest, 0.74, 1e-6);
}

TEST_F(ScenarioFile, MistakesAreNamedWithWhatWasMeant) {
  EXPECT_THAT(refusal("      - {place: cap, on: table_1}\n"),
              HasSubstr("unknown object 'cap'; did you mean 'cup'?"));
  EXPECT_THAT(refusal("      - {place: cup, on: tabel_1}\n"),
              HasSubstr("unknown link 'tabel_1'; did you mean 'table_1'?"));
  EXPECT_THAT(refusal("      - {place: cup, onn: table_1}\n"),
              HasSubstr("unknown key 'onn'; did you mean 'on'?"));
  EXPECT_THAT(refusal("      - {plce: cup, on: table_1}\n"),
              HasSubstr("unknown action 'plce'; did you mean 'place'?"));
  EXPECT_THAT(refusal("      - {open: drawer_7, to: 0.1}\n"),
              HasSubstr("'drawer_7' does not open; did you mean 'drawer_"));
  EXPECT_THAT(refusal("      - {open: drawer_1, to: 0.9}\n"), HasSubstr("moves from 0 to 0.5, not to 0.9"));
  EXPECT_THAT(refusal("      - {place: cup, on: table_1, at: [3, 0]}\n"), HasSubstr("is beside 'table_1'"));
  EXPECT_THAT(refusal("      - {remove: cup}\n"), HasSubstr("'cup' is not there"));
  EXPECT_THAT(refusal("      - {place: cup}\n"), HasSubstr("it is not said where"));
  EXPECT_THAT(refusal("      - {remove: cup}\n", "  x: {model: mugg}\n"),
              HasSubstr("unknown model 'mugg'; did you mean 'mug'?"));
  EXPECT_THAT(refusal("      - {place: cup, on: plate}\n"), HasSubstr("'plate' is not there"));
  EXPECT_THAT(refusal("      - {place: plate, on: table_1}\n      - {place: cup, on: plate}\n"
                      "      - {move: plate, on: cup}\n"),
              HasSubstr("cannot stand on itself"));
  EXPECT_THAT(refusal("      - {place: cup, on: tabel_1}\n"), HasSubstr("s.yaml:9"));
}

TEST_F(ScenarioFile, ScenesMustFollowEachOther) {
  write_file_atomically(
      folder_ / "s.yaml",
      "world: kitchen.urdf\nscenes:\n"
      "  - {time: \"2026-05-01T07:00:00Z\", view: {from: [0, 0, 1], at: [1, 0, 1]}, frames: 5}\n"
      "  - {time: \"2026-05-01T07:00:03Z\", view: {from: [0, 0, 1], at: [1, 0, 1]}}\n");
  EXPECT_THROW(read_scenario(folder_ / "s.yaml"), Error);
}

TEST_F(ScenarioFile, FramesAreCountedBeforeMemoryIsTaken) {
  const auto refusal_of = [&](const std::string& scene) -> std::string {
    write_file_atomically(
        folder_ / "s.yaml",
        "world: kitchen.urdf\nscenes:\n  - {time: \"2026-05-01T07:00:00Z\", " + scene + "}\n");
    try {
      read_scenario(folder_ / "s.yaml");
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const std::string sweep =
      "sweep: {positions: [[0, 0, 1], [1, 0, 1]], pitch_deg: [0, 10], yaw_deg: [0, 90, ";
  EXPECT_EQ(refusal_of(sweep + "2]}, frames: 10"), "");
  EXPECT_THAT(refusal_of(sweep + "1000]}, frames: 251"), HasSubstr("more than 1000000 frames"));
  EXPECT_THAT(refusal_of(sweep + "1e300]}"), HasSubstr("expected [first, last, count]"));
  EXPECT_THAT(refusal_of(sweep + ".nan]}"), HasSubstr("expected [first, last, count]"));
}

TEST(Scenario, CameraLooksWhereItIsTold) {
  const Isometry3d pose = looking_at({1, 1, 1.5}, {1, 3, 0.5});
  const Vector3d target = pose.inverse() * Vector3d(1, 3, 0.5);
  EXPECT_NEAR(target.x(), 0, 1e-12);
  EXPECT_NEAR(target.y(), 0, 1e-12);
  EXPECT_GT(target.z(), 0);
  EXPECT_LT((pose.inverse() * Vector3d(1, 3, 1)).y(), 0) << "what is higher is further up in the image";
  EXPECT_GT((pose.inverse() * Vector3d(2, 3, 0.5)).x(), 0) << "east is right when looking north";
  EXPECT_NEAR(pose.linear().determinant(), 1, 1e-12);
}

TEST(Samples, DayAndTourArePlayable) {
  for (const char* name : {"day.yaml", "tour.yaml"}) {
    const Scenario scenario = read_scenario(kSamples / name);
    const World world = read_urdf(scenario.world);
    EXPECT_EQ(ScenarioPlay(scenario, world, {{}, kSamples}).states().size(), scenario.scenes.size());
  }
  EXPECT_GE(read_scenario(kSamples / "day.yaml").scenes.size(), 8U);
  EXPECT_GE(read_scenario(kSamples / "day.yaml").objects.size(), 12U);
}

TEST(Samples, DayHasTwoIdenticalCups) {
  const Scenario day = read_scenario(kSamples / "day.yaml");
  const ObjectModel a = build_object(day.objects.at("cup_1"));
  const ObjectModel b = build_object(day.objects.at("cup_2"));
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.colors, b.mesh.colors);
}

}  // namespace
}  // namespace loci::mapping
