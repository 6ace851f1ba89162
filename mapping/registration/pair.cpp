#include "mapping/registration/pair.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "mapping/base/cell_index.h"
#include "mapping/base/math.h"
#include "mapping/registration/icp.h"
#include "mapping/registration/verdict.h"

namespace loci::mapping::registration {
namespace {

constexpr size_t kStarts = 6;
constexpr size_t kCandidates = 3;
constexpr size_t kSamplesCoarse = 1500;
constexpr size_t kSamplesMiddle = 3000;
/// Poses that are nearer to one another than this are the same one.
constexpr double kSamePosition = 0.1;
constexpr double kSameAngle = 3 * kPi / 180;
/// Residuals of neighbouring surfels err alike (calibration, wide beams): so many count as one.
constexpr double kCorrelated = 10;
constexpr double kAccuracy = 5e-5;   ///< of the last iteration, metres and radians
constexpr double kLetGo = 0.03;      ///< part of the surface that a finer level may lose
constexpr double kSigmaMin = 0.002;  ///< metres: no surfel is known better
/// Metres. However many surfels agree, the direction that is held best is not known better than this, and the
/// less the worse they fit: what is left over is mixed returns at edges and wide beams, which err to one
/// side. Directions that are held less are so by the ratio of the Hessian.
constexpr double kSystematic = 0.001;
constexpr double kGoodFit = 0.0015;  ///< rmse, metres

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
      pair.reason = fmt_empty();
      return finished(pair);
    }
    const std::vector<Candidate> candidates = descend(guess, window);
    const IcpResult best = polish(candidates.front().pose);
    pair.target_from_source = best.target_from_source;
    const Agreement fits = agreement(target_, source_, best.target_from_source, 0, planar_, 0);
    pair.overlap = fits.overlap;
    pair.conflict = fits.conflict;
    pair.rmse_m = best.rmse;
    measure_hold(best, pair);
    // The scores of rivals are of a coarser level: compared are those of one level.
    double rival = -1e9;
    if (candidates.size() > 1) rival = fits.score() - candidates[0].score + candidates[1].score;
    const Verdict verdict = judge(pair, fits, rival, options_);
    pair.trusted = verdict.trusted;
    pair.reason = verdict.reason;
    if (pair.trusted && astray(guess, pair.target_from_source, window)) {
      pair.trusted = false;
      pair.reason = "fits, but far from where the scan was said to be";
    }
    return finished(pair);
  }

 private:
  std::string fmt_empty() const {
    return "scan " + (target_.points == 0 ? target_.name : source_.name) + " has no points";
  }

  /// Whether a pose left the window: repeated furniture fits elsewhere, too, and no rivals were sought there.
  static bool astray(const Isometry3d& guess, const Isometry3d& found, const SearchWindow& window) {
    return (guess.translation() - found.translation()).norm() > window.position + kSamePosition ||
           Eigen::AngleAxisd(guess.linear().transpose() * found.linear()).angle() > window.angle + kSameAngle;
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
    return (a * centre - b * centre).norm() < kSamePosition &&
           Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < kSameAngle;
  }

  Candidate descended(const Isometry3d& start, size_t level) const {
    IcpOptions icp_options = level_options(level);
    icp_options.samples = level + 1 == target_.levels.size() ? kSamplesCoarse : kSamplesMiddle;
    Candidate next;
    next.pose = icp(target_.levels[level], source_.levels[level], start, icp_options).target_from_source;
    next.score = score_of(next.pose, level);
    return next;
  }

  /// Different poses that starts in the window lead to on the way down to the second finest level, best
  /// first. The guess goes ahead: what it leads to tells the search what to look for.
  std::vector<Candidate> descend(const Isometry3d& guess, const SearchWindow& window) const {
    size_t level = target_.levels.size() - 1;
    std::vector<Candidate> candidates = {descended(guess, level)};
    if (window.position >= kSamePosition || window.angle >= kSameAngle)
      for (const Isometry3d& start :
           promising_starts(target_, source_, guess, window, candidates.front().pose, planar_, kStarts))
        candidates.push_back(descended(start, level));
    candidates = best_of(std::move(candidates));
    while (level-- > std::min<size_t>(1, target_.levels.size() - 1)) {
      for (Candidate& candidate : candidates) candidate = descended(candidate.pose, level);
      candidates = best_of(std::move(candidates));
    }
    return candidates;
  }

  /// The best three that differ, best first.
  std::vector<Candidate> best_of(std::vector<Candidate> candidates) const {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    std::vector<Candidate> best;
    for (const Candidate& candidate : candidates) {
      const bool known = std::any_of(
          best.begin(), best.end(), [&](const Candidate& other) { return same(other.pose, candidate.pose); });
      if (!known) best.push_back(candidate);
      if (best.size() == kCandidates) break;
    }
    return best;
  }

  /// The finest level, then once more with the tolerance that its residuals ask for. Where the surface is
  /// seen too sparsely for fine cells, or scans are bent, the finest level may hold on to a part of the
  /// surface and let go of the rest: then the level above says better where the scan is.
  IcpResult polish(const Isometry3d& pose) const {
    const size_t above = std::min<size_t>(1, target_.levels.size() - 1);
    const IcpResult fine = polished(pose, 0);
    if (score_of(fine.target_from_source, above) > score_of(pose, above) - kLetGo) return fine;
    return polished(pose, above);
  }

  IcpResult polished(const Isometry3d& pose, size_t level) const {
    const Surfels &target = target_.levels[level], &source = source_.levels[level];
    IcpOptions icp_options = level_options(level);
    icp_options.samples = kSamplesMiddle;
    IcpResult result = icp(target, source, pose, icp_options);
    icp_options.samples = 0;
    icp_options.sigma = std::clamp(3 * result.rmse, 3 * kSigmaMin, icp_options.sigma);
    icp_options.accuracy = kAccuracy;
    return icp(target, source, result.target_from_source, icp_options);
  }

  void measure_hold(const IcpResult& best, PairAlignment& pair) const {
    const Vector3d centre = best.target_from_source * source_.centre.cast<double>();
    double squares = 0;
    for (const Eigen::Vector3f& position : source_.finest().position)
      squares += (position - source_.centre).squaredNorm();
    const double lever = std::sqrt(squares / (2 * static_cast<double>(source_.finest().size())));
    pair.degeneracy = registration::degeneracy(best.hessian, centre, lever, planar_);
    const double sigma = std::max(best.rmse, kSigmaMin);
    const double strongest =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(best.hessian.topLeftCorner<3, 3>()).eigenvalues()[2];
    const double fit = std::max(1.0, best.rmse / kGoodFit);
    const double systematic = kSystematic * fit * fit;
    pair.information =
        best.hessian / std::max(kCorrelated * sigma * sigma, strongest * systematic * systematic);
    if (!planar_) return;
    for (const int held : {2, 3, 4}) {  // What was not free is not known from this pair.
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
  return {2 * options.position_error_m, 2 * options.yaw_error_deg * kPi / 180};
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
    near += target.net.find(cell_of(point, surfels.cell)) != CellGrid::kNone ? 1 : 0;
  }
  return surfels.size() > 0 ? static_cast<double>(near) / static_cast<double>(surfels.size()) : 0;
}

}  // namespace loci::mapping::registration
