#include "mapping/tracking/tracking.h"
#include "mapping/recording/posed_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "mapping/tracking/alignment.h"
#include "mapping/tracking/known_poses.h"
#include "mapping/tracking/noise_estimate.h"
#include "mapping/tracking/pose_graph.h"

namespace loci::mapping {
namespace {

using ::testing::HasSubstr;

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Box {
  Vector3d low, high;
};

/// Smooth pattern of patches, different everywhere.
double texture(const Vector3d& p) {
  double value = 0;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3i cell = (p / 0.07 + Vector3d::Constant(1000 + 31 * i)).array().floor().cast<int>();
    const auto hash = [](int n, uint32_t factor) { return static_cast<uint32_t>(n) * factor; };
    const uint32_t mixed = hash(cell.x(), 73856093) ^ hash(cell.y(), 19349663) ^ hash(cell.z(), 83492791) ^
                           static_cast<uint32_t>(i);
    Random random(static_cast<uint64_t>(static_cast<int32_t>(mixed)));  // with which the bounds were set
    value += random.uniform() / 3;
  }
  return 60 + 180 * value;
}

/// A room with boxes in it, seen by a small depth camera with noise that walks through it.
class Room : public Recording {
 public:
  explicit Room(std::vector<Isometry3d> poses) : poses_(std::move(poses)) {
    info_.path = "room";
    info_.frames = poses_.size();
    info_.camera.depth = {160, 120, 140, 140, 79.5, 59.5};
    info_.camera.color = info_.camera.depth;
    info_.camera.depth_from_color.translation().x() = 0.02;
  }

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return poses_.size(); }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond / 30; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame;
    frame.index = index_of(i);
    frame.time_ns = time_of(i);
    frame.camera = info_.camera;
    const PinholeCamera& camera = info_.camera.depth;
    frame.depth =
        cv::Mat(camera.height, camera.width, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    frame.color = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar::all(128));
    if (given_) frame.map_from_camera = given_(poses_[i], i);
    if (blind_.contains(i)) return frame;
    Random random = Random(5).fork(i);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        const double z = depth_along(i, poses_[i], camera.unproject(u, v, 1));
        const double measured =
            z + (random.normal(0.001) + distortion_ * std::sin(0.05 * u + 0.02 * v)) * z * z;
        if (z < 5) frame.depth.at<float>(v, u) = static_cast<float>(measured);
        if (!textured_) continue;
        const Isometry3d eye = poses_[i] * info_.camera.depth_from_color;
        const Vector3d ray = camera.unproject(u, v, 1);
        const double value = texture(eye * Vector3d(ray * depth_along(i, eye, ray))) + random.normal(2);
        frame.color.at<cv::Vec3b>(v, u) =
            cv::Vec3b::all(static_cast<uint8_t>(std::min(255.0, exposure_(i) * value)));
      }
    return frame;
  }

  const std::vector<Isometry3d>& poses() const { return poses_; }

  std::vector<Box> boxes_ = {{{0.5, -0.4, -1}, {0.9, 0.2, -0.2}},
                             {{1.0, 0.5, -1}, {1.5, 1.0, 0.3}},
                             {{1.2, -1.2, -1}, {1.6, -0.7, 0.1}},
                             {{1.7, -0.4, 0.2}, {2.0, 0.4, 0.7}}};
  std::vector<Box> changed_;  ///< the boxes from the frame `changes_at_` on
  size_t changes_at_ = SIZE_MAX;
  bool textured_ = true;
  bool only_wall_ = false;
  double distortion_ = 0;  // of depth, times z².
  std::function<double(size_t)> exposure_ = [](size_t) { return 1.0; };
  std::set<size_t> blind_;
  std::function<std::optional<Isometry3d>(const Isometry3d&, size_t)> given_;

 private:
  double depth_along(size_t i, const Isometry3d& pose, const Vector3d& ray) const {
    const Vector3d origin = pose.translation(), direction = pose.linear() * ray;
    if (only_wall_) return (2 - origin.x()) / direction.x();
    const Vector3d low(-1.5, -1.8, -1), high(2, 1.8, 1.4);
    double nearest = kFar;
    for (int k = 0; k < 3; ++k)
      if (std::abs(direction[k]) > 1e-9)
        nearest = std::min(nearest, ((direction[k] > 0 ? high[k] : low[k]) - origin[k]) / direction[k]);
    for (const Box& box : i < changes_at_ ? boxes_ : changed_) {
      const Vector3d a = (box.low - origin).cwiseQuotient(direction),
                     b = (box.high - origin).cwiseQuotient(direction);
      const double enter = a.cwiseMin(b).maxCoeff(), leave = a.cwiseMax(b).minCoeff();
      if (enter < leave && enter > 0) nearest = std::min(nearest, enter);
    }
    return nearest;
  }

  std::vector<Isometry3d> poses_;
  RecordingInfo info_;
};

