#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "mapping/base/math/cell_index.h"
#include "mapping/sensor/colored_mesh.h"
#include "mapping/sensor/frame.h"

namespace loci::mapping {

/// A truncated signed distance function with colours in blocks of 8 × 8 × 8 voxels, in the map frame.
class SignedDistances {
 public:
  SignedDistances(double voxel_m, double range_max_m, double max_bytes, int threads);

  /// A frame with pose and with its colour as the depth camera sees it (color_in_depth). When the blocks
  /// need more memory than allowed, voxels become twice as large.
  void integrate(const RgbdFrame& frame);

  /// The zero of the distances where enough was seen.
  ColoredMesh mesh() const;

  double voxel_m() const { return voxel_m_; }

 private:
  static constexpr int kSide = 8;
  static constexpr int kVoxels = kSide * kSide * kSide;

  /// Fixed point keeps the memory of a room small.
  struct Voxel {
    int16_t distance = INT16_MAX;        ///< of the truncation, in front of the surface positive
    uint16_t weight = 0;                 ///< 0 = never seen
    std::array<uint16_t, 3> color = {};  ///< blue, green, red in 1/256
    uint16_t color_weight = 0;
  };
  using Block = std::array<Voxel, kVoxels>;
  struct Vertex {
    Vector3d position, color;  ///< colour red, green, blue in 0 … 255
  };

  double truncation() const;
  Vector3d centre(uint32_t block, int voxel) const;
  const Voxel* voxel_at(const Eigen::Vector3i& cell) const;
  std::vector<uint32_t> measured_blocks(const RgbdFrame& frame);
  std::vector<uint32_t> blocks_before_surfaces(const RgbdFrame& frame) const;
  Vector3d exposure(const RgbdFrame& frame, const std::vector<uint32_t>& blocks) const;
  void integrate(const RgbdFrame& frame, const Vector3d& exposure, uint32_t block);
  void coarsen();
  static bool is_known(const Voxel* voxel);
  std::optional<Vertex> crossing(uint32_t block, int voxel) const;

  double voxel_m_, range_max_m_;
  size_t max_blocks_;
  int threads_;
  uint32_t frame_ = 0;  ///< counts frames
  CellIndex index_;
  std::vector<Block> blocks_;
  std::vector<uint32_t> last_frame_;  ///< in which a block was measured, beside blocks_
};

}  // namespace loci::mapping
