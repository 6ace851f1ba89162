#include "perception/conversions/pcl.h"

namespace loci::perception::types {

namespace detail {

namespace {

Header to_header(cas::Cas& cas, const pcl::PCLHeader& header) {
  const Header proxy = Header::create(cas);
  proxy.sequence.set(static_cast<int64_t>(header.seq));
  proxy.frame_id.set(header.frame_id);
  proxy.stamp.get_or_create().nanoseconds.set(static_cast<int64_t>(header.stamp) *
                                              1000);  // PCL: microseconds
  return proxy;
}

pcl::PCLHeader from_header(const Header& proxy) {
  pcl::PCLHeader header;
  if (!proxy) return header;
  header.seq = static_cast<uint32_t>(proxy.sequence.get());
  header.frame_id = proxy.frame_id.get();
  if (const Time stamp = proxy.stamp.get())
    header.stamp = static_cast<uint64_t>(stamp.nanoseconds.get() / 1000);
  return header;
}

}  // namespace

void describe_cloud(const PointCloud& proxy, const pcl::PCLHeader& header, const char* point_type,
                    size_t step, uint32_t width, uint32_t height, bool is_dense) {
  proxy.header.set(to_header(proxy.cas(), header));
  proxy.point_type.set(point_type);
  proxy.point_step.set(static_cast<int32_t>(step));
  proxy.width.set(static_cast<int32_t>(width));
  proxy.height.set(static_cast<int32_t>(height));
  proxy.is_dense.set(is_dense);
}

void check_cloud(const PointCloud& proxy, const char* point_type, size_t step) {
  if (proxy.point_type.get() != point_type)
    throw Error("a cloud of " + proxy.point_type.get() + " is no cloud of " + point_type);
  const int64_t width = proxy.width.get();
  const int64_t height = proxy.height.get();
  if (static_cast<size_t>(proxy.point_step.get()) != step || width < 0 || height < 0 ||
      static_cast<size_t>(width * height) * step != proxy.points.size())
    throw Error("a cloud of " + std::to_string(width) + " x " + std::to_string(height) + " points of " +
                std::to_string(step) + " bytes has " + std::to_string(proxy.points.size()) + " bytes");
}

pcl::PCLHeader header_of(const PointCloud& proxy) {
  return from_header(proxy.header.get());
}

}  // namespace detail

}  // namespace loci::perception::types
