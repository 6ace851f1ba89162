#include "mapping/update/update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/stopwatch.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/registration/pair.h"
#include "mapping/update/epoch.h"
#include "mapping/update/motion.h"
#include "mapping/update/open_front.h"
#include "mapping/update/parameters.h"
#include "mapping/update/pieces.h"
#include "mapping/update/updated_map.h"

namespace loci::mapping {
namespace {

using registration::CellGrid;
using registration::Surfels;

constexpr int kUnexplained = -2, kStatic = -1;  // Owners of a surfel; others are numbers of pieces.

/// The scans at their poses after a correction of the frame.
ScanSet moved_scans(ScanSet scans, const Isometry3d& map_from_new) {
  for (Scan& scan : scans.scans) scan.map_from_scan = map_from_new * scan.map_from_scan;
  return scans;
}

/// Registers the new surface with the old one.
PairAlignment aligned(const ScanSet& before, const ScanSet& now, const UpdateOptions& options) {
  const Epoch old_epoch(before, kEpochs.coarse_m, options.threads),
      new_epoch(now, kEpochs.coarse_m, options.threads);
  RegistrationOptions registration = epoch_options(kEpochs.coarse_m);
  registration.position_error_m = options.position_error_m;
  registration.yaw_error_deg = options.yaw_error_deg;
  PairAlignment pair = align_pair(old_epoch.prepared(), new_epoch.prepared(), Isometry3d::Identity(),
                                  registration::window_of(registration), registration);
  if (!pair.trusted)
    throw Error("the new scans do not fit the map: " + pair.reason, {},
                "they must show walls or cabinets that the map has, from poses that are off by at most twice "
                "--position-error-m and --yaw-error-deg");
  return pair;
}

Epoch clean_epoch(const ScanSet& scans, int threads) {
  Epoch epoch(scans, kEpochs.cell_m, threads);
  epoch.drop_flying_points(threads);
  return epoch;
}

/// The comparison of two epochs of one room.
class EpochComparison {
 public:
  EpochComparison(const World& world, const SemanticMap& semantics, const ScanSet& before, const ScanSet& now,
                  const UpdateOptions& options)
      : world_(world),
        semantics_(semantics),
        before_set_(before),
        now_set_(now),
        options_(options),
        outlines_(outlines_of(semantics)),
        before_(clean_epoch(before, options.threads)),
        now_(clean_epoch(now, options.threads)),
        piece_of_(before_.surface().size(), kStatic),
        owner_(now_.surface().size(), kStatic),
        dropped_before_(before_.surface().size(), 0),
        dropped_now_(now_.surface().size(), 0) {}

  void run(Progress& progress, UpdateResult& result) {
    find_pieces();
    own_surfels();
    progress.check(0.3, "furniture");
    find_motions(progress);
    progress.check(0.7, "joints");
    find_joints();
    find_new();
    result.changes = std::move(changes_);
    std::erase_if(result.changes,
                  [&](const MapChange& change) { return change.probability < options_.min_probability; });
    result.unchanged = std::move(unchanged_);
  }

  const Epoch& before() const { return before_; }
  const Epoch& now() const { return now_; }
  const std::vector<uint8_t>& dropped_before() const { return dropped_before_; }
  const std::vector<uint8_t>& dropped_now() const { return dropped_now_; }
  /// The surfels of the new surface that nothing of the map explains.
  std::vector<uint8_t> unexplained() const {
    std::vector<uint8_t> chosen(owner_.size(), 0);
    for (size_t i = 0; i < owner_.size(); ++i) chosen[i] = owner_[i] == kUnexplained ? 1 : 0;
    return chosen;
  }

 private:
  void find_pieces() {
    pieces_ =
        free_standing_pieces(before_.surface(), std::vector<uint8_t>(before_.surface().size(), 1), outlines_);
    for (size_t k = 0; k < pieces_.size(); ++k)
      for (const uint32_t i : pieces_[k].surfels) piece_of_[i] = static_cast<int>(k);
    name_pieces(before_.surface(), semantics_, pieces_);
    link_fronts();
  }

