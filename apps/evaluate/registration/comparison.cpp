#include "apps/evaluate/registration/comparison.h"

#include <fmt/format.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/sensor/scan.h"

namespace loci::apps::registration_evaluation {
namespace {

struct PeerResult {
  Isometry3d target_from_source = Isometry3d::Identity();
  bool converged = false;  ///< as the method itself claims
};

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kReach = 1.0;  ///< metres

Cloud::Ptr cloud_of(const mapping::Scan& scan) {
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(scan.points.size());
  for (const mapping::ScanPoint& point : scan.points)
    if (point.returned) cloud->push_back({point.position.x(), point.position.y(), point.position.z()});
  return cloud;
}

PeerResult run(pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>& method, const mapping::Scan& target,
               const mapping::Scan& source, const Isometry3d& target_from_source) {
  method.setInputTarget(cloud_of(target));
  method.setInputSource(cloud_of(source));
  Cloud moved;
  method.align(moved, target_from_source.matrix().cast<float>());
  PeerResult result;
  const Eigen::Matrix4d pose = method.getFinalTransformation().cast<double>();
  result.target_from_source.translation() = pose.topRightCorner<3, 1>();
  result.target_from_source.linear() =
      Eigen::Quaterniond(Eigen::Matrix3d(pose.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
  result.converged = method.hasConverged();
  return result;
}

/// "PCL ICP", "PCL GICP", "PCL NDT": one thread each.
const std::vector<std::string>& peers() {
  static const std::vector<std::string> names = {"PCL ICP", "PCL GICP", "PCL NDT"};
  return names;
}

/// Points are taken as they are. Correspondences reach 1 m, so that starts half a metre off are within reach.
PeerResult align_with_peer(const std::string& peer, const mapping::Scan& target, const mapping::Scan& source,
                           const Isometry3d& target_from_source) {
  if (peer == "PCL GICP") {
    pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> method;
    method.setMaxCorrespondenceDistance(kReach);
    return run(method, target, source, target_from_source);
  }
  if (peer == "PCL NDT") {
    pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> method;
    method.setResolution(static_cast<float>(kReach));
    method.setStepSize(0.1);
    method.setTransformationEpsilon(0.001);
    method.setMaximumIterations(50);
    return run(method, target, source, target_from_source);
  }
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> method;
  method.setMaxCorrespondenceDistance(kReach);
  method.setMaximumIterations(100);
  method.setTransformationEpsilon(1e-8);
  return run(method, target, source, target_from_source);
}

double metres_off(const Isometry3d& a, const Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

double degrees_off(const Isometry3d& a, const Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / kPi;
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

struct Answer {
  Isometry3d target_from_source;
  bool claimed = false;
};

Answer answer_of(const std::string& method, const mapping::Scan& target, const mapping::Scan& source,
                 const Isometry3d& start, const mapping::RegistrationOptions& options) {
  if (method.starts_with("PCL")) {
    const PeerResult result = align_with_peer(method, target, source, start);
    return {result.target_from_source, result.converged};
  }
  mapping::RegistrationOptions ours = options;
  ours.method = method.substr(method.find(' ') + 1);
  const mapping::PairAlignment pair = align(target, source, start, ours);
  return {pair.target_from_source, pair.trusted};
}

Json number(double value, double unit) {
  return std::round(value / unit) * unit;
}

}  // namespace

double MethodRow::median_m() const {
  return errors_m.empty() ? 0 : median(errors_m);
}
double MethodRow::median_deg() const {
  return errors_deg.empty() ? 0 : median(errors_deg);
}
double MethodRow::mean_seconds() const {
  return mean(seconds);
}

std::vector<MethodRow> compare_methods(const PairSet& set, const std::vector<Disturbance>& disturbances,
                                       double voxel_m, bool with_peers, const Random& random,
                                       Progress& progress) {
  if (set.pairs.empty()) return {};
  std::vector<std::string> methods = {"loci plane", "loci generalised", "loci point"};
  if (with_peers) methods.insert(methods.end(), peers().begin(), peers().end());
  mapping::RegistrationOptions options;
  options.dof = set.planar ? 3 : 6;
  options.voxel_m = voxel_m;
  options.threads = 1;
  std::map<const mapping::Scan*, mapping::Scan> thin;
  for (const TruePair& pair : set.pairs)
    for (const mapping::Scan* scan : {pair.target, pair.source})
      if (!thin.contains(scan)) thin.emplace(scan, thinned(*scan, voxel_m));
  std::vector<MethodRow> rows;
  for (const Disturbance& disturbance : disturbances)
    for (const std::string& method : methods)
      rows.push_back({set.name, disturbance.name, method, 0, 0, 0, 0, {}, {}, {}, {}});
  for (size_t p = 0; p < set.pairs.size(); ++p) {
    const TruePair& pair = set.pairs[p];
    for (size_t d = 0; d < disturbances.size(); ++d) {
      Random draw = random.fork(p * disturbances.size() + d);
      const Isometry3d start = perturbed(pair.target_from_source, disturbances[d].shift_m,
                                         disturbances[d].turn_deg, set.planar, draw);
      for (size_t m = 0; m < methods.size(); ++m) {
        progress.check(static_cast<double>(p) / static_cast<double>(set.pairs.size()),
                       set.name + ": " + methods[m]);
        MethodRow& row = rows[d * methods.size() + m];
        const double begin = thread_cpu_seconds();
        const Answer answer =
            answer_of(methods[m], thin.at(pair.target), thin.at(pair.source), start, options);
        row.seconds.push_back(thread_cpu_seconds() - begin);
        row.names.push_back(pair.name);
        row.errors_m.push_back(metres_off(answer.target_from_source, pair.target_from_source));
        row.errors_deg.push_back(degrees_off(answer.target_from_source, pair.target_from_source));
        const bool right = row.errors_m.back() <= set.trusted_m && row.errors_deg.back() <= set.trusted_deg;
        ++row.pairs;
        row.right += right ? 1 : 0;
        row.claimed += answer.claimed ? 1 : 0;
        row.false_claims += answer.claimed && !right ? 1 : 0;
      }
    }
  }
  return rows;
}

std::vector<VerdictRow> test_verdicts(const PairSet& set, double shift_m, double turn_deg,
                                      const mapping::RegistrationOptions& options, const Random& random,
                                      Progress& progress) {
  std::vector<VerdictRow> rows;
  for (size_t p = 0; p < set.pairs.size(); ++p) {
    progress.check(static_cast<double>(p) / static_cast<double>(set.pairs.size()), set.name + ": verdicts");
    const TruePair& pair = set.pairs[p];
    Random draw = random.fork(p);
    const Isometry3d start = perturbed(pair.target_from_source, shift_m, turn_deg, set.planar, draw);
    VerdictRow row;
    row.name = pair.name;
    row.same_place = pair.same_place;
    row.overlap = pair.overlap;
    row.alignment = align(*pair.target, *pair.source, start, options);
    row.trusted = row.alignment.trusted;
    row.error_m = metres_off(row.alignment.target_from_source, pair.target_from_source);
    row.error_deg = degrees_off(row.alignment.target_from_source, pair.target_from_source);
    row.right = pair.same_place && row.error_m <= set.trusted_m && row.error_deg <= set.trusted_deg;
    rows.push_back(std::move(row));
  }
  return rows;
}

TourRow test_tour(const std::string& world, const std::vector<mapping::Scan>& scans, double shift_m,
                  double turn_deg, const mapping::RegistrationOptions& options, const Random& random,
                  Progress& progress) {
  mapping::ScanSet set;
  set.scans = scans;
  set.range_max = 10;
  for (size_t i = 1; i < set.scans.size(); ++i) {
    Random draw = random.fork(i);
    set.scans[i].map_from_scan = perturbed(scans[i].map_from_scan, shift_m, turn_deg, true, draw);
  }
  const mapping::RegistrationResult result = register_scans(set, options, progress);
  TourRow row;
  row.world = world;
  row.scans = scans.size();
  row.connected = result.connected_count();
  row.seconds = result.seconds;
  const auto others = static_cast<double>(std::max<size_t>(1, row.connected - 1));
  for (size_t i = 1; i < scans.size(); ++i) {
    if (!result.connected[i]) continue;
    const double metres = metres_off(result.map_from_scan[i], scans[i].map_from_scan);
    const double degrees = degrees_off(result.map_from_scan[i], scans[i].map_from_scan);
    row.max_m = std::max(row.max_m, metres);
    row.max_deg = std::max(row.max_deg, degrees);
    row.mean_m += metres / others;
    row.mean_deg += degrees / others;
  }
  return row;
}

std::vector<MethodRow> over_all_pairs(const std::vector<MethodRow>& rows) {
  std::vector<MethodRow> sums;
  for (const MethodRow& row : rows) {
    auto sum = std::find_if(sums.begin(), sums.end(),
                            [&](const MethodRow& other) { return other.method == row.method; });
    if (sum == sums.end())
      sum = sums.insert(sum, {"all", "10 cm, 5° and 50 cm, 30°", row.method, 0, 0, 0, 0, {}, {}, {}, {}});
    sum->pairs += row.pairs;
    sum->right += row.right;
    sum->claimed += row.claimed;
    sum->false_claims += row.false_claims;
    sum->names.insert(sum->names.end(), row.names.begin(), row.names.end());
    sum->errors_m.insert(sum->errors_m.end(), row.errors_m.begin(), row.errors_m.end());
    sum->errors_deg.insert(sum->errors_deg.end(), row.errors_deg.begin(), row.errors_deg.end());
    sum->seconds.insert(sum->seconds.end(), row.seconds.begin(), row.seconds.end());
  }
  return sums;
}

std::string Evaluation::text(bool verbose) const {
  std::string text;
  if (!methods.empty()) {
    text += "| pairs | starts off by | method | right | median error | claimed | of it false | mean time |\n";
    text += "|---|---|---|---|---|---|---|---|\n";
  }
  std::vector<MethodRow> rows = methods, sums = over_all_pairs(methods);
  std::move(sums.begin(), sums.end(), std::back_inserter(rows));
  for (const MethodRow& row : rows)
    text += fmt::format("| {} | {} | {} | {} of {} | {:.1f} mm, {:.2f}° | {} | {} | {:.0f} ms |\n", row.set,
                        row.disturbance, row.method, row.right, row.pairs, 1000 * row.median_m(),
                        row.median_deg(), row.claimed, row.false_claims, 1000 * row.mean_seconds());
  for (const MethodRow& row : methods)
    for (size_t i = 0; verbose && i < row.pairs; ++i)
      text +=
          fmt::format("  {}, {}: {}: off by {:.1f} mm, {:.2f}°, {:.1f} ms\n", row.names[i], row.disturbance,
                      row.method, 1000 * row.errors_m[i], row.errors_deg[i], 1000 * row.seconds[i]);
  if (!verdicts.empty()) {
    const auto count = [&](auto wanted) { return std::count_if(verdicts.begin(), verdicts.end(), wanted); };
    text += fmt::format(
        "\nVerdicts over {} pairs, {} of them of different places: {} trusted, {} of these wrong; {} refused "
        "although half of the surface is in both.\n",
        verdicts.size(), count([](const VerdictRow& row) { return !row.same_place; }),
        count([](const VerdictRow& row) { return row.trusted; }),
        count([](const VerdictRow& row) { return row.false_trust(); }),
        count([](const VerdictRow& row) { return row.missed(); }));
    for (const VerdictRow& row : verdicts)
      if (verbose || row.false_trust() || row.missed())
        text += fmt::format(
            "  {}: true overlap {:.2f}; {}: {} (overlap {:.2f}, conflict {:.3f}, degeneracy {:.3f}, rmse "
            "{:.1f} "
            "mm); off by {:.1f} mm, {:.2f}°\n",
            row.name, row.overlap, row.trusted ? "trusted" : "refused", row.alignment.reason,
            row.alignment.overlap, row.alignment.conflict, row.alignment.degeneracy,
            1000 * row.alignment.rmse_m, 1000 * row.error_m, row.error_deg);
  }
  if (!tours.empty())
    text +=
        "\n| world | scans | connected | largest error | mean error | time |\n|---|---|---|---|---|---|\n";
  for (const TourRow& row : tours)
    text += fmt::format("| {} | {} | {} | {:.1f} mm, {:.3f}° | {:.1f} mm, {:.3f}° | {:.1f} s |\n", row.world,
                        row.scans, row.connected, 1000 * row.max_m, row.max_deg, 1000 * row.mean_m,
                        row.mean_deg, row.seconds);
  return text;
}

Json Evaluation::to_json() const {
  Json json;
  json["methods"] = Json::array();
  for (const MethodRow& row : methods)
    json["methods"].push_back({{"pairs", row.set},
                               {"disturbance", row.disturbance},
                               {"method", row.method},
                               {"count", row.pairs},
                               {"right", row.right},
                               {"claimed", row.claimed},
                               {"false_claims", row.false_claims},
                               {"median_error_m", number(row.median_m(), 1e-5)},
                               {"median_error_deg", number(row.median_deg(), 1e-4)},
                               {"mean_seconds", number(row.mean_seconds(), 1e-5)}});
  json["verdicts"] = Json::array();
  for (const VerdictRow& row : verdicts)
    json["verdicts"].push_back({{"pair", row.name},
                                {"same_place", row.same_place},
                                {"trusted", row.trusted},
                                {"right", row.right},
                                {"reason", row.alignment.reason},
                                {"true_overlap", row.overlap},
                                {"error_m", row.error_m},
                                {"error_deg", row.error_deg}});
  json["tours"] = Json::array();
  for (const TourRow& row : tours)
    json["tours"].push_back({{"world", row.world},
                             {"scans", row.scans},
                             {"connected", row.connected},
                             {"max_error_m", row.max_m},
                             {"max_error_deg", row.max_deg},
                             {"mean_error_m", row.mean_m},
                             {"mean_error_deg", row.mean_deg},
                             {"seconds", row.seconds}});
  return json;
}

}  // namespace loci::apps::registration_evaluation
