#include "mapping/registration/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/registration/registrar.h"

namespace loci::mapping {
namespace {

using registration::PreparedScan;
using registration::Registrar;
using registration::SearchWindow;

RegistrationOptions checked(RegistrationOptions options) {
  table_of(options).validate({"", 0, "registration"});
  if (options.dof != 3 && options.dof != 6)
    throw Error("a registration has 3 or 6 degrees of freedom", {"", 0, "dof"},
                "3: x, y and yaw of a levelled robot; 6: all");
  return options;
}

/// Standard deviations of the scan's pose: by its covariance, otherwise by the options.
SearchWindow expected_error(const Scan& scan, const RegistrationOptions& options) {
  if (scan.covariance.isZero(0)) return {options.position_error_m, options.yaw_error_deg * kDegree};
  const auto variance = scan.covariance.diagonal();
  return {std::sqrt(std::max(0.0, variance.head<3>().maxCoeff())),
          std::sqrt(std::max(0.0, variance.tail<3>().maxCoeff()))};
}

/// Three standard deviations where a covariance is given, otherwise by the options.
SearchWindow window_of(const Scan& scan, const RegistrationOptions& options) {
  if (scan.covariance.isZero(0)) return registration::window_of(options);
  const SearchWindow expected = expected_error(scan, options);
  return {3 * expected.position, 3 * expected.angle};
}

}  // namespace

void RegistrationOptions::declare(OptionTable& table) {
  table.text("method", method, "Distance that is minimised between surfaces.",
             {"point", "plane", "generalised"});
  table.integer("dof", dof, "", "3: x, y and yaw of a levelled robot; 6: all degrees of freedom.", 3, 6);
  table.number("position_error_m", position_error_m, "m",
               "Expected error of the poses given (standard deviation); twice as far is searched.", 0, 5);
  table.number("yaw_error_deg", yaw_error_deg, "deg",
               "Expected error of the directions given (standard deviation); twice as far is searched.", 0,
               90);
  table.number("voxel_m", voxel_m, "m", "Cells of the finest level.", 0.005, 1);
  table.number("min_overlap", min_overlap, "", "A pair with less shared surface does not count as evidence.",
               0, 1);
  table.number("max_conflict", max_conflict, "",
               "A pair with more points in space that the other scan saw as free is refused.", 0, 1);
  table.number(
      "min_degeneracy", min_degeneracy, "",
      "A pair that is constrained less in its weakest direction, relative to its strongest, is refused.", 0,
      1);
  table.number("max_rmse_m", max_rmse_m, "m", "A pair whose surfaces fit worse is refused.", 0, 1);
  table.number("ambiguity_margin", ambiguity_margin, "",
               "A pair is ambiguous when another pose fits worse by less than this part of the surface.", 0,
               1);
}

PairAlignment align(const Scan& target, const Scan& source, const Isometry3d& target_from_source,
                    const RegistrationOptions& options) {
  const RegistrationOptions valid = checked(options);
  std::array<PreparedScan, 2> prepared;
  parallel_for(2, valid.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) prepared[i] = registration::prepare(i == 0 ? target : source, valid);
  });
  PairAlignment pair = registration::align_pair(prepared[0], prepared[1], target_from_source,
                                                registration::window_of(valid), valid);
  pair.target = 0;
  pair.source = 1;
  return pair;
}

RegistrationResult register_scans(const ScanSet& scans, const RegistrationOptions& options,
                                  Progress& progress) {
  const Stopwatch watch;
  const RegistrationOptions valid = checked(options);
  if (scans.scans.empty()) throw Error("there are no scans to register");
  const size_t count = scans.scans.size();
  progress.check(0, "preparing scans");
  std::vector<PreparedScan> prepared(count);
  parallel_for(count, valid.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) prepared[i] = registration::prepare(scans.scans[i], valid);
  });
  Registrar registrar(valid);
  for (size_t i = 0; i < count; ++i) {
    progress.check(0.3 + 0.6 * static_cast<double>(i) / static_cast<double>(count),
                   fmt::format("aligning scan {} of {}", i + 1, count));
    // Odometry drifts: only the pose relative to the previous scan is known.
    Isometry3d guess = scans.scans[i].map_from_scan;
    if (i > 0) {
      const Isometry3d& before = scans.scans[i - 1].map_from_scan;
      guess = registrar.result().map_from_scan[i - 1] * before.inverse() * guess;
    }
    registrar.add(std::move(prepared[i]), guess, window_of(scans.scans[i], valid),
                  expected_error(scans.scans[i], valid));
  }
  registrar.retry(registration::window_of(valid));
  progress.check(0.95, "solving the pose graph");
  registrar.solve();
  RegistrationResult result = registrar.result();
  result.seconds = watch.seconds();
  return result;
}

