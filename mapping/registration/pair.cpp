#include "mapping/registration/pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/registration/icp.h"
#include "mapping/registration/parameters.h"

namespace loci::mapping::registration {
namespace {

struct Count {
  size_t compared = 0, matched = 0;
  size_t agreeing = 0, conflicting = 0;  ///< among surfels that constrain the pose
};

/// Compares the surfels of `other` with `scan`.
Count compare(const PreparedScan& scan, const PreparedScan& other, const Isometry3d& scan_from_other,
              size_t level, bool planar, size_t samples) {
  const Surfels& known = scan.levels[level];
  const Surfels& tested = other.levels[level];
  const Eigen::Matrix3f turn = scan_from_other.linear().cast<float>();
  const Eigen::Vector3f shift = scan_from_other.translation().cast<float>();
  const auto cell = static_cast<float>(known.cell);
  const size_t step = samples > 0 ? std::max<size_t>(1, tested.size() / samples) : 1;
  Count count;
  for (size_t i = 0; i < tested.size(); i += step) {
    const Eigen::Vector3f point = turn * tested.position[i] + shift;
    const Eigen::Vector3f facing = turn * tested.normal[i];
    ++count.compared;
    const bool constrains =
        tested.weight[i] > 0.F && !(planar && std::abs(tested.normal[i].z()) > kPairs.horizontal_cosine);
    const uint32_t j = known.nearest(point, facing, 1.5F * cell);
    bool matched = j != CellGrid::kNone;
    if (matched && known.weight[j] > 0.F)
      matched = std::abs(known.normal[j].dot(point - known.position[j])) < kPairs.max_offset_cells * cell;
    count.matched += matched ? 1 : 0;
    if (!constrains) continue;
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
  result.overlap = std::max(part(forth.matched, forth.compared), part(back.matched, back.compared));
  result.conflict = std::max(part(forth.conflicting, forth.agreeing + forth.conflicting),
                             part(back.conflicting, back.agreeing + back.conflicting));
  return result;
}

double degeneracy(const Matrix6d& hessian, const Vector3d& about, double lever, bool planar) {
  // The motion about `about` instead of the origin, rotations in units of the lever.
  Matrix6d shifted = Matrix6d::Identity();
  shifted.topRightCorner<3, 3>() << 0, -about.z(), about.y(), about.z(), 0, -about.x(), -about.y(), about.x(),
      0;
  shifted.rightCols<3>() /= std::max(lever, 1e-6);
  const Matrix6d scaled = shifted.transpose() * hessian * shifted;
  Eigen::VectorXd values;
  if (planar) {
    const std::array<int, 3> free = {0, 1, 5};
    values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Matrix3d(scaled(free, free))).eigenvalues();
  } else {
    values = Eigen::SelfAdjointEigenSolver<Matrix6d>(scaled).eigenvalues();
  }
  const double largest = values[values.size() - 1];
  return largest > 0 ? std::clamp(values[0] / largest, 0.0, 1.0) : 0;
}

Verdict judge(const PairAlignment& pair, const Agreement& agreement, double second_score,
              const RegistrationOptions& options) {
  const auto refused = [](std::string why) { return Verdict{false, std::move(why)}; };
  if (pair.overlap < options.min_overlap)
    return refused(fmt::format("only {:.0f} % of the surface is in both scans", 100 * pair.overlap));
  if (pair.conflict > options.max_conflict)
    return refused(fmt::format("{:.0f} % of the points are in space that the other scan saw as free",
                               100 * pair.conflict));
  // Six directions are constrained less than three.
  if (pair.degeneracy < options.min_degeneracy * (options.dof == 3 ? 1.0 : 0.3))
    return refused("the common surfaces do not constrain the pose: it could slide or rotate");
  if (pair.rmse_m > options.max_rmse_m)
    return refused(fmt::format("the surfaces fit only to {:.1f} cm", 100 * pair.rmse_m));
  if (second_score > agreement.score() - options.ambiguity_margin)
    return {false, "another pose fits about as well", true};
  return {true, fmt::format("{:.0f} % overlap, {:.1f} mm rmse, {:.1f} % conflict", 100 * pair.overlap,
                            1000 * pair.rmse_m, 100 * pair.conflict)};
}

namespace {

struct Candidate {
  Isometry3d pose;
  double score = 0;
};

class PairAligner {
 public:
  PairAligner(const PreparedScan& target, const PreparedScan& source, const RegistrationOptions& options)
      : target_(target), source_(source), options_(options), planar_(options.dof == 3) {}

