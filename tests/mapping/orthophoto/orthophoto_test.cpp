#include "mapping/orthophoto/orthophoto.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/orthophoto/bars.h"
#include "mapping/orthophoto/face_points.h"
#include "mapping/orthophoto/patch.h"
#include "mapping/orthophoto/photo_fronts.h"
#include "mapping/orthophoto/photo_interpretation.h"
#include "tests/mapping/orthophoto/painted_front.h"

namespace loci::mapping {
namespace {

const PaintedRecording& recording() {
  static const PaintedRecording doors(two_doors());
  return doors;
}

Orthophoto photo_of(const Recording& recording, int threads = 2) {
  std::vector<std::optional<Isometry3d>> poses;
  for (size_t i = 0; i < recording.size(); ++i) poses.push_back(recording.pose_of(i));
  return make_orthophoto(recording, poses, painted_face(), threads);
}

int red_at(const Orthophoto& photo, double u, double v) {
  return photo.color.at<cv::Vec3b>(static_cast<int>(std::lround(photo.row(v))),
                                   static_cast<int>(std::lround(photo.column(u))))[2];
}

/// Intersection over union of a front and the rectangle [u0, u1] × [0.15, 0.85].
double overlap(const Front& front, double u0, double u1) {
  const double w =
      std::min(front.centre.y() + front.width / 2, u1) - std::max(front.centre.y() - front.width / 2, u0);
  const double h = std::min(front.centre.z() + front.height / 2, 0.85) -
                   std::max(front.centre.z() - front.height / 2, 0.15);
  const double shared = std::max(0.0, w) * std::max(0.0, h);
  return shared / (front.width * front.height + (u1 - u0) * 0.7 - shared);
}

void expect_two_doors(std::vector<Front> fronts, double handle_tolerance = 0.015) {
  ASSERT_EQ(fronts.size(), 2U);
  std::sort(fronts.begin(), fronts.end(),
            [](const Front& a, const Front& b) { return a.centre.y() < b.centre.y(); });
  for (size_t i = 0; i < 2; ++i) {
    const double u0 = i == 0 ? -0.6 : 0;
    EXPECT_GT(overlap(fronts[i], u0, u0 + 0.6), 0.9);
    ASSERT_TRUE(fronts[i].fixture);
    EXPECT_LT((fronts[i].fixture->centre - Vector3d(0.03, u0 + 0.3, 0.781)).norm(), handle_tolerance);
    EXPECT_NEAR(fronts[i].fixture->length, 0.18, 0.02);
  }
}

TEST(Orthophoto, ShowsThePlaneWithoutDrift) {
  const Orthophoto photo = photo_of(recording());
  EXPECT_EQ(photo.frames.size(), recording().size());
  EXPECT_NEAR(red_at(photo, -0.4, 0.4), 150, 12);
  EXPECT_NEAR(red_at(photo, 0.4, 0.9), 60, 8);
  EXPECT_LT(red_at(photo, 0, 0.4), 135) << "the seam is sharp in spite of the drift";
  EXPECT_NEAR(red_at(photo, 0.015, 0.4), 150, 12);
  const float relief =
      photo.relief.at<float>(static_cast<int>(photo.row(0.4)), static_cast<int>(photo.column(0.3)));
  EXPECT_NEAR(relief, 0, 0.006);
  EXPECT_NEAR(photo.roll, 0, 0.003);
}

TEST(Orthophoto, SeenAtIsTheInverseOfInMap) {
  const Orthophoto photo = photo_of(recording());
  for (const Vector2d& at : {Vector2d(-0.4, 0.3), Vector2d(0.1, 0.8), Vector2d(0.5, 0.5)})
    EXPECT_LT((photo.seen_at(photo.in_map(at, 0.03)) - at).norm(), 0.002);
}

TEST(Orthophoto, IsTheSameOnAnyNumberOfThreads) {
  const Orthophoto one = photo_of(recording(), 1), two = photo_of(recording(), 2);
  EXPECT_EQ(cv::norm(one.color, two.color, cv::NORM_INF), 0);
  EXPECT_EQ(one.frames, two.frames);
}

TEST(Orthophoto, WithoutFramesIsEmpty) {
  PaintedRecording recording(two_doors());
  recording.posed_ = false;
  const Orthophoto photo = photo_of(recording);
  EXPECT_TRUE(photo.frames.empty());
  EXPECT_TRUE(find_photo_fronts(photo).fronts.empty());
}

/// A video of the painted face, from 1.6 m before it: 60 frames along most of it, 8 of its left end alone.
class Video : public Recording {
 public:
  Video() {
    info_.frames = 68;
    info_.camera.depth = info_.camera.color = {160, 120, 292, 292, 80, 60};
  }
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return info_.frames; }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond / 30; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }
  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame;
    frame.camera = info_.camera;
    frame.depth = cv::Mat(120, 160, CV_32F, cv::Scalar(1.6));
    frame.color = cv::Mat(120, 160, CV_8UC3);
    cv::RNG(static_cast<uint64_t>(i)).fill(frame.color, cv::RNG::UNIFORM, 100, 200);
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    pose.translation() = Vector3d(1.6, i < 60 ? -0.3 + 0.0175 * static_cast<double>(i) : -1.01, 0.5);
    frame.map_from_camera = pose;
    return frame;
  }

 private:
  RecordingInfo info_;
};

