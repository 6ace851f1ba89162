#include "mapping/registration/registrar.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/parallel.h"
#include "mapping/registration/icp.h"

namespace loci::mapping::registration {
namespace {

/// A pair is tried when the guess promises this part of the overlap that is wanted.
constexpr double kPromising = 0.5;
/// A scan is searched for against so many others at most before it counts as unconnected.
constexpr size_t kSearchesMax = 6;
/// What remains to be found of a pair whose scans are both connected.
constexpr SearchWindow kRefine = {0.05, 0.02};
/// Two parts of the graph that stand by odometry are both off: the window between them is wider.
constexpr double kBothOff = 1.5;
/// Odometry is not taken to be better than this.
constexpr SearchWindow kOdometryBest = {0.005, 0.002};
/// An edge that is off by more standard deviations than this contradicts the others.
constexpr double kContradiction = 12;

/// What is known of a scan that was driven to: deviations are those of the scan itself, turned about its own
/// origin.
Edge odometry_edge(size_t target, const Isometry3d& target_from_source, const SearchWindow& expected) {
  const double position = std::max(expected.position, kOdometryBest.position);
  const double angle = std::max(expected.angle, kOdometryBest.angle);
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << Vector3d::Constant(1 / (position * position)),
      Vector3d::Constant(1 / (angle * angle));
  // A turn about the target's origin moves the scan as well: that motion is not its own.
  const Vector3d t = target_from_source.translation();
  Matrix6d own = Matrix6d::Identity();
  own.topRightCorner<3, 3>() << 0, t.z(), -t.y(), -t.z(), 0, t.x(), t.y(), -t.x(), 0;
  return {target, target + 1, target_from_source, own.transpose() * information * own};
}

}  // namespace

Registrar::Registrar(const RegistrationOptions& options) : options_(options) {}

void Registrar::add(PreparedScan scan, const Isometry3d& map_from_scan, const SearchWindow& window,
                    const SearchWindow& expected) {
  const size_t added = scans_.size();
  if (added > 0)
    odometry_.push_back(
        odometry_edge(added - 1, result_.map_from_scan[added - 1].inverse() * map_from_scan, expected));
  result_.names.push_back(scan.name);
  result_.map_from_scan.push_back(map_from_scan);
  scans_.push_back(std::move(scan));
  root_.push_back(added);
  const std::vector<Partner> partners = partners_of(added, added, window.position);
  if (connect(added, partners, window)) refine(added, partners, window);
  spread();
}

void Registrar::retry(const SearchWindow& window) {
  for (size_t scan = 1; scan < scans_.size(); ++scan) {
    if (root_[scan] == 0) continue;
    std::vector<Partner> partners = partners_of(scan, scans_.size(), window.position);
    std::erase_if(partners, [&](const Partner& partner) { return root_[partner.scan] != 0; });
    if (connect(scan, partners, window)) refine(scan, partners, window);
    spread();
  }
}

/// Scans before `end` that may share enough surface, the most first; those with connection before others.
std::vector<Registrar::Partner> Registrar::partners_of(size_t scan, size_t end, double reach) const {
  std::vector<Partner> partners;
  const Isometry3d& pose = result_.map_from_scan[scan];
  for (size_t other = 0; other < end; ++other) {
    if (other == scan) continue;
    const Isometry3d other_from_scan = result_.map_from_scan[other].inverse() * pose;
    const double overlap = std::max(expected_overlap(scans_[other], scans_[scan], other_from_scan),
                                    expected_overlap(scans_[scan], scans_[other], other_from_scan.inverse()));
    // A wide window may bring more into reach than the guess shows.
    const double wanted = kPromising * options_.min_overlap / (1 + reach);
    if (overlap >= wanted) partners.push_back({other, overlap});
  }
  std::stable_sort(partners.begin(), partners.end(),
                   [](const Partner& a, const Partner& b) { return a.overlap > b.overlap; });
  return partners;
}

PairAlignment Registrar::aligned(size_t target, size_t source, const SearchWindow& window) const {
  const Isometry3d guess = result_.map_from_scan[target].inverse() * result_.map_from_scan[source];
  PairAlignment pair = align_pair(scans_[target], scans_[source], guess, window, options_);
  pair.target = target;
  pair.source = source;
  return pair;
}

/// Searches until one pair is trusted, and moves the scan there.
bool Registrar::connect(size_t scan, const std::vector<Partner>& partners, const SearchWindow& window) {
  size_t searches = 0;
  for (const Partner& partner : partners) {
    if (++searches > kSearchesMax) break;
    PairAlignment pair = aligned(partner.scan, scan, window);
    const bool trusted = pair.trusted;
    if (trusted) result_.map_from_scan[scan] = result_.map_from_scan[partner.scan] * pair.target_from_source;
    put(std::move(pair));
    if (!trusted) continue;
    spread();
    return true;
  }
  return false;
}

/// Aligns a connected scan with the others that it overlaps: those of its part of the graph are where they
/// are, others may be anywhere in a window that is wider, as both parts are off.
void Registrar::refine(size_t scan, const std::vector<Partner>& partners, const SearchWindow& window) {
  std::vector<PairAlignment> pairs(partners.size());
  const SearchWindow between = {kBothOff * window.position, kBothOff * window.angle};
  parallel_for(partners.size(), options_.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t other = partners[i].scan;
      pairs[i] = aligned(other, scan, root_[other] == root_[scan] ? kRefine : between);
    }
  });
  for (PairAlignment& pair : pairs) put(std::move(pair));
}