struct IncrementalRegistration::Impl {
  RegistrationOptions options;
  Registrar registrar;
};

IncrementalRegistration::IncrementalRegistration(const RegistrationOptions& options)
    : impl_(std::make_unique<Impl>(Impl{checked(options), Registrar(options)})) {}

IncrementalRegistration::~IncrementalRegistration() = default;

const RegistrationResult& IncrementalRegistration::add(const Scan& scan) {
  const Stopwatch watch;
  Registrar& registrar = impl_->registrar;
  registrar.add(registration::prepare(scan, impl_->options), scan.map_from_scan,
                window_of(scan, impl_->options), expected_error(scan, impl_->options));
  registrar.solve();
  registrar.result().seconds += watch.seconds();
  return registrar.result();
}

const RegistrationResult& IncrementalRegistration::retry() {
  const Stopwatch watch;
  impl_->registrar.retry(registration::window_of(impl_->options));
  impl_->registrar.solve();
  impl_->registrar.result().seconds += watch.seconds();
  return impl_->registrar.result();
}

const RegistrationResult& IncrementalRegistration::result() const {
  return impl_->registrar.result();
}

bool RegistrationResult::usable() const {
  return names.size() <= 1 ||
         std::any_of(pairs.begin(), pairs.end(), [](const PairAlignment& pair) { return pair.trusted; });
}

size_t RegistrationResult::connected_count() const {
  return static_cast<size_t>(std::count(connected.begin(), connected.end(), true));
}

std::string RegistrationResult::summary() const {
  const auto trusted =
      std::count_if(pairs.begin(), pairs.end(), [](const PairAlignment& p) { return p.trusted; });
  std::string text = fmt::format("{} of {} scans are connected by {} trusted of {} tried pairs",
                                 connected_count(), names.size(), trusted, pairs.size());
  for (size_t i = 0; i < names.size(); ++i) {
    if (connected[i]) continue;
    text += fmt::format("\n{} has no trusted connection and is placed by odometry only", names[i]);
    for (const PairAlignment& pair : pairs)
      if (!pair.trusted && (pair.source == i || pair.target == i))
        text +=
            fmt::format("; with {}: {}", names[pair.source == i ? pair.target : pair.source], pair.reason);
  }
  return text;
}

Json RegistrationResult::report() const {
  Json scans = Json::array();
  for (size_t i = 0; i < names.size(); ++i)
    scans.push_back({{"name", names[i]},
                     {"connected", static_cast<bool>(connected[i])},
                     {"placed_by", i == 0         ? "definition"
                                   : connected[i] ? "registration"
                                                  : "odometry"},
                     {"map_from_scan", values_from_pose(map_from_scan[i])}});
  Json list = Json::array();
  for (const PairAlignment& pair : pairs)
    list.push_back({{"target", names[pair.target]},
                    {"source", names[pair.source]},
                    {"trusted", pair.trusted},
                    {"reason", pair.reason},
                    {"overlap", pair.overlap},
                    {"rmse_m", pair.rmse_m},
                    {"degeneracy", pair.degeneracy},
                    {"conflict", pair.conflict},
                    {"target_from_source", values_from_pose(pair.target_from_source)}});
  return {{"usable", usable()},
          {"connected", connected_count()},
          {"scans", scans},
          {"pairs", list},
          {"seconds", seconds}};
}

bool origins_fit(const Scan& scan) {
  return registration::FreeSpace(scan, Isometry3d::Identity()).plausible();
}

}  // namespace loci::mapping
