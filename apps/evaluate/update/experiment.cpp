#include "apps/evaluate/update/experiment.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/evaluate/update/moves.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/fusion/fusion.h"
#include "mapping/recording/recording.h"
#include "mapping/registration/registration.h"
#include "mapping/simulation/record.h"
#include "mapping/simulation/simulated_robot.h"
#include "mapping/update/update.h"
#include "mapping/world/urdf.h"
#include "nbv/survey.h"

namespace loci::apps::update_claim {
namespace {

namespace fs = std::filesystem;

/// Fewer points on a moved piece do not ask for it: it is hidden or out of view.
constexpr size_t kMinPoints = 300;
/// A piece of the update is the group whose centre is so near.
constexpr double kSamePlace = 0.35;

/// The map, the scans that it was made from, and where they were taken.
struct MappedRoom {
  mapping::World world;
  mapping::SemanticMap semantics;
  mapping::ScanSet scans;
};

MappedRoom mapped(const fs::path& world, const Settings& settings, Progress& progress, Warnings& warnings) {
  const fs::path folder =
      settings.folder / (world.parent_path().filename().string() + "_" + world.stem().string());
  if (!fs::exists(folder / "map.urdf")) {
    mapping::SimulatedRobotOptions options;
    options.package_paths = settings.package_paths;
    options.seed = static_cast<uint64_t>(settings.seed);
    options.threads = settings.threads;
    mapping::SimulatedRobot robot(world, options, {}, warnings);
    const mapping::PlanarPose start = robot.open_place();
    robot.put_at(start);
    nbv::SurveyOptions survey_options;
    survey_options.exploration.seed = options.seed;
    survey_options.exploration.threads = settings.threads;
    nbv::survey(robot, start, folder, false, survey_options, progress, warnings);
  }
  return {mapping::read_urdf(folder / "map.urdf"),
          mapping::read_semantic_map(mapping::sidecar_path(folder / "map.urdf")),
          mapping::read_scan_set(folder / "scans")};
}

/// New scans, and their true points in the world frame.
struct NewData {
  mapping::ScanSet scans;
  std::vector<Vector3d> points;
};

/// The poses of earlier scans in a random order; in part two of them.
std::vector<mapping::PlanarPose> poses_of(const MappedRoom& room, Random& random) {
  std::vector<mapping::PlanarPose> poses;
  for (const mapping::Scan& scan : room.scans.scans) poses.push_back(mapping::planar(scan.map_from_scan));
  for (size_t i = poses.size(); i > 1; --i) std::swap(poses[i - 1], poses[random.index(i)]);
  return poses;
}

void add_points(const mapping::Scan& scan, const Isometry3d& world_from_scan, NewData& data) {
  constexpr size_t kEvery = 4;
  for (size_t i = 0; i < scan.points.size(); i += kEvery)
    if (scan.points[i].returned)
      data.points.push_back(world_from_scan * scan.points[i].position.cast<double>());
}

/// Scans of a robot that starts a little beside where it believes to be, drifts, and registers its scans.
NewData scanned(const fs::path& urdf, const MappedRoom& room, const Settings& settings, Random& random,
                Warnings& warnings) {
  mapping::SimulatedRobotOptions options;
  options.package_paths = settings.package_paths;
  options.threads = settings.threads;
  options.seed = random.bits() % 1000000;
  const std::vector<mapping::PlanarPose> poses = poses_of(room, random);
  mapping::SimulatedRobot robot(urdf, options, poses.front(), warnings);
  NewData data;
  data.scans.sensor = mapping::kLaserSensor;
  data.scans.range_max = options.laser.range_max_m;
  const size_t wanted = settings.part ? 2 : std::min<size_t>(poses.size(), 6);
  std::vector<Isometry3d> world_from_scan;
  for (const mapping::PlanarPose& pose : poses) {
    if (data.scans.scans.size() == wanted) break;
    try {
      data.scans.scans.push_back(robot.scan_at(pose));
      world_from_scan.push_back(robot.true_map_from_scanner());
    } catch (const Error&) {
      // Moved furniture stands there.
    }
  }
  if (data.scans.scans.empty()) throw Error("the robot can stand at none of its earlier places");
  NoProgress quiet;
  const mapping::RegistrationResult registered =
      register_scans(data.scans, mapping::RegistrationOptions{}, quiet);
  Isometry3d offset = Isometry3d::Identity();
  offset.linear() = Eigen::AngleAxisd(random.normal(4 * kDegree), Vector3d::UnitZ()).toRotationMatrix();
  offset.translation() = Vector3d(random.normal(0.15), random.normal(0.15), 0);
  std::vector<mapping::Scan> kept;
  for (size_t i = 0; i < data.scans.scans.size(); ++i) {
    if (!registered.connected[i]) continue;  // What only such a scan shows is hidden.
    add_points(data.scans.scans[i], world_from_scan[i], data);
    kept.push_back(std::move(data.scans.scans[i]));
    kept.back().map_from_scan = offset * registered.map_from_scan[i];
  }
  data.scans.scans = std::move(kept);
  return data;
}

/// Frames of a Kinect that turns round at places of the earlier scans.
NewData recorded(const fs::path& urdf, const MappedRoom& room, const Settings& settings, Random& random,
                 Progress& progress, Warnings& warnings) {
  std::string positions;
  size_t places = 0;
  for (const mapping::PlanarPose& pose : poses_of(room, random)) {
    if (places++ == (settings.part ? 2U : 6U)) break;
    positions += fmt::format("{}[{:.3f}, {:.3f}, 1.45]", positions.empty() ? "" : ", ", pose.x, pose.y);
  }
  const fs::path folder = urdf.parent_path();
  write_file_atomically(
      folder / "walk.yaml",
      fmt::format("world: {}\ncamera: kinect\nfloor: 0\nscenes:\n  - time: \"2026-05-01T06:00:00Z\"\n"
                  "    sweep: {{positions: [{}], pitch_deg: [-40, -12], yaw_deg: [0, 330, 12]}}\n",
                  urdf.filename().string(), positions));
  mapping::RecordOptions options;
  options.seed = static_cast<int>(random.index(1000000));
  options.threads = settings.threads;
  options.package_paths = settings.package_paths;
  record(mapping::read_scenario(folder / "walk.yaml"), folder / "walk", options, progress, warnings);
  mapping::FusionOptions fusion;
  fusion.threads = settings.threads;
  NewData data;
  data.scans = fuse(*mapping::open_recording(folder / "walk"), fusion, progress).scans;
  for (const mapping::Scan& scan : data.scans.scans) add_points(scan, scan.map_from_scan, data);
  return data;
}

/// Compares what the update said with what was moved.
class Judge {
 public:
  Judge(const MovableWorld& world, const std::vector<Move>& moves, const mapping::UpdateResult& result)
      : world_(world), moves_(moves), result_(result), used_(result.changes.size(), false) {}

