#include "perception/pipeline/contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::ranges::find(list, name) != list.end();
}

bool may_write(const AnnotatorDescriptor& descriptor, const std::string& product) {
  return contains(descriptor.outputs, product) || contains(descriptor.modifies, product);
}

/// Under its name, that of a type above it, or either without "Annotation".
bool may_write(const AnnotatorDescriptor& descriptor, cas::Type type) {
  constexpr std::string_view kEnding = "Annotation";
  for (; type; type = type.supertype()) {
    const std::string name(type.short_name());
    if (may_write(descriptor, name) || may_write(descriptor, std::string(type.name()))) return true;
    if (name.ends_with(kEnding) && may_write(descriptor, name.substr(0, name.size() - kEnding.size())))
      return true;
  }
  return false;
}

/// Whether descriptors declare the type. Others, such as vectors and arrays, are parts of what is declared,
/// and everybody writes the log.
bool is_declarable(const cas::FeatureStructure& structure) {
  if (types::is<types::Log>(structure)) return false;
  return types::is<types::Annotation>(structure) || types::is<types::ObjectHypothesis>(structure) ||
         types::is<types::Cluster>(structure) || types::is<types::PlanarSupport>(structure);
}

std::vector<uint32_t> clusters_of(cas::Cas& cas) {
  const types::SceneCas scene(cas);
  std::vector<uint32_t> ids;
  if (scene.has_scene())
    for (const types::Cluster& cluster : scene.scene().clusters) ids.push_back(cluster.structure().id());
  std::ranges::sort(ids);
  return ids;
}

struct ImageSize {
  int width = 0, height = 0;
};

/// Of an image, or of points or normals in the order of one.
std::optional<ImageSize> size_of(const cas::FeatureStructure& subject) {
  if (const auto image = types::try_as<types::Mat>(subject))
    return ImageSize{image->cols.get(), image->rows.get()};
  if (const auto cloud = types::try_as<types::PointCloud>(subject))
    return ImageSize{cloud->width.get(), cloud->height.get()};
  return std::nullopt;
}

/// The size that a view has to have; nothing for views other than those of the cameras.
std::optional<ImageSize> camera_size(const types::SceneCas& scene, const std::string& view) {
  constexpr std::array kOfDepth{types::SceneCas::kDepth,    types::SceneCas::kSmoothedDepth,
                                types::SceneCas::kCloud,    types::SceneCas::kNormals,
                                types::SceneCas::kMapDepth, types::SceneCas::kStructure};
  const bool of_color = view == types::SceneCas::kColor;
  if (!of_color && std::ranges::find(kOfDepth, view) == kOfDepth.end()) return std::nullopt;
  const char* camera = of_color ? "color" : "depth";
  if (!scene.has_scene() || !scene.has_camera(camera)) return std::nullopt;
  const types::CameraInfo info = scene.camera(camera);
  return ImageSize{static_cast<int>(info.width.get()), static_cast<int>(info.height.get())};
}

void check_view(const AnnotatorDescriptor& descriptor, const std::string& view, cas::Cas& cas) {
  if (!may_write(descriptor, "view:" + view))
    throw Error(fmt::format("it sets view:{}, which is not among its outputs", view));
  const auto expected = camera_size(types::SceneCas(cas), view);
  const auto given = size_of(cas.find_view(view)->sofa_data());
  if (expected && given && (given->width != expected->width || given->height != expected->height))
    throw Error(fmt::format("it sets view:{} to {} x {} pixels, the camera has {} x {}", view, given->width,
                            given->height, expected->width, expected->height));
}

}  // namespace

ContentsBefore::ContentsBefore(cas::Cas& cas) : structures(cas.size()), clusters(clusters_of(cas)) {}

void check_contract(const AnnotatorDescriptor& descriptor, const ContentsBefore& before, cas::Cas& cas) {
  for (const cas::FeatureStructure& each : cas.changes())
    if (each.id() > before.structures && is_declarable(each) && !may_write(descriptor, each.type()))
      throw Error(fmt::format("it makes {}, which is not among its outputs", each.type().short_name()));
  for (const std::string& view : cas.changed_views()) check_view(descriptor, view, cas);
  if (!contains(descriptor.modifies, "Cluster") && !std::ranges::includes(clusters_of(cas), before.clusters))
    throw Error("it removes a cluster, and Cluster is not among what it modifies");
}

}  // namespace loci::perception
