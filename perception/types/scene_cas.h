#pragma once

#include "perception/types/generated.h"

namespace loci::perception::types {

/// Our types, from texts that are part of the program. Made once.
const std::shared_ptr<const cas::TypeSystem>& type_system();

/// Our types together with a user's: files in UIMA's XML, which may use and extend ours by name (or import
/// them as "loci.scene" and so on). Throws Error with file and line when they do not fit.
std::shared_ptr<const cas::TypeSystem> type_system_with(
    const std::vector<std::filesystem::path>& files,
    const std::vector<std::filesystem::path>& path_dirs = {});

/// Indices into the scene's cloud; empty when the cluster has none.
cas::Buffer<int32_t> cluster_indices(const Cluster& cluster);
/// Where the cluster is: its place, or the support that it stands on; empty when neither is known.
std::string place_of(const Cluster& cluster);

/// A scene-centric look at a CAS: the scene, its images, clouds and clusters. One of many possible facades
/// over the same CAS; it keeps no state.
///
/// Images and clouds are the subjects of views: colour (BGR 8 bit), depth (float metres, NaN = no
/// measurement), cloud, normals, smoothed_depth. The scene and its clusters are indexed in the default view.
class SceneCas {
 public:
  static constexpr std::string_view kColor = "color";
  static constexpr std::string_view kDepth = "depth";
  static constexpr std::string_view kSmoothedDepth = "smoothed_depth";
  static constexpr std::string_view kCloud = "cloud";
  static constexpr std::string_view kNormals = "normals";
  static constexpr std::string_view kMapDepth = "map_depth";   ///< CV_32F: what the map alone would measure
  static constexpr std::string_view kStructure = "structure";  ///< of KnownStructureFilter: kinds of pixels

  explicit SceneCas(cas::Cas& cas) : cas_(&cas) {}
  cas::Cas& cas() const { return *cas_; }

  bool has_scene() const;
  /// Throws Error when there is none.
  Scene scene() const;
  /// Makes and indexes the scene, which must not be there yet.
  Scene create_scene() const;

  /// Indexes a cluster and makes it part of the scene.
  void add_cluster(const Cluster& cluster) const;
  /// Those of the scene that are not hidden (`scene().clusters` has all), in their order.
  std::vector<Cluster> clusters() const;
  void add_support(const PlanarSupport& support) const;
  std::vector<PlanarSupport> supports() const;

  /// Images and clouds by view; reading one that was never set throws Error with the name of the view.
  void set_image(std::string_view view, const Mat& image) const;
  Mat image(std::string_view view) const;
  bool has(std::string_view view) const;
  void set_cloud(const PointCloud& cloud) const;
  PointCloud cloud() const;
  void set_normals(const NormalMap& normals) const;
  NormalMap normals() const;

  /// Cameras of the scene by name ("depth", "color"); setting one of the same name replaces it.
  void set_camera(const CameraInfo& camera) const;
  bool has_camera(std::string_view name) const;
  CameraInfo camera(std::string_view name) const;

  /// Appends a line to the scene's log. `milliseconds` < 0: not measured.
  void log(const std::string& annotator, const std::string& level, const std::string& text,
           double milliseconds = -1) const;

 private:
  void set_subject(std::string_view view, const cas::FeatureStructure& subject, const char* mime_type) const;
  cas::FeatureStructure subject(std::string_view view) const;

  cas::Cas* cas_;
};

}  // namespace loci::perception::types
