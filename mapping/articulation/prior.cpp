#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/articulation/parameters.h"
#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

/// Mountings of fronts. Left and right as seen by a person in front; a flap hinged below opens downwards
/// (oven, dishwasher), one hinged above upwards (wall cupboard). A pull-out is narrow and high, and is held
/// in the middle: a door's handle is at its side.
enum Mounting { fixed, drawer, door_left, door_right, flap_below, flap_above, pull_out, mounting_count };

/// Usual value and spread of a quantity.
struct Normal {
  double mean, sd;
};

/// Generative model of the fronts of one mounting. Sizes are log-normal (metres, spread of the logarithm);
/// `side` and `rise` are the position of the fixture from -1 (left edge, bottom edge) to 1 (right, top).
struct MountingModel {
  double share;                      ///< of all fronts that have a fixture
  double horizontal, upright, knob;  /// of its fixtures
  Normal side, rise;
  Normal width, height;
  Normal elevation;  ///< of the front's centre above the floor
};

constexpr std::array<MountingModel, mounting_count> kModels{{
    {0.02, 0.40, 0.30, 0.30, {0.0, 0.6}, {0.0, 0.8}, {0.60, 0.6}, {0.60, 0.7}, {1.0, 0.6}},      // fixed
    {0.44, 0.75, 0.05, 0.20, {0.0, 0.15}, {0.5, 0.45}, {0.55, 0.4}, {0.28, 0.5}, {0.5, 0.35}},   // drawer
    {0.22, 0.25, 0.50, 0.25, {0.85, 0.2}, {0.0, 0.8}, {0.48, 0.3}, {0.90, 0.5}, {1.1, 0.6}},     // door_left
    {0.22, 0.25, 0.50, 0.25, {-0.85, 0.2}, {0.0, 0.8}, {0.48, 0.3}, {0.90, 0.5}, {1.1, 0.6}},    // door_right
    {0.05, 0.93, 0.01, 0.06, {0.0, 0.15}, {0.85, 0.25}, {0.60, 0.2}, {0.70, 0.18}, {0.6, 0.3}},  // flap_below
    {0.03,
     0.87,
     0.03,
     0.10,
     {0.0, 0.15},
     {-0.85, 0.25},
     {0.75, 0.4},
     {0.42, 0.35},
     {1.75, 0.35}},                                                                          // flap_above
    {0.02, 0.25, 0.65, 0.10, {0.0, 0.15}, {0.3, 0.6}, {0.28, 0.2}, {1.0, 0.4}, {0.8, 0.3}},  // pull_out
}};

double log_density(double value, const Normal& normal) {
  const double z = (value - normal.mean) / normal.sd;
  return std::log(std::exp(-0.5 * z * z) + kPriors.min_density) - std::log(normal.sd);
}

double log_size_density(double metres, const Normal& normal) {
  return log_density(std::log(std::max(metres, 1e-3)), {std::log(normal.mean), normal.sd});
}

/// Position of a fixture along an extent of the front, -1 to 1: 1 where the fixture touches the edge.
double relative_position(double offset, double extent, double fixture_extent) {
  const double range = std::max(0.5 * (extent - fixture_extent), 0.15 * extent);
  return std::clamp(offset / std::max(range, 1e-3), -1.2, 1.2);
}

double log_fixture_likelihood(const Front& front, const Fixture& fixture, const MountingModel& model) {
  const Vector3d offset = fixture.centre - front.centre;
  double along_right = 0, along_up = 0, share = model.knob;
  if (fixture.kind == Fixture::Kind::handle) {
    const Vector3d axis = fixture.axis.normalized();
    along_right = std::abs(axis.dot(front.right()));
    along_up = std::abs(axis.dot(front.up));
    share = along_up > along_right ? model.upright : model.horizontal;
  }
  const double side = relative_position(offset.dot(front.right()), front.width, along_right * fixture.length);
  const double rise = relative_position(offset.dot(front.up), front.height, along_up * fixture.length);
  return std::log(share) + log_density(side, model.side) + log_density(rise, model.rise);
}

constexpr double kCertainOdds = 5;  ///< logarithm

/// Log odds of a mounting for an appliance against other furniture.
double log_appliance_odds(const std::string& appliance, Mounting mounting) {
  if (appliance == "oven" || appliance == "dishwasher") return mounting == flap_below ? kCertainOdds : 0;
  if (appliance == "fridge" || appliance == "freezer" || appliance == "microwave" ||
      appliance == "washing_machine")
    return mounting == door_left || mounting == door_right ? kCertainOdds : 0;
  return 0;
}

constexpr double kMaxPlinth = 0.18;  ///< m, height of a plinth

/// Log odds of a panel without fixture that is no higher than a plinth: it is one, and closes the space below
/// the furniture.
double log_plinth(const Front& front, Mounting mounting) {
  const bool plinth = !front.fixture && front.centre.z() + front.height / 2 < kMaxPlinth;
  return plinth && mounting == fixed ? kCertainOdds : 0;
}

/// A flap at the plinth is a dishwasher: it reaches up to the worktop. What ends below has a drawer above it
/// and is a drawer itself, for waste or bottles. Ovens stand higher.
double log_reach(const Front& front, Mounting mounting) {
  constexpr Normal kWorktop{0.84, 0.04};
  const double bottom = front.centre.z() - front.height / 2, top = front.centre.z() + front.height / 2;
  if (mounting != flap_below || bottom > kMaxPlinth || top > kWorktop.mean) return 0;
  return log_density(top, kWorktop) - log_density(kWorktop.mean, kWorktop);
}

