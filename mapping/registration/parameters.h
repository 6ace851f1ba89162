#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "mapping/base/math/math.h"

namespace loci::mapping::registration {

/// How far the true pose may be from the guess, at most.
struct SearchWindow {
  double position = 0;  ///< metres
  double angle = 0;     ///< radians
};

/// Planes in cells, and how much each counts.
struct SurfelParameters {
  double max_thickness_ratio = 0.3;  ///< thickness over smaller extent (variances): no plane beyond
  double grazing_cosine = 0.25;      ///< of incidence, at which the weight is 0 …
  double steep_cosine = 0.45;        ///< … and full
  double beam_rad = 0.0035;          ///< 0.2 degrees is usual for laser scanners
  double shallow_spot_m = 0.025;     ///< depth of a beam's spot on a slanted surface with full weight …
  double deep_spot_m = 0.05;         ///< … and none: scanners report its near end
  double min_plane_points = 5;       ///< fewer points fit any plane
  double min_own_points = 12;        ///< cells with fewer are fitted with their neighbours
  float same_side_cosine = 0.5F;     ///< normals agree within 60 degrees
  int64_t max_blocks = int64_t{1} << 22;  ///< of a grid's directory: 16 MB
  double coarsest_cell_m = 0.16;          ///< so wide at least: steps of the search
  double max_hidden = 0.25;               ///< of a scan that was taken from its origins
  size_t max_images = 32;                 ///< of ranges per scan: memory
  float range_margin = 0.02F;             ///< of the range: noise, and the shift by a small rotation
  int image_side = 64;                    ///< pixels of a cube's face: 1.4 degrees each in the middle
};
inline constexpr SurfelParameters kSurfels;

/// The search for starting poses.
struct SearchParameters {
  double shift_step_m = 0.2;              ///< that the descent from there bridges
  double turn_step_planar = 5 * kDegree;  ///< radians, that the descent bridges
  double turn_step = 12 * kDegree;        ///< radians, in six dimensions
  size_t samples_planar = 400;            ///< surfels that are compared per start
  size_t samples = 160;                   ///< in six dimensions
  /// {samples, share}: a start with less of the best score after so many samples is dropped.
  std::array<std::pair<size_t, float>, 3> early_exits = {{{8, 0.15F}, {16, 0.35F}, {40, 0.5F}}};
  float min_score = 0.5F;         ///< of the best score, of a start
  float max_plane_m = 0.15F;      ///< from its plane, of a sample that counts
  float same_side_cosine = 0.7F;  ///< normals agree within 45 degrees
  size_t interleave = 37;         ///< any prefix of the samples covers all directions
};
inline constexpr SearchParameters kSearch;

/// The alignment of two scans.
struct PairParameters {
  size_t starts = 6;                ///< that are refined
  size_t candidates = 3;            ///< that differ and are carried to the next level
  size_t samples_coarse = 1500;     ///< surfels on the coarsest level
  size_t samples_middle = 3000;     ///< surfels on the levels between
  double same_match_cells = 0.05;   ///< matches are searched again after so much motion
  double same_position_m = 0.1;     ///< poses that are nearer to one another are the same …
  double same_angle = 3 * kDegree;  ///< … and less turned, radians
  double correlated = 10;       ///< errors of neighbouring surfels (calibration, beams): so many count as one
  double accuracy = 5e-5;       ///< of the last iteration, metres and radians
  double max_loss = 0.03;       ///< part of the surface that a finer level may lose
  double min_sigma_m = 0.002;   ///< no surfel is known better
  double systematic_m = 0.001;  ///< of the best constrained direction: mixed returns, wide beams
  double good_rmse_m = 0.0015;  ///< beyond it the systematic error grows with the square of the fit
  double thickness = 1e-2;      ///< of a surfel across over along (generalised ICP, Segal et al. 2009)
  float horizontal_cosine = 0.8F;  ///< floors always agree in planar registration
  float max_offset_cells = 0.6F;   ///< beyond it is another surface
};
inline constexpr PairParameters kPairs;

/// Which pairs are tried, and the pose graph.
struct GraphParameters {
  double promising = 0.5;           ///< of the minimum overlap, expected at the guess
  size_t max_searches = 6;          ///< per scan, before it counts as unconnected
  SearchWindow refine{0.05, 0.02};  ///< metres, radians: left to find when both scans are connected
  double between_parts = 1.5;       ///< times the window: both parts of the graph are placed by odometry
  SearchWindow best_odometry{0.005, 0.002};  ///< metres, radians: no odometry is better
  double contradiction_sigmas = 12;          ///< an edge that is farther off contradicts the others
};
inline constexpr GraphParameters kGraph;

}  // namespace loci::mapping::registration
