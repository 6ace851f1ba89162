#include "memory/belief/evidence/texture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "mapping/base/math/math.h"
#include "mapping/sensor/depth_noise.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

constexpr size_t kMinKeypoints = 8;  // fewer are noise and outlines
constexpr float kRatio = 0.85f;      // nearest over second nearest (Lowe 2004)
constexpr float kSpot = 0.01f;       // m; key points nearer than this are one spot
constexpr float kMaxZoom = 1.8f;     // between the diameters of one key point in two views
constexpr size_t kMaxPairs = 80;     // the most alike: the time grows with their square
constexpr size_t kSeeds = 12;

/// A key point of one texture that looks like one of the other.
struct Pair {
  Eigen::Vector3f from, to;
  int distance;  ///< of the descriptors, squared
};
using Pairs = std::vector<Pair>;

using Values = std::array<uint8_t, 2 * sizeof(SurfaceKeypoint::descriptor)>;

std::vector<Values> values_of(const Texture& texture) {
  std::vector<Values> all(texture.size());
  for (size_t i = 0; i < texture.size(); ++i)
    for (size_t byte = 0; byte < texture[i].descriptor.size(); ++byte) {
      all[i][2 * byte] = texture[i].descriptor[byte] & 15U;
      all[i][2 * byte + 1] = static_cast<uint8_t>(texture[i].descriptor[byte] >> 4U);
    }
  return all;
}

int squared_distance(const Values& a, const Values& b) {
  int sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const int difference = int{a[i]} - int{b[i]};
    sum += difference * difference;
  }
  return sum;
}

/// The nearest descriptor, if no other spot has one that is nearly as near. `distances`: to all of `among`.
const SurfaceKeypoint* clearly_nearest(const SurfaceKeypoint& to, const Texture& among,
                                       const std::vector<int>& distances, int& distance) {
  const auto nearest = std::ranges::min_element(distances);
  const SurfaceKeypoint& best = among[static_cast<size_t>(nearest - distances.begin())];
  int second = std::numeric_limits<int>::max();
  for (size_t i = 0; i < among.size(); ++i)
    if (distances[i] < second && (among[i].position - best.position).norm() > kSpot) second = distances[i];
  distance = *nearest;
  const float zoom = to.diameter_m / best.diameter_m;
  const bool clear = static_cast<float>(distance) < kRatio * kRatio * static_cast<float>(second);
  return clear && zoom < kMaxZoom && zoom > 1 / kMaxZoom ? &best : nullptr;
}

Pairs alike(const Texture& a, const Texture& b) {
  const std::vector<Values> of_a = values_of(a), of_b = values_of(b);
  std::vector<int> distances(b.size());
  Pairs pairs;
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) distances[j] = squared_distance(of_a[i], of_b[j]);
    int distance = 0;
    if (const SurfaceKeypoint* other = clearly_nearest(a[i], b, distances, distance))
      pairs.push_back({a[i].position, other->position, distance});
  }
  std::ranges::stable_sort(pairs, {}, &Pair::distance);
  if (pairs.size() > kMaxPairs) pairs.resize(kMaxPairs);
  return pairs;
}

/// Which pairs a rigid motion may carry together: both are as far apart in one texture as in the other.
std::vector<std::vector<bool>> rigid_together(const Pairs& pairs, float tolerance) {
  std::vector<std::vector<bool>> together(pairs.size(), std::vector<bool>(pairs.size()));
  for (size_t i = 0; i < pairs.size(); ++i)
    for (size_t j = 0; j < pairs.size(); ++j)
      together[i][j] =
          std::abs((pairs[i].from - pairs[j].from).norm() - (pairs[i].to - pairs[j].to).norm()) < tolerance;
  return together;
}

using Members = std::vector<size_t>;

/// A set around a seed whose pairs all go together; those first that go with most others.
Members clique(size_t seed, const Members& order, const std::vector<std::vector<bool>>& together) {
  Members members{seed};
  for (const size_t i : order)
    if (i != seed && std::ranges::all_of(members, [&](size_t j) { return together[i][j]; }))
      members.push_back(i);
  return members;
}

