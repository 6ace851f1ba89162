#pragma once

#include <list>
#include <set>

#include "mapping/base/math/pose.h"
#include "perception/pipeline/annotator.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Collects the views of each object over time, and makes a CAS of the object alone (§2.1): annotators that
/// run on it see what no single image shows. Which clusters are the same object says a TrackingAnnotation,
/// or where they are.
///
/// `as: whole`: one cluster that holds the points of all views, in the camera of the newest, with its
/// image. `as: views`: one cluster per view, the newest first, each with its points, image and
/// annotations.
class ObjectViews : public CasMultiplier {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  std::vector<std::unique_ptr<cas::Cas>> split(cas::Cas& scene, Context& context) override;
  void join(size_t part, cas::Cas& done, cas::Cas& scene) override;

 private:
  /// What one frame showed of an object.
  struct View {
    Vector3d seen_from;                            ///< the camera, map
    std::vector<Eigen::Vector3f> points, normals;  ///< map
    std::unique_ptr<cas::Cas> cas;  ///< holds the cluster without what others made of the scene
    types::Cluster cluster;
  };
  struct Object {
    int64_t tracking_id = -1;
    Eigen::AlignedBox3d box;  ///< around all points, map
    std::list<View> views;    ///< the newest first
    int64_t seen = 0;         ///< scenes before
  };
  struct Part {
    types::Cluster original;
    types::Cluster cluster;  ///< that stands for it in the part
    size_t known = 0;
    int views = 0;
  };
  View view_of(const types::SceneCas& scene, const types::Cluster& cluster) const;
  Object& object_of(const types::Cluster& cluster, const View& view, std::set<const Object*>& taken);
  void add_view(Object& object, View view) const;
  static void add_points(const types::SceneCas& part, const types::Cluster& cluster,
                         const std::vector<int32_t>& indices, const Vector3d& centroid);
  std::unique_ptr<cas::Cas> make_part(const types::SceneCas& scene, const types::Cluster& original,
                                      const Object& object);

  std::string as_ = "whole";
  int last_ = 8;
  double apart_deg_ = 10;
  double place_m_ = 0.05;
  int max_points_ = 3000;
  int forget_ = 100;

  int64_t scene_ = 0;
  std::list<Object> objects_;
  std::vector<Part> parts_;
};

}  // namespace loci::perception
