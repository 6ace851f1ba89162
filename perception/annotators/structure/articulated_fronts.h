#pragma once

#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh.h"
#include "perception/annotators/structure/surface_samples.h"

namespace loci::perception {

/// Whether nothing of a ball (camera frame, metres) can fall into a pixel: it lies behind the camera or
/// outside one of the planes through its centre and an edge of the image (a pixel more on every side).
inline bool out_of_view(const Vector3d& middle, double radius, const mapping::PinholeCamera& camera) {
  const auto outside = [&](double x, double y, double z) {
    return x * middle.x() + y * middle.y() + z * middle.z() < -1.001 * radius * std::hypot(x, y, z) - 1e-6;
  };
  return outside(0, 0, 1) || outside(camera.fx, 0, camera.cx + 1) || outside(0, camera.fy, camera.cy + 1) ||
         outside(-camera.fx, 0, camera.width - camera.cx) ||
         outside(0, -camera.fy, camera.height - camera.cy);
}

/// Metres that the farthest point of a front moves: less may be the map's or the pose's error.
inline constexpr double kMinFrontMotion = 0.03;

/// How a front (of a drawer or a door) stands in one depth image.
struct FrontState {
  std::string joint;
  double reach = 1;         ///< metres that its farthest point moves per metre or radian
  double given = 0;         ///< position that was assumed, metres or radians
  double position = 0;      ///< as the image shows it; the given one where it does not
  bool determined = false;  ///< the image shows it there, or elsewhere beyond the errors of depth and map
  bool moved = false;       ///< the image shows it elsewhere than given
  int in_view = 0;          ///< points of the front that face the camera and have a depth in their pixel
  int on = 0;               ///< of these, where the depth is the front's
};

/// Something that stands before a front.
struct Obstacle {
  std::string joint;
  double distance_m = 0;  ///< before the front, the nearest part of it
  double share = 0;       ///< of the front that it hides
};

/// The fronts of a world's drawers and doors as points, to be compared with depth images.
class ArticulatedFronts {
 public:
  /// Joints with limits that slide or turn, and the surfaces of the links that they carry.
  ArticulatedFronts(const mapping::World& world, const mapping::MeshSearch& meshes);

  /// Fits each joint by its front: of all positions within its limits, the one at which most of the front
  /// lies on the depth and least of it where the camera looked through. What hides a front says nothing. Off
  /// the given position by more than noise but less than a depth camera distorts, it is not determined.
  /// `points`: CV_32FC3, camera frame, NaN = none. The same on any number of threads.
  std::vector<FrontState> estimate(const cv::Mat& points, const mapping::PinholeCamera& camera,
                                   const Isometry3d& map_from_camera, const JointState& joints,
                                   int threads = 1) const;

  /// What is seen before fronts, within reach of those who would open them, and is no known structure
  /// (`unknown`: CV_8U, not 0 at pixels of points that the map does not explain).
  std::vector<Obstacle> obstacles(const cv::Mat& points, const cv::Mat& unknown,
                                  const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                                  const JointState& joints) const;

 private:
  struct Front {
    mapping::Joint joint;
    size_t link = 0;                     ///< index into the world's links
    std::vector<SurfaceSample> samples;  ///< frame of the link
    Vector3d middle = Vector3d::Zero();  ///< of a ball around the samples, in the link's frame
    double radius = 0;
    double reach = 0;  ///< of the farthest sample, metres from the joint's axis
  };
  struct Match;

  /// With `best` counting ends, with nothing, as soon as the match can no more be a sure one that is better.
  Match match(const Front& front, const Isometry3d& camera_from_link, const cv::Mat& points,
              const mapping::PinholeCamera& camera, const Match* best) const;

  mapping::World world_;
  std::vector<Front> fronts_;
};

/// Where fronts stand over the frames of a recording. In a video a front has to be seen elsewhere for a while
/// before it is believed there; frames that lie apart count at once.
class FrontTracks {
 public:
  /// Replaces what a frame shows by what is believed; not determined while a motion is not confirmed.
  void settle(FrontState& state, TimeNs time, bool in_video);

 private:
  struct Sighting {
    double position = 0;
    TimeNs since = 0;
  };
  struct Track {
    double position = 0;              ///< believed
    std::optional<Sighting> pending;  ///< elsewhere
  };
  std::map<std::string, Track> tracks_;  ///< by joint
};

}  // namespace loci::perception
