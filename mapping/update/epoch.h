#pragma once

#include <string>
#include <vector>

#include "mapping/registration/prepared_scan.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

/// How one epoch saw a piece of the other's surface.
enum class SurfaceState {
  same,    ///< the surface is there
  other,   ///< another surface is near
  free,    ///< rays passed through
  unknown  ///< hidden or out of view
};

/// All scans of one visit as one surface and its rays, in the map frame.
class Epoch {
 public:
  Epoch(const ScanSet& scans, double cell_m, int threads);

  /// Removes points through which other rays passed, and single ones: beams that met two surfaces.
  void drop_flying_points(int threads);

  const registration::PreparedScan& prepared() const { return prepared_; }
  /// Surfels of the finest cells: positions, normals towards the sensor.
  const registration::Surfels& surface() const { return prepared_.finest(); }
  SurfaceState state_of(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const;
  /// Whether rays passed a surfel; a zero normal is none.
  bool passed(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const;
  /// Whether the rays of one scan passed a position.
  bool passed(size_t scan, const Eigen::Vector3f& position) const;
  const std::vector<std::string>& scan_names() const { return names_; }

  /// The measured points of some surfels as one scan in the map frame.
  Scan part(const std::vector<uint8_t>& chosen) const;
  /// The same, prepared for registration with cells of `cell_m`.
  registration::PreparedScan prepared_part(const std::vector<uint8_t>& chosen, double cell_m) const;
  /// How many points of each scan lie on the chosen surfels.
  std::vector<size_t> points_by_scan(const std::vector<uint8_t>& chosen) const;

 private:
  void number_points(double cell_m, int threads);

  Scan cloud_;                                 ///< returned points of all scans, map frame
  std::vector<uint32_t> surfel_;               ///< of each point of the cloud
  std::vector<uint16_t> scan_;                 ///< of each point of the cloud
  std::vector<std::string> names_;             ///< of the scans
  std::vector<registration::FreeSpace> rays_;  ///< one per scan
  registration::PreparedScan prepared_;
};

/// The options with which epochs and pieces are registered.
RegistrationOptions epoch_options(double cell_m);

/// Surfel of `surface` that a surfel elsewhere shows again; CellGrid::kNone if there is none.
uint32_t same_surfel(const registration::Surfels& surface, const Eigen::Vector3f& position,
                     const Eigen::Vector3f& normal);

}  // namespace loci::mapping
