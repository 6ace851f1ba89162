#include "perception/types/scene_cas.h"

namespace loci::perception::types {
namespace {

/// Without those that are hidden in a branch that works on a part.
template <class P>
std::vector<P> shown(const cas::Cas& cas, std::vector<P> all) {
  std::erase_if(all, [&](const P& each) { return cas.is_hidden(each); });
  return all;
}

}  // namespace

const std::shared_ptr<const cas::TypeSystem>& type_system() {
  static const std::shared_ptr<const cas::TypeSystem> system = type_system_with({});
  return system;
}

std::shared_ptr<const cas::TypeSystem> type_system_with(const std::vector<std::filesystem::path>& files,
                                                        const std::vector<std::filesystem::path>& path_dirs) {
  return cas::TypeSystem::load(type_sources(), files, path_dirs);
}

cas::Buffer<int32_t> cluster_indices(const Cluster& cluster) {
  const auto reference = cluster.hypotheses.first<ReferenceClusterPoints>();
  return reference ? reference.indices.get().indices.get() : cas::Buffer<int32_t>();
}

std::string place_of(const Cluster& cluster) {
  if (cluster.place.is_set()) return cluster.place.get();
  return cluster.support.is_set() ? cluster.support.get().name.get() : std::string();
}

bool SceneCas::has_scene() const {
  return !cas_->select(Scene::kTypeName).empty();
}

Scene SceneCas::scene() const {
  const cas::Selection scenes = cas_->select(Scene::kTypeName);
  if (scenes.empty()) throw Error("the CAS holds no scene", {}, "a reader makes it: create_scene()");
  return Scene(scenes.front());
}

Scene SceneCas::create_scene() const {
  if (has_scene()) throw Error("the CAS holds a scene already");
  const Scene scene = Scene::create(*cas_);
  scene.add_to_index();
  return scene;
}

void SceneCas::add_cluster(const Cluster& cluster) const {
  scene().clusters.push_back(cluster);
  cluster.add_to_index();
}

std::vector<Cluster> SceneCas::clusters() const {
  return shown(*cas_, scene().clusters.to_vector());
}

void SceneCas::add_support(const PlanarSupport& support) const {
  scene().supports.push_back(support);
  support.add_to_index();
}

std::vector<PlanarSupport> SceneCas::supports() const {
  return shown(*cas_, scene().supports.to_vector());
}

void SceneCas::set_subject(std::string_view view, const cas::FeatureStructure& subject,
                           const char* mime_type) const {
  cas_->view(view).set_sofa_data(subject, mime_type);
}

bool SceneCas::has(std::string_view view) const {
  const cas::View* found = cas_->find_view(view);
  return found != nullptr && found->sofa_data();
}

cas::FeatureStructure SceneCas::subject(std::string_view view) const {
  if (!has(view)) throw Error("the CAS has no data in view '" + std::string(view) + "'");
  return cas_->find_view(view)->sofa_data();
}

void SceneCas::set_image(std::string_view view, const Mat& image) const {
  set_subject(view, image, "application/x-opencv-mat");
}

Mat SceneCas::image(std::string_view view) const {
  return as<Mat>(subject(view));
}

void SceneCas::set_cloud(const PointCloud& cloud) const {
  set_subject(kCloud, cloud, "application/x-pcl-cloud");
}

PointCloud SceneCas::cloud() const {
  return as<PointCloud>(subject(kCloud));
}

void SceneCas::set_normals(const NormalMap& normals) const {
  set_subject(kNormals, normals, "application/x-pcl-cloud");
}

NormalMap SceneCas::normals() const {
  return as<NormalMap>(subject(kNormals));
}

void SceneCas::set_camera(const CameraInfo& camera) const {
  const auto& cameras = scene().cameras;
  for (const CameraInfo& each : cameras)
    if (each.name.get() == camera.name.get()) cameras.erase(each);
  cameras.push_back(camera);
}

bool SceneCas::has_camera(std::string_view name) const {
  for (const CameraInfo& each : scene().cameras)
    if (each.name.get() == name) return true;
  return false;
}

CameraInfo SceneCas::camera(std::string_view name) const {
  for (const CameraInfo& each : scene().cameras)
    if (each.name.get() == name) return each;
  throw Error("the scene has no camera '" + std::string(name) + "'");
}

void SceneCas::log(const std::string& annotator, const std::string& level, const std::string& text,
                   double milliseconds) const {
  const LogEntry entry = LogEntry::create(*cas_);
  entry.annotator.set(annotator);
  entry.level.set(level);
  entry.text.set(text);
  if (milliseconds >= 0) entry.milliseconds.set(milliseconds);
  scene().log.get_or_create().entries.push_back(entry);
}

}  // namespace loci::perception::types