TEST(Orthophoto, LeavesNoPartOfAFaceWithoutFrames) {
  const Orthophoto photo = photo_of(Video());
  const auto seen = [&](double u) {
    return photo.weight.at<float>(static_cast<int>(photo.row(0.5)), static_cast<int>(photo.column(u))) > 0;
  };
  EXPECT_TRUE(seen(0.5));
  EXPECT_TRUE(seen(-0.745));
}

std::vector<FurnitureFace> parts_of(const Recording& recording) {
  std::vector<std::optional<Isometry3d>> poses;
  for (size_t i = 0; i < recording.size(); ++i) poses.push_back(recording.pose_of(i));
  return divided_at_steps(recording, poses, painted_face(), 2);
}

TEST(FacePoints, AStepThatSingleFramesShowDividesAFace) {
  PaintedFront doors = two_doors();
  doors.step = 0.028;
  const std::vector<FurnitureFace> parts = parts_of(PaintedRecording(doors));
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(parts[0].u_max, 0, 0.051);
  EXPECT_EQ(parts[1].u_min, parts[0].u_max);
  EXPECT_NEAR(parts[1].offset - parts[0].offset, 0.028, 0.005);
}

TEST(FacePoints, DriftBetweenFramesMakesNoStep) {
  PaintedRecording frames(two_doors());
  frames.drift_ = Vector3d(0.03, 0.006, -0.006);
  EXPECT_EQ(parts_of(frames).size(), 1U);
}

TEST(PhotoFronts, FindsDoorsWithTheirHandles) {
  expect_two_doors(find_photo_fronts(photo_of(recording())).fronts);
}

TEST(PhotoFronts, FindsThemWhereTheMapLeans) {
  PaintedFront leaning = two_doors();
  leaning.roll = 0.02;
  for (PaintedFront::Bar& bar : leaning.bars) {
    const double rise = 0.02 * (bar.u0 + bar.u1) / 2;
    bar.v0 += rise;
    bar.v1 += rise;
  }
  const Orthophoto photo = photo_of(PaintedRecording(leaning));
  EXPECT_NEAR(std::abs(photo.roll), 0.02, 0.004);
  expect_two_doors(find_photo_fronts(photo).fronts, 0.025);
}

TEST(PhotoFronts, FindsHandlesThatAViewFromTheSideShowsBeyondTheirDoors) {
  PaintedFront doors = two_doors();
  doors.side = 1.6;
  doors.bars = {{-0.57, -0.39, 0.775, 0.787, 0.035}, {0.03, 0.21, 0.775, 0.787, 0.035}};
  const std::vector<Front> fronts = find_photo_fronts(photo_of(PaintedRecording(doors))).fronts;
  ASSERT_EQ(fronts.size(), 2U);
  for (const Front& front : fronts) EXPECT_TRUE(front.fixture);
}

TEST(PhotoFronts, AreWhereTheFramesSeeThemNotInThePlaneOfTheFace) {
  PaintedRecording frames(two_doors());
  frames.drift_.setZero();
  FurnitureFace face = painted_face();
  face.offset = 0.028;  // of a tall cupboard beside them
  std::vector<std::optional<Isometry3d>> poses;
  for (size_t i = 0; i < frames.size(); ++i) poses.push_back(frames.frame(i).map_from_camera);
  const std::vector<Front> fronts = find_photo_fronts(make_orthophoto(frames, poses, face, 2)).fronts;
  expect_two_doors(fronts);
  for (const Front& front : fronts) EXPECT_NEAR(front.centre.x(), 0, 0.003);
}

