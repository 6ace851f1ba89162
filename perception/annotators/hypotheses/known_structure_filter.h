#pragma once

#include <memory>

#include "perception/annotators/hypotheses/articulated_fronts.h"
#include "perception/annotators/hypotheses/known_structure.h"
#include "perception/annotators/hypotheses/pose_refinement.h"
#include "perception/pipeline/annotator.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Takes what the map and the robots explain out of the cloud and names the regions of interest
/// (URDFRegionFilter, §4.2.2): fits the pose of the camera to the map, then the fronts of drawers and doors
/// whose joints nobody reports, then compares. Uses the KnownMap among the resources; without one it removes
/// nothing.
class KnownStructureFilter : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  Isometry3d refined_pose(const types::SceneCas& scene, const cv::Mat& points,
                          const mapping::PinholeCamera& camera, Context& context);
  void fit_joints(const types::SceneCas& scene, const cv::Mat& points, const mapping::PinholeCamera& camera,
                  const Isometry3d& pose, int threads, JointState& joints);
  void remove_robots(const types::SceneCas& scene, const mapping::PinholeCamera& camera, Context& context);
  void tell_obstacles(const types::SceneCas& scene, const cv::Mat& points,
                      const mapping::PinholeCamera& camera, const Isometry3d& pose, const JointState& joints,
                      const cv::Mat& map_depth);

  KnownStructureOptions options_;
  PoseRefinementOptions refinement_;
  bool fit_joints_ = true;
  std::string camera_link_;
  KnownMap* map_ = nullptr;
  std::vector<SupportSurface> surfaces_;
  std::unique_ptr<ArticulatedFronts> fronts_;
};

}  // namespace loci::perception
