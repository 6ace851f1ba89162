#include "mapping/world/mesh_files.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <string_view>

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

/// The image of a material in the package of the mesh that names it: relative, and at most two folders up
/// (meshes/x/a.dae and materials/a.png), so that no foreign mesh brings this machine's images into an
/// export; empty for none.
fs::path diffuse_texture(const aiScene& scene, unsigned material_index, const fs::path& folder) {
  aiString name;
  if (material_index >= scene.mNumMaterials ||
      scene.mMaterials[material_index]->GetTexture(aiTextureType_DIFFUSE, 0, &name) != aiReturn_SUCCESS)
    return {};
  const fs::path relative = fs::path(name.C_Str()).lexically_normal();
  if (relative.is_absolute() || relative.string().starts_with("../../../")) return {};
  return existing(folder / relative).value_or(fs::path());
}

class SceneReader {
 public:
  SceneReader(const aiScene& scene, const Vector3d& scale, fs::path folder)
      : scene_(scene), folder_(std::move(folder)) {
    Eigen::Matrix4d root = Eigen::Matrix4d::Identity();
    root.diagonal().head<3>() = scale;
    read_node(*scene.mRootNode, root);
  }

  std::vector<MeshPart> take() { return std::move(parts_); }

 private:
  void read_node(const aiNode& node, const Eigen::Matrix4d& root_from_parent) {
    const Eigen::Matrix4d root_from_node = root_from_parent * matrix_from(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      read_mesh(*scene_.mMeshes[node.mMeshes[i]], root_from_node);
    for (unsigned i = 0; i < node.mNumChildren; ++i) read_node(*node.mChildren[i], root_from_node);
  }

  void read_mesh(const aiMesh& mesh, const Eigen::Matrix4d& root_from_node) {
    MeshPart part;
    part.color = diffuse_color(scene_, mesh.mMaterialIndex);
    if (mesh.HasTextureCoords(0)) part.texture = diffuse_texture(scene_, mesh.mMaterialIndex, folder_);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      part.vertices.push_back((root_from_node * Eigen::Vector4d(v.x, v.y, v.z, 1)).head<3>().cast<float>());
      if (!part.texture.empty())
        part.texture_coordinates.emplace_back(mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y);
    }
    const bool mirrored = root_from_node.topLeftCorner<3, 3>().determinant() < 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // Points and lines have no surface.
      std::array<uint32_t, 3> t = {face.mIndices[0], face.mIndices[1], face.mIndices[2]};
      if (mirrored) std::swap(t[1], t[2]);
      if (std::ranges::all_of(t, [&](uint32_t corner) { return part.vertices[corner].allFinite(); }))
        part.triangles.push_back(t);
    }
    // No triangle has them; another vertex in their place leaves the bounds as they are.
    const auto finite = std::ranges::find_if(part.vertices, [](const auto& v) { return v.allFinite(); });
    for (Eigen::Vector3f& vertex : part.vertices)
      if (!vertex.allFinite()) vertex = finite == part.vertices.end() ? Eigen::Vector3f::Zero() : *finite;
    parts_.push_back(std::move(part));
  }

  const aiScene& scene_;
  fs::path folder_;
  std::vector<MeshPart> parts_;
};

/// Whether a name stands for a file beside the URDF.
bool is_relative(const std::string& uri) {
  return uri.find("://") == std::string::npos && fs::path(uri).is_relative();
}

}  // namespace

std::vector<MeshPart> load_mesh_parts(const Mesh& mesh, const MeshSearch& search, Warnings& warnings) {
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
  std::vector<MeshPart> parts = SceneReader(*scene, mesh.scale, path->parent_path()).take();
  if (std::ranges::all_of(parts, [](const MeshPart& part) { return part.triangles.empty(); }))
    warnings.add("mesh '" + mesh.uri + "' has no triangles");
  return parts;
}

void move_mesh_names(World& world, const fs::path& from, const fs::path& to) {
  // The folder of a bare file name is empty.
  const auto folder = [](const fs::path& path) { return fs::absolute(path.empty() ? "." : path); };
  const auto move = [&](Geometry& geometry) {
    Mesh* mesh = std::get_if<Mesh>(&geometry);
    if (mesh && is_relative(mesh->uri)) mesh->uri = fs::proximate(folder(from) / mesh->uri, folder(to));
  };
  for (Link& link : world.links) {
    for (Visual& visual : link.visuals) move(visual.geometry);
    for (Collision& collision : link.collisions) move(collision.geometry);
  }
}

}  // namespace loci::mapping
