#include "memory/belief/evidence/texture.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "mapping/base/math/random.h"

namespace loci::memory::belief {
namespace {

constexpr double kTolerance = 0.012;

/// A print on three faces of a box of 20 cm.
Texture print(uint64_t seed, size_t keypoints = 60) {
  Random random(seed);
  Texture texture(keypoints);
  for (size_t i = 0; i < keypoints; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      texture[i].position[axis] = static_cast<float>(random.uniform(0, 0.2));
    texture[i].position[static_cast<int>(i % 3)] = 0;
    texture[i].diameter_m = 0.02F;
    for (uint8_t& byte : texture[i].descriptor) byte = static_cast<uint8_t>(random.index(256));
  }
  return texture;
}

/// Another view of it: moved, measured with noise, and half of the key points are others.
Texture seen_again(Texture texture, const Eigen::Isometry3f& motion, uint64_t seed) {
  Random random(seed);
  for (size_t i = 0; i < texture.size(); ++i) {
    SurfaceKeypoint& keypoint = texture[i];
    for (int axis = 0; axis < 3; ++axis) keypoint.position[axis] += static_cast<float>(random.normal(0.002));
    keypoint.position = motion * keypoint.position;
    for (uint8_t& byte : keypoint.descriptor)
      if (i % 2 == 0 || random.uniform() < 0.1) byte = static_cast<uint8_t>(random.index(256));
  }
  return texture;
}

Eigen::Isometry3f motion(float angle, const Eigen::Vector3f& shift) {
  Eigen::Isometry3f moved(Eigen::AngleAxisf(angle, Eigen::Vector3f(1, 2, 3).normalized()));
  moved.pretranslate(shift);
  return moved;
}

TEST(Texture, OfAMovedObjectFitsAndTellsHowFarItMoved) {
  const Texture before = print(1);
  const TextureMatch match =
      match_textures(before, seen_again(before, motion(0, {0.3F, 0, 0.4F}), 2), kTolerance);
  EXPECT_GE(match.agreeing, 25);
  EXPECT_NEAR(match.offset_m, 0.5, 0.01);
  EXPECT_GT(texture_log_ratio(match, before, before), 5);
}

TEST(Texture, FitsHoweverTheObjectWasTurned) {
  const Texture before = print(1);
  const Texture turned = seen_again(before, motion(2.5F, {0.3F, 0.1F, 0}), 2);
  EXPECT_GE(match_textures(before, turned, kTolerance).agreeing, 25);
}

TEST(Texture, OfAnotherObjectDoesNotFit) {
  for (uint64_t seed = 2; seed < 30; ++seed) {
    const Texture one = print(1), other = print(seed);
    const TextureMatch match = match_textures(one, other, kTolerance);
    EXPECT_LT(match.agreeing, kTellingKeypoints);
    EXPECT_LT(texture_log_ratio(match, one, other), 3);
  }
}

TEST(Texture, OfTheSamePatternsAtOtherPlacesDoesNotFit) {
  const Texture before = print(1), shape = print(2);
  Texture other = before;
  for (size_t i = 0; i < other.size(); ++i) other[i].position = shape[i].position;
  EXPECT_LT(match_textures(before, other, kTolerance).agreeing, kTellingKeypoints);
}

TEST(Texture, OfFewKeyPointsTellsNothing) {
  const Texture few = print(1, 5), many = print(2);
  EXPECT_EQ(texture_log_ratio(match_textures(few, many, kTolerance), few, many), 0);
  EXPECT_EQ(texture_log_ratio(match_textures({}, many, kTolerance), {}, many), 0);
  EXPECT_LT(texture_log_ratio(match_textures(print(3), many, kTolerance), print(3), many), 0);
}

}  // namespace
}  // namespace loci::memory::belief
