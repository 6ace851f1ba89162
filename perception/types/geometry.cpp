#include "perception/types/geometry.h"

namespace loci::perception::types {

Vector Conversion<Eigen::Vector3d>::to(cas::Cas& cas, const Eigen::Vector3d& value) {
  const Vector vector = Vector::create(cas);
  vector.x.set(value.x());
  vector.y.set(value.y());
  vector.z.set(value.z());
  return vector;
}

Eigen::Vector3d Conversion<Eigen::Vector3d>::from(const Vector& proxy) {
  return {proxy.x.get(), proxy.y.get(), proxy.z.get()};
}

Quaternion Conversion<Eigen::Quaterniond>::to(cas::Cas& cas, const Eigen::Quaterniond& value) {
  const Quaternion quaternion = Quaternion::create(cas);
  quaternion.x.set(value.x());
  quaternion.y.set(value.y());
  quaternion.z.set(value.z());
  quaternion.w.set(value.w());
  return quaternion;
}

Eigen::Quaterniond Conversion<Eigen::Quaterniond>::from(const Quaternion& proxy) {
  return {proxy.w.get(), proxy.x.get(), proxy.y.get(), proxy.z.get()};
}

Transform Conversion<Eigen::Isometry3d>::to(cas::Cas& cas, const Eigen::Isometry3d& value) {
  const std::array<double, 7> values = values_from_pose(value);
  const Transform transform = Transform::create(cas);
  transform.translation.set(types::to(cas, Eigen::Vector3d(value.translation())));
  transform.rotation.set(types::to(cas, Eigen::Quaterniond(values[6], values[3], values[4], values[5])));
  return transform;
}

Eigen::Isometry3d Conversion<Eigen::Isometry3d>::from(const Transform& proxy) {
  const auto translation = types::from<Eigen::Vector3d>(proxy.translation.get());
  const auto rotation = types::from<Eigen::Quaterniond>(proxy.rotation.get());
  return pose_from_values({translation.x(), translation.y(), translation.z(), rotation.x(), rotation.y(),
                           rotation.z(), rotation.w()});
}

StampedTransform to_stamped(cas::Cas& cas, const Eigen::Isometry3d& frame_from_child,
                            const std::string& frame, const std::string& child, TimeNs time) {
  const Transform plain = to(cas, frame_from_child);
  const StampedTransform stamped = StampedTransform::create(cas);
  stamped.translation.set(plain.translation.get());
  stamped.rotation.set(plain.rotation.get());
  stamped.frame_id.set(frame);
  stamped.child_frame_id.set(child);
  stamped.timestamp.set(time);
  plain.remove();
  return stamped;
}

std::vector<double> values_from_points(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> values;
  values.reserve(points.size() * 3);
  for (const Eigen::Vector3d& point : points) values.insert(values.end(), point.data(), point.data() + 3);
  return values;
}

std::vector<Eigen::Vector3d> points_from_values(const cas::Buffer<double>& values) {
  if (values.size() % 3 != 0)
    throw Error(std::to_string(values.size()) + " numbers are no list of points in space");
  std::vector<Eigen::Vector3d> points;
  points.reserve(values.size() / 3);
  for (size_t i = 0; i < values.size(); i += 3) points.emplace_back(values[i], values[i + 1], values[i + 2]);
  return points;
}

}  // namespace loci::perception::types
