#include "perception/annotators/io/recording_reader.h"

#include <gtest/gtest.h>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

/// One frame, with or without a pose.
class OneFrame : public mapping::Recording {
 public:
  explicit OneFrame(mapping::RgbdFrame frame, const std::string& map_frame) : frame_(std::move(frame)) {
    info_.frames = 1;
    info_.frames_with_pose = frame_.map_from_camera ? 1 : 0;
    info_.map_frame = map_frame;
    info_.camera = frame_.camera;
  }
  const mapping::RecordingInfo& info() const override { return info_; }
  size_t size() const override { return 1; }
  mapping::RgbdFrame frame(size_t) const override { return frame_; }
  TimeNs time_of(size_t) const override { return 0; }
  int64_t index_of(size_t) const override { return 0; }

 private:
  mapping::RgbdFrame frame_;
  mapping::RecordingInfo info_;
};

/// The pose of the scene that the reader makes of a recording.
Isometry3d pose_read(const std::shared_ptr<mapping::Recording>& recording,
                     const std::shared_ptr<KnownMap>& map) {
  Resources resources;
  resources.put(recording);
  if (map) resources.put(map);
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  RecordingReader reader;
  reader.start(context);
  cas::Cas cas(types::type_system());
  reader.read_next(cas, context);
  return map_from_camera(types::SceneCas(cas).scene());
}

std::shared_ptr<KnownMap> levelled_map(const Isometry3d& map_from_input) {
  mapping::World world;
  world.name = "kitchen";
  world.links.emplace_back().name = "map";
  mapping::SemanticMap semantics;
  semantics.map_from_input = map_from_input;
  Warnings warnings;
  return KnownMap::make(std::move(world), std::move(semantics), {}, warnings);
}

TEST(RecordingReader, PosesAreMovedAsTheInputOfTheMapWas) {
  mapping::RgbdFrame frame;
  frame.depth = cv::Mat(frame.camera.depth.height, frame.camera.depth.width, CV_32F, cv::Scalar(1));
  frame.map_from_camera = Isometry3d(Eigen::Translation3d(1, 2, 3));
  Isometry3d map_from_input(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()));
  map_from_input.translation().z() = 1.4;
  const auto map = levelled_map(map_from_input);
  const auto elsewhere = std::make_shared<OneFrame>(frame, "world");
  EXPECT_TRUE(pose_read(elsewhere, map).isApprox(map_from_input * *frame.map_from_camera, 1e-9));
  EXPECT_TRUE(pose_read(elsewhere, nullptr).isApprox(*frame.map_from_camera, 1e-9));
  // Poses in the frame of the map stay.
  EXPECT_TRUE(
      pose_read(std::make_shared<OneFrame>(frame, "map"), map).isApprox(*frame.map_from_camera, 1e-9));
}

}  // namespace
}  // namespace loci::perception
