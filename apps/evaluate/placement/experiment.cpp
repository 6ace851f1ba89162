#include "apps/evaluate/placement/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/render/render.h"
#include "mapping/sensor/kinect.h"
#include "mapping/simulation/walk.h"
#include "mapping/tracking/tracking.h"
#include "mapping/world/urdf.h"

namespace loci::apps::placement_claim {
namespace {

namespace fs = std::filesystem;

constexpr double kRight = 0.05, kRightDeg = 2;
constexpr std::array<double, 4> kStretches = {0.01, 0.02, 0.04, 0.08};

/// A recording whose frame nobody knows.
struct Visit {
  std::string world;
  std::vector<Isometry3d> truth;                 ///< map_from_camera by frame
  std::vector<std::optional<Isometry3d>> poses;  ///< in the visit's own frame
  mapping::ScanSet scans;
  std::string objection;  ///< why it cannot be placed at all

  size_t lost() const { return static_cast<size_t>(std::count(poses.begin(), poses.end(), std::nullopt)); }
};

/// What a Kinect without colour camera measures at some poses of a world, rendered when it is asked for.
class DepthViews : public mapping::Recording {
 public:
  DepthViews(const fs::path& file, const mapping::MeshSearch& search, std::vector<Isometry3d> views, int seed,
             Warnings& warnings)
      : views_(std::move(views)), random_(static_cast<uint64_t>(seed)) {
    const mapping::World world = mapping::read_urdf(file);
    scene_.add(world, search, Isometry3d::Identity(), warnings);
    if (world.find_link("floor") == nullptr)
      scene_.add("floor", mapping::floor_mesh(0), Isometry3d::Identity());
    info_.path = file.string();
    info_.map_frame = "map";
    info_.camera = mapping::kinect_camera();
    info_.frames = info_.frames_with_pose = views_.size();
  }
  const mapping::RecordingInfo& info() const override { return info_; }
  size_t size() const override { return views_.size(); }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }
  mapping::RgbdFrame frame(size_t i) const override {
    mapping::RgbdFrame frame;
    frame.index = index_of(i);
    frame.name = std::to_string(i);
    frame.time_ns = time_of(i);
    frame.camera = info_.camera;
    frame.map_from_camera = views_.at(i);
    mapping::RenderOptions options;
    options.normals = true;
    const mapping::RenderedView view = scene_.render(frame.camera.depth, views_[i], options);
    frame.depth =
        measured_by_kinect(view.depth, view.normal, frame.camera.depth, {}, random_.fork(i), /*threads=*/1);
    return frame;
  }

 private:
  mapping::RenderScene scene_;
  mapping::RecordingInfo info_;
  std::vector<Isometry3d> views_;
  Random random_;
};

std::string name_of(const fs::path& world) {
  return world.parent_path().filename().string() + "_" + world.stem().string();
}

/// The same room, but longer and wider.
mapping::ScanSet stretched(mapping::ScanSet scans, double by) {
  const Eigen::DiagonalMatrix<double, 3> scale(1 + by, 1 + by, 1);
  for (mapping::Scan& scan : scans.scans) {
    const Isometry3d scan_from_map = scan.map_from_scan.inverse();
    const auto move = [&](Eigen::Vector3f& point) {
      point = (scan_from_map * (scale * (scan.map_from_scan * point.cast<double>()))).cast<float>();
    };
    for (mapping::ScanPoint& point : scan.points) move(point.position);
    for (Eigen::Vector3f& origin : scan.origins) move(origin);
  }
  return scans;
}

class Experiment {
 public:
  Experiment(const Settings& settings, Progress& progress, Warnings& warnings)
      : settings_(settings), progress_(progress), warnings_(warnings) {}

  mapping::ScanSet map_of(const fs::path& world) {
    const DepthViews recording(world, search_of(world), mapping::views_from(places_of(world)), settings_.seed,
                               warnings_);
    return mapping::scans_to_place(recording, settings_.threads, progress_);
  }

