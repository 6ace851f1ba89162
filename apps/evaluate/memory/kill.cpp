#include "apps/evaluate/memory/kill.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "memory/ingest/scene_of_detections.h"
#include "memory/recorder/recorder.h"

namespace loci::apps::memory_experiment {
namespace {

/// Goes on with the memory until it is killed; tells the number of each scene after its commit.
[[noreturn]] void write_until_killed(const MemoryOptions& options, const std::filesystem::path& file,
                                     int pipe) {
  try {
    memory::Store store = memory::Store::open_write(file);
    memory::Recorder recorder(store, store.begin_run("loci-evaluate memory", "{}"));
    const std::optional<TimeNs> last = store.last_scene_time();
    Home home(options.home, options.seed);
    for (;;) {
      const memory::DetectedScene scene = home.look();
      if (last && scene.time <= *last) continue;
      const int64_t id = recorder.record(scene_of_detections(scene, options.home.noise_m, {})).scene;
      if (::write(pipe, &id, sizeof(id)) != sizeof(id)) break;
    }
  } catch (const std::exception&) {
    // The parent sees that it ended by itself.
  }
  ::_exit(1);
}

}  // namespace

void kill_writers(const MemoryOptions& options, const std::filesystem::path& file, MemoryFigures& figures,
                  Progress& progress) {
  Random random(static_cast<uint64_t>(options.seed));
  for (int i = 0; i < options.kills; ++i) {
    progress.check(static_cast<double>(i) / options.kills, "killing the writer");
    int ends[2];
    if (::pipe(ends) != 0) throw Error("cannot make a pipe");
    const pid_t child = ::fork();
    if (child < 0) throw Error("cannot start a writer");
    if (child == 0) {
      ::close(ends[0]);
      write_until_killed(options, file, ends[1]);
    }
    ::close(ends[1]);
    int64_t committed = 0, told = 0;
    if (::read(ends[0], &told, sizeof(told)) == sizeof(told)) committed = told;  // it has begun
    std::this_thread::sleep_for(std::chrono::microseconds(random.index(50'000)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    while (::read(ends[0], &told, sizeof(told)) == sizeof(told)) committed = told;
    ::close(ends[0]);
    if (!WIFSIGNALED(status)) throw Error("the writer ended by itself", {file.string(), 0, {}});
    const memory::Store store = memory::Store::open_read(file);
    NoProgress silent;
    ++figures.kills;
    const auto last = store.last_scene();
    if (!last || last->id < committed) ++figures.kills_lost;
    if (!store.verify(silent).problems.empty()) ++figures.kills_unsound;
  }
}

}  // namespace loci::apps::memory_experiment