TEST(PhotoFronts, TakesNoSeamForAHandle) {
  PaintedFront drawers;
  drawers.level_seams = {0.4, 0.6};
  EXPECT_TRUE(find_photo_fronts(photo_of(PaintedRecording(drawers))).fronts.empty());
}

TEST(PhotoFronts, CutsDrawersAtLevelSeams) {
  PaintedFront drawers;
  drawers.level_seams = {0.383, 0.617};
  for (const double v : {0.327, 0.560, 0.793})
    drawers.bars.push_back({-0.12, 0.12, v - 0.006, v + 0.006, 0.035});
  EXPECT_EQ(find_photo_fronts(photo_of(PaintedRecording(drawers))).fronts.size(), 3U);
}

/// Two doors with a spot of 3 cm each, at a depth before them.
PaintedFront doors_with_spots(double depth) {
  PaintedFront doors = two_doors();
  doors.bars = {{-0.075, -0.045, 0.735, 0.765, depth}, {0.045, 0.075, 0.735, 0.765, depth}};
  return doors;
}

TEST(PhotoFronts, FindsKnobs) {
  std::vector<Front> fronts = find_photo_fronts(photo_of(PaintedRecording(doors_with_spots(0.03)))).fronts;
  ASSERT_EQ(fronts.size(), 2U);
  for (const Front& front : fronts) {
    ASSERT_TRUE(front.fixture);
    EXPECT_EQ(front.fixture->kind, Fixture::Kind::knob);
    const Vector3d truth(0.03, front.centre.y() < 0 ? -0.06 : 0.06, 0.75);
    EXPECT_LT((front.fixture->centre - truth).norm(), 0.015);
  }
}

TEST(PhotoFronts, TakesNoSpotOnTheFaceForAKnob) {
  EXPECT_TRUE(find_photo_fronts(photo_of(PaintedRecording(doors_with_spots(0.0005)))).fronts.empty());
}

TEST(PhotoFronts, BarePartsBesideAFrontWithAHandleAreFronts) {
  PaintedFront doors = two_doors();
  doors.bars.pop_back();
  const std::vector<Front> fronts = find_photo_fronts(photo_of(PaintedRecording(doors))).fronts;
  ASSERT_EQ(fronts.size(), 2U);
  EXPECT_NE(fronts[0].fixture.has_value(), fronts[1].fixture.has_value());
}

TEST(PhotoFronts, RibsOfARadiatorAreNoHandles) {
  PaintedFront radiator;
  for (int rib = 0; rib < 7; ++rib)
    radiator.bars.push_back({-0.456 + 0.15 * rib, -0.444 + 0.15 * rib, 0.3, 0.7, 0.03});
  const PhotoFrontSearch found = find_photo_fronts(photo_of(PaintedRecording(radiator)));
  EXPECT_GE(found.ribs.size(), 5U);
  EXPECT_TRUE(found.fronts.empty());
}

/// An orthophoto of one colour, seen by four frames from very different directions.
Orthophoto plain_photo() {
  Orthophoto photo;
  const cv::Size size(200, 100);
  photo.face = painted_face();
  photo.pixel_m = 0.003;
  photo.u0 = -0.3;
  photo.v0 = 0.3;
  photo.color = cv::Mat(size, CV_8UC3, cv::Scalar(40, 50, 150));
  photo.weight = cv::Mat(size, CV_32F, cv::Scalar(1));
  photo.ground = cv::Mat(size, CV_32F, cv::Scalar(0));
  photo.relief = cv::Mat(size, CV_32F, cv::Scalar(0));
  photo.relief_sd = cv::Mat(size, CV_32F, cv::Scalar(0.001));
  photo.slope = cv::Mat(size, CV_32FC2, cv::Scalar::all(0));
  photo.slope_sd = cv::Mat(size, CV_32FC2, cv::Scalar::all(1));
  for (const double depth : {0.0, 0.03})
    photo.layers.push_back({depth, photo.color.clone(), cv::Mat(size, CV_32F, cv::Scalar(1))});
  for (size_t i = 0; i < 4; ++i)
    photo.views.push_back({i,
                           photo.color.clone(),
                           cv::Mat(size, CV_32F, cv::Scalar(1)),
                           {},
                           Vector3d(static_cast<double>(i) - 1.5, 0.45, 1.5)});
  return photo;
}