  Visit visit_of(const fs::path& world, int number) {
    Random random = Random(static_cast<uint64_t>(settings_.seed)).fork(static_cast<uint64_t>(number));
    std::vector<Vector2d> places = places_of(world);
    const size_t some = std::min(places.size(), static_cast<size_t>(settings_.places));
    const auto first = places.begin() + static_cast<std::ptrdiff_t>(random.index(places.size() - some + 1));
    places = {first, first + static_cast<std::ptrdiff_t>(some)};
    Visit visit;
    visit.world = name_of(world);
    try {
      const auto recording = settings_.tracked ? tracked_video(world, places, number, random, visit)
                                               : moved_views(world, places, number, random, visit);
      visit.scans = mapping::scans_to_place(*recording, settings_.threads, progress_);
    } catch (const Error& error) {
      visit.objection = error.what();
    }
    return visit;
  }

  Trial trial_of(const mapping::ScanSet& map, const std::string& map_name, const Visit& visit,
                 double stretch) {
    Trial trial{map_name, visit.world, stretch, visit.truth.size(), visit.lost(), {}, 0, 0, Outcome::refused};
    trial.placement.reason = visit.objection;
    if (!visit.objection.empty()) return trial;
    trial.placement = place_scans(map, stretch == 0 ? visit.scans : stretched(visit.scans, stretch),
                                  settings_.threads, progress_);
    if (trial.own_room()) add_errors(visit, trial);
    const bool is_right = trial.own_room() && trial.error_m < kRight && trial.error_deg < kRightDeg;
    if (trial.placement.trusted) trial.outcome = is_right ? Outcome::right : Outcome::wrong;
    return trial;
  }

 private:
  mapping::MeshSearch search_of(const fs::path& world) const {
    return {settings_.package_paths, world.parent_path()};
  }
  std::vector<Vector2d> places_of(const fs::path& world) {
    return standing_places(mapping::read_urdf(world), search_of(world), warnings_);
  }

  /// A video whose camera is tracked.
  std::unique_ptr<mapping::Recording> tracked_video(const fs::path& world,
                                                    const std::vector<Vector2d>& places, int number,
                                                    Random& random, Visit& visit) {
    const fs::path folder = settings_.folder / fmt::format("{}_visit_{}", name_of(world), number);
    visit.truth = mapping::stroll(places, random);
    visit.poses.resize(visit.truth.size());
    if (!fs::exists(folder / "recording.yaml")) {
      mapping::RecordOptions options;
      options.seed = settings_.seed + number;
      options.threads = settings_.threads;
      options.package_paths = settings_.package_paths;
      record_views(world, visit.truth, kSecond / 30, folder, options, progress_, warnings_);
    }
    auto recording = mapping::open_recording(folder);
    mapping::TrackingOptions options;
    options.threads = settings_.threads;
    const mapping::TrackingResult result = track(*recording, options, progress_);
    require_usable(result, folder.string());
    recording = with_tracked_poses(std::move(recording), result, false, warnings_);
    for (size_t i = 0; i < recording->size(); ++i) visit.poses[i] = recording->pose_of(i);
    return recording;
  }

  /// Single views from a little beside the places, in a frame that nobody knows.
  std::unique_ptr<mapping::Recording> moved_views(const fs::path& world, std::vector<Vector2d> places,
                                                  int number, Random& random, Visit& visit) {
    for (Vector2d& place : places) place += Vector2d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    Isometry3d motion = Isometry3d::Identity();
    motion.linear() = Eigen::AngleAxisd(random.uniform(-kPi, kPi), Vector3d::UnitZ()).toRotationMatrix();
    motion.translation() = Vector3d(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-1.5, 0));
    visit.truth = mapping::views_from(places);
    for (const Isometry3d& view : visit.truth) visit.poses.emplace_back(motion * view);
    return in_frame(std::make_unique<DepthViews>(world, search_of(world), visit.truth,
                                                 settings_.seed + number, warnings_),
                    motion, "odom");
  }

  static void add_errors(const Visit& visit, Trial& trial) {
    double frames = 0;
    for (size_t i = 0; i < visit.truth.size(); ++i) {
      if (!visit.poses[i]) continue;
      const Isometry3d error = visit.truth[i].inverse() * trial.placement.map_from_scans * *visit.poses[i];
      trial.error_m += error.translation().norm();
      trial.error_deg += Eigen::AngleAxisd(error.linear()).angle() / kDegree;
      ++frames;
    }
    trial.error_m /= std::max(frames, 1.0);
    trial.error_deg /= std::max(frames, 1.0);
  }

  const Settings& settings_;
  Progress& progress_;
  Warnings& warnings_;
};

const char* name_of(Outcome outcome) {
  return outcome == Outcome::right ? "right" : outcome == Outcome::wrong ? "wrong" : "refused";
}

