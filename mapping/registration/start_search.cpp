#include "mapping/registration/start_search.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace loci::registration {
namespace {

constexpr double kShiftStep = 0.2;                  ///< metres: what the descent from there bridges
constexpr double kTurnStepPlanar = 5 * M_PI / 180;  ///< radians
constexpr double kTurnStep = 12 * M_PI / 180;
constexpr size_t kSamplesPlanar = 400;
constexpr size_t kSamples = 160;
constexpr size_t kFirstLook = 40;
constexpr float kHopeless = 0.5F;
constexpr float kPlaneDistance = 0.15F;  ///< metres: where a sample counts no more
constexpr float kSameSide = 0.7F;        ///< cosine: normals agree within 45 degrees

struct Sample {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
};

/// The same in an order in which every beginning is a fair choice of the whole.
std::vector<Sample> interleaved(const std::vector<Sample>& samples) {
  std::vector<Sample> mixed;
  mixed.reserve(samples.size());
  constexpr size_t stride = 37;
  for (size_t first = 0; first < stride; ++first)
    for (size_t i = first; i < samples.size(); i += stride) mixed.push_back(samples[i]);
  return mixed;
}

/// Surfels in equal shares from all directions of normals, so that the floor does not outweigh the few
/// surfaces that fix the pose. Planar search leaves out the horizontal ones, which say nothing.
std::vector<Sample> balanced_samples(const Surfels& surfels, bool planar, size_t count) {
  std::array<std::vector<uint32_t>, 10> by_direction;  // Up, down, and eight sectors around.
  for (uint32_t i = 0; i < surfels.size(); ++i) {
    if (surfels.trust[i] < 0.3F) continue;
    const Eigen::Vector3f& n = surfels.normal[i];
    size_t direction = n.z() > 0 ? 0 : 1;
    if (std::abs(n.z()) < 0.7F)
      direction = 2 + static_cast<size_t>((std::atan2(n.y(), n.x()) / (2 * M_PI) + 0.5) * 7.999);
    else if (planar)
      continue;
    by_direction[direction].push_back(i);
  }
  // Small shares are taken whole; what they leave goes to the larger ones.
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

class Scorer {
 public:
  Scorer(const PreparedScan& target, std::vector<Sample> samples)
      : net_(target.net), surfels_(target.coarsest()), samples_(std::move(samples)) {}

  void turn(const Eigen::Matrix3f& rotation) {
    turned_ = samples_;
    for (Sample& sample : turned_) {
      sample.position = rotation * sample.position;
      sample.normal = rotation * sample.normal;
    }
  }

  /// Mean agreement, 0 to 1, of the turned samples at a shift. What is hopeless after a part of the samples
  /// is given up: its score is that of the part.
  float score(const Eigen::Vector3f& shift) {
    float sum = 0;
    for (size_t k = 0; k < turned_.size(); ++k) {
      if (k == kFirstLook && sum < kHopeless * best_ * static_cast<float>(kFirstLook))
        return sum / static_cast<float>(turned_.size());
      const Sample& sample = turned_[k];
      const Eigen::Vector3f point = sample.position + shift;
      const uint32_t i = net_.find((point * per_metre_).array().floor().cast<int>());
      if (i == CellGrid::kNone) continue;
      if (surfels_.normal[i].dot(sample.normal) < kSameSide) continue;
      const float off = surfels_.normal[i].dot(point - surfels_.position[i]) / kPlaneDistance;
      sum += std::max(0.F, 1.F - off * off);
    }
    const float mean = turned_.empty() ? 0.F : sum / static_cast<float>(turned_.size());
    best_ = std::max(best_, mean);
    return mean;
  }

 private:
  const CellGrid& net_;
  const Surfels& surfels_;
  std::vector<Sample> samples_;
  std::vector<Sample> turned_;
  float best_ = 0;
  float per_metre_ = 1.F / static_cast<float>(surfels_.cell);
};

Eigen::Matrix3d rotation_of(const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

}  // namespace

std::vector<Isometry3d> promising_starts(const PreparedScan& target, const PreparedScan& source,
                                         const Isometry3d& target_from_source, const SearchWindow& window,
                                         bool planar, size_t count) {
  struct Start {
    float score;
    Isometry3d pose;
  };
  const Vector3d centre = source.centre.cast<double>();
  const Vector3d place = target_from_source * centre;
  const Vector3d turn_axes = planar ? Vector3d(0, 0, 1) : Vector3d(1, 1, 1);
  const Vector3d shift_axes = planar ? Vector3d(1, 1, 0) : Vector3d(1, 1, 1);
  const auto turns = ball(window.angle, planar ? kTurnStepPlanar : kTurnStep, turn_axes);
  const auto shifts = ball(window.position, kShiftStep, shift_axes);
  Scorer scorer(target, balanced_samples(source.coarsest(), planar, planar ? kSamplesPlanar : kSamples));
  std::vector<Start> starts;
  for (const Vector3d& turn : turns) {
    const Eigen::Matrix3d rotation = rotation_of(turn) * target_from_source.linear();
    scorer.turn(rotation.cast<float>());
    for (const Vector3d& shift : shifts) {
      Start start{0, Isometry3d::Identity()};
      start.pose.linear() = rotation;
      start.pose.translation() = place + shift - rotation * centre;
      start.score = scorer.score(start.pose.translation().cast<float>());
      starts.push_back(start);
    }
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.score > b.score; });
  std::vector<Isometry3d> chosen = {target_from_source};
  const double apart = planar ? 1.6 : 1.2;  // In steps: neighbours on the grid descend to the same place.
  for (const Start& start : starts) {
    if (chosen.size() > count) break;
    const bool known = std::any_of(chosen.begin(), chosen.end(), [&](const Isometry3d& other) {
      const double shift = (start.pose * centre - other * centre).norm() / kShiftStep;
      const double turn = Eigen::AngleAxisd(start.pose.linear().transpose() * other.linear()).angle() /
                          (planar ? kTurnStepPlanar : kTurnStep);
      return shift < apart && turn < apart;
    });
    if (!known) chosen.push_back(start.pose);
  }
  return chosen;
}

}  // namespace loci::registration
