#include "mapping/exchange/formats/gltf.h"

#include <cmath>
#include <sstream>

#include "mapping/base/error.h"

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

namespace loci::mapping {
namespace {

/// Appends an array of the mesh to the model's only buffer; returns the number of its accessor.
template <class T>
int add_array(tinygltf::Model& model, const std::vector<T>& values, size_t count, int component, int type,
              int target) {
  std::vector<unsigned char>& bytes = model.buffers.front().data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = values.size() * sizeof(T);
  view.target = target;
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  bytes.insert(bytes.end(), first, first + view.byteLength);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.bufferViews.push_back(view);
  model.accessors.push_back(accessor);
  return accessor.bufferView;
}

/// Colours of vertices are linear in glTF, those of images are sRGB.
float linear(uint8_t value) {
  const float share = static_cast<float>(value) / 255;
  return share <= 0.04045F ? share / 12.92F : std::pow((share + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

std::string glb_bytes(const ColoredMesh& mesh) {
  if (mesh.triangles.empty()) throw Error("a mesh without triangles cannot be written as glTF");
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "loci";
  model.buffers.emplace_back();
  std::vector<float> colors;
  for (const auto& color : mesh.colors)
    for (const uint8_t channel : color) colors.push_back(linear(channel));
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] =
      add_array(model, mesh.positions, mesh.positions.size(), TINYGLTF_COMPONENT_TYPE_FLOAT,
                TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.attributes["COLOR_0"] =
      add_array(model, colors, mesh.colors.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.indices =
      add_array(model, mesh.triangles, 3 * mesh.triangles.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  Eigen::Vector3f low = mesh.positions.front(), high = low;
  for (const Eigen::Vector3f& position : mesh.positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  model.accessors.front().minValues.assign(low.data(), low.data() + 3);
  model.accessors.front().maxValues.assign(high.data(), high.data() + 3);
  tinygltf::Material material;
  material.doubleSided = true;
  material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object());
  model.extensionsUsed.push_back("KHR_materials_unlit");
  model.materials.push_back(material);
  primitive.material = 0;
  tinygltf::Mesh room;
  room.primitives.push_back(primitive);
  model.meshes.push_back(room);
  tinygltf::Node node;
  node.name = "room";
  node.mesh = 0;
  node.rotation = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // z up becomes y up
  model.nodes.push_back(node);
  tinygltf::Scene scene;
  scene.nodes.push_back(0);
  model.scenes.push_back(scene);
  model.defaultScene = 0;
  std::ostringstream stream;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true))
    throw Error("the mesh cannot be written as glTF");
  return stream.str();
}

}  // namespace loci::mapping
