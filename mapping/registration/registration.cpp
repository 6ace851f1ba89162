#include "mapping/registration/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
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

/// Standard deviations of the scan's pose where a covariance is given, otherwise what the options expect.
SearchWindow expected_error(const Scan& scan, const RegistrationOptions& options) {
  if (scan.covariance.isZero(0)) return {options.position_error_m, options.yaw_error_deg * kPi / 180};
  const auto variance = scan.covariance.diagonal();
  return {std::sqrt(std::max(0.0, variance.head<3>().maxCoeff())),
          std::sqrt(std::max(0.0, variance.tail<3>().maxCoeff()))};
}

/// Three standard deviations where a covariance is given, otherwise what the options ask for.
SearchWindow window_of(const Scan& scan, const RegistrationOptions& options) {
  if (scan.covariance.isZero(0)) return registration::window_of(options);
  const SearchWindow expected = expected_error(scan, options);
  return {3 * expected.position, 3 * expected.angle};
}

}  // namespace

void RegistrationOptions::declare(OptionTable& table) {
  table.text("method", method, "How surfaces are brought together.", {"point", "plane", "generalised"});
  table.integer("dof", dof, "", "3: x, y and yaw of a levelled robot; 6: all degrees of freedom.", 3, 6);
  table.number("position_error_m", position_error_m, "m",
               "Expected error of the poses given (standard deviation); twice as far is searched.", 0, 5);
  table.number("yaw_error_deg", yaw_error_deg, "deg",
               "Expected error of the directions given (standard deviation); twice as far is searched.", 0,
               90);
  table.number("voxel_m", voxel_m, "m", "Cells of the finest level.", 0.005, 1);
  table.number("min_overlap", min_overlap, "", "A pair with less shared surface is no evidence.", 0, 1);
  table.number("max_conflict", max_conflict, "",
               "A pair with more points in space that the other scan saw to be free is refused.", 0, 1);
  table.number("min_degeneracy", min_degeneracy, "",
               "A pair that is held less in its weakest direction (against its strongest) may slide.", 0, 1);
  table.number("rmse_max_m", rmse_max_m, "m", "A pair whose surfaces fit worse is refused.", 0, 1);
  table.number("rival_gap", rival_gap, "",
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
    // Odometry drifts: what is known of a scan is its pose beside the one before it.
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

const RegistrationResult& IncrementalRegistration::result() const {
  return impl_->registrar.result();
}

}  // namespace loci::mapping
