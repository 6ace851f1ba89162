#include "perception/conversions/opencv.h"

#include <limits>

#include "mapping/base/math/vectorised.h"

namespace loci::perception::types {
namespace {

using Floats [[gnu::vector_size(8 * sizeof(float))]] = float;
using Ints [[gnu::vector_size(8 * sizeof(int))]] = int;

/// Lets a cv::Mat keep memory alive that belongs to a CAS: the mat's reference count owns a shared_ptr.
class SharedMemory : public cv::MatAllocator {
 public:
  static cv::Mat share(const cas::Buffer<uint8_t>& memory, int rows, int cols, int type, size_t step) {
    static const SharedMemory allocator;
    auto* pixels = const_cast<uint8_t*>(memory.data());  // cv::Mat knows no constant memory
    cv::Mat image(rows, cols, type, pixels, step);
    auto* handle = new cv::UMatData(&allocator);
    handle->data = handle->origdata = pixels;
    handle->size = memory.size();
    handle->refcount = 1;
    handle->userdata = new std::shared_ptr<const void>(memory.owner());
    image.u = handle;
    return image;
  }

  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step, cv::AccessFlag flags,
                         cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* handle) const override {
    if (handle == nullptr) return;
    delete static_cast<std::shared_ptr<const void>*>(handle->userdata);
    handle->userdata = nullptr;
    delete handle;
  }
};

}  // namespace

Mat Conversion<cv::Mat>::to(cas::Cas& cas, const cv::Mat& image) {
  if (image.dims > 2) throw Error("only images of two dimensions can be kept in a CAS");
  const bool shareable = image.u != nullptr && image.isContinuous();
  const auto kept = std::make_shared<const cv::Mat>(shareable ? image : image.clone());
  const Mat mat = Mat::create(cas);
  mat.rows.set(kept->rows);
  mat.cols.set(kept->cols);
  mat.Mat::type.set(kept->type());
  mat.step_size.set(static_cast<int64_t>(kept->cols) * static_cast<int64_t>(kept->elemSize()));
  mat.data.set(cas::Buffer<uint8_t>(kept, kept->data, kept->total() * kept->elemSize()));
  return mat;
}

cv::Mat Conversion<cv::Mat>::from(const Mat& proxy) {
  const int rows = proxy.rows.get();
  const int cols = proxy.cols.get();
  const int type = proxy.type.get();
  const int64_t step = proxy.step_size.get();
  if (rows < 0 || cols < 0 || type < 0 || type >= (CV_CN_MAX << CV_CN_SHIFT))
    throw Error("an image of " + std::to_string(cols) + " x " + std::to_string(rows) + " pixels of type " +
                std::to_string(type) + " is not possible");
  if (rows == 0 || cols == 0) return cv::Mat(rows, cols, type);
  const cas::Buffer<uint8_t> pixels = proxy.data.get();
  const auto width = static_cast<int64_t>(CV_ELEM_SIZE(type)) * cols;
  if (step < width || static_cast<int64_t>(pixels.size()) < step * (rows - 1) + width)
    throw Error("an image of " + std::to_string(cols) + " x " + std::to_string(rows) + " pixels has " +
                std::to_string(pixels.size()) + " bytes, which are too few");
  return SharedMemory::share(pixels, rows, cols, type, static_cast<size_t>(step));
}

Rect Conversion<cv::Rect>::to(cas::Cas& cas, const cv::Rect& rect) {
  const Rect proxy = Rect::create(cas);
  proxy.x.set(rect.x);
  proxy.y.set(rect.y);
  proxy.width.set(rect.width);
  proxy.height.set(rect.height);
  return proxy;
}

cv::Rect Conversion<cv::Rect>::from(const Rect& proxy) {
  return {proxy.x.get(), proxy.y.get(), proxy.width.get(), proxy.height.get()};
}

CameraInfo Conversion<mapping::PinholeCamera>::to(cas::Cas& cas, const mapping::PinholeCamera& camera) {
  const CameraInfo info = CameraInfo::create(cas);
  info.width.set(camera.width);
  info.height.set(camera.height);
  info.fx.set(camera.fx);
  info.fy.set(camera.fy);
  info.cx.set(camera.cx);
  info.cy.set(camera.cy);
  return info;
}

mapping::PinholeCamera Conversion<mapping::PinholeCamera>::from(const CameraInfo& proxy) {
  return {proxy.width.get(), proxy.height.get(), proxy.fx.get(),
          proxy.fy.get(),    proxy.cx.get(),     proxy.cy.get()};
}

void set_cameras(const SceneCas& cas, const mapping::RgbdCamera& camera) {
  const CameraInfo depth = to(cas.cas(), camera.depth);
  depth.name.set("depth");
  cas.set_camera(depth);
  const CameraInfo color = to(cas.cas(), camera.color);
  color.name.set("color");
  color.depth_from_camera.set(to(cas.cas(), camera.depth_from_color));
  cas.set_camera(color);
}

mapping::RgbdCamera cameras(const SceneCas& cas) {
  const CameraInfo color = cas.camera("color");
  return {from<mapping::PinholeCamera>(cas.camera("depth")), from<mapping::PinholeCamera>(color),
          from<Isometry3d>(color.depth_from_camera.get())};
}

std::vector<cv::Rect> heads_of_people(const Scene& scene) {
  std::vector<cv::Rect> heads;
  for (const Annotation& annotation : scene.annotations)
    if (const auto person = try_as<PersonAnnotation>(annotation); person && person->head.is_set())
      heads.push_back(from<cv::Rect>(person->head.get()));
  return heads;
}

LOCI_VECTORISED
std::vector<cv::Point2f> near_hull(const std::vector<cv::Point2f>& points) {
  constexpr int kSides = 8;
  constexpr Floats kAlongX = {1, 1, 0, -1, -1, -1, 0, 1}, kAlongY = {0, 1, 1, 1, 0, -1, -1, -1};
  // The outermost point in each of these directions, counter-clockwise.
  Floats reach = std::numeric_limits<float>::lowest() + Floats{};
  Ints outermost{};
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    const cv::Point2f& p = points[static_cast<size_t>(i)];
    const Floats along = kAlongX * p.x + kAlongY * p.y;
    outermost = along > reach ? i + Ints{} : outermost;
    reach = along > reach ? along : reach;
  }
  const auto corner = [&](int d) { return points[static_cast<size_t>(outermost[d % kSides])]; };
  if (points.empty() || (corner(0) == corner(4) && corner(2) == corner(6))) return points;  // all are one
  // Without those that lie within all sides of the octagon by more than the rounding. Where two corners are
  // one, the side between them does not count.
  Floats x, y, nx{}, ny{};
  for (int d = 0; d < kSides; ++d) {
    const cv::Point2f from = corner(d), edge = corner(d + 1) - from;
    x[d] = from.x, y[d] = from.y, nx[d] = -edge.y, ny[d] = edge.x;
  }
  constexpr float kRounding = 1e-6f;                                // metres
  const Floats length = (nx < 0 ? -nx : nx) + (ny < 0 ? -ny : ny);  // or somewhat more
  const Floats limit = length > 0 ? kRounding * length : -1 + Floats{};
  std::vector<cv::Point2f> outer;
  for (const cv::Point2f& p : points) {
    const Ints inside = nx * (p.x - x) + ny * (p.y - y) > limit;
    int all = -1;
    for (int d = 0; d < kSides; ++d) all &= inside[d];
    if (all == 0) outer.push_back(p);
  }
  return outer;
}

}  // namespace loci::perception::types
