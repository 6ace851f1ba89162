#include "apps/evaluate/fleet/figures.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <mutex>
#include <sstream>
#include <thread>

#include "apps/evaluate/memory/simulator.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/fleet/fleet_replica.h"
#include "memory/fleet/push.h"
#include "memory/ingest/detection_scene.h"
#include "memory/questions/contents.h"
#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/presence.h"
#include "memory/recorder/recorder.h"

namespace loci::apps::fleet_experiment {
namespace {

namespace fs = std::filesystem;
using memory_experiment::Home;

/// CPU time that all processes of PostgreSQL on this machine have taken, those that ended included.
double server_cpu_s() {
  double ticks = 0;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    if (!is_digit(entry.path().filename().string().front())) continue;
    std::ifstream file(entry.path() / "stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    const size_t end = text.rfind(')');
    if (end == std::string::npos || text.find("(postgres)") == std::string::npos) continue;
    std::istringstream fields(text.substr(end + 1));
    std::string skipped;
    for (int i = 0; i < 11; ++i) fields >> skipped;
    double user = 0, system = 0, children_user = 0, children_system = 0;
    fields >> user >> system >> children_user >> children_system;
    ticks += user + system + children_user + children_system;
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Seeds and names of the robots.
class Robots {
 public:
  Robots(const FleetOptions& options, std::string url, fs::path folder)
      : options_(options), url_(std::move(url)), folder_(std::move(folder)) {}

  static std::string name(int robot) { return fmt::format("robot_{}", robot); }
  fs::path file(int robot) const {
    return folder_ / fmt::format("{}_{}_{}.loci", name(robot), options_.observations, options_.seed);
  }
  std::string url(int robot) const {
    return url_ + (url_.find('?') == std::string::npos ? "?" : "&") + "home=home&robot=" + name(robot);
  }
  fs::path cache() const { return folder_ / "cache"; }
  memory::MemoryPush push(int robot) const {
    return {file(robot), memory::parse_fleet_url(url_), {.name = {"home", name(robot)}, .replace = true}};
  }

  void simulate(int robot) const {
    if (fs::exists(file(robot))) return;
    const fs::path partial = file(robot).string() + ".part";
    fs::remove(partial);
    {
      Home home({}, options_.seed + robot);
      memory::Store store = memory::Store::open_write(partial);
      const memory::Id run = store.begin_run("loci-evaluate fleet", "{}");
      memory::Recorder recorder(store, run);
      for (int64_t observations = 0; observations < options_.observations;) {
        const memory::SceneRecord record = detections_to_scene(home.look(), 0.005, {});
        recorder.record(record);
        observations += static_cast<int64_t>(record.observations.size());
      }
      store.finish_run(run);
    }
    fs::rename(partial, file(robot));
  }

 private:
  const FleetOptions& options_;
  std::string url_;
  fs::path folder_;
};

void push_all(const FleetOptions& options, const Robots& robots, FleetFigures& figures, Progress& progress) {
  NoProgress silent;
  std::vector<double> again;
  for (int robot = 0; robot < options.robots; ++robot) {
    progress.check(0.4 + 0.2 * robot / options.robots, "pushing");
    const double server = server_cpu_s(), client = thread_cpu_seconds();
    const Stopwatch wall;
    memory::MemoryPush push = robots.push(robot);
    figures.rows += push.run(silent).added_rows();
    figures.push_wall_s += wall.seconds();
    figures.push_client_s += thread_cpu_seconds() - client;
    figures.push_server_s += server_cpu_s() - server;
    const Stopwatch second;
    push.run(silent);
    again.push_back(1000 * second.seconds());
  }
  figures.again_ms = median(again);
}

/// Asks one of four kinds of questions about a random object, place or hour.
void ask_one(const memory::Store& store, Random& random) {
  const TimeNs first = store.scene(1).time, last = *store.last_scene_time();
  const auto object = [&] {
    return memory::object_name(
        static_cast<memory::Id>(1 + random.index(static_cast<uint64_t>(store.max_object_id()))));
  };
  const std::string place = Home::place_name(static_cast<int>(random.index(10)));
  const TimeNs from = first + static_cast<TimeNs>(random.uniform() * double(last - first));
  switch (random.index(4)) {
    case 0:
      ask(store, memory::WhereQuestion{object(), {}});
      break;
    case 1:
      ask(store, memory::ContentsQuestion{.place = place});
      break;
    case 2:
      ask(store, memory::ChangesQuestion{.from = from, .to = from + kHour});
      break;
    default:
      ask(store, memory::WasQuestion{object(), place, from, from + kHour, {}});
  }
}

/// Users ask random robots, each as a program that runs: the replica is brought up to date where it is older
/// than a second, opened, and asked.
void ask_all(const FleetOptions& options, const Robots& robots, FleetFigures& figures, Progress& progress) {
  std::mutex mutex;
  std::vector<double> wall_ms, cpu_ms;
  std::vector<std::thread> users;
  const Stopwatch all;
  for (int user = 0; user < options.users; ++user)
    users.emplace_back([&, user] {
      NoProgress silent;
      Random random(static_cast<uint64_t>(options.seed + 1000 + user));
      const auto connections = std::make_shared<memory::FleetConnections>();
      std::vector<memory::FleetReplica> replicas;
      for (int robot = 0; robot < options.robots; ++robot)
        replicas.emplace_back(robots.url(robot), robots.cache(), connections);
      for (int i = 0; i < options.questions; ++i) {
        const auto robot = random.index(replicas.size());
        const Stopwatch wall;
        const double cpu = thread_cpu_seconds();
        ask_one(memory::Store::open_read(replicas[robot].update(silent, memory::kFreshReplica_s)), random);
        const double took_cpu = 1000 * (thread_cpu_seconds() - cpu), took = 1000 * wall.seconds();
        const std::lock_guard lock(mutex);
        wall_ms.push_back(took);
        cpu_ms.push_back(took_cpu);
        std::this_thread::yield();
      }
    });
  progress.check(0.8, "asking");
  for (std::thread& user : users) user.join();
  figures.questions_per_s = double(wall_ms.size()) / all.seconds();
  figures.question_median_ms = median(wall_ms);
  figures.question_p99_ms = quantile(wall_ms, 0.99);
  figures.question_cpu_p99_ms = quantile(cpu_ms, 0.99);
}

/// A robot goes on, is pushed every half second, and is asked for its last scene: how long that takes from
/// the commit in its file.
void measure_lag(const FleetOptions& options, const Robots& robots, FleetFigures& figures,
                 Progress& progress) {
  progress.check(0.9, "following a robot");
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::map<TimeNs, Stopwatch> committed;  // by the time of the scene
  std::thread pushing([&] {
    NoProgress silent;
    memory::MemoryPush push = robots.push(0);
    while (!stop) {
      push.run(silent);
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
  });
  std::vector<double> lags;
  std::thread reading([&] {
    NoProgress silent;
    memory::FleetReplica replica(robots.url(0), robots.cache());
    while (!stop) {
      const TimeNs last =
          *memory::Store::open_read(replica.update(silent, memory::kFreshReplica_s)).last_scene_time();
      {
        const std::lock_guard lock(mutex);
        while (!committed.empty() && committed.begin()->first <= last) {
          lags.push_back(committed.begin()->second.seconds());
          committed.erase(committed.begin());
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  {
    Home home({}, options.seed);
    memory::Store store = memory::Store::open_write(robots.file(0));
    const TimeNs last = *store.last_scene_time();
    memory::Recorder recorder(store, store.begin_run("loci-evaluate fleet", "{}"));
    for (int scenes = 0; scenes < options.lag_scenes;) {
      const memory::DetectedScene scene = home.look();
      if (scene.time <= last) continue;
      recorder.record(detections_to_scene(scene, 0.005, {}));
      ++scenes;
      {
        const std::lock_guard lock(mutex);
        committed.try_emplace(scene.time);
      }
      std::this_thread::sleep_for(std::chrono::duration<double>(options.lag_scene_s));
    }
  }
  for (const Stopwatch waited; waited.seconds() < 30;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const std::lock_guard lock(mutex);
    if (committed.empty()) break;
  }
  stop = true;
  pushing.join();
  reading.join();
  if (!committed.empty()) throw Error("scenes did not arrive within 30 s");
  figures.lag_median_s = median(lags);
  figures.lag_p99_s = quantile(lags, 0.99);
  figures.lag_max_s = *std::max_element(lags.begin(), lags.end());
}

}  // namespace

void FleetOptions::declare(OptionTable& table) {
  table.integer("robots", robots, "", "Robots, each with a memory of its own.", 1, 1000);
  table.integer("observations", observations, "", "Observations of each robot.", 100, 100'000'000);
  table.integer("seed", seed, "", "Seed of the first simulated home.", 0, 1'000'000'000);
  table.integer("users", users, "", "Users who ask at the same time.", 1, 1000);
  table.integer("questions", questions, "", "Questions of each user.", 10, 1'000'000);
  table.integer("lag_scenes", lag_scenes, "", "Scenes of a robot that goes on.", 1, 100'000);
  table.number("lag_scene_s", lag_scene_s, "s", "Time between two of these scenes.", 0.01, 60);
}

FleetFigures measure(const FleetOptions& options, const std::string& url, const fs::path& folder,
                     Progress& progress) {
  const Robots robots(options, url, folder);
  fs::remove_all(robots.cache());
  FleetFigures figures{.robots = options.robots};
  for (int robot = 0; robot < options.robots; ++robot) {
    progress.check(0.4 * robot / options.robots, "simulating");
    robots.simulate(robot);
    figures.observations += memory::Store::open_read(robots.file(robot)).max_observation_id();
  }
  push_all(options, robots, figures, progress);
  const Stopwatch pulling;
  NoProgress silent;
  for (int robot = 0; robot < options.robots; ++robot) {
    progress.check(0.6 + 0.2 * robot / options.robots, "making replicas");
    memory::FleetReplica(robots.url(robot), robots.cache()).update(silent);
  }
  figures.pull_wall_s = pulling.seconds();
  ask_all(options, robots, figures, progress);
  measure_lag(options, robots, figures, progress);
  return figures;
}

std::string text_of(const FleetFigures& f) {
  const double rows = double(f.rows);
  return fmt::format(
      "{} robots, {} observations, {} rows\n"
      "  push: {:.0f} rows per second of the clock; {:.0f} per second of CPU time ({:.0f} s of the program, "
      "{:.0f} s of "
      "the server)\n"
      "  push without news: {:.1f} ms\n"
      "  first replicas: {:.0f} rows per second of the clock\n"
      "  questions: median {:.2f} ms, p99 {:.2f} ms; p99 of CPU time {:.2f} ms; {:.0f} per second\n"
      "  lag: median {:.2f} s, p99 {:.2f} s, maximum {:.2f} s",
      f.robots, f.observations, f.rows, rows / f.push_wall_s, rows / (f.push_client_s + f.push_server_s),
      f.push_client_s, f.push_server_s, f.again_ms, rows / f.pull_wall_s, f.question_median_ms,
      f.question_p99_ms, f.question_cpu_p99_ms, f.questions_per_s, f.lag_median_s, f.lag_p99_s, f.lag_max_s);
}

Json json_of(const FleetFigures& f) {
  return {{"robots", f.robots},
          {"observations", f.observations},
          {"rows", f.rows},
          {"push_wall_s", f.push_wall_s},
          {"push_client_s", f.push_client_s},
          {"push_server_s", f.push_server_s},
          {"push_again_ms", f.again_ms},
          {"pull_wall_s", f.pull_wall_s},
          {"question_median_ms", f.question_median_ms},
          {"question_p99_ms", f.question_p99_ms},
          {"question_cpu_p99_ms", f.question_cpu_p99_ms},
          {"questions_per_s", f.questions_per_s},
          {"lag_median_s", f.lag_median_s},
          {"lag_p99_s", f.lag_p99_s},
          {"lag_max_s", f.lag_max_s}};
}

}  // namespace loci::apps::fleet_experiment
