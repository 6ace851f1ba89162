#include "perception/annotators/structure/moved_furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/parallel.h"
#include "mapping/world/free_standing.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/articulated_fronts.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {
namespace {

using mapping::kFurnitureMotion;

struct SearchParameters {
  double tolerance_m = 0.02;     ///< plus twice the noise: the filter's own
  double same_normal = 0.8;      ///< cosine
  double min_through = 12;       ///< samples that are looked through, and …
  double through_share = 0.08;   ///< … of those seen, for a piece to be looked for: edges are less
  double max_evidence = 6;       ///< log odds of one frame: its samples share its errors
  double decided = 2;            ///< log odds
  double cell_m = 0.1;           ///< between starting poses
  double turn = 15 * kDegree;    ///< between starting poses
  double finest_m = 0.002;       ///< of the descent
  double level_m = 0.04;         ///< points so near to a piece's level may be of its top
  size_t samples = 160;          ///< per starting pose
  double as_good = 0.92;         ///< of the best score: a pose elsewhere that is as good
  int stride = 4;                ///< pixels between points that starts are made of
  double min_agreement = 0.5;    ///< of the rest of the map with the frame, for a place to be empty
  double agreement_gain = 0.03;  ///< of the rest of the map, for the camera's pose to be right
  double pose_errors = 1.5;      ///< a motion of more expected errors of the pose is none of the camera
  double pose_shift_m = 0.02;    ///< half of what counts as a motion of furniture, and …
  double pose_turn_deg = 1.25;   ///< … its turn: more may the camera's pose not be off
  double hidden_m = -1000;       ///< below everything
};
constexpr SearchParameters kSearch;
constexpr auto kFew = static_cast<double>(kFurnitureMotion.min_gain_surfels);

double turned(double angle) {
  return std::remainder(angle, 2 * kPi);
}

/// How the rest of a map agrees with a frame: of the pixels behind which it was measured.
struct Agreement {
  int compared = 0, agreed = 0;
  double share() const { return compared == 0 ? 0 : static_cast<double>(agreed) / compared; }
};

Agreement agreement_of(const cv::Mat& points, const cv::Mat& rest, int stride) {
  Agreement agreement;
  for (int v = 0; v < rest.rows; ++v)
    for (int u = 0; u < rest.cols; ++u) {
      const auto z = static_cast<double>(points.at<cv::Vec3f>(v * stride, u * stride)[2]);
      const auto model = static_cast<double>(rest.at<float>(v, u));
      if (std::isnan(z) || std::isnan(model)) continue;
      const double tolerance = kSearch.tolerance_m + 2 * depth_noise(z);
      if (z < model - tolerance) continue;  // Something stands there.
      ++agreement.compared;
      agreement.agreed += z < model + tolerance ? 1 : 0;
    }
  return agreement;
}

}  // namespace

struct MovedFurniture::View {
  const FurnitureFrame& frame;
  cv::Mat rest;  ///< CV_32F: what the map without the piece would measure

  bool explained(int pixel) const {
    const auto z = static_cast<double>(frame.points.ptr<cv::Vec3f>()[pixel][2]);
    const auto model = static_cast<double>(rest.ptr<float>()[pixel]);
    return !std::isnan(model) && z > model - kSearch.tolerance_m - 2 * depth_noise(z);
  }
};

MovedFurniture::MovedFurniture(KnownMap& map, const PoseRefinementOptions& pose_errors)
    : map_(map), world_(map.world), pose_errors_(pose_errors), pieces_(movable_furniture(map)) {
  for (const Furniture& piece : pieces_)
    states_.push_back({piece.name, false, true, Vector2d::Zero(), 0, kFurnitureMotion.prior_log_odds});
}

void MovedFurniture::restore(const std::vector<FurnitureState>& states) {
  for (const FurnitureState& known : states)
    for (FurnitureState& state : states_)
      if (state.name == known.name) state = known;
  place(std::nullopt, {});
}

void MovedFurniture::reset() {
  map_.world = world_;
  map_.scene.set_world(map_.part, world_);
}

Isometry3d MovedFurniture::motion_of(const Furniture& piece, const Pose& pose) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(pose.turn, Vector3d::UnitZ()).toRotationMatrix();
  motion.translation() =
      piece.middle + Vector3d(pose.shift.x(), pose.shift.y(), 0) - motion.linear() * piece.middle;
  return motion;
}

Isometry3d MovedFurniture::motion(size_t piece) const {
  return motion_of(pieces_[piece], pose_of(piece));
}