  /// Fronts move with the piece whose surface they are.
  void link_fronts() {
    for (const Front& front : fronts_of(world_, semantics_)) {
      std::vector<size_t> votes(pieces_.size(), 0);
      size_t all = 0;
      for (uint32_t i = 0; i < before_.surface().size(); ++i) {
        if (!on_front(front, before_.surface().position[i])) continue;
        ++all;
        if (piece_of_[i] >= 0) ++votes[static_cast<size_t>(piece_of_[i])];
      }
      for (size_t k = 0; k < pieces_.size(); ++k)
        if (2 * votes[k] > all)
          if (const auto link = front_link(front.name, semantics_)) pieces_[k].links.push_back(*link);
    }
  }

  static bool is_floor(const Eigen::Vector3f& position) {
    return static_cast<double>(position.z()) < kPieces.floor_m;
  }

  void own_surfels() {
    const Surfels &now = now_.surface(), &before = before_.surface();
    const float radius = 1.5F * static_cast<float>(before.cell);
    for (uint32_t i = 0; i < now.size(); ++i) {
      if (is_floor(now.position[i])) continue;
      uint32_t j = same_surfel(before, now.position[i], now.normal[i]);
      if (j == CellGrid::kNone) j = before.nearest(now.position[i], Eigen::Vector3f::Zero(), radius);
      // The floor does not explain what stands on it.
      owner_[i] = j == CellGrid::kNone || is_floor(before.position[j]) ? kUnexplained : piece_of_[j];
    }
    continue_planes();
  }

  /// Parts of cabinets and walls that were hidden before continue planes of what does not move: they are no
  /// furniture that came. What stands where space was free was not hidden, and stray points that were left
  /// over beside furniture are no planes.
  void continue_planes() {
    const std::vector<int> owners = owner_;
    const Surfels& now = now_.surface();
    const auto is_known = [&](uint32_t i) { return owners[i] == kStatic && !is_floor(now.position[i]); };
    const auto was_hidden = [&](uint32_t i) {
      return owners[i] == kUnexplained && !before_.passed(now.position[i], now.normal[i]);
    };
    std::vector<uint8_t> visited(owner_.size(), 0);
    for (uint32_t i = 0; i < owner_.size(); ++i) {
      if (visited[i] != 0 || !is_known(i)) continue;
      const std::vector<uint32_t> plane = coplanar_region({i}, visited, is_known);
      if (plane.size() < kPieces.min_surfels) continue;
      for (const uint32_t j : coplanar_region(plane, visited, was_hidden)) owner_[j] = kStatic;
    }
  }

  /// The surfels that are connected to some in their planes, and these; `may_join` chooses them.
  template <class MayJoin>
  std::vector<uint32_t> coplanar_region(std::vector<uint32_t> region, std::vector<uint8_t>& visited,
                                        const MayJoin& may_join) const {
    for (const uint32_t i : region) visited[i] = 1;
    for (size_t at = 0; at < region.size(); ++at)
      for_neighbours(region[at], [&](uint32_t j) {
        if (visited[j] != 0 || !may_join(j) || !coplanar(region[at], j)) return;
        visited[j] = 1;
        region.push_back(j);
      });
    return region;
  }

  bool coplanar(uint32_t i, uint32_t j) const {
    const Surfels& now = now_.surface();
    if (now.weight[i] <= 0.F || now.weight[j] <= 0.F) return false;
    const Eigen::Vector3f between = now.position[j] - now.position[i];
    return now.normal[i].dot(now.normal[j]) > kEpochs.same_plane_cosine &&
           std::abs(now.normal[i].dot(between)) < kEpochs.same_plane_m &&
           std::abs(now.normal[j].dot(between)) < kEpochs.same_plane_m;
  }

  /// Visits the surfels within two cells.
  template <class Visit>
  void for_neighbours(uint32_t i, const Visit& visit) const {
    const Surfels& now = now_.surface();
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z) {
          const uint32_t j = now.grid.find(now.cells[i] + Eigen::Vector3i(x, y, z));
          if (j != CellGrid::kNone && j != i) visit(j);
        }
  }

