#include "mapping/exchange/formats/gltf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <span>
#include <sstream>
#include <tuple>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh_files.h"

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

namespace loci::mapping {
namespace {

constexpr int kMaxImageSide = 2048;  // pixels
const Rgba kPlain(0.7F, 0.7F, 0.7F, 1);

/// Colours of vertices and materials are linear in glTF, those of images are sRGB.
float linear(float share) {
  return share <= 0.04045F ? share / 12.92F : std::pow((share + 0.055F) / 1.055F, 2.4F);
}

std::vector<double> doubles_of(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return {values.begin(), values.end()};
}

/// A model with one scene and one buffer.
class GltfModel {
 public:
  GltfModel() {
    model_.asset.version = "2.0";
    model_.asset.generator = "loci";
    model_.buffers.emplace_back();
    model_.scenes.emplace_back();
    model_.defaultScene = 0;
  }

  /// A node with the pose in its parent; -1 makes it one of the scene. Returns its number.
  int add_node(int parent, const std::string& name, const Isometry3d& pose = Isometry3d::Identity()) {
    const int number = static_cast<int>(model_.nodes.size());
    tinygltf::Node& node = model_.nodes.emplace_back();
    node.name = name;
    if (!pose.translation().isZero()) node.translation = doubles_of(pose.translation());
    const Eigen::Quaterniond turn(pose.linear());
    if (turn.vec() != Vector3d::Zero()) node.rotation = doubles_of(turn.coeffs());
    (parent < 0 ? model_.scenes[0].nodes : model_.nodes[static_cast<size_t>(parent)].children)
        .push_back(number);
    return number;
  }
  /// A node of the scene in which z is up.
  int add_upright(const std::string& name) {
    return add_node(-1, name, Isometry3d(Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitX())));
  }

  tinygltf::Node& node(int number) { return model_.nodes[static_cast<size_t>(number)]; }

  /// An accessor to vectors of floats or, with indices, to integers. Returns its number.
  template <class T>
  int add_array(const std::vector<T>& values, int type, int target = 0) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_bytes(values.data(), values.size() * sizeof(T), target);
    accessor.componentType = target == TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER
                                 ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT
                                 : TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = type;
    accessor.count = values.size() * sizeof(T) / sizeof(float) /
                     static_cast<size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }
  int add_positions(const std::vector<Eigen::Vector3f>& positions) {
    const int number = add_array(positions, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& position : positions) box.extend(position);
    model_.accessors.back().minValues = doubles_of(box.min().cast<double>());
    model_.accessors.back().maxValues = doubles_of(box.max().cast<double>());
    return number;
  }
  int add_triangles(const std::vector<std::array<uint32_t, 3>>& triangles) {
    return add_array(triangles, TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  }

  int add_material(const tinygltf::Material& material) {
    model_.materials.push_back(material);
    return static_cast<int>(model_.materials.size()) - 1;
  }
  /// Of what shows the light of the room already.
  void set_unlit(tinygltf::Material& material) {
    constexpr const char* kUnlit = "KHR_materials_unlit";
    material.extensions[kUnlit] = tinygltf::Value(tinygltf::Value::Object());
    if (model_.extensionsUsed.empty()) model_.extensionsUsed.emplace_back(kUnlit);
  }
  /// A texture from the bytes of a PNG or JPEG file.
  int add_texture(const std::string& bytes) {
    tinygltf::Image image;
    image.bufferView = add_bytes(bytes.data(), bytes.size(), 0);
    image.mimeType = bytes.starts_with("\x89PNG") ? "image/png" : "image/jpeg";
    tinygltf::Texture texture;
    texture.source = static_cast<int>(model_.images.size());
    model_.images.push_back(image);
    model_.textures.push_back(texture);
    return static_cast<int>(model_.textures.size()) - 1;
  }

  int add_mesh(const std::string& name, std::vector<tinygltf::Primitive> primitives) {
    tinygltf::Mesh& mesh = model_.meshes.emplace_back();
    mesh.name = name;
    mesh.primitives = std::move(primitives);
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  /// Moves a node within a second; `path` is "rotation" or "translation" and `type` that of its values.
  void animate(int target, const std::string& name, const char* path, int type,
               const std::vector<float>& values) {
    tinygltf::AnimationSampler sampler;
    sampler.input = add_array(std::vector<float>{0, 1}, TINYGLTF_TYPE_SCALAR);
    model_.accessors.back().minValues = {0};
    model_.accessors.back().maxValues = {1};
    sampler.output = add_array(values, type);
    tinygltf::AnimationChannel channel;
    channel.sampler = 0;
    channel.target_node = target;
    channel.target_path = path;
    tinygltf::Animation& animation = model_.animations.emplace_back();
    animation.name = name;
    animation.samplers.push_back(sampler);
    animation.channels.push_back(channel);
  }

  std::string bytes() {
    std::ostringstream stream;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, false, true))
      throw Error("the model cannot be written as glTF");
    return stream.str();
  }

