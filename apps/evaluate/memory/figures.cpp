#include "apps/evaluate/memory/figures.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <atomic>
#include <filesystem>
#include <functional>
#include <thread>

#include "apps/evaluate/memory/plain.h"
#include "apps/evaluate/resident_memory.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "memory/ingest/detection_scene.h"
#include "memory/questions/contents.h"
#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/presence.h"
#include "memory/questions/question.h"
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
      const int64_t id = recorder.record(detections_to_scene(scene, options.home.noise_m, {})).scene;
      if (::write(pipe, &id, sizeof(id)) != sizeof(id)) break;
    }
  } catch (const std::exception&) {
    // The parent sees that it ended by itself.
  }
  ::_exit(1);
}

/// Kills a writer (SIGKILL) at random moments, again and again over one file, and looks each time whether
/// every scene that it had committed is there and the memory is sound.
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

namespace fs = std::filesystem;

/// Takes scenes in and counts.
class Writer {
 public:
  Writer(const MemoryOptions& options, const fs::path& file)
      : options_(options),
        home_(options.home, options.seed),
        store_(memory::Store::open_write(file)),
        run_(store_.begin_run("loci-evaluate memory", "{}")),
        recorder_(store_, run_) {}

  /// Only the reasoning and the writing are timed, not the simulation.
  void write(size_t observations, const std::function<void()>& done) {
    const size_t end = observations_ + observations;
    while (observations_ < end) {
      const memory::SceneRecord record = detections_to_scene(home_.look(), options_.home.noise_m, {});
      const Stopwatch wall;
      const double begin = thread_cpu_seconds();
      const memory::RecordedScene recorded = recorder_.record(record);
      processor_ += thread_cpu_seconds() - begin;
      wall_ += wall.seconds();
      judge(recorded.update);
      observations_ += record.observations.size();
      ++scenes_;
      if (scenes_ % 64 == 0) done();
    }
  }
  void finish() { store_.finish_run(run_); }

  size_t observations() const { return observations_; }
  size_t scenes() const { return scenes_; }
  double processor() const { return processor_; }
  double wall() const { return wall_; }
  IdentityFigures identity() const { return judge_.figures(); }

 private:
  void judge(const memory::belief::BeliefUpdate& update) {
    std::vector<JudgedSighting> scene;
    for (size_t k = 0; k < update.observations.size(); ++k) {
      const memory::belief::ObservationOutcome& outcome = update.observations[k];
      const TrueObject& truth = home_.seen()[k];
      scene.push_back({truth.number, truth.event, outcome.object,
                       outcome.explanation == memory::Explanation::appear,
                       outcome.explanation == memory::Explanation::move});
    }
    judge_.see(scene);
  }

  const MemoryOptions& options_;
  Home home_;
  memory::Store store_;
  memory::Id run_;
  memory::Recorder recorder_;
  IdentityJudge judge_;
  size_t observations_ = 0, scenes_ = 0;
  double processor_ = 0, wall_ = 0;
};

void ingest_all(Writer& writer, const MemoryOptions& options, MemoryFigures& figures, Progress& progress) {
  const auto total = static_cast<size_t>(options.observations), tenth = total / 10;
  const auto tell = [&] {
    progress.check(double(writer.observations()) / double(total), "taking observations in");
  };
  writer.write(tenth, tell);
  figures.first_tenth_rate = double(writer.observations()) / writer.processor();
  figures.megabytes_first_tenth = resident_megabytes();
  if (total > 2 * tenth) writer.write(total - 2 * tenth, tell);
  const size_t before = writer.observations();
  const double processor_before = writer.processor();
  writer.write(tenth, tell);
  figures.last_tenth_rate = double(writer.observations() - before) / (writer.processor() - processor_before);
  figures.megabytes_at_end = resident_megabytes();
  figures.identity = writer.identity();
  figures.scenes = writer.scenes();
  figures.observations = writer.observations();
  figures.processor_rate = double(figures.observations) / writer.processor();
  figures.wall_rate = double(figures.observations) / writer.wall();
}

