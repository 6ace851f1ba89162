#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/render/render.h"
#include "mapping/simulation/play.h"

namespace loci::mapping {

/// What one object takes up in one depth image.
struct SeenObject {
  int pixels = 0;
  int unhidden_pixels = 0;    ///< if nothing else stood in the way
  int box[4] = {0, 0, 0, 0};  ///< first column, first row, last column, last row
};

/// A world with its objects, set up for the renderer.
class Studio {
 public:
  Studio(const Scenario& scenario, const World& world, const MeshSearch& search, const ScenarioPlay& play,
         Warnings& warnings);

  /// Moves everything to where it is in a state.
  void arrange(const WorldState& state);

  /// Depth and normals without noise.
  RenderedView depth_view(const PinholeCamera& camera, const Isometry3d& map_from_camera, int threads) const;

  /// A lit image, smoothed at edges.
  cv::Mat color_image(const PinholeCamera& camera, const Isometry3d& map_from_camera, int threads) const;

  /// Counts the objects' pixels in a view that depth_view() made.
  std::map<std::string, SeenObject> seen_objects(const RenderedView& view, const PinholeCamera& camera,
                                                 const Isometry3d& map_from_camera, int threads);

 private:
  struct Part {
    size_t number = 0;  ///< in the scene
    int link = 0;       ///< id in images
  };
  const Part& part_for(const std::string& name, const ObjectState& object);

  const Scenario& scenario_;
  const ScenarioPlay& play_;
  RenderScene scene_;
  std::vector<size_t> background_;       ///< parts that are no objects
  std::map<std::string, Part> parts_;    ///< by object and its colours
  std::map<std::string, Part> visible_;  ///< by object, as arranged
};

}  // namespace loci::mapping