 private:
  /// The number of the view of the bytes, which begin where floats may.
  int add_bytes(const void* data, size_t size, int target) {
    std::vector<unsigned char>& bytes = model_.buffers.front().data;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = size;
    view.target = target;
    const auto* first = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), first, first + size);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  tinygltf::Model model_;
};

/// The bytes of an image file that glTF may hold, made smaller where it is large.
std::string texture_bytes(const std::filesystem::path& file) {
  std::string bytes = read_file(file);
  cv::Mat image = decode_color(bytes, file.string());
  const int side = std::max(image.cols, image.rows);
  if (side <= kMaxImageSide) return bytes;
  const double scale = static_cast<double>(kMaxImageSide) / side;
  cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  const std::vector<unsigned char> smaller = encode_image(image, ".jpg");
  return {smaller.begin(), smaller.end()};
}

class WorldWriter {
 public:
  WorldWriter(const World& world, const MeshSearch& search, Warnings& warnings)
      : world_(world), search_(search), warnings_(warnings) {}

  std::string bytes() {
    add_link(model_.add_upright(world_.name), world_.root);
    if (!any_) throw Error("a world without shapes cannot be written as glTF");
    return model_.bytes();
  }

 private:
  int add_link(int parent, const std::string& name) {
    const int node = model_.add_node(parent, name);
    std::vector<tinygltf::Primitive> primitives;
    for (const Visual& visual : world_.find_link(name)->visuals) add_visual(visual, primitives);
    if (!primitives.empty()) {
      model_.node(node).mesh = model_.add_mesh(name, std::move(primitives));
      any_ = true;
    }
    for (const Joint& joint : world_.joints)
      if (joint.parent == name) add_joint(node, joint);
    return node;
  }

  void add_joint(int parent, const Joint& joint) {
    const int node = model_.add_node(parent, joint.name, joint.parent_from_joint);
    using tinygltf::Value;
    Value::Object extras = {{"type", Value(std::string(joint_type_name(joint.type)))}};
    if (joint.type != JointType::fixed) {
      Value::Array axis;
      for (const double value : joint.axis.normalized()) axis.emplace_back(value);
      extras["axis"] = Value(axis);
    }
    if (joint.limits)
      extras["limits"] = Value(Value::Array{Value(joint.limits->lower), Value(joint.limits->upper)});
    model_.node(node).extras = Value(extras);
    const int link = add_link(node, joint.child);
    if (joint.limits && !joint.mimic) animate(link, joint);
  }

  void animate(int link, const Joint& joint) {
    const double upper = joint.limits->upper > 0 ? joint.limits->upper : joint.limits->lower;
    const Isometry3d open = joint_motion(joint, upper);
    if (joint.type == JointType::revolute) {
      const Eigen::Quaternionf turn(open.linear().cast<float>());
      model_.animate(link, joint.name, "rotation", TINYGLTF_TYPE_VEC4,
                     {0, 0, 0, 1, turn.x(), turn.y(), turn.z(), turn.w()});
    } else if (joint.type == JointType::prismatic) {
      const Eigen::Vector3f far = open.translation().cast<float>();
      model_.animate(link, joint.name, "translation", TINYGLTF_TYPE_VEC3,
                     {0, 0, 0, far.x(), far.y(), far.z()});
    }
  }

