#include "mapping/update/motion.h"

#include <algorithm>
#include <cmath>

#include "mapping/registration/icp.h"
#include "mapping/update/parameters.h"

namespace loci::mapping {

using registration::CellGrid;
using registration::PreparedScan;
using registration::Surfels;

double PieceFit::agreement() const {
  const size_t seen = same + free;
  return seen > 0 ? static_cast<double>(same) / static_cast<double>(seen) : 0;
}

PieceSearch::PieceSearch(const Epoch& before, const Epoch& now, const Piece& piece) : now_(now) {
  std::vector<uint8_t> chosen(before.surface().size(), 0);
  for (const uint32_t i : piece.surfels) chosen[i] = 1;
  source_ = before.prepared_part(chosen);
  middle_ = piece.box.center().head<2>().cast<double>();
  const Surfels& level = source_.levels[1];
  const size_t step = std::max<size_t>(1, level.size() / kMotion.samples);
  // Any prefix of the samples covers all of the piece.
  for (size_t first = 0; first < kMotion.interleave; ++first)
    for (size_t i = first * step; i < level.size(); i += kMotion.interleave * step)
      samples_.push_back(static_cast<uint32_t>(i));
}

PieceFit PieceSearch::fit(const Surfels& target, const Isometry3d& now_from_before) const {
  const Eigen::Matrix3f turn = now_from_before.linear().cast<float>();
  const Eigen::Vector3f shift = now_from_before.translation().cast<float>();
  const Surfels& source = source_.finest();
  PieceFit fit;
  for (size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3f p = turn * source.position[i] + shift, n = turn * source.normal[i];
    if (same_surfel(target, p, n) != CellGrid::kNone)
      ++fit.same;
    else if (now_.surface().near(p))
      ++fit.other;
    else
      ++(now_.passed(p) ? fit.free : fit.unknown);
  }
  return fit;
}

Isometry3d PieceSearch::pose_of(const Vector2d& middle, double yaw) const {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  const Vector3d from(middle_.x(), middle_.y(), 0), to(middle.x(), middle.y(), 0);
  pose.translation() = to - pose.linear() * from;
  return pose;
}

double PieceSearch::coarse_score(const Surfels& target, const Isometry3d& pose) const {
  const Eigen::Matrix3f turn = pose.linear().cast<float>();
  const Eigen::Vector3f shift = pose.translation().cast<float>();
  const Surfels& source = source_.levels[1];
  double score = 0;
  for (size_t k = 0; k < samples_.size(); ++k) {
    if (k == kMotion.first_samples && score < kMotion.min_first_score) return 0;
    const uint32_t i = samples_[k];
    const Eigen::Vector3f p = turn * source.position[i] + shift;
    const uint32_t j = target.nearest(p, turn * source.normal[i], static_cast<float>(target.cell));
    if (j != CellGrid::kNone)
      score += 1 - static_cast<double>((target.position[j] - p).norm() / 2 / static_cast<float>(target.cell));
  }
  return score;
}

void PieceSearch::search(const Surfels& target, const Vector2d& middle, double reach, double turn,
                         std::vector<Start>& starts) const {
  std::vector<Start> found;
  const int steps = static_cast<int>(std::lround(reach / kMotion.step_m));
  const int turns = static_cast<int>(std::floor(turn / kMotion.turn_step + 1e-9));
  for (int k = -turns; k <= turns; ++k)
    for (int x = -steps; x <= steps; ++x)
      for (int y = -steps; y <= steps; ++y) {
        const Isometry3d pose = pose_of(middle + kMotion.step_m * Vector2d(x, y), k * kMotion.turn_step);
        if (const double score = coarse_score(target, pose); score > 0) found.push_back({pose, score});
      }
  std::ranges::stable_sort(found, std::greater(), &Start::score);
  const Vector3d centre(middle_.x(), middle_.y(), 0);
  size_t kept = 0;
  const size_t first = starts.size();
  for (const Start& start : found) {
    if (kept == kMotion.starts) break;
    const bool beside = std::any_of(
        starts.begin() + static_cast<std::ptrdiff_t>(first), starts.end(), [&](const Start& other) {
          return (start.pose * centre - other.pose * centre).norm() < kMotion.apart_m &&
                 Eigen::AngleAxisd(start.pose.linear().transpose() * other.pose.linear()).angle() <
                     kMotion.apart_turn;
        });
    if (beside) continue;
    starts.push_back(start);
    ++kept;
  }
}

Isometry3d PieceSearch::refined(const PreparedScan& target, const Isometry3d& pose) const {
  Isometry3d result = pose;
  for (int level = 1; level >= 0; --level) {
    const auto k = static_cast<size_t>(level);
    registration::IcpOptions options;
    options.metric = registration::Metric::kGeneralised;  // Legs and edges have no planes.
    options.radius = 1.5 * target.levels[k].cell;
    options.sigma = 0.5 * target.levels[k].cell;
    options.iterations = 30;
    result = icp(target.levels[k], source_.levels[k], result, options).target_from_source;
  }
  return result;
}

std::optional<PieceMotion> PieceSearch::find(const PreparedScan& target,
                                             const std::vector<Eigen::AlignedBox3f>& components) const {
  if (target.points == 0) return std::nullopt;
  std::vector<Start> starts;
  search(target.levels[1], middle_, kMotion.near_m, kMotion.near_turn, starts);
  for (const Eigen::AlignedBox3f& box : components)
    search(target.levels[1], box.center().head<2>().cast<double>(), kMotion.around_m, kPi, starts);
  const PieceFit still = fit(target.finest(), Isometry3d::Identity());
  const auto size = static_cast<double>(source_.finest().size());
  const Vector3d centre(middle_.x(), middle_.y(), 0);
  std::optional<PieceMotion> best;
  for (const Start& start : starts) {
    PieceMotion motion;
    motion.now_from_before = refined(target, start.pose);
    motion.fit = fit(target.finest(), motion.now_from_before);
    const double shift = (motion.now_from_before * centre - centre).norm();
    const double turn = Eigen::AngleAxisd(motion.now_from_before.linear()).angle();
    motion.gain = motion.fit.score() - still.score();
    motion.rank =
        motion.gain - size * (kMotion.cost_per_m * std::min(shift, 1.0) + kMotion.cost_per_turn * turn / kPi);
    if (!best || motion.rank > best->rank) best = motion;
  }
  return best;
}

}  // namespace loci::mapping