std::vector<std::string> MovedFurniture::texts() const {
  std::vector<std::string> texts;
  for (const FurnitureState& state : states_) {
    if (!state.moved) continue;
    texts.push_back(fmt::format(
        "{} is not where the map has it: {}; `loci-map update` makes a new map", state.name,
        state.found
            ? fmt::format("it moved by {:.2f} m, {:.0f}°", state.shift.norm(), std::abs(state.turn) / kDegree)
            : "what stood on it is not observed"));
  }
  return texts;
}

/// Rebuilds world and scene of the map; `hidden`: a piece that is left out.
void MovedFurniture::place(std::optional<size_t> hidden, const JointState& joints) {
  std::vector<MovedBranch> branches;
  for (size_t k = 0; k < pieces_.size(); ++k) {
    const bool away = k == hidden || !states_[k].found;
    if (!away && !states_[k].moved) continue;
    const Isometry3d now_from_before =
        away ? Isometry3d(Eigen::Translation3d(0, 0, kSearch.hidden_m)) : motion(k);
    for (const std::string& link : pieces_[k].branches) branches.push_back({link, now_from_before});
  }
  map_.world = with_moved(world_, branches);
  map_.scene.set_world(map_.part, map_.world);
  map_.scene.set_joints(map_.part, joints);
}

MovedFurniture::Fit MovedFurniture::fit(const Furniture& piece, const Pose& pose, const FurnitureFrame& frame,
                                        const View* view, size_t samples) const {
  const Isometry3d camera_from_piece = frame.map_from_camera.inverse() * motion_of(piece, pose);
  // Drawers and doors may be open where the piece stands; that they are shut says which way round it does.
  const std::vector<SurfaceSample>& surface = view == nullptr ? piece.samples : piece.closed;
  Fit fit;
  const auto* point = frame.points.ptr<cv::Vec3f>();
  const auto* direction = frame.normals.ptr<cv::Vec3f>();
  for (size_t i = 0; i < std::min(samples, surface.size()); ++i) {
    const Vector3d p = camera_from_piece * surface[i].point;
    const Vector3d normal = camera_from_piece.linear() * surface[i].normal;
    const double before = -normal.dot(p);
    if (before < kFacing * p.norm()) continue;
    ++fit.facing;
    const int pixel = pixel_of(p, frame.camera);
    if (pixel < 0) continue;
    const auto z = static_cast<double>(point[pixel][2]);
    if (std::isnan(z)) continue;
    const double off = (z / p.z() - 1) * before / (kSearch.tolerance_m + 2 * depth_noise(p.z()));
    if (off < -1) continue;  // Something stands before it.
    if (off > 1)
      fit.through += 1;
    else if ((view != nullptr && view->explained(pixel)) ||
             to_vector(direction[pixel]).dot(normal) < kSearch.same_normal)
      fit.other += 1;
    else
      fit.found += 1 - off * off / 2;
  }
  return fit;
}

MovedFurniture::View MovedFurniture::view_without(size_t piece, const FurnitureFrame& frame, int threads) {
  place(piece, frame.joints);
  return {frame, map_.scene.render(frame.camera, frame.map_from_camera, {}, threads).depth};
}

/// Where the middle of a piece may be: around what lies at its level and is not of the rest of the map.
std::vector<Vector2d> MovedFurniture::middles(const Furniture& piece, const View& view) const {
  const FurnitureFrame& frame = view.frame;
  const Vector3d up = frame.map_from_camera.linear().row(2).transpose();
  std::set<std::pair<int, int>> tops, cells;
  for (int v = 0; v < frame.points.rows; v += kSearch.stride)
    for (int u = 0; u < frame.points.cols; u += kSearch.stride) {
      const int pixel = v * frame.points.cols + u;
      const Vector3d p = to_vector(frame.points.ptr<cv::Vec3f>()[pixel]);
      if (!(to_vector(frame.normals.ptr<cv::Vec3f>()[pixel]).dot(up) > kSearch.same_normal)) continue;
      const Vector3d at = frame.map_from_camera * p;
      if (!(std::abs(at.z() - piece.top) < kSearch.level_m) || view.explained(pixel)) continue;
      const Eigen::Vector3i cell = cell_of(at, kSearch.cell_m);
      tops.insert({cell.x(), cell.y()});
    }
  const int reach = static_cast<int>(std::ceil(piece.radius / kSearch.cell_m));
  for (const auto& [x, y] : tops)
    for (int dx = -reach; dx <= reach; ++dx)
      for (int dy = -reach; dy <= reach; ++dy)
        if (dx * dx + dy * dy <= reach * reach) cells.insert({x + dx, y + dy});
  std::vector<Vector2d> middles = {piece.middle.head<2>()};
  for (const auto& [x, y] : cells)
    middles.emplace_back((x + 0.5) * kSearch.cell_m, (y + 0.5) * kSearch.cell_m);
  return middles;
}

