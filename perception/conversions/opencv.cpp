#include "perception/conversions/opencv.h"

#include <algorithm>
#include <array>
#include <limits>

namespace loci::perception::types {
namespace {

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

std::vector<cv::Point2f> near_hull(const std::vector<cv::Point2f>& points) {
  constexpr std::array<std::array<float, 2>, 8> kDirections{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};  // counter-clockwise
  std::array<cv::Point2f, 8> corners;
  std::array<float, 8> reach;
  reach.fill(std::numeric_limits<float>::lowest());
  for (const cv::Point2f& p : points)
    for (size_t d = 0; d < corners.size(); ++d) {
      const float along = kDirections[d][0] * p.x + kDirections[d][1] * p.y;
      if (along <= reach[d]) continue;
      reach[d] = along;
      corners[d] = p;
    }
  if (corners[0] == corners[4] && corners[2] == corners[6]) return points;  // all are one
  constexpr float kOnEdge = 1e-9f;  // square metres: a point on an edge may be a corner
  std::vector<std::pair<cv::Point2f, cv::Point2f>> edges;  // from where, and along
  for (size_t d = 0; d < corners.size(); ++d)
    if (const cv::Point2f edge = corners[(d + 1) % corners.size()] - corners[d]; edge != cv::Point2f())
      edges.emplace_back(corners[d], edge);
  std::vector<cv::Point2f> outer;
  for (const cv::Point2f& p : points)
    if (!std::ranges::all_of(edges, [&](const auto& e) { return e.second.cross(p - e.first) > kOnEdge; }))
      outer.push_back(p);
  return outer;
}

}  // namespace loci::perception::types