/// One verdict per pair: a trusted one stays, otherwise the later one.
void Registrar::put(PairAlignment pair) {
  for (PairAlignment& known : result_.pairs) {
    const bool same = known.target == pair.target && known.source == pair.source;
    const bool turned = known.target == pair.source && known.source == pair.target;
    if (!same && !turned) continue;
    if (!known.trusted) known = std::move(pair);
    return;
  }
  result_.pairs.push_back(std::move(pair));
}

/// Follows trusted pairs from each part's first scan. A part that is newly reached moves as a whole: its
/// scans stay where they are beside each other.
void Registrar::spread() {
  std::vector<size_t> part = root_;
  std::vector<bool> reached(scans_.size(), false);
  const auto join = [&](size_t at, size_t next, const Isometry3d& at_from_next) {
    const Isometry3d move = result_.map_from_scan[at] * at_from_next * result_.map_from_scan[next].inverse();
    const size_t joining = part[next];
    for (size_t i = 0; i < part.size(); ++i) {
      if (part[i] != joining) continue;
      result_.map_from_scan[i] = move * result_.map_from_scan[i];
      part[i] = part[at];
    }
  };
  for (size_t first = 0; first < scans_.size(); ++first) {
    if (reached[first]) continue;
    std::vector<size_t> open = {first};
    reached[first] = true;
    while (!open.empty()) {
      const size_t at = open.back();
      open.pop_back();
      root_[at] = first;
      for (const PairAlignment& pair : result_.pairs) {
        if (!pair.trusted || (pair.target != at && pair.source != at)) continue;
        const bool forward = pair.target == at;
        const size_t next = forward ? pair.source : pair.target;
        if (reached[next]) continue;
        reached[next] = true;
        open.push_back(next);
        if (part[next] != part[at])
          join(at, next, forward ? pair.target_from_source : pair.target_from_source.inverse());
      }
    }
  }
}

void Registrar::solve() {
  for (int round = 0; round < 3; ++round) {
    spread();
    std::vector<Edge> edges;
    std::vector<PairAlignment*> pairs;
    for (PairAlignment& pair : result_.pairs) {
      if (!pair.trusted) continue;
      edges.push_back({pair.target, pair.source, pair.target_from_source, pair.information});
      pairs.push_back(&pair);
    }
    for (const Edge& edge : odometry_)
      if (root_[edge.target] != root_[edge.source]) edges.push_back(edge);
    std::vector<bool> fixed(scans_.size(), false);
    fixed[0] = true;
    const std::vector<double> off = solve_pose_graph(result_.map_from_scan, fixed, edges, options_.dof == 3);
    bool contradiction = false;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (off[i] < kContradiction) continue;
      pairs[i]->trusted = false;
      pairs[i]->reason = "contradicts the other pairs";
      contradiction = true;
    }
    if (!contradiction) break;
  }
  spread();
  result_.connected.resize(scans_.size());
  for (size_t i = 0; i < scans_.size(); ++i) result_.connected[i] = root_[i] == 0;
}

}  // namespace loci::mapping::registration
