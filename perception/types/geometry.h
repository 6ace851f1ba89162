#pragma once

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "perception/types/scene_cas.h"

namespace loci::perception::types {

/// How a native C++ type is kept in a CAS. Specialised per native type (geometry.h here;
/// perception/conversions for OpenCV, PCL and cameras; anybody for types of their own) with
///
///     using Proxy = ...;                                      what it is kept as
///     static Proxy to(cas::Cas& cas, const Native& value);
///     static Native from(const Proxy& proxy);                 throws Error when the proxy is null or does
///     not fit
///
/// so that the meaning of what is stored is written down in one place.
template <typename Native>
struct Conversion;

/// Keeps a native value in a CAS: `types::Mat mat = types::to(cas, image)`.
template <typename Native>
typename Conversion<Native>::Proxy to(cas::Cas& cas, const Native& value) {
  return Conversion<Native>::to(cas, value);
}

/// Brings it back: `cv::Mat image = types::from<cv::Mat>(mat)`. Throws Error when `proxy` is null.
template <typename Native>
Native from(const typename Conversion<Native>::Proxy& proxy) {
  if (!proxy) throw Error("no " + std::string(Conversion<Native>::Proxy::kTypeName) + " to convert");
  return Conversion<Native>::from(proxy);
}

// Vectors, rotations and poses of Eigen. Metres; from<Isometry3d> takes quaternions of length one within
// 1e-2.

template <>
struct Conversion<Eigen::Vector3d> {
  using Proxy = Vector;
  static Vector to(cas::Cas& cas, const Eigen::Vector3d& value);
  static Eigen::Vector3d from(const Vector& proxy);
};

template <>
struct Conversion<Eigen::Quaterniond> {
  using Proxy = Quaternion;
  static Quaternion to(cas::Cas& cas, const Eigen::Quaterniond& value);
  static Eigen::Quaterniond from(const Quaternion& proxy);
};

template <>
struct Conversion<Eigen::Isometry3d> {
  using Proxy = Transform;
  static Transform to(cas::Cas& cas, const Eigen::Isometry3d& value);
  static Eigen::Isometry3d from(const Transform& proxy);
};

/// frame_from_child at a time, e.g. map_from_camera.
StampedTransform to_stamped(cas::Cas& cas, const Eigen::Isometry3d& frame_from_child,
                            const std::string& frame, const std::string& child, TimeNs time);

/// x0, y0, z0, x1, ... as outlines are kept. points_from_values throws Error when a coordinate is missing.
std::vector<double> values_from_points(const std::vector<Eigen::Vector3d>& points);
std::vector<Eigen::Vector3d> points_from_values(const cas::Buffer<double>& values);

}  // namespace loci::perception::types