/// A camera at (x, y) that looks along x, turned by `yaw`.
Isometry3d camera_at(double x, double y, double yaw, double pitch = 0) {
  Isometry3d pose = Isometry3d::Identity();
  Eigen::Matrix3d optical;
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.linear() =
      Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) * optical;
  pose.translation() = Vector3d(x, y, 0.2 + 0.1 * pitch);
  return pose;
}

std::vector<Isometry3d> walk(size_t frames) {
  std::vector<Isometry3d> poses;
  for (size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / 30;
    poses.push_back(
        camera_at(-1.2 + 0.1 * t, 0.3 * std::sin(1.5 * t), 0.4 * std::sin(1.1 * t), 0.15 * std::sin(2 * t)));
  }
  return poses;
}

TrackingResult tracked(const Room& room, TrackingOptions options = {}) {
  NoProgress progress;
  return track(room, options, progress);
}

/// The largest error of a good frame, after the first frames are brought together.
double max_error(const Room& room, const TrackingResult& result) {
  double error = 0;
  const TrackedFrame* first = nullptr;
  for (const TrackedFrame& frame : result.frames) {
    if (!frame.map_from_camera) continue;
    if (first == nullptr) first = &frame;
    const Isometry3d measured = first->map_from_camera->inverse() * *frame.map_from_camera;
    const Isometry3d truth = room.poses()[first->number].inverse() * room.poses()[frame.number];
    error = std::max(error, (measured.translation() - truth.translation()).norm());
  }
  return error;
}

TEST(Tracking, FollowsAWalkThroughARoom) {
  const Room room(walk(60));
  const TrackingResult result = tracked(room);
  EXPECT_EQ(result.good(), 60U);
  EXPECT_LT(max_error(room, result), 0.01);
  EXPECT_GT(result.keyframes, 1U);
  EXPECT_FALSE(result.still);
  EXPECT_THAT(result.summary(), HasSubstr("60 of 60 frames tracked"));
}

TEST(Tracking, CamerasAdaptTheirExposure) {
  Room room(walk(60));
  room.exposure_ = [](size_t i) { return i < 20 ? 1.0 : i < 40 ? 0.45 : 1.7; };
  const TrackingResult result = tracked(room);
  EXPECT_EQ(result.good(), 60U);
  EXPECT_LT(max_error(room, result), 0.01);
}

TEST(Tracking, FastMotionStartsFromFeatures) {
  const Room room(walk(120));
  TrackingOptions options;
  options.every = 8;
  const TrackingResult result = tracked(room, options);
  EXPECT_EQ(result.good(), result.frames.size());
  EXPECT_LT(max_error(room, result), 0.015);
}

TEST(Tracking, ACameraThatStandsStillIsRecognised) {
  const Room room(std::vector<Isometry3d>(12, camera_at(-1.2, 0, 0)));
  const TrackingResult result = tracked(room);
  EXPECT_TRUE(result.still);
  EXPECT_EQ(result.good(), 12U);
  EXPECT_EQ(max_error(room, result), 0);
  EXPECT_THAT(result.summary(), HasSubstr("stands still"));
}

TEST(Tracking, AWallWithoutTextureIsLostNotGuessed) {
  Room room(walk(10));
  room.only_wall_ = true;
  room.textured_ = false;
  const TrackingResult result = tracked(room);
  EXPECT_EQ(result.good(), 1U);  // The first, which defines the map frame.
  EXPECT_THAT(result.frames[5].objection, HasSubstr("do not determine the pose"));
  EXPECT_THAT(result.summary(), HasSubstr("9 lost"));
  EXPECT_THAT(result.summary(), testing::Not(HasSubstr("stands still")));
}