TEST(Bars, TheReliefOfABarFallsToTheFaceOnBothSides) {
  Orthophoto photo = plain_photo();
  photo.relief(cv::Rect(60, 48, 60, 4)).setTo(0.03);
  EXPECT_EQ(find_bars(photo).size(), 1U);
}

TEST(Bars, TheTopOfASlabIsNone) {
  Orthophoto photo = plain_photo();
  for (int row = 38; row < 48; ++row)  // The relief of its top rises towards its edge.
    photo.relief(cv::Rect(60, row, 60, 1)).setTo(0.0035 * (row - 38));
  photo.relief(cv::Rect(60, 48, 60, 6)).setTo(0.045);
  EXPECT_TRUE(find_bars(photo).empty());
}

const cv::Rect kBarInLayer(80, 48, 40, 4);

/// Draws a bar that stands in the second layer into some of the frames.
void draw_bar(Orthophoto& photo, size_t views) {
  photo.layers[1].color(kBarInLayer).setTo(cv::Scalar(215, 215, 215));
  for (size_t i = 0; i < views; ++i) {
    const LayerScaling scaling = photo.scaling(photo.views[i], photo.layers[1].depth);
    photo.views[i]
        .color(cv::Rect(scaling.on_face(kBarInLayer.x, kBarInLayer.y), kBarInLayer.size()))
        .setTo(cv::Scalar(200, 200, 200));
  }
}

TEST(Patches, CountTheFramesThatShowThem) {
  LayerPatch patch;
  for (int x = kBarInLayer.x; x < kBarInLayer.br().x; ++x) patch.own.emplace_back(x, 49);
  for (const int row : {42, 56}) {
    patch.sides.emplace_back();
    for (int x = kBarInLayer.x; x < kBarInLayer.br().x; ++x) patch.sides.back().emplace_back(x, row);
  }
  for (const size_t views : {0, 1, 4}) {
    Orthophoto photo = plain_photo();
    draw_bar(photo, views);
    EXPECT_NEAR(share_showing(photo, photo.layers[1], patch), static_cast<double>(views) / 4, 1e-9);
  }
}

TEST(Bars, WhatNoFrameShowsIsNone) {
  Orthophoto seen = plain_photo(), made_up = plain_photo();
  draw_bar(seen, 4);
  draw_bar(made_up, 0);
  ASSERT_EQ(find_bars(seen).size(), 1U);
  EXPECT_EQ(find_bars(seen)[0].fixture.evidence.at("frames_showing"), 1);
  EXPECT_TRUE(find_bars(made_up).empty());
}

InterpretedMap map_with_face() {
  InterpretedMap map;
  map.world.name = map.world.root = "map";
  map.world.links.push_back({.name = "map", .visuals = {}, .collisions = {}, .inertial = {}});
  map.faces = {painted_face()};
  return map;
}

TEST(PhotoInterpretation, ReplacesTheFrontsOfAFace) {
  InterpretedMap map = map_with_face();
  Front strip;
  strip.centre = Vector3d(0, 0.2, 0.2);
  strip.width = 0.8;
  strip.height = 0.1;
  Front elsewhere = strip;
  elsewhere.centre = Vector3d(-2, 0.2, 0.2);
  replace_fronts({strip, elsewhere}, map);
  NoProgress progress;
  const auto faces = interpret_photos(recording(), 2, progress, map);
  ASSERT_EQ(faces.size(), 1U);
  EXPECT_EQ(map.fronts.size(), 3U) << "two doors and the one elsewhere";
  EXPECT_EQ(std::count_if(map.fronts.begin(), map.fronts.end(),
                          [](const Front& front) { return front.joint.has_value(); }),
            2);
  const cv::Mat image = drawn(faces[0]);
  EXPECT_EQ(image.rows, 2 * faces[0].photo.height());
  ASSERT_EQ(map.photos.size(), 1U);
  EXPECT_EQ(map.photos[0].color.size(), faces[0].photo.color.size());
}

