#include "mapping/fusion/signed_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"

namespace loci::mapping {
namespace {

using Eigen::Vector3i;

constexpr double kMinTruncation = 0.03;  ///< metres: a step of a Kinect's disparity is 2.6 cm at 3 m
constexpr int kPixelStep = 2;            ///< blocks are larger than what lies between
constexpr double kNearWeight = 64;  ///< of a measurement at 1 m; falls with z⁴ as the noise's variance grows
constexpr double kMaxWeight = 60000;
constexpr uint16_t kMinWeight = 2;  ///< of a voxel that is meshed: two looks from afar
constexpr double kMaxVoxel = 0.1;   ///< metres
constexpr double kMinPatch = 0.05;  ///< metres: what is smaller across and hangs alone is noise
constexpr double kNoColor = 160;    ///< of all channels, where the colour camera saw nothing
constexpr size_t kMinExposureSamples = 300;

Vector3i offset_of(int voxel) {
  return {voxel & 7, (voxel >> 3) & 7, voxel >> 6};
}

int voxel_of(const Vector3i& cell) {
  return (cell.x() & 7) | ((cell.y() & 7) << 3) | ((cell.z() & 7) << 6);
}

Vector3i block_of(const Vector3i& cell) {
  return {cell.x() >> 3, cell.y() >> 3, cell.z() >> 3};
}

/// Depth and colour where a point of the camera frame is seen; depth is not a number elsewhere.
struct Sight {
  double depth = std::numeric_limits<double>::quiet_NaN();
  cv::Vec3b color = {0, 0, 0};
};

Sight sight_of(const RgbdFrame& frame, const Vector3d& point) {
  Sight sight;
  if (point.z() <= 0.1) return sight;
  const Vector2d pixel = frame.camera.depth.project(point);
  const auto u = static_cast<int>(std::floor(pixel.x() + 0.5)),
             v = static_cast<int>(std::floor(pixel.y() + 0.5));
  if (u < 0 || v < 0 || u >= frame.depth.cols || v >= frame.depth.rows) return sight;
  sight.depth = static_cast<double>(frame.depth.at<float>(v, u));
  sight.color = frame.color.at<cv::Vec3b>(v, u);
  return sight;
}

bool is_exposed(const cv::Vec3b& color) {
  return *std::min_element(color.val, color.val + 3) > 8 && *std::max_element(color.val, color.val + 3) < 248;
}

double mean(double value, double weight, double new_value, double new_weight) {
  return (value * weight + new_value * new_weight) / (weight + new_weight);
}

uint16_t added(uint16_t weight, double more) {
  return static_cast<uint16_t>(std::min(std::round(weight + more), kMaxWeight));
}

/// Drops patches that are smaller than `min_vertices`, and vertices that no triangle uses.
void drop_small_patches(ColoredMesh& mesh, size_t min_vertices) {
  std::vector<uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle)
      parent[std::max(root(corner), root(triangle[0]))] = std::min(root(corner), root(triangle[0]));
  std::vector<size_t> sizes(parent.size());
  for (uint32_t i = 0; i < parent.size(); ++i) ++sizes[root(i)];
  ColoredMesh kept;
  std::vector<uint32_t> number(parent.size(), UINT32_MAX);
  for (auto triangle : mesh.triangles) {
    if (sizes[root(triangle[0])] < min_vertices) continue;
    for (uint32_t& corner : triangle) {
      if (number[corner] == UINT32_MAX) {
        number[corner] = static_cast<uint32_t>(kept.positions.size());
        kept.positions.push_back(mesh.positions[corner]);
        kept.colors.push_back(mesh.colors[corner]);
      }
      corner = number[corner];
    }
    kept.triangles.push_back(triangle);
  }
  mesh = std::move(kept);
}

}  // namespace

SignedDistances::SignedDistances(double voxel_m, double range_max_m, double max_bytes, int threads)
    : voxel_m_(voxel_m),
      range_max_m_(range_max_m),
      max_blocks_(std::max<size_t>(64, static_cast<size_t>(max_bytes / sizeof(Block)))),
      threads_(threads) {}

double SignedDistances::truncation() const {
  return std::max(4 * voxel_m_, kMinTruncation);
}

Vector3d SignedDistances::centre(uint32_t block, int voxel) const {
  const Vector3i cell = index_.cells()[block] * kSide + offset_of(voxel);
  return (cell.cast<double>() + Vector3d::Constant(0.5)) * voxel_m_;
}

