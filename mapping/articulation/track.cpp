#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/articulation/parameters.h"
#include "mapping/articulation/path.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"

namespace loci::mapping {
namespace {

double square(double x) {
  return x * x;
}

double log_normal_odds(double value, double usual, double spread) {
  return -0.5 * square(std::log(std::max(value, 1e-9) / usual) / spread);
}

std::vector<Vector3d> across_all(const PathFit& fit, const std::vector<Vector3d>& positions) {
  std::vector<Vector3d> all;
  for (const Vector3d& p : positions) all.push_back(fit.path.across(p));
  return all;
}

/// The number of independent poses with the information of these.
double effective_poses(const PathFit& fit, const std::vector<Vector3d>& positions) {
  const std::vector<Vector3d> residuals = across_all(fit, positions);
  std::vector<Vector3d> inliers;
  for (size_t i = 0; i < residuals.size(); ++i)
    if (fit.weights[i] > 0.5) inliers.push_back(residuals[i]);
  return effective_count(inliers);
}

/// Deviation of the smoothed track (moving median) from a path: 90 % of the track is nearer than 1.52 times
/// that, as for a normal misfit.
double structured_misfit(const PathFit& fit, const std::vector<Vector3d>& positions, double noise) {
  const std::vector<Vector3d> residuals = across_all(fit, positions);
  const size_t half = std::min<size_t>(4, residuals.size() / 8);
  std::vector<double> distances, window;
  for (size_t i = 0; i < residuals.size(); ++i) {
    const size_t from = i < half ? 0 : i - half, to = std::min(residuals.size(), i + half + 1);
    Vector3d smooth = Vector3d::Zero();
    for (int k = 0; k < 2; ++k) {
      window.clear();
      for (size_t j = from; j < to; ++j) window.push_back(residuals[j][k]);
      const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
      std::nth_element(window.begin(), middle, window.end());
      smooth[k] = *middle;
    }
    distances.push_back(smooth.norm());
  }
  const auto most = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() * 9 / 10);
  std::nth_element(distances.begin(), most, distances.end());
  const double left = noise * std::min(1.0, std::sqrt(kPi / 2 / static_cast<double>(2 * half + 1)));
  return std::sqrt(std::max(square(*most / 1.52) - 2 * square(left), 0.0));
}

/// White noise per direction from second differences, which do not depend on the path's shape. The lowest
/// fifth is used, as an outlier affects three differences.
double white_noise(const std::vector<Vector3d>& positions) {
  std::vector<double> seconds;
  for (size_t i = 2; i < positions.size(); ++i)
    seconds.push_back((positions[i] - 2 * positions[i - 1] + positions[i - 2]).norm());
  const auto fifth = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 5);
  std::nth_element(seconds.begin(), fifth, seconds.end());
  return *fifth / (1.003 * std::sqrt(6.0));  // 1.003: a fifth of normal vectors in space is shorter
}

/// A gain in log likelihood, reduced for a possible systematic error of size `tolerated` (in the units of
/// `effect`): the effect counts against noise and systematic error together.
double tolerant_gain(double gain, double effect, double tolerated) {
  if (gain <= 0 || effect <= 0) return std::min(gain, 0.0);
  return 0.5 * square(effect) / (square(effect) / (2 * gain) + square(tolerated));
}

/// log of exp(-x) · I0(x), Bessel's function.
double log_scaled_bessel(double x) {
  return x < 30 ? std::log(std::cyl_bessel_i(0.0, x)) - x : -0.5 * std::log(2 * kPi * x);
}

/// Log likelihood of a curvature given the `seen` one: a Rice distribution, as errors of standard deviation
/// `sd` act in both directions across the path. Without common factors.
double log_curvature_likelihood(double curvature, double seen, double sd) {
  return -0.5 * square((seen - curvature) / sd) + log_scaled_bessel(seen * curvature / (sd * sd));
}

/// The same for a revolute joint of unknown radius: the mean over usual radii.
double log_revolute_likelihood(double seen, double sd) {
  const double step = 0.02;
  double sum = 0, largest = -1e300;
  std::vector<double> logs;
  for (double z = -4; z < 4; z += step)
    logs.push_back(-0.5 * z * z + log_curvature_likelihood(
                                      std::exp(-kTracks.radius_log_sd * z) / kTracks.radius_m, seen, sd));
  for (const double log : logs) largest = std::max(largest, log);
  for (const double log : logs) sum += std::exp(log - largest);
  return largest + std::log(sum * step / std::sqrt(2 * kPi));
}

