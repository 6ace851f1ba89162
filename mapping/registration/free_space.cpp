#include "mapping/registration/free_space.h"

#include <algorithm>
#include <cmath>

namespace loci::mapping::registration {
namespace {

constexpr size_t kImagesMax = 32;
constexpr float kRangeMargin = 0.02F;  ///< of the range: what a small turn moves, and noise

}  // namespace

FreeSpace::FreeSpace(const Scan& scan, const Isometry3d& level_from_scan) {
  if (scan.origins.empty()) return;
  const size_t step = (scan.origins.size() + kImagesMax - 1) / kImagesMax;
  for (size_t i = 0; i < scan.origins.size(); i += step) {
    images_.emplace_back();
    images_.back().origin = (level_from_scan * scan.origins[i].cast<double>()).cast<float>();
    for (Face& face : images_.back().nearest) face.fill(0.F);
  }
  const Eigen::Matrix3f turn = level_from_scan.linear().cast<float>();
  const auto for_rays = [&](const auto& visit) {
    for (const ScanPoint& point : scan.points) {
      if (point.origin_index % step != 0 || point.origin_index >= scan.origins.size()) continue;
      const Eigen::Vector3f ray = turn * (point.position - scan.origins[point.origin_index]);
      const float range = ray.norm();
      if (!(range > 0.F)) continue;
      const auto [face, pixel] = pixel_of(ray);
      visit(images_[point.origin_index / step].nearest[static_cast<size_t>(face)][static_cast<size_t>(pixel)],
            range);
    }
  };
  for_rays([](float& nearest, float range) { nearest = nearest > 0.F ? std::min(nearest, range) : range; });
  size_t rays = 0, hidden = 0;
  for_rays([&](float nearest, float range) {
    ++rays;
    hidden += range > 1.5F * nearest ? 1 : 0;
  });
  hidden_part_ = rays > 0 ? static_cast<double>(hidden) / static_cast<double>(rays) : 0;
  erode();
}

std::pair<int, int> FreeSpace::pixel_of(const Eigen::Vector3f& direction) {
  int axis = 0;
  const float longest = direction.cwiseAbs().maxCoeff(&axis);
  const auto coordinate = [&](int other) {
    const float value = (direction[other] / longest + 1.F) * 0.5F * static_cast<float>(kSide);
    return std::clamp(static_cast<int>(value), 0, kSide - 1);
  };
  const int face = 2 * axis + (direction[axis] < 0.F ? 1 : 0);
  return {face, coordinate((axis + 1) % 3) * kSide + coordinate((axis + 2) % 3)};
}

/// Every pixel that a ray went to gets the nearest range around it: at edges of things nothing is called
/// free.
void FreeSpace::erode() {
  for (Image& image : images_) {
    for (Face& face : image.nearest) {
      const Face source = face;
      for (int v = 0; v < kSide; ++v)
        for (int u = 0; u < kSide; ++u) {
          float& nearest = face[static_cast<size_t>(v * kSide + u)];
          if (nearest == 0.F) continue;
          for (int y = std::max(0, v - 1); y <= std::min(kSide - 1, v + 1); ++y)
            for (int x = std::max(0, u - 1); x <= std::min(kSide - 1, u + 1); ++x) {
              const float other = source[static_cast<size_t>(y * kSide + x)];
              if (other > 0.F) nearest = std::min(nearest, other);
            }
        }
    }
  }
}

bool FreeSpace::passed(const Eigen::Vector3f& point, float margin) const {
  for (const Image& image : images_) {
    const Eigen::Vector3f ray = point - image.origin;
    const float range = ray.norm();
    const auto [face, pixel] = pixel_of(ray);
    const float nearest = image.nearest[static_cast<size_t>(face)][static_cast<size_t>(pixel)];
    if (nearest > 0.F && range + margin + kRangeMargin * nearest < nearest) return true;
  }
  return false;
}

}  // namespace loci::mapping::registration
