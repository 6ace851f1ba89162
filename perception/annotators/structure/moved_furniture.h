#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perception/annotators/structure/furniture.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/annotators/structure/pose_refinement.h"
#include "perception/conversions/furniture_state.h"

namespace loci::perception {

/// One frame that furniture is compared with. Images of one size, camera frame.
struct FurnitureFrame {
  const cv::Mat& points;   ///< CV_32FC3, metres, NaN = none
  const cv::Mat& normals;  ///< CV_32FC3, unit
  const mapping::PinholeCamera& camera;
  const Isometry3d& map_from_camera;
  const JointState& joints;  ///< of the map's world
};

/// Finds out, frame by frame, which movable furniture of a map stands elsewhere. A piece whose surface the
/// camera looks through is searched for; where its surface is found by far better than where it was, it has
/// moved, and where most of it is looked through and it is nowhere in view, it is lost. What stands before a
/// piece says nothing, and a motion that an error of the camera's pose explains as well does not count.
/// Evidence adds up over the frames as log odds. While a piece is believed elsewhere, the world and the scene
/// of the map have it there.
class MovedFurniture {
 public:
  /// `map` must outlive it.
  MovedFurniture(KnownMap& map, const PoseRefinementOptions& pose_errors);

  /// Goes on from what an earlier run found out.
  void restore(const std::vector<FurnitureState>& states);
  /// Whether a frame changed where some piece is believed to stand. The same on any number of threads.
  bool update(const FurnitureFrame& frame, int threads);
  /// Puts all furniture back to where the map has it.
  void reset();

  const std::vector<Furniture>& pieces() const { return pieces_; }
  /// By piece.
  const std::vector<FurnitureState>& states() const { return states_; }
  /// From where the map has a piece to where it stands, or stood last while it is not found; map frame.
  Isometry3d motion(size_t piece) const;
  /// "table_1 is not where the map has it: …" for each piece that has moved.
  std::vector<std::string> texts() const;

 private:
  /// How a frame shows a piece at a pose: weights of samples.
  struct Fit {
    double found = 0;    ///< it is measured there
    double through = 0;  ///< what is behind it is measured
    double other = 0;    ///< something else is measured there, or what the map explains already
    int facing = 0;      ///< samples that look at the camera, in view or not

    double seen() const { return found + through + other; }
    double score() const { return found - through - other / 2; }
    double agreement() const { return found + through > 0 ? found / (found + through) : 0; }
  };
  struct Pose {
    Vector2d shift = Vector2d::Zero();
    double turn = 0;
  };
  struct Candidate {
    Pose pose;
    Fit fit;
    double rank = 0;
  };
  struct View;  ///< a frame with what the rest of the map looks like in it
  enum class Comparison { as_before, searched, changed };

  Pose pose_of(size_t piece) const { return {states_[piece].shift, states_[piece].turn}; }
  static Isometry3d motion_of(const Furniture& piece, const Pose& pose);
  /// With the first `samples`; with a `view` what the rest of the map explains is not found.
  Fit fit(const Furniture& piece, const Pose& pose, const FurnitureFrame& frame, const View* view,
          size_t samples) const;
  View view_without(size_t piece, const FurnitureFrame& frame, int threads);
  std::vector<Vector2d> middles(const Furniture& piece, const View& view) const;
  double rank(const Candidate& candidate) const;
  void refine(const Furniture& piece, const View& view, Candidate& candidate) const;
  /// The poses that fit a frame, best first.
  std::vector<Candidate> search(const Furniture& piece, const View& view, int threads) const;
  bool camera_may_be_wrong(const Isometry3d& now_from_before, const Vector3d& middle, const View& view,
                           int threads) const;
  bool is_looked_through(size_t piece, const FurnitureFrame& frame);
  /// Adds evidence that a piece has left where it is believed to stand.
  bool is_decided(size_t piece, double evidence);
  Comparison settle(size_t piece, bool found, const Pose& pose);
  /// After `searched` and `changed` world and scene have to be rebuilt.
  Comparison compare(size_t piece, const FurnitureFrame& frame, int threads);
  void place(std::optional<size_t> hidden, const JointState& joints);

  KnownMap& map_;
  mapping::World world_;  ///< as the map has it
  PoseRefinementOptions pose_errors_;
  std::vector<Furniture> pieces_;
  std::vector<FurnitureState> states_;
};

}  // namespace loci::perception
