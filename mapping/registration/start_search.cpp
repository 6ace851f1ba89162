#include "mapping/registration/pair.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/math/rotation_vector.h"
#include "mapping/registration/parameters.h"

namespace loci::mapping::registration {
namespace {

struct Sample {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
};

/// The samples in an order in which every prefix covers all directions.
std::vector<Sample> interleaved(const std::vector<Sample>& samples) {
  std::vector<Sample> mixed;
  mixed.reserve(samples.size());
  for (size_t first = 0; first < kSearch.interleave; ++first)
    for (size_t i = first; i < samples.size(); i += kSearch.interleave) mixed.push_back(samples[i]);
  return mixed;
}

/// Surfels in equal shares by direction of the normal, so that the floor does not outweigh the few surfaces
/// that constrain the pose. Planar search omits horizontal ones.
std::vector<Sample> balanced_samples(const Surfels& surfels, bool planar, size_t count) {
  std::array<std::vector<uint32_t>, 10> by_direction;  // Up, down, and eight sectors around.
  for (uint32_t i = 0; i < surfels.size(); ++i) {
    if (surfels.weight[i] < 0.3F) continue;
    const Eigen::Vector3f& n = surfels.normal[i];
    size_t direction = n.z() > 0 ? 0 : 1;
    if (std::abs(n.z()) < 0.7F)
      direction = 2 + static_cast<size_t>((std::atan2(n.y(), n.x()) / (2 * kPi) + 0.5) * 7.999);
    else if (planar)
      continue;
    by_direction[direction].push_back(i);
  }
  // Small shares are taken completely; the remainder is divided among larger ones.
  std::sort(by_direction.begin(), by_direction.end(),
            [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::vector<Sample> samples;
  for (size_t k = 0; k < by_direction.size(); ++k) {
    const std::vector<uint32_t>& members = by_direction[k];
    const size_t share = (count - samples.size()) / (by_direction.size() - k);
    const size_t taken = std::min(share, members.size());
    for (size_t j = 0; j < taken; ++j) {
      const uint32_t i = members[j * members.size() / taken];
      samples.push_back({surfels.position[i], surfels.normal[i]});
    }
  }
  return interleaved(samples);
}

/// Steps of a grid over [-half, half]: the middle one is 0.
std::vector<double> grid(double half, double step) {
  const int steps = static_cast<int>(std::ceil(half / step - 0.01));
  std::vector<double> values;
  for (int i = -steps; i <= steps; ++i) values.push_back(i * step);
  return values;
}

/// Vectors of a grid in a ball, or in a disc or on a line where dimensions are missing.
std::vector<Vector3d> ball(double radius, double step, const Vector3d& dimensions) {
  std::vector<Vector3d> vectors;
  for (const double x : grid(dimensions.x() * radius, step))
    for (const double y : grid(dimensions.y() * radius, step))
      for (const double z : grid(dimensions.z() * radius, step))
        if (std::sqrt(x * x + y * y + z * z) < radius + 0.8 * step) vectors.emplace_back(x, y, z);
  return vectors;
}

/// Whether a vector of a grid is an odd number of steps away from the middle.
bool odd(const Vector3d& vector, double step) {
  return (std::lround(vector.sum() / step) & 1) != 0;
}

class Scorer {
 public:
  Scorer(const PreparedScan& target, std::vector<Sample> samples)
      : dilated_grid_(target.dilated_grid), samples_(std::move(samples)) {
    const Surfels& surfels = target.coarsest();
    per_metre_ = 1.F / static_cast<float>(surfels.cell);
    planes_.reserve(surfels.size() + 1);
    for (size_t i = 0; i < surfels.size(); ++i)
      planes_.emplace_back(surfels.normal[i].x(), surfels.normal[i].y(), surfels.normal[i].z(),
                           surfels.normal[i].dot(surfels.position[i]));
    none_ = static_cast<uint32_t>(surfels.size());
    planes_.push_back(Eigen::Vector4f::Zero());  // no normal agrees with none
  }

  void rotate(const Eigen::Matrix3f& rotation) {
    rotated_ = samples_;
    for (Sample& sample : rotated_) {
      sample.position = rotation * sample.position;
      sample.normal = rotation * sample.normal;
    }
  }

  /// Mean agreement, 0 to 1, of the rotated samples at a shift; 0 if much lower than the best so far.
  float score(const Eigen::Vector3f& shift) {
    float sum = 0;
    size_t exit = 0;
    for (size_t k = 0; k < rotated_.size(); ++k) {
      if (exit < kSearch.early_exits.size() && k == kSearch.early_exits[exit].first) {
        if (sum < kSearch.early_exits[exit].second * best_ * static_cast<float>(k)) return 0;
        ++exit;
      }
      // Without branches, which would be mispredicted: half of the samples meet nothing.
      const Sample& sample = rotated_[k];
      const Eigen::Vector3f point = sample.position + shift;
      const Eigen::Vector4f& plane = planes_[std::min(dilated_grid_.find(cell_of(point)), none_)];
      const float off = (plane.head<3>().dot(point) - plane[3]) * (1 / kSearch.max_plane_m);
      const float near = std::max(0.F, 1.F - off * off);
      sum += plane.head<3>().dot(sample.normal) < kSearch.same_side_cosine ? 0.F : near;
    }
    const float mean = rotated_.empty() ? 0.F : sum / static_cast<float>(rotated_.size());
    best_ = std::max(best_, mean);
    return mean < kSearch.min_score * best_ ? 0 : mean;
  }

 private:
  Eigen::Vector3i cell_of(const Eigen::Vector3f& point) const {
    constexpr float far = 1 << 13;  // Adding it makes all positive: then the conversion rounds down.
    return (point.array() * per_metre_ + far).cast<int>() - static_cast<int>(far);
  }

  const CellGrid& dilated_grid_;
  std::vector<Eigen::Vector4f> planes_;  ///< of the coarsest surfels: normal, distance from the origin
  uint32_t none_ = 0;                    ///< the plane of cells without a surfel
  std::vector<Sample> samples_;
  std::vector<Sample> rotated_;
  float best_ = 0;
  float per_metre_ = 0;
};

}  // namespace

std::vector<Isometry3d> promising_starts(const PreparedScan& target, const PreparedScan& source,
                                         const Isometry3d& target_from_source, const SearchWindow& window,
                                         const Isometry3d& known, bool planar, size_t count) {
  struct Start {
    float score;
    uint32_t turn, shift;
  };
  const Vector3d centre = source.centre.cast<double>();
  const Vector3d place = target_from_source * centre;
  const Vector3d turn_axes = planar ? Vector3d(0, 0, 1) : Vector3d(1, 1, 1);
  const Vector3d shift_axes = planar ? Vector3d(1, 1, 0) : Vector3d(1, 1, 1);
  const auto turns = ball(window.angle, planar ? kSearch.turn_step_planar : kSearch.turn_step, turn_axes);
  const auto shifts = ball(window.position, kSearch.shift_step_m, shift_axes);
  const auto pose_of = [&](const Start& start) {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = rotation_from_vector(turns[start.turn]) * target_from_source.linear();
    pose.translation() = place + shifts[start.shift] - pose.linear() * centre;
    return pose;
  };
  Scorer scorer(
      target, balanced_samples(source.coarsest(), planar, planar ? kSearch.samples_planar : kSearch.samples));
  scorer.rotate(known.linear().cast<float>());
  scorer.score(known.translation().cast<float>());
  const double turn_step = planar ? kSearch.turn_step_planar : kSearch.turn_step;
  std::vector<Start> starts;
  for (uint32_t turn = 0; turn < turns.size(); ++turn) {
    const Isometry3d unmoved = pose_of({0, turn, 0});
    const Vector3d origin = unmoved.translation() - shifts[0];
    scorer.rotate(unmoved.linear().cast<float>());
    for (uint32_t shift = 0; shift < shifts.size(); ++shift) {
      // In six dimensions every other point of a grid covers the space as well as all do (the lattice D6).
      if (!planar && odd(turns[turn], turn_step) != odd(shifts[shift], kSearch.shift_step_m)) continue;
      const float score = scorer.score((origin + shifts[shift]).cast<float>());
      if (score > 0) starts.push_back({score, turn, shift});
    }
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.score > b.score; });
  std::vector<Isometry3d> chosen = {known};
  const double apart = planar ? 1.6 : 1.2;  // In steps: neighbours on the grid descend to the same place.
  for (const Start& start : starts) {
    if (chosen.size() > count) break;
    const Isometry3d pose = pose_of(start);
    const bool beside = std::any_of(chosen.begin(), chosen.end(), [&](const Isometry3d& other) {
      const double shift = (pose * centre - other * centre).norm() / kSearch.shift_step_m;
      const double turn = Eigen::AngleAxisd(pose.linear().transpose() * other.linear()).angle() / turn_step;
      return shift < apart && turn < apart;
    });
    if (!beside) chosen.push_back(pose);
  }
  chosen.erase(chosen.begin());
  return chosen;
}

}  // namespace loci::mapping::registration
