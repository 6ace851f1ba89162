#include "mapping/update/motion.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/log_odds.h"
#include "mapping/registration/icp.h"
#include "mapping/update/parameters.h"

namespace loci::mapping {

using registration::CellGrid;
using registration::PreparedScan;
using registration::Surfels;

double change_probability(double surfels) {
  const double log_odds = kMotion.prior_log_odds + surfels / kMotion.correlated;
  return std::clamp(probability_from_log_odds(log_odds), 0.01, 0.99);
}

double PieceFit::agreement() const {
  const size_t seen = same + free;
  return seen > 0 ? static_cast<double>(same) / static_cast<double>(seen) : 0;
}

namespace {

Isometry3d aligned(const Surfels& target, const Surfels& source, const Isometry3d& pose) {
  registration::IcpOptions options;
  options.metric = registration::Metric::kGeneralised;  // Legs and edges have no planes.
  options.radius = 1.5 * target.cell;
  options.sigma = 0.5 * target.cell;
  options.iterations = 30;
  return icp(target, source, pose, options).target_from_source;
}

}  // namespace

PieceSearch::PieceSearch(const Epoch& before, const Epoch& now, const Piece& piece)
    : before_(before), now_(now), piece_(piece), chosen_(before.surface().size(), 0) {
  for (const uint32_t i : piece.surfels) chosen_[i] = 1;
  source_ = before.prepared_part(chosen_, before.surface().cell);
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
  const float radius = 1.5F * static_cast<float>(source.cell);
  PieceFit fit;
  for (size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3f p = turn * source.position[i] + shift, n = turn * source.normal[i];
    if (same_surfel(target, p, n) != CellGrid::kNone)
      ++fit.same;
    else if (now_.surface().near(p))  // The far side of a board cannot be seen where its near side is.
      ++(now_.surface().nearest(p, n, radius) != CellGrid::kNone ? fit.other : fit.unknown);
    else
      ++(now_.passed(p, n) ? fit.free : fit.unknown);
  }
  return fit;
}

bool PieceSearch::beside(const Eigen::Vector3f& position) const {
  constexpr auto kMargin = static_cast<float>(kMotion.beside_m);
  return position.z() > piece_.box.min().z() - kMargin && position.z() < piece_.box.max().z() + kMargin &&
         inside(piece_.outline, position.head<2>().cast<double>(), kMotion.beside_m);
}

size_t PieceSearch::foreign(const Surfels& target, const Isometry3d& now_from_before) const {
  const Eigen::Isometry3f before_from_now = now_from_before.inverse().cast<float>();
  const Surfels& source = source_.finest();
  const float radius = 1.5F * static_cast<float>(source.cell);
  size_t count = 0;
  for (size_t i = 0; i < target.size(); ++i) {
    const Eigen::Vector3f p = before_from_now * target.position[i];
    if (!beside(p) || source.nearest(p, Eigen::Vector3f::Zero(), radius) != CellGrid::kNone) continue;
    count += before_.passed(p, before_from_now.linear() * target.normal[i]) ? 1 : 0;
  }
  return count;
}

size_t PieceSearch::arrived(const Surfels& target, const Isometry3d& now_from_before) const {
  const Eigen::Isometry3f pose = now_from_before.cast<float>();
  const Surfels& source = source_.finest();
  size_t count = 0;
  for (size_t i = 0; i < source.size(); ++i) {
    const uint32_t j = same_surfel(target, pose * source.position[i], pose.linear() * source.normal[i]);
    count += j != CellGrid::kNone && before_.passed(target.position[j], target.normal[j]) ? 1 : 0;
  }
  return count;
}

void PieceSearch::refine(const std::vector<uint8_t>& chosen, PieceMotion& motion) const {
  const Eigen::Isometry3f before_from_now = motion.now_from_before.inverse().cast<float>();
  std::vector<uint8_t> near = chosen;
  for (uint32_t i = 0; i < near.size(); ++i)
    if (near[i] != 0 && !beside(before_from_now * now_.surface().position[i])) near[i] = 0;
  const double cell = source_.finest().cell / 2;
  const PreparedScan source = before_.prepared_part(chosen_, cell), target = now_.prepared_part(near, cell);
  if (target.points == 0) return;
  motion.now_from_before = aligned(target.finest(), source.finest(), motion.now_from_before);
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
  return aligned(target.levels[0], source_.levels[0], aligned(target.levels[1], source_.levels[1], pose));
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
    motion.fit.foreign = foreign(target.finest(), motion.now_from_before);
    motion.gain = motion.fit.score() - still.score();
    motion.rank = motion.gain - static_cast<double>(motion.fit.foreign) -
                  size * (kMotion.cost_per_m * std::min(shift, 1.0) + kMotion.cost_per_turn * turn / kPi);
    motion.jump = shift > kMotion.near_m || turn > kMotion.near_turn;
    if (!best || motion.rank > best->rank) best = motion;
  }
  if (best) best->arrived = arrived(target.finest(), best->now_from_before);
  return best;
}

}  // namespace loci::mapping