/// Null where nothing was measured nearby.
const SignedDistances::Voxel* SignedDistances::voxel_at(const Vector3i& cell) const {
  const uint32_t block = index_.find(block_of(cell));
  return block == CellIndex::kNone ? nullptr : &blocks_[block][static_cast<size_t>(voxel_of(cell))];
}

bool SignedDistances::is_known(const Voxel* voxel) {
  return voxel != nullptr && voxel->weight >= kMinWeight;
}

/// Blocks within the truncation of a measured point, new ones included, in order of first sight.
std::vector<uint32_t> SignedDistances::measured_blocks(const RgbdFrame& frame) {
  std::vector<uint32_t> blocks;
  const double block_m = kSide * voxel_m_;
  for (int v = 0; v < frame.depth.rows; v += kPixelStep)
    for (int u = 0; u < frame.depth.cols; u += kPixelStep) {
      const auto z = static_cast<double>(frame.depth.at<float>(v, u));
      if (!(z > 0 && z <= range_max_m_)) continue;
      for (const double along : {z - truncation(), z, z + truncation()}) {
        const Vector3d point = *frame.map_from_camera * frame.camera.depth.unproject(u, v, along);
        const uint32_t block = index_.insert(cell_of(point, block_m));
        if (block == blocks_.size()) {
          blocks_.emplace_back();
          last_frame_.push_back(0);
        }
        if (last_frame_[block] == frame_) continue;
        last_frame_[block] = frame_;
        blocks.push_back(block);
      }
    }
  return blocks;
}

/// Blocks that the frame looks through: what was there is gone.
std::vector<uint32_t> SignedDistances::blocks_before_surfaces(const RgbdFrame& frame) const {
  const Isometry3d camera_from_map = frame.map_from_camera->inverse();
  const double radius = kSide * voxel_m_ * std::sqrt(3.0) / 2;
  std::vector<uint32_t> blocks;
  for (uint32_t block = 0; block < blocks_.size(); ++block) {
    if (last_frame_[block] == frame_) continue;
    const Vector3d middle =
        camera_from_map *
        Vector3d((index_.cells()[block].cast<double>() + Vector3d::Constant(0.5)) * kSide * voxel_m_);
    bool is_free = middle.z() > radius;
    for (const Vector2d& corner :
         {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1), Vector2d(0, 0)}) {
      if (!is_free) break;
      const Vector3d side(corner.x() * radius, corner.y() * radius, 0);
      is_free = sight_of(frame, middle + side).depth > middle.z() + radius + truncation();
    }
    if (is_free) blocks.push_back(block);
  }
  return blocks;
}

/// How much brighter the frame is than what was integrated before, by channel.
Vector3d SignedDistances::exposure(const RgbdFrame& frame, const std::vector<uint32_t>& blocks) const {
  const Isometry3d camera_from_map = frame.map_from_camera->inverse();
  std::array<std::vector<double>, 3> ratios;
  for (const uint32_t block : blocks)
    for (int i = 0; i < kVoxels; i += 3) {
      const Voxel& voxel = blocks_[block][static_cast<size_t>(i)];
      if (voxel.color_weight == 0 || std::abs(voxel.distance) > INT16_MAX / 4) continue;
      const Vector3d point = camera_from_map * centre(block, i);
      const Sight sight = sight_of(frame, point);
      if (!(std::abs(sight.depth - point.z()) < truncation() / 2) || !is_exposed(sight.color)) continue;
      for (size_t k = 0; k < 3; ++k)
        ratios[k].push_back(std::log(256.0 * sight.color.val[k] / std::max<double>(voxel.color[k], 256)));
    }
  Vector3d gains = Vector3d::Ones();
  if (ratios[0].size() < kMinExposureSamples) return gains;
  for (size_t k = 0; k < 3; ++k)
    gains[static_cast<Eigen::Index>(k)] = std::exp(std::clamp(median(ratios[k]), -0.7, 0.7));
  return gains;
}

