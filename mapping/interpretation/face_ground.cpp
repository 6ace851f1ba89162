#include "mapping/interpretation/face_ground.h"

#include <algorithm>

namespace loci::mapping {
namespace {

constexpr double kRank = 0.7;          // of the depths in a neighbourhood: bars cover less than the rest
constexpr double kRankSigmas = 0.524;  // by which that rank of a normal distribution exceeds its mean
constexpr size_t kMin = 30;
constexpr double kMaxNoise = 0.012;  // m; more is relief

}  // namespace

FaceGround::FaceGround(const FaceRays& rays)
    : grid_(rays.face), width_(grid_.width / kCells + 1), height_(grid_.height / kCells + 1) {
  std::vector<std::vector<float>> patches(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  depth_.assign(patches.size(), 0);
  for (const FaceRay& ray : rays.rays) {
    const int x = grid_.column(static_cast<double>(ray.u));
    const int y = grid_.row(static_cast<double>(ray.v));
    if (ray.returned && std::abs(ray.depth) < static_cast<float>(kFaceRelief) && grid_.inside(x, y))
      patches[static_cast<size_t>(y / kCells * width_ + x / kCells)].push_back(ray.depth);
  }
  std::vector<float> around;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      around.clear();
      for (int ny = std::max(0, y - 1); ny <= std::min(height_ - 1, y + 1); ++ny)
        for (int nx = std::max(0, x - 1); nx <= std::min(width_ - 1, x + 1); ++nx) {
          const std::vector<float>& patch = patches[static_cast<size_t>(ny * width_ + nx)];
          around.insert(around.end(), patch.begin(), patch.end());
        }
      if (around.size() < kMin) continue;
      const auto rank =
          around.begin() + static_cast<std::ptrdiff_t>(kRank * static_cast<double>(around.size()));
      std::nth_element(around.begin(), rank, around.end());
      depth_[static_cast<size_t>(y * width_ + x)] =
          *rank - static_cast<float>(kRankSigmas * std::min(rays.sigma, kMaxNoise));
    }
}

double FaceGround::at(double u, double v) const {
  const int x = grid_.column(u);
  const int y = grid_.row(v);
  if (!grid_.inside(x, y)) return 0;
  return static_cast<double>(depth_[static_cast<size_t>(y / kCells * width_ + x / kCells)]);
}

}  // namespace loci::mapping
