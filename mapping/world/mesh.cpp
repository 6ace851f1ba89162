#include "mapping/world/mesh.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <bit>
#include <cmath>
#include <optional>
#include <string_view>
#include <unordered_map>

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

fs::path clean_path(const fs::path& path) {
  std::error_code ignored;
  fs::path absolute = fs::absolute(path, ignored).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

std::optional<fs::path> existing(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return path;
  return std::nullopt;
}

std::optional<fs::path> find_in_packages(const std::string& rest, const MeshSearch& search) {
  const size_t slash = rest.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const std::string package = rest.substr(0, slash), inside = rest.substr(slash + 1);
  for (const fs::path& folder : search.package_paths) {
    if (auto found = existing(folder / rest)) return found;
    if (clean_path(folder).filename() == package)
      if (auto found = existing(folder / inside)) return found;
  }
  // The URDF usually lies inside the package that it names.
  for (fs::path folder = clean_path(search.urdf_folder); folder.has_relative_path();
       folder = folder.parent_path())
    if (folder.filename() == package)
      if (auto found = existing(folder / inside)) return found;
  return std::nullopt;
}

std::optional<fs::path> find_mesh(const std::string& uri, const MeshSearch& search) {
  for (const std::string_view scheme : {"package://", "model://"})
    if (uri.starts_with(scheme)) return find_in_packages(uri.substr(scheme.size()), search);
  const std::string_view file_scheme = "file://";
  if (uri.starts_with(file_scheme)) return existing(uri.substr(file_scheme.size()));
  return existing(search.urdf_folder / uri);
}

/// Welds equal positions, so that neighbouring triangles share vertices whatever the file says of normals.
class Collector {
 public:
  explicit Collector(TriangleMesh& mesh) : mesh_(mesh) {}

  uint32_t vertex(const Eigen::Vector3d& position) {
    const Eigen::Vector3f p = position.cast<float>() + Eigen::Vector3f::Zero();  // -0 becomes 0.
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

Eigen::Matrix4d matrix_from(const aiMatrix4x4& m) {
  Eigen::Matrix4d result;
  result << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return result;
}

/// The diffuse colour of a material from the file; unset for the one that assimp makes up.
std::optional<Rgba> diffuse_color(const aiScene& scene, unsigned material_index) {
  if (material_index >= scene.mNumMaterials) return std::nullopt;
  const aiMaterial& material = *scene.mMaterials[material_index];
  aiString name;
  if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS &&
      std::string_view(name.C_Str()) == AI_DEFAULT_MATERIAL_NAME)
    return std::nullopt;
  aiColor4D color;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != aiReturn_SUCCESS) return std::nullopt;
  return Rgba(color.r, color.g, color.b, color.a);
}

constexpr float kDefaultGrey = 0.7f;

class SceneReader {
 public:
  SceneReader(const aiScene& scene, const Vector3d& scale) : scene_(scene), collector_(mesh_) {
    Eigen::Matrix4d root = Eigen::Matrix4d::Identity();
    root.diagonal().head<3>() = scale;
    read_node(*scene.mRootNode, root);
    if (!any_color_) mesh_.colors.clear();
  }

  TriangleMesh take() { return std::move(mesh_); }

 private:
  void read_node(const aiNode& node, const Eigen::Matrix4d& root_from_parent) {
    const Eigen::Matrix4d root_from_node = root_from_parent * matrix_from(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      read_mesh(*scene_.mMeshes[node.mMeshes[i]], root_from_node);
    for (unsigned i = 0; i < node.mNumChildren; ++i) read_node(*node.mChildren[i], root_from_node);
  }

  void read_mesh(const aiMesh& part, const Eigen::Matrix4d& root_from_node) {
    const bool mirrored = root_from_node.topLeftCorner<3, 3>().determinant() < 0;
    const std::optional<Rgba> color = diffuse_color(scene_, part.mMaterialIndex);
    any_color_ = any_color_ || color.has_value();
    std::vector<uint32_t> index(part.mNumVertices);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& v = part.mVertices[i];
      const Eigen::Vector3d position = (root_from_node * Eigen::Vector4d(v.x, v.y, v.z, 1)).head<3>();
      index[i] = position.allFinite() ? collector_.vertex(position) : kNone;
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // Points and lines have no surface.
      std::array<uint32_t, 3> t = {index[face.mIndices[0]], index[face.mIndices[1]], index[face.mIndices[2]]};
      if (mirrored) std::swap(t[1], t[2]);
      if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2] || std::ranges::find(t, kNone) != t.end()) continue;
      mesh_.triangles.push_back(t);
      mesh_.colors.push_back(color.value_or(Rgba(kDefaultGrey, kDefaultGrey, kDefaultGrey, 1)));
    }
  }

  static constexpr uint32_t kNone = ~0u;
  const aiScene& scene_;
  TriangleMesh mesh_;
  Collector collector_;
  bool any_color_ = false;
};

}  // namespace

TriangleMesh load_mesh(const Mesh& mesh, const MeshSearch& search, Warnings& warnings) {
  const std::optional<fs::path> path = find_mesh(mesh.uri, search);
  if (!path) {
    warnings.add("mesh '" + mesh.uri + "' not found" +
                 (mesh.uri.starts_with("package://")
                      ? "; --package-path names the folder that holds its package"
                      : ""));
    return {};
  }
  Assimp::Importer importer;
  // assimp turns COLLADA files with Z up by -90 degrees about x; robots' files mean their own axes.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path->string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (!scene || !scene->mRootNode) {
    warnings.add("mesh '" + mesh.uri + "' cannot be read: " + importer.GetErrorString());
    return {};
  }
  TriangleMesh triangles = SceneReader(*scene, mesh.scale).take();
  if (triangles.triangles.empty()) warnings.add("mesh '" + mesh.uri + "' has no triangles");
  return triangles;
}

}  // namespace loci::mapping
