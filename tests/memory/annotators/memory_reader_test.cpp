#include "memory/annotators/memory_reader.h"

#include <gmock/gmock.h>

#include "memory/recorder/recorder.h"
#include "perception/conversions/opencv.h"
#include "perception/types/scene_cas.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

/// A colour camera of more pixels beside the depth camera, as ingest and reason store it
/// (SceneRecord::cameras).
mapping::RgbdCamera beside_each_other() {
  mapping::RgbdCamera cameras;
  cameras.depth = {160, 120, 150, 151, 79.5, 59.5};
  cameras.color = {640, 480, 600, 602, 319.5, 239.5};
  cameras.depth_from_color = Isometry3d(Eigen::AngleAxisd(0.02, Vector3d::UnitY()));
  cameras.depth_from_color.translation() = Vector3d(0.025, 0, 0.001);
  return cameras;
}

class MemoryReaderTest : public testing_support::TemporaryFolder {
 protected:
  /// Records an empty scene with these cameras, and reads it as a pipeline does.
  mapping::RgbdCamera read_again(const mapping::RgbdCamera& cameras) {
    {
      Store store = Store::open_write(file_);
      Recorder recorder(store, store.begin_run("test", "{}"));
      SceneRecord record;
      record.row.time = 100 * kSecond;
      const mapping::PinholeCamera& depth = cameras.depth;
      record.row.camera =
          SceneCamera{depth.width, depth.height, depth.fx, depth.fy, depth.cx, depth.cy, 0.3, 5.0};
      record.row.map_from_camera = Isometry3d::Identity();
      record.cameras = cameras;
      recorder.record(record);
    }
    perception::Resources resources;
    resources.put_for_run(std::make_shared<MemorySource>(Store::open_read(file_)));
    perception::Context context{resources, warnings_, 1, {}};
    MemoryReader reader;
    reader.start(context);
    EXPECT_EQ(reader.count(), 1U);
    perception::cas::Cas cas(perception::types::type_system());
    reader.read_next(cas, context);
    return perception::types::cameras(perception::types::SceneCas(cas));
  }

  Warnings warnings_;
};

TEST_F(MemoryReaderTest, ReadsAColourCameraThatIsNotRegistered) {
  const mapping::RgbdCamera stored = beside_each_other(), read = read_again(stored);
  EXPECT_EQ(read.depth, stored.depth);
  EXPECT_EQ(read.color, stored.color);
  EXPECT_TRUE(read.depth_from_color.isApprox(stored.depth_from_color, 1e-9));
}

TEST_F(MemoryReaderTest, ARegisteredColourCameraIsThatOfTheDepth) {
  mapping::RgbdCamera registered;
  registered.depth = registered.color = beside_each_other().depth;
  const mapping::RgbdCamera read = read_again(registered);
  EXPECT_EQ(read.color, registered.depth);
  EXPECT_TRUE(read.depth_from_color.isApprox(Isometry3d::Identity()));
}

}  // namespace
}  // namespace loci::memory