  void add_visual(const Visual& visual, std::vector<tinygltf::Primitive>& primitives) {
    // A URDF material says more than the mesh file, as in RViz.
    const std::optional<Rgba> given = visual.material ? visual.material->color : std::nullopt;
    const Mesh* mesh = std::get_if<Mesh>(&visual.geometry);
    std::vector<MeshPart> parts;
    if (mesh != nullptr) {
      parts = load_mesh_parts(*mesh, search_, warnings_);
    } else {
      TriangleMesh shape = triangulate(visual.geometry, search_, warnings_);
      parts.push_back({std::move(shape.vertices), {}, std::move(shape.triangles), {}, {}});
    }
    for (MeshPart& part : parts) {
      if (part.triangles.empty()) continue;
      for (Eigen::Vector3f& vertex : part.vertices)
        vertex = (visual.link_from_visual * vertex.cast<double>()).cast<float>();
      tinygltf::Primitive primitive;
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
      primitive.attributes["POSITION"] = model_.add_positions(part.vertices);
      primitive.indices = model_.add_triangles(part.triangles);
      if (given || part.texture.empty()) {
        primitive.material = plain_material(given.value_or(part.color.value_or(kPlain)));
      } else {
        for (Eigen::Vector2f& at : part.texture_coordinates) at.y() = 1 - at.y();  // downwards in glTF
        primitive.attributes["TEXCOORD_0"] =
            model_.add_array(part.texture_coordinates, TINYGLTF_TYPE_VEC2, TINYGLTF_TARGET_ARRAY_BUFFER);
        primitive.material = textured_material(part);
      }
      primitives.push_back(std::move(primitive));
    }
  }

  int plain_material(const Rgba& color) {
    const auto key = std::tuple(color[0], color[1], color[2], color[3]);
    if (const auto known = plain_.find(key); known != plain_.end()) return known->second;
    tinygltf::Material material;
    material.pbrMetallicRoughness.baseColorFactor = {linear(color[0]), linear(color[1]), linear(color[2]),
                                                     color[3]};
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = 0.9;
    if (color[3] < 1) material.alphaMode = "BLEND";
    return plain_[key] = model_.add_material(material);
  }

  int textured_material(const MeshPart& part) {
    if (const auto known = textured_.find(part.texture); known != textured_.end()) return known->second;
    try {
      tinygltf::Material material;
      material.name = part.texture.stem();
      material.pbrMetallicRoughness.metallicFactor = 0;
      material.pbrMetallicRoughness.baseColorTexture.index = model_.add_texture(texture_bytes(part.texture));
      model_.set_unlit(material);
      return textured_[part.texture] = model_.add_material(material);
    } catch (const Error& error) {
      warnings_.add(error.what());
      return textured_[part.texture] = plain_material(part.color.value_or(kPlain));
    }
  }

  const World& world_;
  const MeshSearch& search_;
  Warnings& warnings_;
  GltfModel model_;
  bool any_ = false;
  std::map<std::tuple<float, float, float, float>, int> plain_;
  std::map<std::filesystem::path, int> textured_;
};

}  // namespace

std::string glb_bytes(const ColoredMesh& mesh) {
  if (mesh.triangles.empty()) throw Error("a mesh without triangles cannot be written as glTF");
  GltfModel model;
  std::vector<float> colors;
  for (const auto& color : mesh.colors)
    for (const uint8_t channel : color) colors.push_back(linear(static_cast<float>(channel) / 255));
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = model.add_positions(mesh.positions);
  primitive.attributes["COLOR_0"] = model.add_array(colors, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  primitive.indices = model.add_triangles(mesh.triangles);
  tinygltf::Material material;
  material.doubleSided = true;
  model.set_unlit(material);
  primitive.material = model.add_material(material);
  model.node(model.add_upright("room")).mesh = model.add_mesh("room", {primitive});
  return model.bytes();
}

std::string glb_bytes(const World& world, const MeshSearch& search, Warnings& warnings) {
  return WorldWriter(world, search, warnings).bytes();
}

}  // namespace loci::mapping