/// Of similar poses the one that needs less motion.
double MovedFurniture::rank(const Candidate& candidate) const {
  return candidate.fit.score() -
         candidate.fit.facing * (kFurnitureMotion.cost_per_m * std::min(1.0, candidate.pose.shift.norm()) +
                                 kFurnitureMotion.cost_per_turn * std::abs(candidate.pose.turn) / kPi);
}

/// Descends in steps that become smaller.
void MovedFurniture::refine(const Furniture& piece, const View& view, Candidate& candidate) const {
  const auto fit_at = [&](const Pose& pose) { return fit(piece, pose, view.frame, &view, SIZE_MAX); };
  candidate.fit = fit_at(candidate.pose);
  for (double step = kSearch.cell_m / 2; step > kSearch.finest_m; step /= 2) {
    const double turn = step / piece.radius;
    for (bool better = true; better;) {
      better = false;
      for (const auto& [x, y, angle] : {std::array{step, 0.0, 0.0},
                                        {-step, 0, 0},
                                        {0, step, 0},
                                        {0, -step, 0},
                                        {0, 0, turn},
                                        {0, 0, -turn}}) {
        const Pose pose{candidate.pose.shift + Vector2d(x, y), turned(candidate.pose.turn + angle)};
        const Fit fit = fit_at(pose);
        if (fit.score() <= candidate.fit.score() + 1e-9) continue;
        candidate.pose = pose;
        candidate.fit = fit;
        better = true;
      }
    }
  }
  candidate.rank = rank(candidate);
}

std::vector<MovedFurniture::Candidate> MovedFurniture::search(const Furniture& piece, const View& view,
                                                              int threads) const {
  const std::vector<Vector2d> places = middles(piece, view);
  std::vector<std::vector<Candidate>> at_place(places.size());
  parallel_for(places.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (double turn = -kPi; turn < kPi - kSearch.turn / 2; turn += kSearch.turn) {
        Candidate start{{places[i] - piece.middle.head<2>(), turn}, {}, 0};
        if (fit(piece, start.pose, view.frame, &view, kFurnitureMotion.first_samples).score() <
            kFurnitureMotion.min_first_score)
          continue;
        start.fit = fit(piece, start.pose, view.frame, &view, kSearch.samples);
        start.rank = rank(start);
        if (start.rank > 0) at_place[i].push_back(start);
      }
  });
  std::vector<Candidate> all, starts;
  for (const auto& some : at_place) all.insert(all.end(), some.begin(), some.end());
  std::ranges::stable_sort(all, std::greater<>(), &Candidate::rank);
  const auto apart = [](const Candidate& a, const Candidate& b) {
    return (a.pose.shift - b.pose.shift).norm() > kFurnitureMotion.apart_m ||
           std::abs(turned(a.pose.turn - b.pose.turn)) > kFurnitureMotion.apart_turn;
  };
  for (const Candidate& start : all) {
    if (starts.size() == kFurnitureMotion.starts) break;
    if (std::ranges::all_of(starts, [&](const Candidate& other) { return apart(start, other); }))
      starts.push_back(start);
  }
  parallel_for(starts.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) refine(piece, view, starts[i]);
  });
  std::ranges::stable_sort(starts, std::greater<>(), &Candidate::rank);
  std::erase_if(starts, [](const Candidate& start) {
    return start.fit.found < std::max(kFew, kFurnitureMotion.min_share * start.fit.facing) ||
           start.fit.agreement() < kFurnitureMotion.min_agreement;
  });
  return starts;
}

/// Whether the camera could stand elsewhere instead, as far as its pose may be off: then the rest of the map
/// would fit as well from there. The scene is that of view_without().
bool MovedFurniture::camera_may_be_wrong(const Isometry3d& now_from_before, const Vector3d& middle,
                                         const View& view, int threads) const {
  const double shift = (now_from_before * middle - middle).norm();
  const double turn = Eigen::AngleAxisd(now_from_before.linear()).angle() / kDegree;
  if (shift > kSearch.pose_errors * pose_errors_.pose_error_m ||
      turn > kSearch.pose_errors * pose_errors_.pose_error_deg)
    return false;
  const mapping::PinholeCamera camera = subsampled(view.frame.camera, kSearch.stride);
  const auto agreement = [&](const Isometry3d& map_from_camera) {
    return agreement_of(view.frame.points, map_.scene.render(camera, map_from_camera, {}, threads).depth,
                        kSearch.stride)
        .share();
  };
  return agreement(view.frame.map_from_camera) <
         agreement(now_from_before.inverse() * view.frame.map_from_camera) + kSearch.agreement_gain;
}

