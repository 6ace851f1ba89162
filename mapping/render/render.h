#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/sensor/camera.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh.h"

namespace loci::mapping {

/// What a camera would see of a world, per pixel.
struct RenderedView {
  cv::Mat depth;  ///< CV_32F, z-depth in metres, NaN = nothing
  cv::Mat link;   ///< CV_32S, index into RenderScene::link_names(), -1 = nothing
  cv::Mat
      normal;  ///< CV_32FC3, unit, camera frame, towards the camera; zero = nothing. Empty unless asked for
  cv::Mat color;  ///< CV_8UC3, BGR, unshaded material colour. Empty unless asked for
};

struct RenderOptions {
  double near_m = 0.05;
  double far_m = 100;
  bool normals = false;
  bool colors = false;
  bool occlusion_culling = true;  ///< passes over what is hidden; the view is the same without, only later
};

/// Worlds as triangles, ready to be drawn by a z-buffer rasteriser that passes over what is hidden: instances
/// and clusters of triangles go nearest first, each compared with the farthest pixels of the tiles that it
/// can touch (a hierarchical z-buffer, Greene et al. 1993). Several worlds (a map and robots) share
/// one scene; a joint state can be changed without loading anything again. Only visual geometry is seen.
class RenderScene {
 public:
  RenderScene();
  ~RenderScene();
  RenderScene(RenderScene&&) noexcept;
  RenderScene& operator=(RenderScene&&) noexcept;

  /// Adds a world with its root at `map_from_root`; returns its number. A visual's URDF colour goes before
  /// the colours of its mesh. Missing meshes are warned about by name.
  size_t add(const World& world, const MeshSearch& search, const Isometry3d& map_from_root,
             Warnings& warnings);

  /// Adds free triangles (an object, a floor) under a name that takes a link id of its own; returns the
  /// number.
  size_t add(const std::string& name, const TriangleMesh& mesh, const Isometry3d& map_from_mesh);

  /// Adds a part once more, elsewhere, with joints of its own (all at 0); returns the number. Triangles are
  /// shared: thousands of copies cost little memory.
  size_t add_copy(size_t part, const Isometry3d& map_from_part);

  /// Moves the joints of a world (all joints, those not named to 0), or all of a part to another pose.
  void set_joints(size_t part, const JointState& state);
  void set_pose(size_t part, const Isometry3d& map_from_part);
  /// Gives a part the joints of a world of the same links, whose furniture stands elsewhere; all at 0.
  void set_world(size_t part, const World& world);
  void set_visible(size_t part, bool visible);

  /// Names by link id, over all parts in the order in which they were added; "WORLD/LINK" only where names
  /// repeat, "WORLD#PART/LINK" where those repeat, too.
  const std::vector<std::string>& link_names() const;
  /// Where a link (by id) is in the map frame.
  Isometry3d map_from_link(size_t link) const;

  /// Draws what the camera at `map_from_camera` sees. Same result on any number of threads (0 = all cores).
  RenderedView render(const PinholeCamera& camera, const Isometry3d& map_from_camera,
                      const RenderOptions& options = {}, int threads = 1) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::mapping