void SignedDistances::integrate(const RgbdFrame& frame, const Vector3d& exposure, uint32_t block) {
  const Isometry3d camera_from_map = frame.map_from_camera->inverse();
  for (int i = 0; i < kVoxels; ++i) {
    const Vector3d point = camera_from_map * centre(block, i);
    const Sight sight = sight_of(frame, point);
    const double ahead = sight.depth - point.z();
    if (!(ahead > -truncation()) || sight.depth > range_max_m_) continue;
    const double squared = sight.depth * sight.depth;
    const double weight = std::clamp(kNearWeight / (squared * squared), 1.0, 1024.0);
    Voxel& voxel = blocks_[block][static_cast<size_t>(i)];
    const double distance = std::min(ahead / truncation(), 1.0) * INT16_MAX;
    voxel.distance = static_cast<int16_t>(std::lround(mean(voxel.distance, voxel.weight, distance, weight)));
    voxel.weight = added(voxel.weight, weight);
    if (std::abs(ahead) > truncation() / 2 || sight.color == cv::Vec3b(0, 0, 0)) continue;
    for (int k = 0; k < 3; ++k) {
      uint16_t& channel = voxel.color[static_cast<size_t>(k)];
      const double seen = std::min(256 * sight.color.val[k] / exposure[k], 65535.0);
      channel = static_cast<uint16_t>(std::lround(mean(channel, voxel.color_weight, seen, weight)));
    }
    voxel.color_weight = added(voxel.color_weight, weight);
  }
}

void SignedDistances::integrate(const RgbdFrame& frame) {
  ++frame_;
  std::vector<uint32_t> blocks = measured_blocks(frame);
  while (blocks_.size() > max_blocks_ && voxel_m_ < kMaxVoxel) {
    coarsen();
    blocks = measured_blocks(frame);
  }
  const Vector3d gains = exposure(frame, blocks);
  const std::vector<uint32_t> free = blocks_before_surfaces(frame);
  blocks.insert(blocks.end(), free.begin(), free.end());
  parallel_for(blocks.size(), threads_, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) integrate(frame, gains, blocks[i]);
  });
}

/// Voxels of twice the size, each the mean of what its eight parts know.
void SignedDistances::coarsen() {
  const double scale = truncation();
  const CellIndex fine_index = std::move(index_);
  const std::vector<Block> fine = std::move(blocks_);
  index_ = CellIndex();
  blocks_.clear();
  voxel_m_ *= 2;
  const double factor = scale / truncation();
  for (const Vector3i& cell : fine_index.cells())
    index_.insert(Vector3i(cell.x() >> 1, cell.y() >> 1, cell.z() >> 1));
  blocks_.resize(index_.size());
  last_frame_.assign(index_.size(), 0);
  const auto part = [&](const Vector3i& at) -> const Voxel* {
    const uint32_t block = fine_index.find(block_of(at));
    return block == CellIndex::kNone ? nullptr : &fine[block][static_cast<size_t>(voxel_of(at))];
  };
  parallel_for(blocks_.size(), threads_, [&](size_t begin, size_t end) {
    for (size_t block = begin; block < end; ++block)
      for (int i = 0; i < kVoxels; ++i) {
        const Vector3i base = 2 * (index_.cells()[block] * kSide + offset_of(i));
        double distance = 0, weight = 0, color_weight = 0;
        Vector3d color = Vector3d::Zero();
        for (int corner = 0; corner < 8; ++corner) {
          const Voxel* voxel = part(base + Vector3i(corner & 1, (corner >> 1) & 1, corner >> 2));
          if (voxel == nullptr || voxel->weight == 0) continue;
          distance += static_cast<double>(voxel->weight) * voxel->distance;
          weight += voxel->weight;
          color += static_cast<double>(voxel->color_weight) *
                   Vector3d(voxel->color[0], voxel->color[1], voxel->color[2]);
          color_weight += voxel->color_weight;
        }
        if (weight == 0) continue;
        Voxel& voxel = blocks_[block][static_cast<size_t>(i)];
        voxel.distance = static_cast<int16_t>(std::lround(factor * distance / weight));
        voxel.weight = static_cast<uint16_t>(std::ceil(weight / 8));
        if (color_weight == 0) continue;
        for (int k = 0; k < 3; ++k)
          voxel.color[static_cast<size_t>(k)] = static_cast<uint16_t>(std::lround(color[k] / color_weight));
        voxel.color_weight = static_cast<uint16_t>(std::ceil(color_weight / 8));
      }
  });
}