void check(const Track& track) {
  if (track.positions.size() < 3)
    throw Error("the track has " + std::to_string(track.positions.size()) + " poses", {},
                "a joint shows in three poses at least");
  if (!track.orientations.empty() && track.orientations.size() != track.positions.size())
    throw Error("the track has " + std::to_string(track.positions.size()) + " positions and " +
                std::to_string(track.orientations.size()) + " orientations");
  for (size_t i = 0; i < track.positions.size(); ++i)
    if (!track.positions[i].allFinite() ||
        (!track.orientations.empty() && !track.orientations[i].coeffs().allFinite()))
      throw Error("pose " + std::to_string(i) + " of the track has a value that is not a finite number");
}

/// Makes the joint open in the positive sense.
void orient(PathFit& fit) {
  double low = 0, high = 0;
  for (size_t i = 0; i < fit.along.size(); ++i)
    if (fit.weights[i] > 0.5) {
      low = std::min(low, fit.along[i]);
      high = std::max(high, fit.along[i]);
    }
  if (high >= -low) return;
  fit.path.axis = -fit.path.axis;
  for (double& s : fit.along) s = -s;
}

struct Evidence {
  std::array<double, 4> log{};  ///< rigid, prismatic, revolute, unknown
};

/// Log evidence of the types by the positions, relative to the circle's likelihood.
Evidence position_evidence(const std::array<PathFit, 3>& fits, double poses, double misfit) {
  const auto& [point, line, circle] = fits;
  const double scale = poses / static_cast<double>(point.weights.size());
  const double travel = std::max(line.travel, 1e-6);
  const double static_gain =
      scale * (std::max(circle.log_likelihood, line.log_likelihood) - point.log_likelihood);

  // A straight path of length l that bends by rms b looks like an arc of 8 · b / (0.298 · l) radians. One
  // bend takes a share of the misfit, as a path deviates in few independent ways.
  const double bent = std::hypot(kTracks.bend * travel, misfit * std::sqrt(std::min(3 / poses, 1.0)));
  // The curvature of a parabola through noise has the standard deviation σ · √(720 / n) / l².
  const double bend = bent / travel * 8 / 0.298 / travel;
  const double noise = circle.sigma * std::sqrt(720 / poses) / square(travel);
  const bool arc = circle.log_likelihood > line.log_likelihood;
  const double curvature = arc ? 1 / circle.path.radius : 0, curvature_sd = std::hypot(bend, noise);

  const double penalty = 0.5 * std::log(poses);
  const double log_travel = log_normal_odds(travel, kTracks.travel_m, kTracks.travel_log_sd);
  const double slack = std::hypot(kTracks.slack_m, kTracks.slack_per_length * travel);
  const double log_misfit = -0.5 * square(misfit / slack);
  Evidence evidence;
  // Noise alone spreads over about four standard deviations; the rms of a uniform motion is its length / √12.
  const double motion_rms = std::max(line.travel - 4 * line.sigma, 0.0) / std::sqrt(12.0);
  evidence.log[0] = -tolerant_gain(static_gain, motion_rms, kTracks.wander_m) - 3 * penalty +
                    std::log((1 - kTracks.unknown_share) / 3);
  // A line has four parameters, and the span over which the poses are spread.
  const double common = -5 * penalty + log_travel + log_misfit + std::log((1 - kTracks.unknown_share) / 3);
  evidence.log[1] = common + log_curvature_likelihood(0, curvature, curvature_sd);
  evidence.log[2] = common + log_revolute_likelihood(curvature, curvature_sd);
  evidence.log[3] =
      std::max(evidence.log[1], evidence.log[2]) - log_misfit + std::log(3 * kTracks.unknown_share);
  return evidence;
}

/// Adds the evidence of the orientations.
void add_orientation_evidence(const Track& track, const std::array<PathFit, 3>& fits,
                              const TrackOptions& options, Evidence& evidence) {
  if (track.orientations.empty()) return;
  const std::vector<double> static_positions(track.positions.size(), 0.0);
  const OrientationFit stays =
      fit_orientations(track.orientations, fits[2].path.axis, static_positions, fits[2].weights);
  const OrientationFit turns =
      fit_orientations(track.orientations, fits[2].path.axis, fits[2].along, fits[2].weights);
  double sigma = options.orientation_sigma_deg * kDegree;
  if (sigma == 0) sigma = std::max(std::min(stays.sigma, turns.sigma), 0.3 * kDegree);
  const double poses = (stays.sigma < turns.sigma ? stays : turns).effective_poses;
  const double stay = stays.log_likelihood(sigma, poses), turn = turns.log_likelihood(sigma, poses);
  // The drift of a marker's orientation is no rotation.
  const double arc = fits[2].path.radius > 0 ? fits[2].travel / fits[2].path.radius : 0;
  const double gain = tolerant_gain(std::abs(turn - stay), arc, std::hypot(kTracks.drift, sigma));
  // Markers flip and hands slip: one orientation in ten is no evidence.
  const auto worse_by = [](double log) { return std::log(std::exp(-log) + 0.1 * std::exp(-4)); };
  const double stay_penalty = worse_by(turn > stay ? gain : 0),
               turn_penalty = worse_by(turn > stay ? 0 : gain);
  evidence.log[0] += stay_penalty;
  evidence.log[1] += stay_penalty;
  evidence.log[2] += turn_penalty;
  evidence.log[3] -= 4;  // Any rotation is possible without a joint.
}