  void find_joints() {
    for (const Front& front : fronts_of(world_, semantics_)) {
      if (went_along(front)) continue;
      const auto open = open_front(front, {before_set_, before_}, {now_set_, now_}, unexplained());
      if (open) add_open(front, *open);
    }
  }

  /// Whether a front belongs to a piece that moved or is gone.
  bool went_along(const Front& front) const {
    const auto link = front_link(front.name, semantics_);
    for (size_t k = 0; link && k < pieces_.size(); ++k)
      if (left_[k] && std::ranges::find(pieces_[k].links, *link) != pieces_[k].links.end()) return true;
    return false;
  }

  void add_open(const Front& front, const OpenFront& open) {
    MapChange change;
    change.kind = MapChange::Kind::opened;
    change.name = front.name;
    change.class_name = front.class_name;
    change.joint_position = open.position;
    change.prismatic = open.joint.type == ArticulationType::prismatic;
    change.centre = front.centre;
    change.height = front.centre.z() + front.height / 2;
    if (const auto link = front_link(front.name, semantics_)) change.links = {*link};
    change.probability = open.probability;
    change.reason = open.reason;
    change.scans = explain(open.surfels);
    changes_.push_back(std::move(change));
  }

  /// Marks surfels that an open front explains, which do not show the room at rest; the scans that show them.
  std::vector<std::string> explain(const std::vector<uint32_t>& surfels) {
    std::vector<uint8_t> shown(now_.surface().size(), 0);
    for (const uint32_t i : surfels) {
      owner_[i] = kStatic;
      shown[i] = dropped_now_[i] = 1;
    }
    return scans_showing(shown);
  }

  std::vector<std::string> scans_showing(const std::vector<uint8_t>& shown) const {
    std::vector<std::string> names;
    const std::vector<size_t> counts = now_.points_by_scan(shown);
    for (size_t i = 0; i < counts.size(); ++i)
      if (counts[i] >= kChanges.min_scan_points) names.push_back(now_.scan_names()[i]);
    return names;
  }

  /// Surfels that may show a piece: unexplained ones, its own place, and places of pieces that left.
  std::vector<uint8_t> target_of(size_t piece) const {
    std::vector<uint8_t> chosen(owner_.size(), 0);
    for (size_t i = 0; i < owner_.size(); ++i)
      chosen[i] = owner_[i] == kUnexplained || owner_[i] == static_cast<int>(piece) ||
                  (owner_[i] >= 0 && left_[static_cast<size_t>(owner_[i])]);
    return chosen;
  }

  std::vector<uint8_t> unexplained_or_vacated() const {
    std::vector<uint8_t> chosen(owner_.size(), 0);
    for (size_t i = 0; i < owner_.size(); ++i)
      chosen[i] = owner_[i] == kUnexplained || (owner_[i] >= 0 && left_[static_cast<size_t>(owner_[i])]);
    return chosen;
  }

  /// Whether a piece is seen in its old place about as well as elsewhere, or turned: pieces look alike, and
  /// many look the same from behind.
  static bool fits_as_well(const PieceMotion& motion, const PieceFit& still) {
    return still.agreement() >= kMotion.min_agreement &&
           static_cast<double>(still.same) >= kMotion.as_good * static_cast<double>(motion.fit.same);
  }

  /// Surfels that were there and are free now, or the other way round. What was hidden before, or is now,
  /// does not show that anything changed.
  static size_t changed_space(const PieceMotion& motion, const PieceFit& still) {
    return still.free + motion.arrived;
  }

  static double evidence_of(const PieceMotion& motion, const PieceFit& still) {
    if (!motion.jump) return motion.gain;
    return std::min(motion.gain, static_cast<double>(changed_space(motion, still)));
  }

  /// Whether a pose is good enough. Where nothing contradicts that the piece stands in its old place, it
  /// stays there if it is seen there; otherwise a part of it is not enough: another piece has such parts,
  /// too.
  static bool accepted(const PieceMotion& motion, const PieceFit& still) {
    const auto all = static_cast<double>(still.all());
    if (motion.jump &&
        (fits_as_well(motion, still) || changed_space(motion, still) < kMotion.min_gain_surfels))
      return false;
    const bool contradicted =
        still.contradictions() >= motion.fit.contradictions() + kMotion.min_gain_surfels;
    if (!contradicted && static_cast<double>(still.same) >= kMotion.min_share * all) return false;
    const double share = contradicted ? kMotion.min_share : kMotion.min_share_unseen;
    const double min_gain = std::max(static_cast<double>(kMotion.min_gain_surfels), kMotion.min_gain * all);
    return motion.gain >= min_gain && motion.fit.agreement() >= kMotion.min_agreement &&
           static_cast<double>(motion.fit.same) >= share * all;
  }