/// The pairs that the best motion of some carries to within the tolerance.
Members carried(const Pairs& pairs, const Members& members, float tolerance) {
  Eigen::Matrix3Xd from(3, members.size()), to(3, members.size());
  for (size_t i = 0; i < members.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = pairs[members[i]].from.cast<double>();
    to.col(static_cast<Eigen::Index>(i)) = pairs[members[i]].to.cast<double>();
  }
  const Eigen::Affine3f motion(Eigen::umeyama(from, to, false).cast<float>());
  Members all;
  for (size_t i = 0; i < pairs.size(); ++i)
    if ((motion * pairs[i].from - pairs[i].to).norm() < tolerance) all.push_back(i);
  return all;
}

using Spot = std::array<int, 3>;

Spot spot_of(const Eigen::Vector3f& position) {
  Spot spot{};
  for (int axis = 0; axis < 3; ++axis)
    spot[size_t(axis)] = static_cast<int>(std::floor(position[axis] / kSpot));
  return spot;
}

TextureMatch match_of(const Pairs& pairs, const Members& members) {
  std::set<Spot> from, to;
  double squares = 0;
  for (const size_t i : members) {
    from.insert(spot_of(pairs[i].from));
    to.insert(spot_of(pairs[i].to));
    squares += static_cast<double>((pairs[i].from - pairs[i].to).squaredNorm());
  }
  return {static_cast<int>(std::min(from.size(), to.size())), std::sqrt(squares / double(members.size()))};
}

}  // namespace

TextureMatch match_textures(const Texture& a, const Texture& b, double tolerance_m) {
  constexpr size_t kMinMembers = 3;
  TextureMatch best;
  if (a.size() < kMinKeypoints || b.size() < kMinKeypoints) return best;
  const auto tolerance = static_cast<float>(tolerance_m);
  const Pairs pairs = alike(a, b);
  const auto together = rigid_together(pairs, tolerance);
  Members order(pairs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&](size_t i) { return std::ranges::count(together[i], true); });
  for (size_t s = 0; s < std::min(kSeeds, order.size()); ++s) {
    Members members = clique(order[s], order, together);
    for (int round = 0; round < 3 && members.size() >= kMinMembers; ++round)
      members = carried(pairs, members, tolerance);
    if (members.size() < kMinMembers) continue;
    const TextureMatch match = match_of(pairs, members);
    if (match.agreeing > best.agreeing) best = match;
  }
  return best;
}

double texture_tolerance(double range_m) {
  constexpr double kLocalisation = 0.005;  // m: of a key point in the image
  constexpr double kMaxSigmas = 3;         // standard deviations
  return kLocalisation + kMaxSigmas * std::sqrt(2.0) * mapping::depth_noise(range_m);
}

double texture_log_ratio(const TextureMatch& match, const Texture& a, const Texture& b) {
  if (a.size() < kMinKeypoints || b.size() < kMinKeypoints) return 0;
  // By how many agree, from labelled views of objects on a table that were moved and turned between them.
  constexpr std::array kRatios{-0.7, -0.7, -0.7, 1.6, 2.8, 3.5, 4.5, 5.5, kMaxTextureLogRatio};
  return kRatios[std::min(kRatios.size() - 1, static_cast<size_t>(match.agreeing))];
}

bool is_another_print(const TextureMatch& match, const Texture& a, const Texture& b) {
  constexpr size_t kRich = 30;
  return std::min(a.size(), b.size()) >= kRich && texture_log_ratio(match, a, b) < 0;
}

Vector3d towards_camera(const Observation& observation, const Scene& scene) {
  return (scene.view.map_from_camera.translation() - observation.box.centre).normalized();
}

bool is_same_side(const Vector3d& one, const Vector3d& other) {
  static const double kMinCosine = std::cos(kParameters.same_side_deg * kPi / 180);
  return one.dot(other) > kMinCosine;
}

}  // namespace loci::memory::belief