TrackFit fit_of(ArticulationType type, const PathFit& path, double poses) {
  TrackFit fit;
  fit.type = type;
  fit.axis = path.path.axis;
  fit.centre = path.path.centre;
  fit.radius = path.path.radius;
  fit.rms_m = path.rms;
  fit.parameters = static_cast<size_t>(path.path.parameters());
  fit.outliers = path.outliers();
  fit.log_likelihood = path.log_likelihood * poses / static_cast<double>(path.weights.size());
  fit.bic = static_cast<double>(fit.parameters) * std::log(poses) - 2 * fit.log_likelihood;
  fit.positions = path.along;
  return fit;
}

void describe(JointEstimate& estimate, const PathFit& fit, double poses) {
  estimate.axis = fit.path.axis;
  estimate.origin = fit.path.centre;
  for (size_t i = 0; i < fit.along.size(); ++i)
    if (fit.weights[i] > 0.5) {
      estimate.lower = std::min(estimate.lower, fit.along[i]);
      estimate.upper = std::max(estimate.upper, fit.along[i]);
    }
  const double correlated = static_cast<double>(fit.weights.size()) / poses;
  const Eigen::VectorXd variances = correlated * fit.covariance.diagonal();
  estimate.origin_sd_m = std::sqrt(variances.head(2).sum());
  const Eigen::Index tilt = fit.path.kind == Path::Kind::circle ? 3 : 2;
  if (fit.path.kind != Path::Kind::point)
    estimate.axis_sd_deg = std::sqrt(variances.segment(tilt, 2).sum()) / kDegree;
}

}  // namespace

TrackResult fit_track(const Track& track, const TrackOptions& options) {
  check(track);
  TrackOptions checked = options;
  table_of(checked).validate({"", 0, "track"});
  PathOptions path_options{options.position_sigma_m, options.outlier_probability};
  std::array<PathFit, 3> fits;
  fits[0] = fit_path(Path::Kind::point, track.positions, path_options);
  fits[1] = fit_path(Path::Kind::line, track.positions, path_options);
  path_options.span = fits[1].span;
  fits[2] = fit_path(Path::Kind::circle, track.positions, path_options);
  orient(fits[1]);
  orient(fits[2]);

  TrackResult result;
  result.effective_poses = effective_poses(fits[2], track.positions);
  const double noise = white_noise(track.positions);
  result.misfit_m = std::min(structured_misfit(fits[1], track.positions, noise),
                             structured_misfit(fits[2], track.positions, noise));
  result.sigma_m = fits[2].sigma;

  Evidence evidence = position_evidence(fits, result.effective_poses, result.misfit_m);
  add_orientation_evidence(track, fits, options, evidence);
  const double largest = *std::max_element(evidence.log.begin(), evidence.log.end());
  double sum = 0;
  for (double& log : evidence.log) sum += log = std::exp(log - largest);
  for (size_t i = 0; i < 3; ++i) {
    result.fits.push_back(fit_of(static_cast<ArticulationType>(i), fits[i], result.effective_poses));
    result.estimate.probabilities[i] = evidence.log[i] / (sum - evidence.log[3]);
  }
  result.unknown_probability = evidence.log[3] / sum;
  const size_t best =
      static_cast<size_t>(std::max_element(evidence.log.begin(), evidence.log.end()) - evidence.log.begin());
  result.usable = best < 3;
  result.estimate.evidence = "track";
  if (!result.usable) {
    result.estimate.probabilities.fill(1.0 / 3);
    result.reason = "neither line nor circle fits";
    return result;
  }
  result.estimate.type = static_cast<ArticulationType>(best);
  describe(result.estimate, fits[best], result.effective_poses);
  if (result.estimate.probabilities[best] < 0.9)
    result.reason =
        best == 0 ? "the motion is too short to decide" : "the arc is too short or too rough to decide";
  return result;
}