  MovedPiece judge(const Move& move) {
    const Group& group = world_.groups()[move.group];
    MovedPiece piece;
    piece.piece = group.name;
    piece.distance = (move.now_from_before * group.centre - group.centre).norm();
    // Its own change, or that of a piece of the same shape that ended where this one did.
    double best = 0.25;
    for (size_t i = 0; i < result_.changes.size(); ++i) {
      const mapping::MapChange& change = result_.changes[i];
      if (used_[i] || change.kind != mapping::MapChange::Kind::moved) continue;
      for (const Group& from : world_.groups()) {
        if (from.shape != group.shape || (change.centre - from.centre).head<2>().norm() > kSamePlace)
          continue;
        const Isometry3d error = (move.now_from_before * group.map_from_group).inverse() *
                                 (change.now_from_before * from.map_from_group);
        const Vector3d off = change.now_from_before * from.centre - move.now_from_before * group.centre;
        if (off.head<2>().norm() > best) continue;
        best = off.head<2>().norm();
        piece.found = true;
        piece.swapped = from.name != group.name;
        piece.position_error = best;
        piece.turn_error_deg = group.turn_error_deg(error);
        match_ = i;
      }
    }
    if (piece.found) {
      used_[match_] = true;
      piece.said = result_.changes[match_].reason;
    }
    for (const mapping::MapChange& change : result_.changes)
      if (!piece.found && (change.centre - group.centre).head<2>().norm() < kSamePlace)
        piece.said += change.text() + " [" + change.reason + "]; ";
    if (!piece.found && piece.said.empty())
      for (const mapping::UnchangedPiece& same : result_.unchanged) {
        Vector2d middle = Vector2d::Zero();
        for (const Vector2d& corner : same.outline) middle += corner / 4;
        if ((middle - group.centre.head<2>()).norm() < kSamePlace)
          piece.said += same.name + (same.seen ? " in place; " : " not seen; ");
      }
    return piece;
  }