/// A tenth more alone, then as much beside readers.
void write_beside_readers(Writer& writer, const MemoryOptions& options, const fs::path& file,
                          MemoryFigures& figures, Progress& progress) {
  const size_t part = std::max<size_t>(2000, static_cast<size_t>(options.observations) / 20);
  const auto tell = [&] { progress.check(0.5, "one writer, several readers"); };
  const auto rate = [&] {
    const Stopwatch watch;
    const size_t before = writer.observations();
    writer.write(part, tell);
    return double(writer.observations() - before) / watch.seconds();
  };
  figures.rate_alone = rate();
  std::atomic<bool> stop = false;
  std::atomic<size_t> asked = 0;
  std::vector<std::thread> readers;
  for (int i = 0; i < options.readers; ++i)
    readers.emplace_back([&, i] {
      const memory::Store store = memory::Store::open_read(file);
      Random random(static_cast<uint64_t>(options.seed + 100 + i));
      const auto objects = static_cast<uint64_t>(store.max_object_id());
      while (!stop) {
        ask(store, memory::WhereQuestion{
                       memory::object_name(static_cast<memory::Id>(1 + random.index(objects))), {}});
        ++asked;
        std::this_thread::sleep_for(std::chrono::duration<double>(1 / options.reader_hz));
      }
    });
  figures.rate_with_readers = rate();
  stop = true;
  for (std::thread& reader : readers) reader.join();
  figures.reader_questions = asked;
}

class Asker {
 public:
  /// `plain` may be null: then nothing is compared.
  Asker(const MemoryOptions& options, const memory::Store& store, PlainTables* plain)
      : options_(options), store_(store), plain_(plain), random_(static_cast<uint64_t>(options.seed + 1)) {
    first_ = store.scene(1).time;
    last_ = *store.last_scene_time();
    objects_ = static_cast<uint64_t>(store.max_object_id());
  }

  std::vector<QuestionFigures> run() {
    const auto object = [&] { return static_cast<memory::Id>(1 + random_.index(objects_)); };
    const auto place = [&] { return Home::place_name(static_cast<int>(random_.index(places()))); };
    time("where is object N", [&] {
      return ask(store_, memory::WhereQuestion{memory::object_name(object()), {}}).objects.size();
    });
    compare([&] { return plain_->last_seen(object()); });
    time("the same, as a query and as text", [&] {
      const memory::Query query{.question = "where",
                                .arguments = {{"object", memory::object_name(object())}}};
      return memory::ask(store_, query).to_text(memory::TimeWriter(store_)).size();
    });
    time(
        "where was object N at T",
        [&] {
          const memory::Id id = object();
          const TimeNs seen = store_.first_observation_after(id, 0, {})->time;  // before, it was not known
          asked_at_ = std::max(seen, some_time());
          return id;
        },
        [&](memory::Id id) {
          return ask(store_, memory::WhereQuestion{memory::object_name(id), {.at = asked_at_}})
              .objects.size();
        });
    time("what is on PLACE",
         [&] { return ask(store_, memory::ContentsQuestion{.place = place()}).places.front().there.size(); });
    compare([&] { return plain_->at_place(1 + static_cast<memory::Id>(random_.index(places())), last_); });
    time("what was on PLACE at T", [&] {
      return ask(store_, memory::ContentsQuestion{.place = place(), .as_of = {.at = some_time()}})
          .places.front()
          .there.size();
    });
    compare(
        [&] { return plain_->at_place(1 + static_cast<memory::Id>(random_.index(places())), some_time()); });
    const auto point = [&] { return Vector3d(random_.uniform(-1, 13), random_.uniform(-1, 5), 0.8); };
    time("what was within 0.5 m of a point at T",
         [&] { return store_.objects_near(point(), 0.5, {.at = some_time()}).size(); });
    compare([&] { return plain_->near(point(), 0.5, some_time()); });
    time("what changed in an hour", [&] {
      const TimeNs from = some_time();
      return ask(store_, memory::ChangesQuestion{.from = from, .to = from + kHour}).changes.size();
    });
    time("was object N on PLACE in an hour", [&] {
      const TimeNs from = some_time();
      return ask(store_, memory::WasQuestion{memory::object_name(object()), place(), from, from + kHour, {}})
          .objects.size();
    });
    time("what bears the word milk", [&] { return store_.objects_with_text("milk").size(); });
    compare([&] { return plain_->with_text("milk"); });
    return std::move(results_);
  }

 private:
  uint64_t places() const { return static_cast<uint64_t>(options_.home.places); }
  TimeNs some_time() {
    return first_ + static_cast<TimeNs>(random_.uniform() * static_cast<double>(last_ - first_));
  }

  template <class Ask>
  std::vector<double> milliseconds(Ask ask_one, size_t& most) {
    std::vector<double> times;
    for (int i = 0; i < options_.questions; ++i) {
      const double begin = thread_cpu_seconds();
      most = std::max(most, ask_one());
      times.push_back(1000 * (thread_cpu_seconds() - begin));
    }
    return times;
  }