TEST(Tracking, TheFirstFrameAloneIsNotTracked) {
  Room room(walk(10));
  room.only_wall_ = true;
  room.textured_ = false;
  EXPECT_THROW(require_usable(tracked(room), "room"), Error);
  EXPECT_NO_THROW(require_usable(tracked(Room(walk(1))), "room"));
  EXPECT_NO_THROW(require_usable(tracked(Room(walk(2))), "room"));
}

TEST(Tracking, TheColoursOfAFlatWallDetermineThePose) {
  Room room(walk(20));
  room.only_wall_ = true;
  const TrackingResult result = tracked(room);
  EXPECT_EQ(result.good(), 20U);
  EXPECT_LT(max_error(room, result), 0.02);
}

TEST(Tracking, FindsBackAfterFramesWithoutDepth) {
  Room room(walk(60));
  for (size_t i = 25; i < 35; ++i) room.blind_.insert(i);
  const TrackingResult result = tracked(room);
  EXPECT_EQ(result.good(), 50U);
  EXPECT_THAT(result.frames[30].objection, HasSubstr("hardly any depth"));
  EXPECT_FALSE(result.frames[30].map_from_camera);
  EXPECT_LT(max_error(room, result), 0.015);
}

TEST(Tracking, AnotherPlaceIsLostAndTheKnownOneFoundAgain) {
  std::vector<Isometry3d> poses = walk(30);
  for (int i = 0; i < 10; ++i) poses.push_back(camera_at(0, 0, kPi, 0.02 * i));
  for (int i = 0; i < 10; ++i) poses.push_back(camera_at(-1.1, 0.05, 0.01 * i));
  const Room room(poses);
  const TrackingResult result = tracked(room);
  for (size_t i = 30; i < 40; ++i) EXPECT_FALSE(result.frames[i].map_from_camera) << i;
  for (size_t i = 41; i < 50; ++i)
    EXPECT_TRUE(result.frames[i].map_from_camera) << i << result.frames[i].objection;
  EXPECT_LT(max_error(room, result), 0.05);
}

/// Frames 40 to 49 come back to where the first ones were, and the boxes stand `shift` metres farther away.
Room room_that_changed(double shift) {
  std::vector<Isometry3d> poses = walk(30);
  for (int i = 0; i < 10; ++i) poses.push_back(camera_at(0, 0, kPi, 0.02 * i));
  for (int i = 0; i < 10; ++i) poses.push_back(camera_at(-1.1, 0.05, 0.01 * i));
  Room room(poses);
  room.changes_at_ = 40;
  room.changed_ = room.boxes_;
  for (Box& box : room.changed_) {
    box.low.x() += shift;
    box.high.x() += shift;
  }
  return room;
}

/// What fits from frame to frame is not enough: depth behind the known surfaces contradicts the place.
TEST(Tracking, APlaceWhoseDepthContradictsIsNotTheKnownOne) {
  const TrackingResult result = tracked(room_that_changed(0.3));
  for (size_t i = 40; i < 50; ++i) EXPECT_FALSE(result.frames[i].map_from_camera) << i;
}

/// What little stands nearer hides known surfaces and does not contradict them.
TEST(Tracking, WhatIsHiddenDoesNotContradictAKnownPlace) {
  Room room = room_that_changed(0);
  room.changed_.push_back({{0.2, -0.1, -0.1}, {0.4, 0.1, 0.1}});
  const TrackingResult result = tracked(room);
  for (size_t i = 40; i < 50; ++i) EXPECT_TRUE(result.frames[i].map_from_camera) << i;
  EXPECT_LT(max_error(room, result), 0.015);
}

/// Where much stands nearer, all of the model in view may agree: the old depth saw through it.
TEST(Tracking, APlaceWithMuchInItsFreeSpaceIsNotTheKnownOne) {
  const TrackingResult result = tracked(room_that_changed(-0.3));
  for (size_t i = 40; i < 50; ++i) EXPECT_FALSE(result.frames[i].map_from_camera) << i;
}