  bool is_motion(const Piece& piece, const Isometry3d& now_from_before) const {
    const Vector3d centre = piece.box.center().cast<double>();
    return (now_from_before * centre - centre).norm() > options_.min_move_m ||
           Eigen::AngleAxisd(now_from_before.linear()).angle() > options_.min_move_deg * kDegree;
  }

  void find_motions(Progress& progress) {
    std::vector<PieceSearch> searches;
    std::vector<PieceFit> still;
    left_.assign(pieces_.size(), false);
    for (size_t k = 0; k < pieces_.size(); ++k) {
      searches.emplace_back(before_, now_, pieces_[k]);
      still.push_back(searches[k].fit(now_.surface(), Isometry3d::Identity()));
      still[k].foreign = searches[k].foreign(now_.prepared_part(target_of(k), kEpochs.cell_m).finest(),
                                             Isometry3d::Identity());
      left_[k] = still[k].free >= kMotion.min_gain_surfels && still[k].agreement() < 1 - kMotion.left_share;
    }
    std::vector<std::optional<PieceMotion>> found(pieces_.size());
    for (size_t k = 0; k < pieces_.size(); ++k) {
      progress.check(0.3 + 0.4 * static_cast<double>(k) / static_cast<double>(pieces_.size()), "furniture");
      found[k] = motion_of(k, searches[k], still[k]);
    }
    std::vector<bool> resolved(pieces_.size(), false);
    for (;;) {
      size_t best = pieces_.size();
      for (size_t k = 0; k < pieces_.size(); ++k)
        if (found[k] && (best == pieces_.size() || found[k]->rank > found[best]->rank)) best = k;
      if (best == pieces_.size()) break;
      resolved[best] = true;
      add_motion(best, *found[best], still[best]);
      found[best].reset();
      // What one piece explains does not speak for another.
      for (size_t k = 0; k < pieces_.size(); ++k)
        if (found[k] &&
            !still_found(*found[k], searches[k], now_.prepared_part(target_of(k), kEpochs.cell_m)))
          found[k] = motion_of(k, searches[k], still[k]);
    }
    for (size_t k = 0; k < pieces_.size(); ++k)
      if (!resolved[k]) settle(k, still[k]);
  }

  /// The motion of a piece that moved; unset for one that is better explained at its old place or nowhere.
  std::optional<PieceMotion> motion_of(size_t k, const PieceSearch& search, const PieceFit& still) const {
    const std::vector<uint8_t> target = target_of(k);
    auto motion = search.find(now_.prepared_part(target, kEpochs.cell_m), boxes_of_components());
    if (!motion || !accepted(*motion, still)) return std::nullopt;
    search.refine(target, *motion);
    return is_motion(pieces_[k], motion->now_from_before) ? motion : std::nullopt;
  }

  static bool still_found(const PieceMotion& motion, const PieceSearch& search,
                          const registration::PreparedScan& target) {
    const PieceFit fit = search.fit(target.finest(), motion.now_from_before);
    return static_cast<double>(fit.same) >= kMotion.min_kept * static_cast<double>(motion.fit.same);
  }

  std::vector<Eigen::AlignedBox3f> boxes_of_components() const {
    std::vector<Eigen::AlignedBox3f> boxes;
    for (const Piece& component :
         components_of(now_.surface(), unexplained_or_vacated(), {outlines_.walls, {}}))
      boxes.push_back(component.box);
    return boxes;
  }