  template <class Ask>
  void time(const std::string& name, Ask ask_one) {
    QuestionFigures& figures = results_.emplace_back();
    figures.name = name;
    const std::vector<double> times = milliseconds(ask_one, figures.max_rows);
    figures.median_ms = median(times);
    figures.p99_ms = quantile(times, 0.99);
  }
  template <class Prepare, class Ask>
  void time(const std::string& name, Prepare prepare, Ask ask_one) {
    std::vector<memory::Id> prepared;
    std::vector<TimeNs> at;
    for (int i = 0; i < options_.questions; ++i) {
      prepared.push_back(prepare());
      at.push_back(asked_at_);
    }
    size_t next = 0;
    time(name, [&] {
      asked_at_ = at[next];
      return ask_one(prepared[next++]);
    });
  }
  template <class Ask>
  void compare(Ask ask_one) {
    if (plain_ == nullptr) return;
    size_t most = 0;
    const std::vector<double> times = milliseconds(ask_one, most);
    results_.back().plain_median_ms = median(times);
    results_.back().plain_p99_ms = quantile(times, 0.99);
  }

  const MemoryOptions& options_;
  const memory::Store& store_;
  PlainTables* plain_;
  Random random_;
  TimeNs first_ = 0, last_ = 0, asked_at_ = 0;
  uint64_t objects_ = 0;
  std::vector<QuestionFigures> results_;
};

}  // namespace