TEST(Tracking, WhatIsTrackedLongestCounts) {
  std::vector<Isometry3d> poses;
  for (int i = 0; i < 10; ++i) poses.push_back(camera_at(0, 0, kPi, 0.02 * i));
  for (const Isometry3d& pose : walk(40)) poses.push_back(pose);
  const Room room(poses);
  const TrackingResult result = tracked(room);
  for (size_t i = 0; i < 10; ++i) EXPECT_FALSE(result.frames[i].map_from_camera) << i;
  EXPECT_THAT(result.frames[3].objection, HasSubstr("nothing connects it"));
  EXPECT_GT(result.good(), 33U);
  EXPECT_LT(max_error(room, result), 0.015);
}

/// An empty room without texture: a corner with a box in it, a bare wall, another such corner, and back.
Room two_corners() {
  std::vector<Isometry3d> poses;
  for (int i = -36; i <= 36; ++i) poses.push_back(camera_at(0, 0, (130 - 2.5 * std::abs(i)) * kDegree, 0.1));
  Room room(poses);
  room.textured_ = false;
  room.boxes_ = {{{1.3, 1.1, -1}, {2, 1.8, -0.1}}, {{-1.5, 1.0, -1}, {-0.9, 1.8, 0}}};
  return room;
}

/// Along the bare wall the camera slides: what was seen behind it is not known to be right.
TEST(Tracking, WhatABareWallSeparatesIsAnotherPart) {
  const Room room = two_corners();
  const TrackingResult result = tracked(room);
  for (size_t i = 0; i < 5; ++i) EXPECT_TRUE(result.frames[i].map_from_camera) << i;
  for (size_t i = 34; i < 39; ++i) {
    EXPECT_FALSE(result.frames[i].map_from_camera) << i;
    EXPECT_THAT(result.frames[i].objection, HasSubstr("nothing connects it")) << i;
  }
  for (size_t i = 68; i < 73; ++i) EXPECT_TRUE(result.frames[i].map_from_camera) << i;
  EXPECT_LT(max_error(room, result), 0.02);
}

/// The contradiction between the first frame and another at a pose that is wrong by `error`.
double contradiction_of(const Room& room, size_t other, const Isometry3d& error = Isometry3d::Identity()) {
  const tracking::Keyframe keyframe(0, tracking::frame_images(room.frame(0)), {});
  const std::vector<tracking::Reference> reference = {{&keyframe, room.poses()[0]}};
  return contradiction(tracking::frame_images(room.frame(other)), reference, room.poses()[other] * error);
}

TEST(Contradiction, TheRightPoseHasNone) {
  const Room room({camera_at(-1.2, 0, 0), camera_at(-1.1, 0.5, -0.2), camera_at(-0.6, -0.4, 0.3)});
  EXPECT_LT(contradiction_of(room, 0), 0.01);
  EXPECT_LT(contradiction_of(room, 1), 0.02);
  EXPECT_LT(contradiction_of(room, 2), 0.02);
}

TEST(Contradiction, AWrongPoseHasMuch) {
  const Room room({camera_at(-1.2, 0, 0), camera_at(-1.1, 0.1, 0)});
  Isometry3d shift = Isometry3d::Identity();
  shift.translation().x() = 0.36;
  EXPECT_GT(contradiction_of(room, 1, shift), 0.05);
  EXPECT_GT(contradiction_of(room, 1, shift.inverse()), 0.05);
}

/// What stands nearer hides all that could disagree in the frame: only the keyframe's depth sees through it.
TEST(Contradiction, EachViewChecksTheOther) {
  for (const double shift : {-0.4, 0.4}) {
    Room room({camera_at(-1.2, 0, 0), camera_at(-1.2, 0, 0)});
    room.changes_at_ = 1;
    room.changed_ = room.boxes_;
    for (Box& box : room.changed_) box.low.x() += shift, box.high.x() += shift;
    EXPECT_GT(contradiction_of(room, 1), 0.05) << shift;
  }
}

