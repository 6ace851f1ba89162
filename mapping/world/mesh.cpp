#include "mapping/world/mesh.h"

#include <algorithm>
#include <bit>
#include <opencv2/core.hpp>
#include <unordered_map>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/world/mesh_files.h"

namespace loci::mapping {
namespace {

/// Welds equal positions, so that neighbouring triangles share vertices whatever the file says of normals.
class Collector {
 public:
  explicit Collector(TriangleMesh& mesh) : mesh_(mesh) {}

  uint32_t vertex(const Eigen::Vector3f& position) {
    const Eigen::Vector3f p = position + Eigen::Vector3f::Zero();  // -0 becomes 0.
    const auto [entry, fresh] = index_.emplace(
        Key{std::bit_cast<uint32_t>(p.x()), std::bit_cast<uint32_t>(p.y()), std::bit_cast<uint32_t>(p.z())},
        static_cast<uint32_t>(mesh_.vertices.size()));
    if (fresh) mesh_.vertices.push_back(p);
    return entry->second;
  }

 private:
  using Key = std::array<uint32_t, 3>;
  struct Hash {
    size_t operator()(const Key& key) const {
      uint64_t hash = key[0];
      for (const uint32_t part : {key[1], key[2]})
        hash = (hash ^ part) * 0x9E3779B97F4A7C15ULL ^ (hash >> 29);
      return hash;
    }
  };

  TriangleMesh& mesh_;
  std::unordered_map<Key, uint32_t, Hash> index_;
};

constexpr float kDefaultGrey = 0.7f;
constexpr uint64_t kMaxTexturePixels = uint64_t{1} << 24;  // of larger ones the material's colour is taken

/// The mean colour of a texture, else that of the material.
std::optional<Rgba> color_of(const MeshPart& part, Warnings& warnings) {
  if (part.texture.empty()) return part.color;
  try {
    const cv::Scalar bgr =
        cv::mean(decode_color(read_file(part.texture), part.texture.string(), kMaxTexturePixels)) / 255;
    return Rgba(
        cv::Vec4f(static_cast<float>(bgr[2]), static_cast<float>(bgr[1]), static_cast<float>(bgr[0]), 1).val);
  } catch (const Error& error) {
    warnings.add(error.what());
    return part.color;
  }
}

}  // namespace

TriangleMesh load_mesh(const Mesh& mesh, const MeshSearch& search, Warnings& warnings) {
  TriangleMesh result;
  Collector collector(result);
  bool any_color = false;
  for (const MeshPart& part : load_mesh_parts(mesh, search, warnings)) {
    const std::optional<Rgba> color = color_of(part, warnings);
    any_color = any_color || color.has_value();
    std::vector<uint32_t> index;
    for (const Eigen::Vector3f& vertex : part.vertices) index.push_back(collector.vertex(vertex));
    for (const auto& [a, b, c] : part.triangles) {
      const std::array<uint32_t, 3> t = {index[a], index[b], index[c]};
      if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
      result.triangles.push_back(t);
      result.colors.push_back(color.value_or(Rgba(kDefaultGrey, kDefaultGrey, kDefaultGrey, 1)));
    }
  }
  if (!any_color) result.colors.clear();
  return result;
}

}  // namespace loci::mapping