/// Logarithms of the joint densities of mountings and appearance.
std::array<double, mounting_count> mounting_scores(const Front& front) {
  std::array<double, mounting_count> scores{};
  for (size_t i = 0; i < mounting_count; ++i) {
    const MountingModel& model = kModels[i];
    double share = model.share;
    if (!front.fixture && i == pull_out) share *= 0.1;  // What slides out has something to hold it by.
    if (!front.fixture)
      share = i == fixed ? kPriors.fixed_without_fixture
                         : share * (1 - kPriors.fixed_without_fixture) / (1 - kModels[fixed].share);
    scores[i] = std::log(share) + log_size_density(front.width, model.width) +
                log_size_density(front.height, model.height) +
                log_density(front.centre.z(), model.elevation) +
                log_appliance_odds(front.appliance, Mounting(i)) + log_reach(front, Mounting(i)) +
                log_plinth(front, Mounting(i));
    if (front.fixture) scores[i] += log_fixture_likelihood(front, *front.fixture, model);
  }
  return scores;
}

std::array<double, mounting_count> mounting_probabilities(const Front& front) {
  std::array<double, mounting_count> probabilities = mounting_scores(front);
  const double largest = *std::max_element(probabilities.begin(), probabilities.end());
  double sum = 0;
  for (double& p : probabilities) sum += p = std::exp(p - largest);
  for (double& p : probabilities) p /= sum;
  return probabilities;
}

struct Mechanism {
  ArticulationType type;
  Vector3d axis, origin;
  double upper;
};

Mechanism mechanism_of(const Front& front, Mounting mounting) {
  const Vector3d behind = front.centre - kFaceMotion.hinge_depth_m * front.normal;
  const Vector3d half_width = 0.5 * front.width * front.right(), half_height = 0.5 * front.height * front.up;
  switch (mounting) {
    case drawer:
    case pull_out:
      return {ArticulationType::prismatic, front.normal, front.centre, 0.9 * front.depth};
    case door_left:
      return {ArticulationType::revolute, -front.up, behind - half_width, 100 * kDegree};
    case door_right:
      return {ArticulationType::revolute, front.up, behind + half_width, 100 * kDegree};
    case flap_below:
      return {ArticulationType::revolute, front.right(), behind - half_height, kPi / 2};
    case flap_above:
      return {ArticulationType::revolute, -front.right(), behind + half_height, kPi / 2};
    default:
      return {ArticulationType::rigid, front.normal, front.centre, 0};
  }
}

std::array<double, 3> type_probabilities(const Front& front,
                                         const std::array<double, mounting_count>& probabilities) {
  std::array<double, 3> types{};
  for (size_t i = 0; i < mounting_count; ++i)
    types[static_cast<size_t>(mechanism_of(front, Mounting(i)).type)] += probabilities[i];
  return types;
}

}  // namespace

JointEstimate joint_prior(const Front& front) {
  const std::array<double, 3> probabilities = type_probabilities(front, mounting_probabilities(front));
  return joint_prior(
      front, static_cast<ArticulationType>(std::ranges::max_element(probabilities) - probabilities.begin()));
}

JointEstimate joint_prior(const Front& front, ArticulationType type) {
  const std::array<double, mounting_count> probabilities = mounting_probabilities(front);
  JointEstimate joint;
  joint.probabilities = type_probabilities(front, probabilities);
  joint.type = type;

  size_t best = mounting_count;
  for (size_t i = 0; i < mounting_count; ++i)
    if (mechanism_of(front, Mounting(i)).type == joint.type &&
        (best == mounting_count || probabilities[i] > probabilities[best]))
      best = i;
  const Mechanism mechanism = mechanism_of(front, Mounting(best));
  joint.axis = mechanism.axis;
  joint.origin = mechanism.origin;
  joint.upper = mechanism.upper;

  // Real joints deviate from their front by a few degrees; other mountings of the type add to the spread.
  double axis_variance = 3 * 3, origin_variance = 0.02 * 0.02;
  for (size_t i = 0; i < mounting_count; ++i) {
    const Mechanism other = mechanism_of(front, Mounting(i));
    if (other.type != joint.type) continue;
    const double share = probabilities[i] / joint.probabilities[static_cast<size_t>(joint.type)];
    const double angle_deg = std::acos(std::clamp(other.axis.dot(joint.axis), -1.0, 1.0)) / kDegree;
    axis_variance += share * angle_deg * angle_deg;
    origin_variance += share * (other.origin - joint.origin).squaredNorm();
  }
  joint.axis_sd_deg = std::sqrt(axis_variance);
  joint.origin_sd_m = std::sqrt(origin_variance);
  joint.evidence = "prior";
  return joint;
}

double front_log_likelihood(const Front& front) {
  const std::array<double, mounting_count> scores = mounting_scores(front);
  const double largest = *std::max_element(scores.begin(), scores.end());
  double sum = 0;
  for (const double score : scores) sum += std::exp(score - largest);
  return largest + std::log(sum);
}

std::string front_class(const Front& front, const JointEstimate& joint) {
  switch (joint.type) {
    case ArticulationType::prismatic:  // A door may slide along its plane.
      return std::abs(joint.axis.dot(front.normal)) > std::sqrt(0.5) ? "drawer" : "door";
    case ArticulationType::revolute:
      return std::abs(joint.axis.dot(front.up)) > std::sqrt(0.5) ? "door" : "flap";
    case ArticulationType::rigid:
      break;
  }
  return "front";
}

}  // namespace loci::mapping