/// A front of the scans with a bar, on the painted face or elsewhere.
Front scanned_front(double u, double x, double confidence) {
  Front front;
  front.centre = Vector3d(x, u, 0.5);
  front.width = 0.3;
  front.height = 0.3;
  front.fixture.emplace();
  front.fixture->centre = Vector3d(x + 0.03, u, 0.5);
  front.fixture->axis = Vector3d::UnitY();
  front.fixture->length = 0.2;
  front.fixture->radius = 0.006;
  front.fixture->confidence = confidence;
  return front;
}

TEST(PhotoInterpretation, DropsBarsOfTheScansThatTheFramesRefute) {
  PaintedFront bare;  // A board of 6 cm stands there: the photo takes it for no bar, its depth shows it.
  bare.bars = {{0.2, 0.5, 0.47, 0.53, 0.03}};
  const PaintedRecording recording(bare);
  InterpretedMap map = map_with_face();
  replace_fronts({scanned_front(-0.35, 0, 0.9), scanned_front(0.35, 0, 0.9)}, map);
  NoProgress progress;
  interpret_photos(recording, 2, progress, map);
  ASSERT_EQ(map.fronts.size(), 1U);
  EXPECT_GT(map.fronts[0].centre.y(), 0);
}

TEST(PhotoInterpretation, KeepsCertainBarsOfTheScansThatNoPhotoShows) {
  InterpretedMap map = map_with_face();
  replace_fronts({scanned_front(0, -2, 0.9), scanned_front(1, -2, 0.5)}, map);
  map.faces.clear();
  NoProgress progress;
  interpret_photos(recording(), 2, progress, map);
  ASSERT_EQ(map.fronts.size(), 1U);
  EXPECT_LT(map.fronts[0].centre.y(), 0.5);
}

TEST(PhotoInterpretation, DropsFrontsAmongRibsOfTheScans) {
  InterpretedMap map = map_with_face();
  replace_fronts({scanned_front(0, -2, 0.9)}, map);
  map.faces.clear();
  Fixture rib = *map.fronts[0].fixture;
  rib.centre.y() += 0.1;
  rib.axis = Vector3d::UnitZ();
  map.ribs = {rib};
  NoProgress progress;
  interpret_photos(recording(), 2, progress, map);
  EXPECT_TRUE(map.fronts.empty());
}

TEST(PhotoInterpretation, PhotographsAFaceOnceThatDepthErrorsDivide) {
  InterpretedMap map = map_with_face();
  FurnitureFace second = painted_face();
  second.offset = -0.035;
  second.u_max = 0;
  second.area = 0.4;
  map.faces.push_back(second);
  NoProgress progress;
  EXPECT_EQ(interpret_photos(recording(), 2, progress, map).size(), 1U);
  EXPECT_EQ(map.fronts.size(), 2U);
}

/// The painted recording over and over, of which only some frames have colour.
class ColorlessRecording : public PaintedRecording {
 public:
  explicit ColorlessRecording(size_t with_color) : PaintedRecording(two_doors()), with_color_(with_color) {}
  size_t size() const override { return 5 * PaintedRecording::size(); }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i); }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }
  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame = PaintedRecording::frame(i % PaintedRecording::size());
    if (i >= with_color_) {
      frame.color = cv::Mat();
      if (i % 2 == 0) frame.damage = "a.jpg: the image is damaged";
    }
    return frame;
  }

 private:
  size_t with_color_;
};

TEST(PhotoInterpretation, FewerThanATenthOfUsableFramesIsAnErrorAndOthersLeftOutANote) {
  NoProgress progress;
  InterpretedMap map = map_with_face();
  try {
    interpret_photos(ColorlessRecording(3), 2, progress, map);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("only 3 of 40 frames have both a pose and a colour image: no colour "
                        "image in 19, an image that cannot be read in 18 (a.jpg: the "
                        "image is damaged); interpret the scans without --recording"),
              std::string::npos)
        << error.what();
  }
  interpret_photos(ColorlessRecording(20), 2, progress, map);
  EXPECT_EQ(
      std::ranges::count(map.notes,
                         "orthophotos are made of 20 of 40 frames: no colour image in 10, an image that "
                         "cannot be read in 10 (a.jpg: the image is damaged)"),
      1);
}

TEST(PhotoInterpretation, RefusesARecordingWithoutPoses) {
  InterpretedMap map = map_with_face();
  PaintedRecording recording(two_doors());
  recording.posed_ = false;
  NoProgress progress;
  EXPECT_THROW(interpret_photos(recording, 1, progress, map), Error);
}

}  // namespace
}  // namespace loci::mapping