  /// False changes of what did not move.
  void judge_rest(Trial& trial) {
    for (size_t g = 0; g < world_.groups().size(); ++g)
      trial.unmoved +=
          std::ranges::none_of(moves_, [&](const Move& move) { return move.group == g; }) ? 1 : 0;
    for (size_t i = 0; i < result_.changes.size(); ++i) {
      const mapping::MapChange& change = result_.changes[i];
      using Kind = mapping::MapChange::Kind;
      if (used_[i] || change.kind == Kind::seen_first) continue;
      const bool appears = change.kind == Kind::came;
      const bool concerns_move = std::ranges::any_of(moves_, [&](const Move& move) {
        const Vector3d before = world_.groups()[move.group].centre, now = move.now_from_before * before;
        return (change.centre - (appears ? now : before)).head<2>().norm() < 2 * kSamePlace;
      });
      if (concerns_move) continue;
      ++(appears ? trial.invented : trial.called_moved);
      trial.wrong.push_back(change.text() + " [" + change.reason + "]");
    }
  }

 private:
  const MovableWorld& world_;
  const std::vector<Move>& moves_;
  const mapping::UpdateResult& result_;
  std::vector<bool> used_;
  size_t match_ = 0;
};

Trial run_trial(int number, const fs::path& world, const MappedRoom& room, const MovableWorld& movable,
                const Settings& settings, Progress& progress, Warnings& warnings) {
  Trial trial;
  trial.world = world.parent_path().filename().string();
  trial.trial = number;
  Random random = Random(static_cast<uint64_t>(settings.seed)).fork(static_cast<uint64_t>(number));
  const size_t count = 1 + static_cast<size_t>(number) % static_cast<size_t>(settings.moves);
  const std::vector<Move> moves = movable.draw(count, random);
  const fs::path folder = settings.folder / fmt::format("{}_trial_{}", trial.world, number);
  make_folder(folder);
  const fs::path urdf = folder / "world.urdf";
  write_urdf(movable.moved(moves), urdf);
  const NewData data = settings.kinect ? recorded(urdf, room, settings, random, progress, warnings)
                                       : scanned(urdf, room, settings, random, warnings);
  mapping::UpdateOptions options;
  options.threads = settings.threads;
  const mapping::UpdateResult result =
      update(room.world, room.semantics, room.scans, data.scans, options, progress);
  Judge judge(movable, moves, result);
  for (const Move& move : moves) {
    MovedPiece piece = judge.judge(move);
    piece.world = trial.world;
    piece.trial = number;
    piece.points = 4 * movable.points_on(move.group, move.now_from_before, data.points);
    trial.moved.push_back(piece);
  }
  judge.judge_rest(trial);
  trial.seconds = result.seconds;
  fs::remove_all(folder);
  return trial;
}

struct Sums {
  size_t asked = 0, found = 0, within = 0, swapped = 0, hidden = 0, unmoved = 0, called_moved = 0,
         invented = 0;
  std::vector<double> position, turn, seconds;

  explicit Sums(const std::vector<Trial>& trials) {
    for (const Trial& trial : trials) {
      unmoved += trial.unmoved;
      called_moved += trial.called_moved;
      invented += trial.invented;
      seconds.push_back(trial.seconds);
      for (const MovedPiece& piece : trial.moved) {
        if (piece.points < kMinPoints) {
          ++hidden;
          continue;
        }
        ++asked;
        if (!piece.found) continue;
        ++found;
        swapped += piece.swapped ? 1 : 0;
        position.push_back(piece.position_error);
        if (piece.turn_error_deg) turn.push_back(*piece.turn_error_deg);
        within += piece.position_error <= 0.02 && piece.turn_error_deg.value_or(0) <= 1 ? 1 : 0;
      }
    }
  }