  PairAlignment run(const Isometry3d& guess, const SearchWindow& window) const {
    PairAlignment pair;
    pair.target_from_source = guess;
    if (target_.points == 0 || source_.points == 0) {
      pair.reason = "scan " + (target_.points == 0 ? target_.name : source_.name) + " has no points";
      return finished(pair);
    }
    const std::vector<Candidate> candidates = descend(guess, window);
    const IcpResult best = refine(candidates.front().pose);
    pair.target_from_source = best.target_from_source;
    const Agreement fits = agreement(target_, source_, best.target_from_source, 0, planar_, 0);
    pair.overlap = fits.overlap;
    pair.conflict = fits.conflict;
    pair.rmse_m = best.rmse;
    measure_information(best, pair);
    // Other candidates have scores of a coarser level: scores of one level are compared.
    double second_score = -1e9;
    if (candidates.size() > 1) second_score = fits.score() - candidates[0].score + candidates[1].score;
    const Verdict verdict = judge(pair, fits, second_score, options_);
    pair.trusted = verdict.trusted;
    pair.reason = verdict.reason;
    pair.ambiguous = verdict.ambiguous;
    if (pair.trusted && outside_window(guess, pair.target_from_source, window)) {
      pair.trusted = false;
      pair.reason = "fits, but far from the given pose of the scan";
    }
    return finished(pair);
  }

 private:
  /// Whether a pose left the window: repeated furniture fits elsewhere, too, where no other poses were
  /// searched. The search turns about the centre of the source, which may be far from its origin.
  bool outside_window(const Isometry3d& guess, const Isometry3d& found, const SearchWindow& window) const {
    const Vector3d centre = source_.centre.cast<double>();
    return (guess * centre - found * centre).norm() > window.position + kPairs.same_position_m ||
           Eigen::AngleAxisd(guess.linear().transpose() * found.linear()).angle() >
               window.angle + kPairs.same_angle;
  }

  IcpOptions level_options(size_t level) const {
    IcpOptions icp_options;
    icp_options.metric = options_.method == "point"   ? Metric::kPoint
                         : options_.method == "plane" ? Metric::kPlane
                                                      : Metric::kGeneralised;
    icp_options.planar = planar_;
    icp_options.radius = 1.5 * target_.levels[level].cell;
    icp_options.sigma = 0.5 * target_.levels[level].cell;
    icp_options.accuracy = 0.01 * target_.levels[level].cell;
    return icp_options;
  }

  double score_of(const Isometry3d& pose, size_t level) const {
    return agreement(target_, source_, pose, level, planar_, 1000).score();
  }

  bool same(const Isometry3d& a, const Isometry3d& b) const {
    const Vector3d centre = source_.centre.cast<double>();
    return (a * centre - b * centre).norm() < kPairs.same_position_m &&
           Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < kPairs.same_angle;
  }

  Candidate descended(const Isometry3d& start, size_t level) const {
    IcpOptions icp_options = level_options(level);
    icp_options.samples = level + 1 == target_.levels.size() ? kPairs.samples_coarse : kPairs.samples_middle;
    Candidate next;
    next.pose = icp(target_.levels[level], source_.levels[level], start, icp_options).target_from_source;
    next.score = score_of(next.pose, level);
    return next;
  }

  /// Different poses at the second finest level, from starts in the window, best first. The pose from the
  /// guess is computed first, as it limits the search.
  std::vector<Candidate> descend(const Isometry3d& guess, const SearchWindow& window) const {
    size_t level = target_.levels.size() - 1;
    std::vector<Candidate> candidates = {descended(guess, level)};
    if (window.position >= kPairs.same_position_m || window.angle >= kPairs.same_angle)
      for (const Isometry3d& start :
           promising_starts(target_, source_, guess, window, candidates.front().pose, planar_, kPairs.starts))
        candidates.push_back(descended(start, level));
    candidates = best_of(std::move(candidates));
    while (level-- > std::min<size_t>(1, target_.levels.size() - 1)) {
      for (Candidate& candidate : candidates) candidate = descended(candidate.pose, level);
      candidates = best_of(std::move(candidates));
    }
    return candidates;
  }

