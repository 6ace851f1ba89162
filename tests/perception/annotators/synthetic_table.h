#pragma once

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/math/random.h"
#include "mapping/sensor/camera.h"

namespace loci::perception::test {

/// A box that stands on the table, along the axes of the map.
struct TableBox {
  Vector3d centre;
  Vector3d size;
};

/// A piece of a round thing whose axis is upright: the radius changes evenly from the bottom to the top.
struct TableCone {
  Vector3d foot;  ///< middle of its bottom
  double height;
  double radius_low;
  double radius_high;

  /// Where a ray enters its side or its top; infinity = nowhere.
  double enter(const Vector3d& origin, const Vector3d& ray) const {
    const double slope = (radius_high - radius_low) / height;
    const Vector3d from = origin - foot;
    const double radius = radius_low + slope * from.z();
    const double a = ray.head<2>().squaredNorm() - std::pow(slope * ray.z(), 2);
    const double b = from.head<2>().dot(ray.head<2>()) - radius * slope * ray.z();
    const double c = from.head<2>().squaredNorm() - radius * radius;
    double nearest = std::numeric_limits<double>::infinity();
    if (b * b >= a * c)
      for (const double t : {(-b - std::sqrt(b * b - a * c)) / a, (-b + std::sqrt(b * b - a * c)) / a}) {
        const double z = from.z() + t * ray.z();
        if (t > 0 && z >= 0 && z <= height && radius_low + slope * z >= 0) nearest = std::min(nearest, t);
      }
    const double top = (height - from.z()) / ray.z();
    if (top > 0 && (from + top * ray).head<2>().norm() <= radius_high) nearest = std::min(nearest, top);
    return nearest;
  }
};

/// A vessel that is open at the top: its wall leans out evenly, its floor is as thick as the wall.
struct TableBowl {
  Vector3d foot;  ///< middle of its bottom
  double height;
  double radius_low;
  double radius_high;
  double wall = 0.005;

  /// Where a ray enters its outside, its rim or its inside; infinity = nowhere.
  double enter(const Vector3d& origin, const Vector3d& ray) const {
    const TableCone outside{foot, height, radius_low, radius_high};
    const double outer = outside.enter(origin, ray);
    const double rim = (foot.z() + height - origin.z()) / ray.z();
    const bool through_top = (origin + rim * ray - foot).head<2>().norm() < radius_high - wall;
    if (!through_top || outer < rim) return outer;
    // From the opening on the ray goes until it is as near to the wall as the wall is thick.
    for (double t = rim;; t += 0.0005) {
      const Vector3d p = origin + t * ray - foot;
      const double inner = radius_low + (radius_high - radius_low) * p.z() / height - wall;
      if (p.z() <= wall || p.head<2>().norm() >= inner) return t;
    }
  }
};

/// A table (z = 0, 1.2 × 0.8 m) with boxes and round things before a camera that looks down on it, every
/// pixel computed.
struct SyntheticTable {
  mapping::PinholeCamera camera{320, 240, 290, 290, 160, 120};
  Isometry3d map_from_camera = Isometry3d::Identity();
  std::vector<TableBox> boxes;
  std::vector<std::vector<TableCone>> rounds;  ///< things made of cones
  std::vector<TableBowl> bowls;

  SyntheticTable() {
    const Vector3d from(0, -0.9, 0.8);
    const Vector3d z = (Vector3d(0, 0, 0.05) - from).normalized();
    const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
    map_from_camera.linear().col(0) = x;
    map_from_camera.linear().col(1) = z.cross(x);
    map_from_camera.linear().col(2) = z;
    map_from_camera.translation() = from;
  }

  Vector3d up() const { return map_from_camera.linear().transpose() * Vector3d::UnitZ(); }

  /// Which thing a pixel shows: 1 + its index, round things after the boxes, bowls after them, 0 = the table,
  /// -1 = nothing; `depth` is set to z in metres.
  int hit(int u, int v, double& depth) const {
    const Vector3d ray = map_from_camera.linear() * camera.unproject(u, v, 1.0);
    const Vector3d origin = map_from_camera.translation();
    depth = std::numeric_limits<double>::infinity();
    int what = -1;
    const double table = -origin.z() / ray.z();
    const Vector3d on_table = origin + table * ray;
    if (table > 0 && std::abs(on_table.x()) < 0.6 && std::abs(on_table.y()) < 0.4) {
      depth = table;
      what = 0;
    }
    for (size_t b = 0; b < boxes.size(); ++b) {
      const Vector3d low = (boxes[b].centre - boxes[b].size / 2 - origin).cwiseQuotient(ray);
      const Vector3d high = (boxes[b].centre + boxes[b].size / 2 - origin).cwiseQuotient(ray);
      const double enter = low.cwiseMin(high).maxCoeff();
      const double leave = low.cwiseMax(high).minCoeff();
      if (enter < leave && enter > 0 && enter < depth) {
        depth = enter;
        what = static_cast<int>(b) + 1;
      }
    }
    for (size_t r = 0; r < rounds.size(); ++r)
      for (const TableCone& cone : rounds[r])
        if (const double enter = cone.enter(origin, ray); enter < depth) {
          depth = enter;
          what = static_cast<int>(boxes.size() + r) + 1;
        }
    for (size_t b = 0; b < bowls.size(); ++b)
      if (const double enter = bowls[b].enter(origin, ray); enter < depth) {
        depth = enter;
        what = static_cast<int>(boxes.size() + rounds.size() + b) + 1;
      }
    return what;
  }

  /// CV_32F, metres, with disparity noise of `sigma` pixels quantised to 1/8; `labels` as hit().
  cv::Mat render(double sigma, cv::Mat& labels) const {
    cv::Mat depth(camera.height, camera.width, CV_32F);
    labels = cv::Mat(camera.height, camera.width, CV_32S);
    Random random(7);
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        double z = 0;
        const int what = hit(u, v, z);
        labels.at<int>(v, u) = what;
        if (sigma > 0 && what >= 0) {
          const double bf = 0.075 * 585;
          z = bf / (std::round(8 * (bf / z + random.normal(sigma))) / 8);
        }
        depth.at<float>(v, u) = what < 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(z);
      }
    return depth;
  }
};

}  // namespace loci::perception::test
