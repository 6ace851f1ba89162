#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/sensor/pixel_kind.h"
#include "perception/annotators/structure/articulated_fronts.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/annotators/structure/moved_furniture.h"
#include "perception/annotators/structure/pose_refinement.h"
#include "perception/pipeline/annotator.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// How points are taken for known structure (§4.2.2).
struct KnownStructureOptions {
  std::vector<std::string> regions = {"counter*", "table*",  "island*", "shelf*",
                                      "desk*",    "*_shelf", "*_top",   "*drawer*bottom"};
  double epsilon_m = 0.02;
  double region_height_m = 1.0;
  double support_tolerance_m = 0.035;
  double margin_m = 0.03;

  void declare(OptionTable& table);
};

/// A region of interest in one frame: the box above a surface.
struct Region {
  const SupportSurface* surface = nullptr;
  Isometry3d map_from_top = Isometry3d::Identity();  ///< with the joints of the frame
  int pixels = 0;                                    ///< that fell into it
  double height_m = 0;                               ///< of the space that holds what is there, metres
};

/// View of the scene with the kind of each pixel: CV_8U, mapping::PixelKind.
inline constexpr std::string_view kStructureView = types::SceneCas::kStructure;

struct KnownStructure {
  cv::Mat region;     ///< CV_16U: 1 + index into regions; 0 = known structure, or in no region
  cv::Mat map_depth;  ///< CV_32F: what the map alone would measure, NaN = nothing
  cv::Mat bare;       ///< CV_8U: 255 = the map alone would show a surface for objects here, or nothing
  cv::Mat kind;       ///< CV_8U: mapping::PixelKind
  std::vector<Region> regions;
  int known = 0;    ///< pixels removed because a known surface explains them
  int outside = 0;  ///< pixels in no region
};

/// Compares a depth image with what the map, its joints as they are now, would look like from
/// `map_from_camera`. A point is known structure when d_model − z ≤ ε (one-sided: what lies behind a known
/// surface goes too; ε grows with the noise of the depth). The tops of the surfaces themselves stay: within
/// the tolerance around a surface's height a point belongs to its region, so that neither flat objects nor a
/// map that is some centimetres off cost anything. `points` and `normals`: CV_32FC3, camera frame. With
/// normals, what continues a known surface and faces as it does is known structure up to a larger distance,
/// which covers the distortion of depth cameras; an empty Mat = single pixels only.
KnownStructure find_known_structure(const cv::Mat& points, const cv::Mat& normals,
                                    const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                                    KnownMap& map, const std::vector<SupportSurface>& surfaces,
                                    const JointState& joints, const KnownStructureOptions& options,
                                    int threads);

/// Takes what the map and the robots explain out of the cloud and names the regions of interest
/// (URDFRegionFilter, §4.2.2): fits the pose of the camera to the map, then the fronts of drawers and doors
/// whose joints nobody reports, then compares. Furniture that is not where the map has it is looked for, and
/// the map is used with it where it stands until finish(). Uses the KnownMap among the resources; without one
/// it removes nothing.
class KnownStructureFilter : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;
  void finish(Context& context) override;

 private:
  Isometry3d refined_pose(const types::SceneCas& scene, const cv::Mat& points,
                          const mapping::PinholeCamera& camera, Context& context);
  void find_furniture(const types::SceneCas& scene, const FurnitureFrame& frame, int threads);
  /// Regions of furniture that is known to be somewhere.
  std::vector<SupportSurface> standing_surfaces() const;
  void fit_joints(const types::SceneCas& scene, const cv::Mat& points, const mapping::PinholeCamera& camera,
                  const Isometry3d& pose, const Context& context, JointState& joints);
  void remove_robots(const types::SceneCas& scene, const mapping::PinholeCamera& camera, Context& context);
  void annotate_obstacles(const types::SceneCas& scene, const cv::Mat& points,
                          const mapping::PinholeCamera& camera, const Isometry3d& pose,
                          const JointState& joints, const cv::Mat& map_depth);

  KnownStructureOptions options_;
  PoseRefinementOptions refinement_;
  bool fit_joints_ = true;
  bool find_furniture_ = true;
  std::string camera_link_;
  KnownMap* map_ = nullptr;
  std::vector<SupportSurface> surfaces_;
  std::unique_ptr<ArticulatedFronts> fronts_;
  std::unique_ptr<MovedFurniture> furniture_;
  FrontTracks tracks_;
  std::optional<TimeNs> last_fitted_;  ///< time of the last frame whose fronts were fitted
};

}  // namespace loci::perception