TEST(Tracking, TheAdviceFitsTheReason) {
  const auto advice = [](TimeNs interval, const std::string& objection, double noise = 0) {
    TrackingResult result;
    result.depth_noise = noise;
    for (int i = 0; i < 20; ++i) result.frames.push_back({0, i, i * interval, {}, {}, objection});
    try {
      require_usable(result, "room");
    } catch (const Error& error) {
      return error.hint();
    }
    return std::string();
  };
  EXPECT_THAT(advice(60 * kSecond, "no keyframe shows the same"), HasSubstr("frames are 60 s apart"));
  EXPECT_THAT(advice(kSecond / 30, "no keyframe shows the same"), HasSubstr("move more slowly"));
  EXPECT_THAT(advice(kSecond / 30, "there is hardly any depth in range"), HasSubstr("depth_scale"));
  EXPECT_THAT(advice(kSecond / 30, "the depth does not fit the model", 0.005), HasSubstr("noise"));
  EXPECT_THAT(advice(60 * kSecond, "the surfaces in view do not determine the pose"), HasSubstr("corners"));
}

TEST(Tracking, TheNoiseOfDepthIsEstimatedFromTheImages) {
  EXPECT_NEAR(tracking::depth_noise_per_z2(Room(walk(20))).value_or(0), 0.001, 0.0004);
}

TEST(Tracking, TheFixedErrorOfTheDepthCameraIsFoundAndUndone) {
  Room room(walk(80));
  room.distortion_ = 0.004;
  const TrackingResult result = tracked(room);
  EXPECT_EQ(result.good(), 80U);
  EXPECT_NEAR(result.depth_offset, 0.003, 0.001);
  EXPECT_LT(max_error(room, result), 0.02);
  EXPECT_EQ(tracked(Room(walk(20))).depth_offset, 0);
}

/// Mean absolute difference of the measured inverse depths, in 1/m.
double depth_difference(const Recording& a, const Recording& b, size_t number) {
  const cv::Mat first = a.frame(number).depth, second = b.frame(number).depth;
  const cv::Mat both = (first == first) & (second == second);
  return cv::mean(cv::abs(1 / first - 1 / second), both)[0];
}

TEST(Tracking, WhatIsTrackedIsReadWithoutTheFixedError) {
  Room distorted(walk(80)), straight(walk(80));
  distorted.distortion_ = -0.004;
  const TrackingResult result = tracked(distorted);
  Warnings warnings;
  const auto corrected = with_tracked_poses(std::make_unique<Room>(distorted), result, false, warnings);
  EXPECT_LT(depth_difference(*corrected, straight, 40), 0.4 * depth_difference(distorted, straight, 40));
}

TEST(Tracking, AFewCentimetresAreEnoughToFindTheFixedError) {
  Room room(walk(30));
  room.distortion_ = 0.004;
  const TrackingResult result = tracked(room);
  EXPECT_NEAR(result.depth_offset, 0.003, 0.001);
  EXPECT_LT(max_error(room, result), 0.02);
}

TEST(Tracking, SameResultOnAnyNumberOfThreads) {
  const Room room(walk(20));
  TrackingOptions one, three;
  one.threads = 1;
  three.threads = 3;
  const TrackingResult a = tracked(room, one), b = tracked(room, three);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (size_t i = 0; i < a.frames.size(); ++i) {
    ASSERT_EQ(a.frames[i].map_from_camera.has_value(), b.frames[i].map_from_camera.has_value());
    EXPECT_EQ(a.frames[i].map_from_camera->matrix(), b.frames[i].map_from_camera->matrix());
    EXPECT_EQ(a.frames[i].covariance, b.frames[i].covariance);
  }
}

