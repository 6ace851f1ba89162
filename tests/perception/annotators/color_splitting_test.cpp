#include "perception/annotators/segmentation/clustering/color_splitting.h"

#include <gtest/gtest.h>

#include <numeric>

#include "mapping/base/math/random.h"

namespace loci::perception {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

const cv::Vec3b kPurple(80, 170, 130), kPale(220, 128, 128);

/// Points of flat shapes on a grid of 3 mm, as a camera above them sees them.
struct FlatCloud {
  std::vector<Vector3f> points, normals;
  std::vector<float> areas;
  std::vector<cv::Vec3b> lab;

  template <class Inside>
  void add(const cv::Vec3b& color, const Inside& inside, const Vector3f& normal = Vector3f::UnitZ()) {
    constexpr float kStep = 0.003f;
    for (float x = -0.4f; x < 0.4f; x += kStep)
      for (float y = -0.4f; y < 0.4f; y += kStep) {
        if (!inside(x, y)) continue;
        points.emplace_back(x, y, 0.02f);
        normals.push_back(normal);
        areas.push_back(kStep * kStep);
        lab.push_back(color);
      }
  }
  void add_disc(const cv::Vec3b& color, float x, float y, float radius) {
    add(color, [&](float u, float v) { return std::hypot(u - x, v - y) < radius; });
  }
  void add_box(const cv::Vec3b& color, float x0, float y0, float x1, float y1,
               const Vector3f& normal = Vector3f::UnitZ()) {
    add(
        color, [&](float u, float v) { return u >= x0 && u < x1 && v >= y0 && v < y1; }, normal);
  }
  size_t parts() const {
    std::vector<size_t> all(points.size());
    std::iota(all.begin(), all.end(), size_t{0});
    return split_colors(points, normals, areas, lab, all).size();
  }
};

TEST(ColorSplitting, PlatesWhoseRimsTouchComeApart) {
  FlatCloud cloud;
  cloud.add_disc(kPurple, -0.11f, 0.02f, 0.115f);
  cloud.add_disc(kPale, 0.12f, -0.02f, 0.115f);
  EXPECT_EQ(cloud.parts(), 2U);
  cloud.add_disc({120, 90, 180}, 0.25f, 0.17f, 0.115f);
  EXPECT_EQ(cloud.parts(), 3U);
}

TEST(ColorSplitting, NoiseOfColorsDoesNotHoldThemTogether) {
  FlatCloud cloud;
  cloud.add_disc(kPurple, -0.115f, 0, 0.115f);
  cloud.add_disc(kPale, 0.115f, 0, 0.115f);
  Random random(1);
  for (cv::Vec3b& color : cloud.lab)
    if (random.uniform() < 0.02) color = random.uniform() < 0.5 ? kPurple : kPale;
  EXPECT_EQ(cloud.parts(), 2U);
}

TEST(ColorSplitting, EqualPlatesAreLeftToTheSurface) {
  FlatCloud cloud;
  cloud.add_disc(kPale, -0.115f, 0, 0.115f);
  cloud.add_disc(kPale, 0.115f, 0, 0.115f);
  EXPECT_EQ(cloud.parts(), 1U);
}

TEST(ColorSplitting, WhatMeetsInItsFullWidthIsOneObject) {
  FlatCloud book;
  book.add_box(kPurple, -0.1f, -0.15f, 0, 0.15f);
  book.add_box(kPale, 0, -0.15f, 0.1f, 0.15f);
  EXPECT_EQ(book.parts(), 1U);
  FlatCloud spatula;
  spatula.add_disc(kPale, 0.1f, 0, 0.05f);
  spatula.add_box(kPurple, -0.2f, -0.012f, 0.055f, 0.012f);
  EXPECT_EQ(spatula.parts(), 1U);
}

TEST(ColorSplitting, APatternOnAPlateIsOfThePlate) {
  FlatCloud cloud;
  cloud.add_disc(kPale, 0, 0, 0.115f);
  for (size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.points[i].head<2>().norm() < 0.07f) cloud.lab[i] = kPurple;
  EXPECT_EQ(cloud.parts(), 1U);
}

TEST(ColorSplitting, SidesOfABoxAreOfTheBox) {
  FlatCloud box;  // two upright faces, as thin in plan as their noise
  box.add_box(kPurple, 0, 0, 0.2f, 0.01f, -Vector3f::UnitY());
  box.add_box(kPale, -0.01f, 0, 0, 0.2f, -Vector3f::UnitX());
  EXPECT_EQ(box.parts(), 1U);
}

}  // namespace
}  // namespace loci::perception
