#include "mapping/registration/verdict.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace loci::mapping::registration {
namespace {

constexpr float kHorizontal = 0.8F;     ///< cosine
constexpr float kSurfaceOffset = 0.6F;  ///< of a cell: beyond it is another surface

struct Count {
  size_t asked = 0, matched = 0;
  size_t telling = 0, agreeing = 0, conflicting = 0;  ///< among surfaces that tell something about the pose
};

/// What `scan` says about the surfels of `other`.
Count compare(const PreparedScan& scan, const PreparedScan& other, const Isometry3d& scan_from_other,
              size_t level, bool planar, size_t samples) {
  const Surfels& known = scan.levels[level];
  const Surfels& asked = other.levels[level];
  const Eigen::Matrix3f turn = scan_from_other.linear().cast<float>();
  const Eigen::Vector3f shift = scan_from_other.translation().cast<float>();
  const auto cell = static_cast<float>(known.cell);
  const size_t step = samples > 0 ? std::max<size_t>(1, asked.size() / samples) : 1;
  Count count;
  for (size_t i = 0; i < asked.size(); i += step) {
    const Eigen::Vector3f point = turn * asked.position[i] + shift;
    const Eigen::Vector3f facing = turn * asked.normal[i];
    ++count.asked;
    const bool telling = asked.trust[i] > 0.F && !(planar && std::abs(asked.normal[i].z()) > kHorizontal);
    count.telling += telling ? 1 : 0;
    const uint32_t j = known.nearest(point, facing, 1.5F * cell);
    bool matched = j != CellGrid::kNone;
    if (matched && known.trust[j] > 0.F)
      matched = std::abs(known.normal[j].dot(point - known.position[j])) < kSurfaceOffset * cell;
    count.matched += matched ? 1 : 0;
    if (!telling) continue;
    if (matched)
      ++count.agreeing;
    else if (!known.near(point) && scan.free_space.passed(point, cell))
      ++count.conflicting;
  }
  return count;
}

double part(size_t some, size_t all) {
  return all > 0 ? static_cast<double>(some) / static_cast<double>(all) : 0;
}

}  // namespace

Agreement agreement(const PreparedScan& target, const PreparedScan& source,
                    const Isometry3d& target_from_source, size_t level, bool planar, size_t samples) {
  const Count forth = compare(target, source, target_from_source, level, planar, samples);
  const Count back = compare(source, target, target_from_source.inverse(), level, planar, samples);
  Agreement result;
  result.overlap = std::max(part(forth.matched, forth.asked), part(back.matched, back.asked));
  result.conflict = std::max(part(forth.conflicting, forth.agreeing + forth.conflicting),
                             part(back.conflicting, back.agreeing + back.conflicting));
  result.told = std::min(forth.agreeing + forth.conflicting, back.agreeing + back.conflicting);
  return result;
}

double degeneracy(const Matrix6d& hessian, const Vector3d& about, double lever, bool planar) {
  // The motion about `about` instead of the origin, turns in units of the lever.
  Matrix6d shifted = Matrix6d::Identity();
  shifted.topRightCorner<3, 3>() << 0, -about.z(), about.y(), about.z(), 0, -about.x(), -about.y(), about.x(),
      0;
  shifted.rightCols<3>() /= std::max(lever, 1e-6);
  const Matrix6d scaled = shifted.transpose() * hessian * shifted;
  Eigen::VectorXd values;
  if (planar) {
    const std::array<int, 3> free = {0, 1, 5};
    values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scaled(free, free)).eigenvalues();
  } else {
    values = Eigen::SelfAdjointEigenSolver<Matrix6d>(scaled).eigenvalues();
  }
  const double largest = values[values.size() - 1];
  return largest > 0 ? std::clamp(values[0] / largest, 0.0, 1.0) : 0;
}

Verdict judge(const PairAlignment& pair, const Agreement& agreement, double rival,
              const RegistrationOptions& options) {
  const auto refused = [](std::string why) { return Verdict{false, std::move(why)}; };
  if (pair.overlap < options.min_overlap)
    return refused(fmt::format("only {:.0f} % of the surface is in both scans", 100 * pair.overlap));
  if (pair.conflict > options.max_conflict)
    return refused(
        fmt::format("{:.0f} % of the points stand where the other scan saw free space", 100 * pair.conflict));
  // Six directions share what three have to themselves.
  if (pair.degeneracy < options.min_degeneracy * (options.dof == 3 ? 1.0 : 0.3))
    return refused("the surfaces in common do not hold the pose: it could slide or turn");
  if (pair.rmse_m > options.rmse_max_m)
    return refused(fmt::format("the surfaces fit only to {:.1f} cm", 100 * pair.rmse_m));
  if (rival > agreement.score() - options.rival_gap) return refused("another pose fits about as well");
  return {true, fmt::format("{:.0f} % overlap, {:.1f} mm rmse, {:.1f} % conflict", 100 * pair.overlap,
                            1000 * pair.rmse_m, 100 * pair.conflict)};
}

}  // namespace loci::mapping::registration
