#pragma once

#include <optional>
#include <vector>

#include "mapping/registration/prepared_scan.h"
#include "mapping/update/epoch.h"
#include "mapping/update/pieces.h"

namespace loci::mapping {

/// The probability of a change for which so many surfels speak, less those against it.
double change_probability(double surfels);

/// How a piece's surfels are seen in the other epoch at some pose.
struct PieceFit {
  size_t same = 0, other = 0, free = 0, unknown = 0;
  size_t foreign = 0;  ///< surfels beside it that are not its own, in space that was free around it

  double score() const {
    return static_cast<double>(same) - static_cast<double>(free) - static_cast<double>(other) / 2;
  }
  size_t all() const { return same + other + free + unknown; }
  size_t contradictions() const { return other + free + foreign; }
  /// Found over found and contradicted; 0 where neither.
  double agreement() const;
};

/// A pose of a piece in the other epoch.
struct PieceMotion {
  Isometry3d now_from_before = Isometry3d::Identity();  ///< x, y and yaw, map frame
  PieceFit fit;
  double gain = 0;     ///< score above that of the old place, surfels
  size_t arrived = 0;  ///< surfels found there in space that was free before
  bool jump = false;   ///< farther, or turned more, than the search around the old place reaches
  double rank = 0;  ///< gain less foreign surface and the cost of the motion: of similar poses the nearer one
};

/// A piece as it was seen before, to be searched in what is seen now.
class PieceSearch {
 public:
  PieceSearch(const Epoch& before, const Epoch& now, const Piece& piece);

  /// At its old place, with the surfels of `target` (those that may show it) counted as found.
  PieceFit fit(const registration::Surfels& target, const Isometry3d& now_from_before) const;
  /// The best pose: near the old place and at each of `components` (boxes of surface that is not explained).
  std::optional<PieceMotion> find(const registration::PreparedScan& target,
                                  const std::vector<Eigen::AlignedBox3f>& components) const;
  /// Aligns a pose that was found with the chosen surfels of the epoch on cells of half the size, which keep
  /// the two faces of a board apart.
  void refine(const std::vector<uint8_t>& chosen, PieceMotion& motion) const;
  /// Surfels of the target beside the piece at a pose that are not its surface, where space around the piece
  /// was free.
  size_t foreign(const registration::Surfels& target, const Isometry3d& now_from_before) const;

 private:
  /// Surfels of the piece that the target shows at a pose, in space that was free before.
  size_t arrived(const registration::Surfels& target, const Isometry3d& now_from_before) const;
  struct Start {
    Isometry3d pose;
    double score = 0;
  };
  void search(const registration::Surfels& target, const Vector2d& middle, double reach, double turn,
              std::vector<Start>& starts) const;
  double coarse_score(const registration::Surfels& target, const Isometry3d& pose) const;
  /// Whether a position in the piece's own frame is in the piece or beside it.
  bool beside(const Eigen::Vector3f& position) const;
  Isometry3d refined(const registration::PreparedScan& target, const Isometry3d& pose) const;
  Isometry3d pose_of(const Vector2d& middle, double yaw) const;

  const Epoch &before_, &now_;
  const Piece& piece_;
  std::vector<uint8_t> chosen_;  ///< surfels of the piece
  registration::PreparedScan source_;
  std::vector<uint32_t> samples_;  ///< of the second level
  Vector2d middle_;                ///< centre of rotation
};

}  // namespace loci::mapping
