#include "mapping/exchange/formats/mjcf.h"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <memory>

#include "mapping/base/files.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/world/kinematics.h"
#include "tests/mapping/exchange/furnished_map.h"
#include "tests/mapping/exchange/photographed_map.h"
#include "tests/mapping/exchange/scanned_kitchens.h"

namespace loci::mapping::test {
namespace {

/// A world in MuJoCo, through its MJCF.
class Simulation {
 public:
  explicit Simulation(const World& world, const MeshSearch& search = {}) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) /
        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".xml");
    Warnings warnings;
    write_file_atomically(file, mjcf_text(world, search, warnings));
    mju_user_warning = [](const char*) {};  // otherwise it writes a log beside the tests
    std::array<char, 1000> error{};
    model_.reset(mj_loadXML(file.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
    EXPECT_NE(model_, nullptr) << error.data();
    if (!model_) throw std::runtime_error("MuJoCo does not read the map");
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
  }

  mjModel& model() { return *model_; }
  int contacts() const { return data_->ncon; }
  int id(mjtObj kind, const std::string& name) const { return mj_name2id(model_.get(), kind, name.c_str()); }
  double position(const std::string& joint) const {
    return data_->qpos[model_->jnt_qposadr[id(mjOBJ_JOINT, joint)]];
  }

  /// Pulls at a body's centre of mass, N, in the map's axes.
  void pull(const std::string& body, const Vector3d& force, double seconds) {
    mjtNum* applied = data_->xfrc_applied + 6 * id(mjOBJ_BODY, body);
    std::copy_n(force.data(), 3, applied);
    step(seconds);
    std::fill_n(applied, 3, 0);
  }

  /// The joint's own motor at full effort, all other joints held closed. Returns where it ends.
  double open(const std::string& joint, double seconds) {
    mj_resetData(model_.get(), data_.get());
    const int moving = id(mjOBJ_JOINT, joint);
    const int motor = id(mjOBJ_ACTUATOR, joint);
    for (double time = 0; time < seconds; time += model_->opt.timestep) {
      for (int i = 0; i < model_->njnt; ++i)
        if (i != moving) data_->qpos[i] = data_->qvel[i] = 0;
      data_->ctrl[motor] = model_->actuator_ctrlrange[2 * motor + 1];
      mj_step(model_.get(), data_.get());
    }
    return position(joint);
  }

 private:
  void step(double seconds) {
    for (double time = 0; time < seconds; time += model_->opt.timestep) mj_step(model_.get(), data_.get());
  }

  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

void expect_all_open(const World& world) {
  Simulation simulation(world);
  EXPECT_EQ(simulation.contacts(), 0);
  for (const Joint& joint : world.joints) {
    if (joint.type == JointType::fixed) continue;
    EXPECT_GT(simulation.open(joint.name, 3), 0.97 * joint.limits->upper) << joint.name;
  }
}

TEST(Mjcf, MuJoCoReadsTheSameBodiesAndJointsFromIt) {
  const FurnishedMap map;
  Simulation simulation(map.world);
  for (const Link& link : map.world.links) EXPECT_GE(simulation.id(mjOBJ_BODY, link.name), 0) << link.name;
  const int drawer = simulation.id(mjOBJ_JOINT, "drawer_1_front_joint");
  ASSERT_GE(drawer, 0);
  EXPECT_EQ(simulation.model().jnt_type[drawer], mjJNT_SLIDE);
  EXPECT_DOUBLE_EQ(simulation.model().jnt_range[2 * drawer + 1], 0.42);
  EXPECT_EQ(simulation.model().jnt_type[simulation.id(mjOBJ_JOINT, "door_1_joint")], mjJNT_HINGE);
  EXPECT_EQ(simulation.model().njnt, 2);
}

TEST(Mjcf, ADrawerPulledByAForceOpens) {
  const FurnishedMap map;
  Simulation simulation(map.world);
  EXPECT_EQ(simulation.contacts(), 0);
  simulation.pull("drawer_1_handle", {0, -15, 0}, 2);
  EXPECT_GT(simulation.position("drawer_1_front_joint"), 0.4);
  EXPECT_NEAR(simulation.position("door_1_joint"), 0, 0.01);
}

TEST(Mjcf, TightFurnitureStandsFreeWhenClosedAndOpensToItsLimits) {
  expect_all_open(tight_furniture().world);
}

TEST(Mjcf, SoDoesAKitchenAsItWasScanned) {
  expect_all_open(scanned_sample_kitchen().world);
}

TEST(Mjcf, SoDoesTheKitchenOfALaboratory) {
  const std::optional<InterpretedMap> map = scanned_laboratory_kitchen();
  if (!map) GTEST_SKIP() << "no shared data";
  expect_all_open(map->world);
}

TEST(Mjcf, MuJoCoReadsAKitchenOfMeshes) {
  const std::filesystem::path kitchens = std::filesystem::path(LOCI_SHARED_DIR) / "data/kitchens";
  const std::filesystem::path urdf = kitchens / "iai_kitchen/kitchen.urdf";
  if (!std::filesystem::exists(urdf)) GTEST_SKIP() << "no shared data";
  Simulation simulation(read_urdf(urdf), {{kitchens}, urdf.parent_path()});
  EXPECT_GE(simulation.model().njnt, 18);
  EXPECT_GT(simulation.model().nmesh, 0);
}

TEST(Mjcf, TexturesAreSheetsThatTouchNothing) {
  InterpretedMap map = photographed_map();
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "mjcf_textures";
  std::filesystem::create_directories(folder / "textures");
  for (const auto& [name, bytes] : add_textures(map)) write_file_atomically(folder / name, bytes);
  Simulation simulation(map.world, {{}, folder});
  EXPECT_EQ(simulation.contacts(), 0);
  EXPECT_NEAR(simulation.open("door_1_joint", 4), map.world.find_joint("door_1_joint")->limits->upper, 0.1);
}

}  // namespace
}  // namespace loci::mapping::test
