#pragma once

#include "mapping/registration/pair.h"
#include "mapping/registration/pose_graph.h"

namespace loci::mapping::registration {

/// Scans that were added, the pairs that were aligned among them, and the poses that follow: what
/// register_scans and IncrementalRegistration share.
class Registrar {
 public:
  explicit Registrar(const RegistrationOptions& options);

  /// Aligns a scan with those before it that it may overlap, the likeliest first with a search over the whole
  /// window; once it is connected the others only need to be refined. `expected` is the standard deviation of
  /// where the scan stands beside the one before it.
  void add(PreparedScan scan, const Isometry3d& map_from_scan, const SearchWindow& window,
           const SearchWindow& expected);
  /// Tries pairs of scans with and without connection again, as poses are known better now.
  void retry(const SearchWindow& window);
  /// Poses of all scans from all trusted pairs; pairs that contradict the others lose their trust. Parts of
  /// the graph that no trusted pair ties together are held beside one another by odometry.
  void solve();

  const RegistrationResult& result() const { return result_; }
  RegistrationResult& result() { return result_; }
  size_t size() const { return scans_.size(); }

 private:
  struct Partner {
    size_t scan = 0;
    double overlap = 0;
  };

  std::vector<Partner> partners_of(size_t scan, size_t end, double reach) const;
  PairAlignment aligned(size_t target, size_t source, const SearchWindow& window) const;
  bool connect(size_t scan, const std::vector<Partner>& partners, const SearchWindow& window);
  void refine(size_t scan, const std::vector<Partner>& partners, const SearchWindow& window);
  void put(PairAlignment pair);
  void spread();

  RegistrationOptions options_;
  std::vector<PreparedScan> scans_;
  std::vector<size_t> root_;    ///< the first scan of the part of the graph that each scan belongs to
  std::vector<Edge> odometry_;  ///< from each scan to the next
  RegistrationResult result_;
};

}  // namespace loci::mapping::registration