  static double share(size_t part, size_t all) {
    return all == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(all);
  }
};

}  // namespace

std::vector<Trial> run_world(const fs::path& world, const Settings& settings, Progress& progress,
                             Warnings& warnings) {
  const MappedRoom room = mapped(world, settings, progress, warnings);
  const mapping::MeshSearch search{settings.package_paths, world.parent_path()};
  const MovableWorld movable(mapping::read_urdf(world), search, settings.families, warnings);
  if (movable.groups().empty())
    throw Error("the world has nothing to move", {world.string(), 0, ""},
                "name its furniture with --movable");
  std::vector<Trial> trials;
  for (int number = 0; number < settings.trials; ++number)
    trials.push_back(run_trial(number, world, room, movable, settings, progress, warnings));
  return trials;
}

std::string table_text(const std::vector<Trial>& trials, bool verbose) {
  std::string text;
  for (const Trial& trial : trials) {
    if (!verbose) break;
    for (const MovedPiece& piece : trial.moved)
      text += fmt::format(
          "{} {}: {} by {:.2f} m, {} points: {}; {}\n", trial.world, trial.trial, piece.piece, piece.distance,
          piece.points,
          piece.found ? fmt::format("off by {:.1f} cm and {:.2f}°{}", 100 * piece.position_error,
                                    piece.turn_error_deg.value_or(0), piece.swapped ? " (as its twin)" : "")
                      : "not found",
          piece.said);
    for (const std::string& wrong : trial.wrong)
      text += fmt::format("{} {}: wrong: {}\n", trial.world, trial.trial, wrong);
  }
  const Sums sums(trials);
  const auto spread = [](const std::vector<double>& values, double scale) {
    if (values.empty()) return std::string("-");
    return fmt::format("{:.2f} median, {:.2f} 95 %, {:.2f} worst", scale * quantile(values, 0.5),
                       scale * quantile(values, 0.95), scale * quantile(values, 1.0));
  };
  text += fmt::format("moves found               {:.1f} % ({} of {}; {} more were hidden)\n",
                      Sums::share(sums.found, sums.asked), sums.found, sums.asked, sums.hidden);
  text += fmt::format("  within 2 cm and 1 deg   {:.1f} %\n", Sums::share(sums.within, sums.found));
  text += fmt::format("  as a piece of one shape {}\n", sums.swapped);
  text += fmt::format("position error, cm        {}\n", spread(sums.position, 100));
  text += fmt::format("turn error, deg           {}\n", spread(sums.turn, 1));
  text += fmt::format("unmoved called moved      {:.1f} % ({} of {})\n",
                      Sums::share(sums.called_moved, sums.unmoved), sums.called_moved, sums.unmoved);
  text += fmt::format("invented pieces           {}\n", sums.invented);
  text += fmt::format("seconds per update        {}\n", spread(sums.seconds, 1));
  return text;
}

Json table_json(const std::vector<Trial>& trials) {
  const Sums sums(trials);
  Json json = {{"asked", sums.asked},
               {"found", sums.found},
               {"hidden", sums.hidden},
               {"within", sums.within},
               {"swapped", sums.swapped},
               {"unmoved", sums.unmoved},
               {"called_moved", sums.called_moved},
               {"invented", sums.invented},
               {"pieces", Json::array()}};
  for (const Trial& trial : trials)
    for (const MovedPiece& piece : trial.moved)
      json["pieces"].push_back(
          {{"world", trial.world},
           {"trial", trial.trial},
           {"piece", piece.piece},
           {"distance_m", piece.distance},
           {"points", piece.points},
           {"found", piece.found},
           {"position_error_m", piece.position_error},
           {"turn_error_deg", piece.turn_error_deg ? Json(*piece.turn_error_deg) : Json()}});
  return json;
}

}  // namespace loci::apps::update_claim