/// Where the surface crosses the cell between a voxel and its seven neighbours of higher coordinates: the
/// mean of the crossings of the cell's edges, and the colour there. Unset where it does not, or not all is
/// known.
std::optional<SignedDistances::Vertex> SignedDistances::crossing(uint32_t block, int voxel) const {
  const Vector3i offset = offset_of(voxel), base = index_.cells()[block] * kSide + offset;
  const bool is_inner = (offset.array() < kSide - 1).all();
  std::array<const Voxel*, 8> corners{};
  int inside = 0;
  for (int c = 0; c < 8; ++c) {
    const Vector3i step(c & 1, c >> 1 & 1, c >> 2);
    const Voxel* corner =
        is_inner ? &blocks_[block][static_cast<size_t>(voxel_of(offset + step))] : voxel_at(base + step);
    if (!is_known(corner)) return std::nullopt;
    if (corner->distance < 0) ++inside;
    corners[static_cast<size_t>(c)] = corner;
  }
  if (inside == 0 || inside == 8) return std::nullopt;
  Vector3d sum = Vector3d::Zero(), color = Vector3d::Zero();
  double crossings = 0, colored = 0;
  for (int c = 0; c < 8; ++c) {
    const Voxel& from = *corners[static_cast<size_t>(c)];
    const double nearness = from.color_weight == 0 ? 0 : 1 - std::abs(from.distance) / (INT16_MAX + 1.0);
    color += nearness * Vector3d(from.color[2], from.color[1], from.color[0]) / 256;
    colored += nearness;
    for (int axis = 0; axis < 3; ++axis) {
      if ((c >> axis & 1) != 0) continue;
      const Voxel& to = *corners[static_cast<size_t>(c | 1 << axis)];
      if ((from.distance < 0) == (to.distance < 0)) continue;
      Vector3d at(c & 1, c >> 1 & 1, c >> 2);
      at[axis] += from.distance / static_cast<double>(from.distance - to.distance);
      sum += at;
      ++crossings;
    }
  }
  color = colored > 0 ? Vector3d(color / colored) : Vector3d::Constant(kNoColor);
  return Vertex{(base.cast<double>() + Vector3d::Constant(0.5) + sum / crossings) * voxel_m_, color};
}

ColoredMesh SignedDistances::mesh() const {
  ColoredMesh mesh;
  std::vector<std::array<uint32_t, kVoxels>> numbers(blocks_.size());
  for (uint32_t block = 0; block < blocks_.size(); ++block)
    for (int i = 0; i < kVoxels; ++i) {
      uint32_t& number = numbers[block][static_cast<size_t>(i)];
      number = UINT32_MAX;
      const auto vertex = crossing(block, i);
      if (!vertex) continue;
      number = static_cast<uint32_t>(mesh.positions.size());
      mesh.positions.push_back(vertex->position.cast<float>());
      const Eigen::Matrix<uint8_t, 3, 1> color = vertex->color.cast<uint8_t>();
      mesh.colors.push_back({color[0], color[1], color[2]});
    }
  const auto vertex_at = [&](const Vector3i& cell) {
    const uint32_t block = index_.find(block_of(cell));
    return block == CellIndex::kNone ? UINT32_MAX : numbers[block][static_cast<size_t>(voxel_of(cell))];
  };
  // Two triangles between the four cells around every pair of neighbouring voxels that the surface separates.
  for (uint32_t block = 0; block < blocks_.size(); ++block)
    for (int i = 0; i < kVoxels; ++i) {
      const Voxel& here = blocks_[block][static_cast<size_t>(i)];
      if (!is_known(&here)) continue;
      const Vector3i cell = index_.cells()[block] * kSide + offset_of(i);
      for (int axis = 0; axis < 3; ++axis) {
        const Voxel* next = voxel_at(cell + Vector3i::Unit(axis));
        if (!is_known(next) || (here.distance < 0) == (next->distance < 0)) continue;
        const Vector3i b = Vector3i::Unit((axis + 1) % 3), c = Vector3i::Unit((axis + 2) % 3);
        std::array<uint32_t, 4> quad = {vertex_at(cell - b - c), vertex_at(cell - c), vertex_at(cell),
                                        vertex_at(cell - b)};
        if (std::find(quad.begin(), quad.end(), UINT32_MAX) != quad.end()) continue;
        if (here.distance >= 0) std::swap(quad[1], quad[3]);  // The surface looks the other way.
        mesh.triangles.push_back({quad[0], quad[1], quad[2]});
        mesh.triangles.push_back({quad[0], quad[2], quad[3]});
      }
    }
  drop_small_patches(mesh, static_cast<size_t>(std::pow(kMinPatch / voxel_m_, 2)));
  return mesh;
}

}  // namespace loci::mapping