  /// The new surfels that a piece explains at its new pose belong to it.
  std::vector<uint8_t> claim(size_t piece, const Isometry3d& now_from_before) {
    const std::vector<uint8_t> target = target_of(piece);
    const Isometry3d before_from_now = now_from_before.inverse();
    const Eigen::Matrix3f turn = before_from_now.linear().cast<float>();
    const Eigen::Vector3f shift = before_from_now.translation().cast<float>();
    Eigen::AlignedBox3f box = pieces_[piece].box;
    box.min().array() -= 0.05F;
    box.max().array() += 0.05F;
    std::vector<uint8_t> claimed(owner_.size(), 0);
    const Surfels& before = before_.surface();
    for (uint32_t i = 0; i < owner_.size(); ++i) {
      if (target[i] == 0) continue;
      const Eigen::Vector3f p = turn * now_.surface().position[i] + shift;
      if (!box.contains(p)) continue;
      // Sides that were hidden before lie within its outline.
      const uint32_t j = before.nearest(p, Eigen::Vector3f::Zero(), 1.5F * static_cast<float>(before.cell));
      const bool own = j != CellGrid::kNone && piece_of_[j] == static_cast<int>(piece);
      if (own || inside(pieces_[piece].outline, p.head<2>().cast<double>(), 0.01)) {
        claimed[i] = 1;
        owner_[i] = kStatic;
      }
    }
    return claimed;
  }

  void drop_before(size_t piece) {
    for (const uint32_t i : pieces_[piece].surfels) dropped_before_[i] = 1;
  }

  MapChange change_of(const Piece& piece) const {
    MapChange change;
    change.name = piece.name;
    change.class_name = piece.class_name;
    change.centre = piece.box.center().cast<double>();
    change.height = static_cast<double>(piece.box.max().z());
    change.links = piece.links;
    return change;
  }

  void add_motion(size_t piece, const PieceMotion& motion, const PieceFit& still) {
    MapChange change = change_of(pieces_[piece]);
    change.kind = MapChange::Kind::moved;
    change.now_from_before = motion.now_from_before;
    change.outline_before = pieces_[piece].outline;
    for (const Vector2d& corner : change.outline_before)
      change.outline_now.push_back((motion.now_from_before * Vector3d(corner.x(), corner.y(), 0)).head<2>());
    change.probability = change_probability(evidence_of(motion, still));
    change.reason =
        fmt::format("{} of {} surfels found at the new place, {} contradicted; at the old one {} and {}",
                    motion.fit.same, motion.fit.all(), motion.fit.free, still.same, still.free);
    left_[piece] = true;
    change.scans = scans_showing(claim(piece, motion.now_from_before));
    drop_before(piece);
    changes_.push_back(std::move(change));
  }

  /// A piece that did not move: it is gone, still there, or was not seen.
  void settle(size_t k, const PieceFit& still) {
    if (!left_[k] ||
        static_cast<double>(still.same + still.free) < kMotion.min_share * static_cast<double>(still.all())) {
      unchanged_.push_back(
          {pieces_[k].name, pieces_[k].outline,
           static_cast<double>(still.same) > kMotion.min_share * static_cast<double>(still.all())});
      left_[k] = false;
      return;
    }
    MapChange change = change_of(pieces_[k]);
    change.kind = MapChange::Kind::gone;
    change.outline_before = pieces_[k].outline;
    change.probability =
        change_probability(static_cast<double>(still.free) - static_cast<double>(still.same));
    change.reason = fmt::format("rays passed through {} of {} surfels, {} are still seen", still.free,
                                still.all(), still.same);
    for (size_t scan = 0; scan < now_.scan_names().size(); ++scan) {
      size_t passing = 0;
      for (const uint32_t i : pieces_[k].surfels)
        passing += now_.passed(scan, before_.surface().position[i]) ? 1 : 0;
      if (passing >= kMotion.min_gain_surfels) change.scans.push_back(now_.scan_names()[scan]);
    }
    drop_before(k);
    changes_.push_back(std::move(change));
  }