bool MovedFurniture::update(const FurnitureFrame& frame, int threads) {
  bool changed = false;
  for (size_t k = 0; k < pieces_.size(); ++k) {
    const Comparison comparison = compare(k, frame, threads);
    changed |= comparison == Comparison::changed;
    if (comparison != Comparison::as_before) place(std::nullopt, frame.joints);
  }
  return changed;
}

/// Whether so much of a piece is looked through that it is worth a search. Where it is seen in its place,
/// earlier evidence against that is void.
bool MovedFurniture::is_looked_through(size_t k, const FurnitureFrame& frame) {
  const Pose pose = pose_of(k);
  const Vector3d middle = motion(k) * pieces_[k].middle;
  if (out_of_view(frame.map_from_camera.inverse() * middle, pieces_[k].radius, frame.camera)) return false;
  const Fit here = fit(pieces_[k], pose, frame, nullptr, SIZE_MAX);
  if (here.seen() < kFew) return false;
  if (here.through >= kSearch.min_through && here.through >= kSearch.through_share * here.seen()) return true;
  states_[k].log_odds = kFurnitureMotion.prior_log_odds;
  return false;
}

bool MovedFurniture::is_decided(size_t k, double evidence) {
  states_[k].log_odds += std::min(kSearch.max_evidence, evidence / kFurnitureMotion.correlated);
  return states_[k].log_odds > kSearch.decided;
}

MovedFurniture::Comparison MovedFurniture::settle(size_t k, bool found, const Pose& pose) {
  FurnitureState& state = states_[k];
  state.log_odds = kFurnitureMotion.prior_log_odds;
  state.found = found;
  state.shift = pose.shift;
  state.turn = pose.turn;
  state.moved = !found || mapping::is_furniture_motion(motion(k), pieces_[k].middle);
  if (!state.moved) {
    state.shift.setZero();
    state.turn = 0;
  }
  return Comparison::changed;
}

MovedFurniture::Comparison MovedFurniture::compare(size_t k, const FurnitureFrame& frame, int threads) {
  const Furniture& piece = pieces_[k];
  const bool was_found = states_[k].found;
  if (was_found && !is_looked_through(k, frame)) return Comparison::as_before;
  const View view = view_without(k, frame, threads);
  // Where the rest of the map says that the camera stands elsewhere, the frame tells nothing of furniture.
  const PoseRefinement rest = refine_pose(frame.points, frame.normals, frame.camera, frame.map_from_camera,
                                          map_.scene, pose_errors_, threads);
  if (rest.shift_m > kSearch.pose_shift_m || rest.turn_deg > kSearch.pose_turn_deg)
    return Comparison::searched;
  const Fit here = was_found ? fit(piece, pose_of(k), frame, &view, SIZE_MAX) : Fit();
  const std::vector<Candidate> fits = search(piece, view, threads);
  const Isometry3d to_here = motion(k);
  const auto by_camera = [&](const Candidate& fit) {
    return camera_may_be_wrong(motion_of(piece, fit.pose) * to_here.inverse(), to_here * piece.middle, view,
                               threads);
  };
  // A part of a plane fits anywhere on it: then this frame does not show where the piece stands.
  const bool ambiguous = std::ranges::any_of(fits, [&](const Candidate& other) {
    return other.fit.score() > kSearch.as_good * fits.front().fit.score() &&
           (other.pose.shift - fits.front().pose.shift).norm() > kFurnitureMotion.apart_m;
  });
  if (!fits.empty() && !ambiguous) {
    const Candidate& best = fits.front();
    const Isometry3d change = motion_of(piece, best.pose) * to_here.inverse();
    const bool elsewhere =
        !was_found || (mapping::is_furniture_motion(change, to_here * piece.middle) && !by_camera(best));
    const double gain = best.fit.score() - here.score();
    const double least = std::max(kFew, kFurnitureMotion.min_gain * best.fit.facing);
    return elsewhere && gain >= least && is_decided(k, gain) ? settle(k, true, best.pose)
                                                             : Comparison::searched;
  }
  const bool left = was_found && here.agreement() < 1 - kFurnitureMotion.left_share && here.through >= kFew &&
                    here.through >= kFurnitureMotion.min_share * here.facing;
  // The pose of a lost piece remains the last one that was known.
  return left && agreement_of(frame.points, view.rest, 1).share() > kSearch.min_agreement &&
                 std::ranges::none_of(fits, by_camera) && is_decided(k, here.through - here.found)
             ? settle(k, false, pose_of(k))
             : Comparison::searched;
}

}  // namespace loci::perception