namespace {

Json json_of(const TrackFit& fit) {
  Json json{{"type", to_text(fit.type)},
            {"rms_m", fit.rms_m},
            {"outliers", fit.outliers},
            {"parameters", fit.parameters},
            {"log_likelihood", fit.log_likelihood},
            {"bic", fit.bic}};
  if (fit.type != ArticulationType::rigid) json["axis"] = json_from_vector(fit.axis);
  json["centre"] = json_from_vector(fit.centre);
  if (fit.type == ArticulationType::revolute) json["radius"] = fit.radius;
  return json;
}

}  // namespace

Track read_track(const std::filesystem::path& csv) {
  const CsvTable table = CsvTable::read(csv);
  const std::array<size_t, 3> xyz{table.require_column("x"), table.require_column("y"),
                                  table.require_column("z")};
  std::vector<size_t> turn;
  if (table.column("qx") >= 0 || table.column("qw") >= 0)
    for (const char* name : {"qx", "qy", "qz", "qw"}) turn.push_back(table.require_column(name));
  Track track;
  for (size_t row = 0; row < table.rows(); ++row) {
    std::array<double, 7> values{0, 0, 0, 0, 0, 0, 1};
    for (size_t i = 0; i < 3; ++i) values[i] = table.number(row, xyz[i]);
    for (size_t i = 0; i < turn.size(); ++i) values[3 + i] = table.number(row, turn[i]);
    const Isometry3d pose = pose_from_values(values, table.location(row));
    track.positions.push_back(pose.translation());
    if (!turn.empty()) track.orientations.emplace_back(pose.linear());
  }
  return track;
}

void TrackOptions::declare(OptionTable& table) {
  table.number("position_sigma_m", position_sigma_m, "m", "Noise of positions; 0 = estimated.", 0, 1);
  table.number("orientation_sigma_deg", orientation_sigma_deg, "deg", "Noise of orientations; 0 = estimated.",
               0, 90);
  table.number("outlier_probability", outlier_probability, "", "How often a pose is an outlier.", 0, 0.5);
}

std::string TrackResult::type_name() const {
  return usable ? to_text(estimate.type) : "unknown";
}

std::string TrackResult::summary() const {
  const auto type = static_cast<size_t>(estimate.type);
  if (!usable) return "unknown: " + reason;
  std::string text = fmt::format("{}, probability {:.2f}", type_name(),
                                 estimate.probabilities[type] * (1 - unknown_probability));
  const TrackFit& fit = fits[type];
  if (estimate.type == ArticulationType::prismatic)
    text += fmt::format("; axis {:.3f} {:.3f} {:.3f} (± {:.2f} deg), travel {:.3f} m", estimate.axis.x(),
                        estimate.axis.y(), estimate.axis.z(), estimate.axis_sd_deg,
                        estimate.upper - estimate.lower);
  if (estimate.type == ArticulationType::revolute)
    text += fmt::format("; axis {:.3f} {:.3f} {:.3f} (± {:.2f} deg), radius {:.3f} m, arc {:.1f} deg",
                        estimate.axis.x(), estimate.axis.y(), estimate.axis.z(), estimate.axis_sd_deg,
                        fit.radius, (estimate.upper - estimate.lower) / kDegree);
  text += fmt::format("; rms {:.1f} mm, {} of {} poses are outliers", 1000 * fit.rms_m, fit.outliers,
                      fit.positions.size());
  return reason.empty() ? text : text + "; " + reason;
}

Json TrackResult::report() const {
  Json json{{"type", type_name()}};
  // For an unknown joint the remaining probability is spread evenly.
  for (size_t i = 0; i < 3; ++i)
    json["probabilities"][to_text(static_cast<ArticulationType>(i))] =
        estimate.probabilities[i] * (1 - unknown_probability);
  json["probabilities"]["unknown"] = unknown_probability;
  const bool moves = usable && estimate.type != ArticulationType::rigid;
  json["axis"] = moves ? json_from_vector(estimate.axis) : Json();
  if (usable) json["origin"] = json_from_vector(estimate.origin);
  if (moves) {
    if (estimate.type == ArticulationType::revolute) {
      json["centre"] = json_from_vector(estimate.origin);
      json["radius"] = fits[static_cast<size_t>(estimate.type)].radius;
    }
    json["limits"] = Json::array({estimate.lower, estimate.upper});
    json["axis_sd_deg"] = estimate.axis_sd_deg;
    json["origin_sd_m"] = estimate.origin_sd_m;
  }
  json["usable"] = usable;
  json["reason"] = reason;
  json["poses"] = fits.front().positions.size();
  json["effective_poses"] = effective_poses;
  json["sigma_m"] = sigma_m;
  json["misfit_m"] = misfit_m;
  json["fits"] = Json::array();
  for (const TrackFit& fit : fits) json["fits"].push_back(json_of(fit));
  return json;
}

}  // namespace loci::mapping