TEST(Tracking, GivenPosesAreRefinedInTheirFrame) {
  Room room(walk(30));
  room.given_ = [](const Isometry3d& pose, size_t i) {
    Random random = Random(3).fork(i);
    Isometry3d noisy = pose;
    noisy.translation() += Vector3d(random.normal(0.02), random.normal(0.02), random.normal(0.02));
    return std::optional(noisy);
  };
  TrackingOptions options;
  options.refine = true;
  EXPECT_THROW(tracked(room, options), Error);  // Its info says that there are none.
  class Posed : public Room {
   public:
    explicit Posed(const Room& room) : Room(room), posed_(room.info()) {
      posed_.frames_with_pose = posed_.frames;
      posed_.map_frame = "map";
    }
    const RecordingInfo& info() const override { return posed_; }

   private:
    RecordingInfo posed_;
  };
  const TrackingResult result = tracked(Posed(room), options);
  EXPECT_EQ(result.map_frame, "map");
  EXPECT_EQ(result.good(), 30U);
  EXPECT_LT(max_error(room, result), 0.01);  // Between frames; the given ones are off by 3 cm.
  EXPECT_LT((result.frames[10].map_from_camera->translation() - room.poses()[10].translation()).norm(), 0.06);
}

TEST(Tracking, PosesComeWithTheRecording) {
  auto room = std::make_unique<Room>(walk(12));
  const TrackingResult result = tracked(*room);
  const auto posed =
      in_frame(with_poses(std::move(room), result.poses(12), "map", false), camera_at(0, 0, 0), "map");
  EXPECT_EQ(posed->info().frames_with_pose, 12U);
  EXPECT_EQ(posed->info().map_frame, "map");
  EXPECT_TRUE(posed->frame(0).map_from_camera->isApprox(camera_at(0, 0, 0)));
}

TEST(Tracking, ToBePlacedACameraThatStandsStillHasOnePose) {
  NoProgress progress;
  for (const size_t frames : {size_t{1}, size_t{12}}) {
    Warnings warnings;
    const auto room = [&] {
      return std::make_unique<Room>(std::vector<Isometry3d>(frames, camera_at(0, 0, 0)));
    };
    EXPECT_EQ(with_known_poses(room(), PosesFor::perception, 2, progress, warnings)->info().frames_with_pose,
              0U);
    const auto placed = with_known_poses(room(), PosesFor::placement, 2, progress, warnings);
    EXPECT_EQ(placed->info().frames_with_pose, frames);
    EXPECT_TRUE(placed->info().levelled);
    EXPECT_TRUE(placed->pose_of(0)->isApprox(*with_fixed_pose(room(), warnings)->pose_of(frames - 1)));
  }
}

TEST(Tracking, NothingToTrackIsAnError) {
  Room room(walk(3));
  room.blind_ = {0, 1, 2};
  EXPECT_THROW(tracked(room), Error);
  EXPECT_THROW(tracked(Room({})), Error);
}

TEST(PoseGraph, AWrongLoopHasLittleWeight) {
  std::vector<Isometry3d> truth, poses;
  std::vector<tracking::PoseConstraint> constraints;
  const auto information = Matrix6d(Matrix6d::Identity() * 1e6);  // 1 mm, 1 mrad
  for (size_t i = 0; i < 8; ++i) {
    truth.push_back(camera_at(0.2 * static_cast<double>(i), 0, 0.1 * static_cast<double>(i)));
    poses.push_back(truth.back());
    if (i > 0) poses.back().translation() += Vector3d(0.02, 0.03, -0.01) * static_cast<double>(i);
    if (i > 0) constraints.push_back({i - 1, i, truth[i - 1].inverse() * truth[i], information});
    if (i > 1) constraints.push_back({i - 2, i, truth[i - 2].inverse() * truth[i], information});
  }
  constraints.push_back({0, 7, Isometry3d::Identity(), information});
  tracking::optimise(poses, constraints);
  for (size_t i = 0; i < poses.size(); ++i)
    EXPECT_LT((poses[i].translation() - truth[i].translation()).norm(), 0.01) << i;
}

TEST(PoseGraph, GravityLevelsTheMap) {
  std::vector<Isometry3d> poses = {Isometry3d::Identity(),
                                   Isometry3d(Eigen::AngleAxisd(0.3, Vector3d::UnitY()))};
  const Vector3d up(0.1, -0.9, 0.2);
  tracking::optimise(poses, {{0, 1, poses[0].inverse() * poses[1], Matrix6d::Identity() * 1e4}},
                     {{0, up.normalized(), 0.01}});
  EXPECT_NEAR((poses[0].linear() * up.normalized()).z(), 1, 1e-6);
}

}  // namespace
}  // namespace loci::mapping