/// The trials of one kind of room.
struct Sums {
  size_t right = 0, wrong = 0, refused = 0;
  std::vector<double> metres, degrees;  ///< of those that are right

  void add(const Trial& trial) {
    ++(trial.outcome == Outcome::right ? right : trial.outcome == Outcome::wrong ? wrong : refused);
    if (trial.outcome != Outcome::right) return;
    metres.push_back(trial.error_m);
    degrees.push_back(trial.error_deg);
  }
};

/// By kind of room, in the order of a table.
std::map<std::pair<int, double>, Sums> sums_of(const std::vector<Trial>& trials) {
  std::map<std::pair<int, double>, Sums> sums;
  for (const Trial& trial : trials)
    sums[{trial.own_room() ? 0 : trial.stretch == 0 ? 1 : 2, std::abs(trial.stretch)}].add(trial);
  return sums;
}

std::string kind_text(const std::pair<int, double>& kind) {
  return kind.first == 0   ? "its own room"
         : kind.first == 1 ? "another room"
                           : fmt::format("its own, {:g} % longer", 100 * kind.second);
}

}  // namespace

std::vector<Trial> place_visits(const std::vector<fs::path>& worlds, const Settings& settings,
                                Progress& progress, Warnings& warnings) {
  Experiment experiment(settings, progress, warnings);
  std::vector<mapping::ScanSet> maps;
  for (const fs::path& world : worlds) maps.push_back(experiment.map_of(world));
  std::vector<Trial> trials;
  for (size_t own = 0; own < worlds.size(); ++own)
    for (int number = 1; number <= settings.visits; ++number) {
      const Visit visit = experiment.visit_of(worlds[own], number);
      for (size_t i = 0; i < maps.size(); ++i)
        trials.push_back(experiment.trial_of(maps[i], name_of(worlds[i]), visit, 0));
      for (const double stretch : kStretches)
        if (settings.stretched)
          trials.push_back(experiment.trial_of(maps[own], name_of(worlds[own]), visit, stretch));
    }
  return trials;
}

std::string table_text(const std::vector<Trial>& trials, bool verbose) {
  std::string text;
  for (const Trial& trial : trials) {
    if (!verbose) break;
    text += fmt::format("{} in the map of {}{}: {}, {}", trial.visit, trial.map,
                        trial.stretch == 0 ? "" : fmt::format(", {:g} % longer", 100 * trial.stretch),
                        name_of(trial.outcome), trial.placement.reason);
    text += fmt::format(" [overlap {:.3f}, conflict {:.3f}, rmse {:.1f} mm", trial.placement.overlap,
                        trial.placement.conflict, 1000 * trial.placement.rmse_m);
    text += trial.own_room() ? fmt::format(", off by {:.1f} cm {:.2f}°, {} of {} frames lost]\n",
                                           100 * trial.error_m, trial.error_deg, trial.lost, trial.frames)
                             : "]\n";
  }
  text += fmt::format("{:24} {:>6} {:>6} {:>8}   {}\n", "map of", "right", "wrong", "refused",
                      "error, median and largest");
  for (const auto& [kind, sums] : sums_of(trials)) {
    text += fmt::format("{:24} {:6} {:6} {:8}", kind_text(kind), sums.right, sums.wrong, sums.refused);
    if (!sums.metres.empty())
      text +=
          fmt::format("   {:.0f}, {:.0f} mm; {:.2f}, {:.2f}°", 1000 * median(sums.metres),
                      1000 * quantile(sums.metres, 1.0), median(sums.degrees), quantile(sums.degrees, 1.0));
    text += "\n";
  }
  return text;
}

Json table_json(const std::vector<Trial>& trials) {
  Json json = Json::array();
  for (const Trial& trial : trials) {
    Json entry = {{"map", trial.map},
                  {"visit", trial.visit},
                  {"stretch", trial.stretch},
                  {"frames", trial.frames},
                  {"lost", trial.lost},
                  {"outcome", name_of(trial.outcome)},
                  {"reason", trial.placement.reason},
                  {"overlap", trial.placement.overlap},
                  {"conflict", trial.placement.conflict},
                  {"rmse_m", trial.placement.rmse_m}};
    if (trial.own_room()) {
      entry["error_m"] = trial.error_m;
      entry["error_deg"] = trial.error_deg;
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace loci::apps::placement_claim
