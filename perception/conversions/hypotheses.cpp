#include "perception/conversions/hypotheses.h"

#include <cstring>
#include <optional>

namespace loci::perception::types {
namespace {

/// x, y, z of any cloud whose points begin with them.
class Positions {
 public:
  explicit Positions(const PointCloud& cloud) {
    if (!cloud) throw Error("a hypothesis without its cloud");
    if (is<NormalMap>(cloud)) throw Error("a map of normals has no positions");
    step_ = static_cast<size_t>(cloud.point_step.get());
    bytes_ = cloud.points.get();
    if (step_ < 3 * sizeof(float) || bytes_.size() % step_ != 0)
      throw Error("a cloud of " + cloud.point_type.get() + " has no positions");
  }

  size_t size() const { return bytes_.size() / step_; }

  std::optional<Vector3d> at(size_t index) const {
    float values[3];
    std::memcpy(values, bytes_.data() + index * step_, sizeof values);
    const Vector3d point(values[0], values[1], values[2]);
    return point.allFinite() ? std::optional(point) : std::nullopt;
  }

 private:
  cas::Buffer<uint8_t> bytes_;
  size_t step_ = 0;
};

template <typename Hypothesis>
Hypothesis made_from(const ObjectHypothesis& origin) {
  const Hypothesis made = Hypothesis::create(origin.cas());
  if (origin.source.is_set()) made.source.set(origin.source.get());
  return made;
}

template <typename Keep>
ReferenceClusterPoints points_that(const ObjectHypothesis& origin, const PointCloud& cloud, Keep keep) {
  const Positions positions(cloud);
  std::vector<int32_t> indices;
  for (size_t i = 0; i < positions.size(); ++i)
    if (const auto point = positions.at(i); point && keep(*point)) indices.push_back(static_cast<int32_t>(i));
  const auto made = made_from<ReferenceClusterPoints>(origin);
  made.cloud.set(cloud);
  made.indices.get_or_create().indices.set(std::move(indices));
  if (const Header header = cloud.header.get()) made.indices.get().header.set(header);
  return made;
}

}  // namespace

std::vector<Vector3d> positions_of(const ClusterPoints& points) {
  std::vector<Vector3d> found;
  if (const auto alone = try_as<StandaloneClusterPoints>(points)) {
    const Positions positions(alone->cloud.get());
    for (size_t i = 0; i < positions.size(); ++i)
      if (const auto point = positions.at(i)) found.push_back(*point);
    return found;
  }
  const auto reference = as<ReferenceClusterPoints>(points);
  const Positions positions(reference.cloud.get());
  if (!reference.indices.is_set()) return found;
  for (const int32_t index : reference.indices.get().indices.get()) {
    if (index < 0 || static_cast<size_t>(index) >= positions.size())
      throw Error("point " + std::to_string(index) + " of a cloud of " + std::to_string(positions.size()));
    if (const auto point = positions.at(static_cast<size_t>(index))) found.push_back(*point);
  }
  return found;
}

ReferenceClusterPoints points_in_volume(const TFLinkROI& volume, const PointCloud& cloud,
                                        const Isometry3d& frame_from_cloud) {
  if (const auto sphere = try_as<TFLinkSphereROI>(volume)) {
    const Vector3d center = from<Vector3d>(sphere->center.get());
    const double radius = sphere->radius.get();
    return points_that(volume, cloud, [&](const Vector3d& point) {
      return (frame_from_cloud * point - center).norm() <= radius;
    });
  }
  const BoundingBox box = as<TFLinkBBoxROI>(volume).bbox.get();
  if (!box) throw Error("a volume without its box");
  const Isometry3d box_from_cloud = from<Isometry3d>(box.pose.get()).inverse() * frame_from_cloud;
  const Vector3d half = from<Vector3d>(box.size.get()) / 2;
  return points_that(volume, cloud, [&](const Vector3d& point) {
    return ((box_from_cloud * point).array().abs() <= half.array()).all();
  });
}

}  // namespace loci::perception::types
