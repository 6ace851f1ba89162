#pragma once

#include "memory/belief/scene.h"

namespace loci::memory::belief {

/// How two textures fit on each other as rigid surfaces.
struct TextureMatch {
  /// Key points at different spots of the surface that one rigid motion carries from one to the other.
  int agreeing = 0;
  double offset_m = 0;  ///< root mean square distance between the two positions of these; 0 without any
};

/// The rigid motion that most key points with like descriptors agree with, and how many those are. The same
/// for the same textures. `tolerance_m`: of a position.
TextureMatch match_textures(const Texture& a, const Texture& b, double tolerance_m);

/// Error of the distance between two key points when each is measured from up to this range, metres.
double texture_tolerance(double range_m);

/// Log-likelihood ratio "same object" against "unrelated objects". That nothing agrees says little: it may be
/// another side. 0 where either shows too few key points to tell.
inline constexpr double kMaxTextureLogRatio = 6.5;
double texture_log_ratio(const TextureMatch& match, const Texture& a, const Texture& b);

/// Whether two views of one side show different prints: both have so many key points that some would agree.
bool is_another_print(const TextureMatch& match, const Texture& a, const Texture& b);

/// Direction from an observation to the camera, map frame.
Vector3d towards_camera(const Observation& observation, const Scene& scene);
/// Whether an object that did not move shows the same side in these directions.
bool is_same_side(const Vector3d& one, const Vector3d& other);

/// From so many agreeing key points on a match tells how far the surface moved.
inline constexpr int kTellingKeypoints = 6;

}  // namespace loci::memory::belief