void MemoryOptions::declare(OptionTable& table) {
  table.integer("observations", observations, "", "Observations to take in.", 100, 100'000'000);
  table.integer("seed", seed, "", "Seed of the simulated home.", 0, 1'000'000'000);
  table.integer("readers", readers, "", "Readers beside the writer.", 0, 100);
  table.number("reader_hz", reader_hz, "Hz", "Questions that each of them asks per second.", 0.1, 10000);
  table.integer("questions", questions, "", "Questions of each kind.", 10, 100000);
  table.flag("reuse", reuse, "Take nothing in: ask the memory that an earlier run left in the folder.");
  table.integer("kills", kills, "", "Random moments at which a writer is killed.", 0, 10000);
  table.integer("places", home.places, "", "Tables that are looked at one after the other.", 1, 1000);
  table.integer("objects", home.objects, "", "Objects in the home at any time.", 1, 10000);
  table.number("moves", home.moves, "", "Objects put elsewhere per scene.", 0, 1);
  table.number("exchanges", home.exchanges, "", "Objects that leave for good and are replaced per scene.", 0,
               1);
  table.number("detection", home.detection, "", "Probability that an object in view is detected.", 0.1, 1);
  table.number("clutter", home.clutter, "", "False detections per scene.", 0, 1);
  table.number("noise_m", home.noise_m, "m", "Noise of positions per axis.", 0.0001, 0.1);
}

namespace {

void take_in(const MemoryOptions& options, const fs::path& file, MemoryFigures& figures, Progress& progress) {
  Writer writer(options, file);
  PartialProgress part(progress, 0, 0.7);
  ingest_all(writer, options, figures, part);
  if (options.readers > 0) write_beside_readers(writer, options, file, figures, progress);
  writer.finish();
}

/// Opens, asks and verifies a memory that nobody writes to.
void examine(const MemoryOptions& options, const fs::path& file, const fs::path& plain_file,
             MemoryFigures& figures, Progress& progress) {
  const double before_open = thread_cpu_seconds();
  const memory::Store store = memory::Store::open_read(file);
  ask(store, memory::WhereQuestion{memory::object_name(1), {}});
  figures.open_ms = 1000 * (thread_cpu_seconds() - before_open);
  figures.objects = static_cast<size_t>(store.max_object_id());
  figures.bytes_per_observation = double(fs::file_size(file)) / double(store.max_observation_id());
  std::optional<PlainTables> plain;
  if (!options.reuse) figures.plain_rate = plain.emplace(plain_file, file).write_rate();
  progress.check(0.8, "asking");
  figures.questions = Asker(options, store, plain ? &*plain : nullptr).run();
  const double before_rows = thread_cpu_seconds();
  store.statistics(false);
  figures.statistics_ms = 1000 * (thread_cpu_seconds() - before_rows);
  const double before_bytes = thread_cpu_seconds();
  store.statistics();
  figures.table_bytes_ms = 1000 * (thread_cpu_seconds() - before_bytes);
  PartialProgress part(progress, 0.9, 1);
  const Stopwatch verify;
  if (const auto problems = store.verify(part).problems; !problems.empty())
    throw Error("the memory is not sound: " + problems.front(), {file.string(), 0, {}});
  figures.verify_s = verify.seconds();
}

}  // namespace

MemoryFigures measure(const MemoryOptions& options, const fs::path& folder, Progress& progress) {
  MemoryFigures figures;
  const fs::path file = folder / "simulated.loci", plain_file = folder / "plain.sqlite";
  fs::remove(plain_file);
  if (!options.reuse) {
    fs::remove(file);
    take_in(options, file, figures, progress);
  }
  examine(options, file, plain_file, figures, progress);
  fs::remove(plain_file);
  if (options.kills > 0) {
    const fs::path killed = folder / "killed.loci";
    fs::remove(killed);
    kill_writers(options, killed, figures, progress);
  }
  return figures;
}

std::string text_of(const MemoryFigures& f) {
  std::string text;
  if (f.observations > 0)
    text = fmt::format(
               "{} scenes, {} observations\n"
               "  taken in: {:.0f} observations per second of CPU time ({:.0f} in the first tenth, {:.0f} in "
               "the last), {:.0f} per second of the clock\n"
               "  plain tables without reasoning: {:.0f} per second of the clock\n"
               "  memory of the writer: {:.0f} MB after a tenth, {:.0f} MB at the end\n",
               f.scenes, f.observations, f.processor_rate, f.first_tenth_rate, f.last_tenth_rate, f.wall_rate,
               f.plain_rate, f.megabytes_first_tenth, f.megabytes_at_end) +
           text_of(f.identity);
  text += fmt::format(
      "  {} objects, {:.0f} bytes per observation\n"
      "  opened and asked once: {:.0f} ms; rows of all tables: {:.0f} ms, their bytes: {:.0f} ms; verify: "
      "{:.1f} s\n",
      f.objects, f.bytes_per_observation, f.open_ms, f.statistics_ms, f.table_bytes_ms, f.verify_s);
  if (f.reader_questions > 0)
    text += fmt::format(
        "  beside readers ({} questions): {:.0f} per second of the clock, alone {:.0f} ({:.0f} %)\n",
        f.reader_questions, f.rate_with_readers, f.rate_alone, 100 * f.rate_with_readers / f.rate_alone);
  if (f.kills > 0)
    text += fmt::format("  killed {} times: {} with a committed scene lost, {} not sound\n", f.kills,
                        f.kills_lost, f.kills_unsound);
  text += fmt::format("  {:40} {:>10} {:>10} {:>12} {:>10} {:>6}\n", "question, ms", "median", "p99",
                      "plain median", "p99", "rows");
  for (const QuestionFigures& q : f.questions) {
    text += fmt::format("  {:40} {:10.3f} {:10.3f}", q.name, q.median_ms, q.p99_ms);
    text += q.plain_median_ms < 0 ? fmt::format(" {:>12} {:>10}", "", "")
                                  : fmt::format(" {:12.3f} {:10.3f}", q.plain_median_ms, q.plain_p99_ms);
    text += fmt::format(" {:6}\n", q.max_rows);
  }
  text.pop_back();
  return text;
}

Json json_of(const MemoryFigures& f) {
  Json questions = Json::array();
  for (const QuestionFigures& q : f.questions) {
    Json one = {
        {"question", q.name}, {"median_ms", q.median_ms}, {"p99_ms", q.p99_ms}, {"max_rows", q.max_rows}};
    if (q.plain_median_ms >= 0) one["plain"] = {{"median_ms", q.plain_median_ms}, {"p99_ms", q.plain_p99_ms}};
    questions.push_back(std::move(one));
  }
  return {{"scenes", f.scenes},
          {"observations", f.observations},
          {"objects", f.objects},
          {"observations_per_s",
           {{"processor", f.processor_rate},
            {"first_tenth", f.first_tenth_rate},
            {"last_tenth", f.last_tenth_rate},
            {"clock", f.wall_rate},
            {"plain_tables", f.plain_rate},
            {"alone", f.rate_alone},
            {"beside_readers", f.rate_with_readers}}},
          {"identity", json_of(f.identity)},
          {"bytes_per_observation", f.bytes_per_observation},
          {"resident_mb", {{"first_tenth", f.megabytes_first_tenth}, {"end", f.megabytes_at_end}}},
          {"open_ms", f.open_ms},
          {"statistics_ms", f.statistics_ms},
          {"table_bytes_ms", f.table_bytes_ms},
          {"verify_s", f.verify_s},
          {"kills", {{"times", f.kills}, {"lost", f.kills_lost}, {"not_sound", f.kills_unsound}}},
          {"questions", questions}};
}

}  // namespace loci::apps::memory_experiment