  /// Pieces that the map does not explain.
  void find_new() {
    std::vector<Piece> fresh =
        free_standing_pieces(now_.surface(), unexplained_or_vacated(), {outlines_.walls, {}});
    SemanticMap named = semantics_;  // Names of pieces that are known already are taken.
    for (const Piece& piece : pieces_) named.extra["pieces"][piece.name] = Json::object();
    name_pieces(now_.surface(), named, fresh);
    for (const Piece& piece : fresh) {
      size_t free = 0;
      std::vector<uint8_t> shown(owner_.size(), 0);
      for (const uint32_t i : piece.surfels) {
        free += before_.passed(now_.surface().position[i], now_.surface().normal[i]) ? 1 : 0;
        shown[i] = 1;
      }
      const auto size = static_cast<double>(piece.surfels.size());
      MapChange change = change_of(piece);
      change.kind = static_cast<double>(free) > kChanges.min_free_share * size ? MapChange::Kind::came
                                                                               : MapChange::Kind::seen_first;
      change.outline_now = piece.outline;
      change.probability =
          change_probability(change.kind == MapChange::Kind::came ? static_cast<double>(free) : size / 2);
      change.reason =
          fmt::format("{} surfels that the map does not explain, {} of them in space that was free",
                      piece.surfels.size(), free);
      change.scans = scans_showing(shown);
      changes_.push_back(std::move(change));
    }
  }

  const World& world_;
  const SemanticMap& semantics_;
  const ScanSet& before_set_;
  const ScanSet& now_set_;
  const UpdateOptions& options_;
  MapOutlines outlines_;
  Epoch before_, now_;
  std::vector<Piece> pieces_;
  std::vector<int> piece_of_;                          ///< of each surfel before
  std::vector<int> owner_;                             ///< of each surfel now
  std::vector<bool> left_;                             ///< whether a piece's old place is empty
  std::vector<uint8_t> dropped_before_, dropped_now_;  ///< surfels that do not show the room at rest
  std::vector<MapChange> changes_;
  std::vector<UnchangedPiece> unchanged_;
};

void check_scans(const ScanSet& scans, const char* which) {
  if (scans.scans.empty()) throw Error(fmt::format("there are no {} scans", which));
  if (!scans.free_space)
    throw Error(
        fmt::format("the {} scans do not say where they were taken from: nothing is known to be free", which),
        {}, "give a folder with a scans.yaml, as loci-map fuse writes it");
  if (!scans.levelled)
    throw Error(fmt::format("which way is up in the {} scans is not known", which), {},
                "write 'levelled: true' in their scans.yaml if z is up; of a recording --up says it");
}

}  // namespace

void UpdateOptions::declare(OptionTable& table) {
  table.number("position_error_m", position_error_m, "m",
               "Expected error (σ) of the new scans in the map frame.", 0, 3);
  table.number("yaw_error_deg", yaw_error_deg, "deg", "Expected error (σ) of the new scans' yaw.", 0, 90);
  table.number("min_move_m", min_move_m, "m", "Furniture that moved less has not moved.", 0.01, 1);
  table.number("min_move_deg", min_move_deg, "deg", "Furniture that turned less has not turned.", 0.5, 45);
  table.number("min_probability", min_probability, "", "Less probable changes are not reported.", 0, 1);
}

UpdateResult update(const World& world, const SemanticMap& semantics, const ScanSet& before,
                    const ScanSet& now, const UpdateOptions& options, Progress& progress) {
  UpdateOptions checked = options;
  table_of(checked).validate({"", 0, "update"});
  check_scans(before, "earlier");
  check_scans(now, "new");
  const Stopwatch watch;
  UpdateResult result;
  progress.check(0, "registration");
  const PairAlignment pair = aligned(before, now, options);
  result.map_from_new = pair.target_from_source;
  result.overlap = pair.overlap;
  const ScanSet placed = moved_scans(now, result.map_from_new);
  progress.check(0.15, "surfaces");
  EpochComparison comparison(world, semantics, before, placed, options);
  comparison.run(progress, result);
  PartialProgress interpreting(progress, 0.8, 1);
  result.scans =
      current_scans({before, comparison.before().surface(), comparison.dropped_before()},
                    {placed, comparison.now().surface(), comparison.dropped_now()}, result.changes);
  result.map = updated_map(world, semantics, comparison.now().surface(), comparison.unexplained(), result,
                           options.threads, interpreting);
  result.seconds = watch.seconds();
  return result;
}

}  // namespace loci::mapping