  /// The best different candidates, best first.
  std::vector<Candidate> best_of(std::vector<Candidate> candidates) const {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    std::vector<Candidate> best;
    for (const Candidate& candidate : candidates) {
      const bool known = std::any_of(
          best.begin(), best.end(), [&](const Candidate& other) { return same(other.pose, candidate.pose); });
      if (!known) best.push_back(candidate);
      if (best.size() == kPairs.candidates) break;
    }
    return best;
  }

  /// The finest level, repeated with a tolerance by its residuals. Where the surface is too sparse for fine
  /// cells, or scans are bent, the finest level may fit only a part of the surface: then the level above is
  /// better.
  IcpResult refine(const Isometry3d& pose) const {
    const size_t above = std::min<size_t>(1, target_.levels.size() - 1);
    IcpResult fine = refined(pose, 0);
    if (score_of(fine.target_from_source, above) > score_of(pose, above) - kPairs.max_loss) return fine;
    return refined(pose, above);
  }

  IcpResult refined(const Isometry3d& pose, size_t level) const {
    const Surfels &target = target_.levels[level], &source = source_.levels[level];
    IcpOptions icp_options = level_options(level);
    icp_options.samples = kPairs.samples_middle;
    IcpResult result = icp(target, source, pose, icp_options);
    icp_options.samples = 0;
    icp_options.sigma = std::clamp(3 * result.rmse, 3 * kPairs.min_sigma_m, icp_options.sigma);
    icp_options.accuracy = kPairs.accuracy;
    return icp(target, source, result.target_from_source, icp_options);
  }

  void measure_information(const IcpResult& best, PairAlignment& pair) const {
    const Vector3d centre = best.target_from_source * source_.centre.cast<double>();
    double squares = 0;
    for (const Eigen::Vector3f& position : source_.finest().position)
      squares += (position - source_.centre).squaredNorm();
    const double lever = std::sqrt(squares / (2 * static_cast<double>(source_.finest().size())));
    pair.degeneracy = registration::degeneracy(best.hessian, centre, lever, planar_);
    const double sigma = std::max(best.rmse, kPairs.min_sigma_m);
    const double strongest =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Matrix3d(best.hessian.topLeftCorner<3, 3>()))
            .eigenvalues()[2];
    const double fit = std::max(1.0, best.rmse / kPairs.good_rmse_m);
    const double systematic = kPairs.systematic_m * fit * fit;
    pair.information =
        best.hessian / std::max(kPairs.correlated * sigma * sigma, strongest * systematic * systematic);
    if (!planar_) return;
    for (const int held : {2, 3, 4}) {  // The pair does not constrain directions that were not free.
      pair.information.row(held).setZero();
      pair.information.col(held).setZero();
    }
  }

  /// From the upright frames into the scans' own.
  PairAlignment finished(PairAlignment pair) const {
    pair.target_from_source =
        target_.level_from_scan.inverse() * pair.target_from_source * source_.level_from_scan;
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = target_.level_from_scan.linear();
    pair.information = turn.transpose() * pair.information * turn;
    return pair;
  }

  const PreparedScan& target_;
  const PreparedScan& source_;
  const RegistrationOptions& options_;
  bool planar_;
};

}  // namespace

SearchWindow window_of(const RegistrationOptions& options) {
  return {2 * options.position_error_m, 2 * options.yaw_error_deg * kDegree};
}

PairAlignment align_pair(const PreparedScan& target, const PreparedScan& source,
                         const Isometry3d& target_from_source, const SearchWindow& window,
                         const RegistrationOptions& options) {
  const Isometry3d guess = target.level_from_scan * target_from_source * source.level_from_scan.inverse();
  return PairAligner(target, source, options).run(guess, window);
}

double expected_overlap(const PreparedScan& target, const PreparedScan& source,
                        const Isometry3d& target_from_source) {
  const Isometry3d pose = target.level_from_scan * target_from_source * source.level_from_scan.inverse();
  const Surfels& surfels = source.coarsest();
  size_t near = 0;
  for (const Eigen::Vector3f& position : surfels.position) {
    const Vector3d point = pose * position.cast<double>();
    near += target.dilated_grid.find(cell_of(point, surfels.cell)) != CellGrid::kNone ? 1 : 0;
  }
  return surfels.size() > 0 ? static_cast<double>(near) / static_cast<double>(surfels.size()) : 0;
}

}  // namespace loci::mapping::registration
