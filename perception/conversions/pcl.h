#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "perception/types/geometry.h"

namespace loci::perception::types {

// Only who uses PCL includes this header: it is slow to compile.

/// What a type of point is called in a CAS. Users specialise it for types of their own.
template <typename Point>
struct PointTraits;

template <>
struct PointTraits<pcl::PointXYZ> {
  static constexpr const char* kName = "PointXYZ";
  using Proxy = PointCloud;
};
template <>
struct PointTraits<pcl::Normal> {
  static constexpr const char* kName = "Normal";
  using Proxy = NormalMap;
};

namespace detail {
/// Writes the members that do not depend on the type of point.
void describe_cloud(const PointCloud& proxy, const pcl::PCLHeader& header, const char* point_type,
                    size_t step, uint32_t width, uint32_t height, bool is_dense);
/// Throws Error when the cloud holds other points, or not as many as its size says.
void check_cloud(const PointCloud& proxy, const char* point_type, size_t step);
pcl::PCLHeader header_of(const PointCloud& proxy);

/// Keeps a cloud alive for its points, and is found again by std::get_deleter.
template <typename Point>
struct CloudOwner {
  std::shared_ptr<const pcl::PointCloud<Point>> cloud;
  void operator()(const void*) const {}
};
}  // namespace detail

/// The points of a cloud without copying (unless their memory is not aligned), kept alive by the buffer.
/// Throws Error when the cloud holds other points.
template <typename Point>
cas::Buffer<Point> points_of(const PointCloud& proxy) {
  detail::check_cloud(proxy, PointTraits<Point>::kName, sizeof(Point));
  const cas::Buffer<uint8_t> bytes = proxy.points.get();
  const size_t size = bytes.size() / sizeof(Point);
  if (reinterpret_cast<uintptr_t>(bytes.data()) % alignof(Point) == 0)
    return {bytes.owner(), reinterpret_cast<const Point*>(bytes.data()), size};
  const auto copy = std::make_shared<std::vector<Point, Eigen::aligned_allocator<Point>>>(size);
  std::memcpy(static_cast<void*>(copy->data()), bytes.data(), bytes.size());
  return {copy, copy->data(), size};
}

/// A shared cloud stays where it is: `to` keeps it alive, and nobody may write to it afterwards; `from` gives
/// back the same cloud when it was one, otherwise a copy.
template <typename Point>
struct Conversion<std::shared_ptr<const pcl::PointCloud<Point>>> {
  using Cloud = pcl::PointCloud<Point>;
  using Proxy = typename PointTraits<Point>::Proxy;

  static Proxy to(cas::Cas& cas, const std::shared_ptr<const Cloud>& cloud) {
    const Proxy proxy = Proxy::create(cas);
    detail::describe_cloud(proxy, cloud->header, PointTraits<Point>::kName, sizeof(Point), cloud->width,
                           cloud->height, cloud->is_dense);
    const auto* bytes = reinterpret_cast<const uint8_t*>(cloud->points.data());
    const std::shared_ptr<const void> owner(static_cast<const void*>(bytes),
                                            detail::CloudOwner<Point>{cloud});
    proxy.points.set(cas::Buffer<uint8_t>(owner, bytes, cloud->size() * sizeof(Point)));
    return proxy;
  }

  static std::shared_ptr<const Cloud> from(const Proxy& proxy) {
    const cas::Buffer<Point> points = points_of<Point>(proxy);
    const auto* owner = std::get_deleter<detail::CloudOwner<Point>>(points.owner());
    if (owner != nullptr && static_cast<int64_t>(owner->cloud->width) == proxy.width.get() &&
        static_cast<int64_t>(owner->cloud->height) == proxy.height.get())
      return owner->cloud;
    const auto cloud = std::make_shared<Cloud>();
    cloud->header = detail::header_of(proxy);
    cloud->points.assign(points.begin(), points.end());
    cloud->width = static_cast<uint32_t>(proxy.width.get());
    cloud->height = static_cast<uint32_t>(proxy.height.get());
    cloud->is_dense = proxy.is_dense.get();
    return cloud;
  }
};

template <typename Point>
struct Conversion<std::shared_ptr<pcl::PointCloud<Point>>> {
  using Cloud = pcl::PointCloud<Point>;
  using Proxy = typename PointTraits<Point>::Proxy;
  static Proxy to(cas::Cas& cas, const std::shared_ptr<Cloud>& cloud) {
    return Conversion<std::shared_ptr<const Cloud>>::to(cas, cloud);
  }
  /// A copy that may be written to.
  static std::shared_ptr<Cloud> from(const Proxy& proxy) {
    return std::make_shared<Cloud>(*Conversion<std::shared_ptr<const Cloud>>::from(proxy));
  }
};

/// By value: copies.
template <typename Point>
struct Conversion<pcl::PointCloud<Point>> {
  using Cloud = pcl::PointCloud<Point>;
  using Proxy = typename PointTraits<Point>::Proxy;
  static Proxy to(cas::Cas& cas, const Cloud& cloud) {
    return Conversion<std::shared_ptr<const Cloud>>::to(cas, std::make_shared<const Cloud>(cloud));
  }
  static Cloud from(const Proxy& proxy) { return *Conversion<std::shared_ptr<const Cloud>>::from(proxy); }
};

}  // namespace loci::perception::types
