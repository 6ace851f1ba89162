#include <fmt/format.h>

#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/base/csv.h"
#include "mapping/base/json.h"
#include "mapping/base/math.h"

namespace loci::mapping {
namespace {

Json json_of(const Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json json_of(const TrackFit& fit) {
  Json json{{"type", joint_estimate_type_name(fit.type)},
            {"rms_m", fit.rms_m},
            {"outliers", fit.outliers},
            {"parameters", fit.parameters},
            {"log_likelihood", fit.log_likelihood},
            {"bic", fit.bic}};
  if (fit.type != JointEstimate::Type::rigid) json["axis"] = json_of(fit.axis);
  json["centre"] = json_of(fit.centre);
  if (fit.type == JointEstimate::Type::revolute) json["radius"] = fit.radius;
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
    const Isometry3d pose = pose_from_values(values, table.place(row));
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
  return usable ? joint_estimate_type_name(estimate.type) : "unknown";
}

std::string TrackResult::summary() const {
  const auto type = static_cast<size_t>(estimate.type);
  if (!usable) return "unknown: " + reason;
  std::string text = fmt::format("{}, probability {:.2f}", type_name(),
                                 estimate.probabilities[type] * (1 - unknown_probability));
  const TrackFit& fit = fits[type];
  if (estimate.type == JointEstimate::Type::prismatic)
    text += fmt::format("; axis {:.3f} {:.3f} {:.3f} (± {:.2f} deg), travel {:.3f} m", estimate.axis.x(),
                        estimate.axis.y(), estimate.axis.z(), estimate.axis_sd_deg,
                        estimate.upper - estimate.lower);
  if (estimate.type == JointEstimate::Type::revolute)
    text += fmt::format("; axis {:.3f} {:.3f} {:.3f} (± {:.2f} deg), radius {:.3f} m, arc {:.1f} deg",
                        estimate.axis.x(), estimate.axis.y(), estimate.axis.z(), estimate.axis_sd_deg,
                        fit.radius, (estimate.upper - estimate.lower) * 180 / kPi);
  text += fmt::format("; rms {:.1f} mm, {} of {} poses are outliers", 1000 * fit.rms_m, fit.outliers,
                      fit.positions.size());
  return reason.empty() ? text : text + "; " + reason;
}

Json TrackResult::report() const {
  Json json{{"type", type_name()}};
  // Of an unknown joint nothing is claimed: what is left beside "unknown" is spread evenly.
  for (size_t i = 0; i < 3; ++i)
    json["probabilities"][joint_estimate_type_name(static_cast<JointEstimate::Type>(i))] =
        estimate.probabilities[i] * (1 - unknown_probability);
  json["probabilities"]["unknown"] = unknown_probability;
  const bool moves = usable && estimate.type != JointEstimate::Type::rigid;
  json["axis"] = moves ? json_of(estimate.axis) : Json();
  if (usable) json["origin"] = json_of(estimate.origin);
  if (moves) {
    if (estimate.type == JointEstimate::Type::revolute) {
      json["centre"] = json_of(estimate.origin);
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
