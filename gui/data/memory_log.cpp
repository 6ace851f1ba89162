#include "gui/data/memory_log.h"

#include <fmt/format.h>
#include <map>

#include "memory/questions/events.h"
#include "memory/report/memory_statistics.h"
#include "memory/store/store.h"

namespace loci::gui {
namespace {

std::string duration(TimeNs span) {
  return fmt::format("{:.1f} s", in_seconds(span));
}

LogEntry entry_of(const memory::RunRow& run, size_t scenes) {
  LogEntry entry{.time = run.started, .what = run.program};
  const std::string took = run.finished ? "took " + duration(*run.finished - run.started) : "did not finish";
  entry.is_problem = !run.finished;
  entry.text = fmt::format("{} scene{}, {}", scenes, scenes == 1 ? "" : "s", took);
  entry.details = fmt::format("run {}: {} {}\nstarted {}\n{}\nconfiguration {}", run.id, run.program,
                              run.version, format_time(run.started), entry.text, run.configuration);
  return entry;
}

LogEntry entry_of(const memory::AnnotatorTimes& times) {
  LogEntry entry{.what = times.name, .is_problem = times.failures > 0};
  entry.text = fmt::format("{:.1f} ms/scene, {} scene{}", times.ms_per_scene(), times.scenes,
                           times.scenes == 1 ? "" : "s");
  if (times.failures > 0) entry.text += fmt::format(", {} failed", times.failures);
  entry.details = fmt::format(
      "annotator {}\n{}\n{:.3f} s in all\nfailed {} times, {} of them for time; tried again {} times",
      times.name, entry.text, times.seconds, times.failures, times.timeouts, times.retries);
  return entry;
}

LogEntry entry_of(const memory::SceneRow& row, const memory::SceneSummary& summary) {
  LogEntry entry{
      .time = row.time, .what = fmt::format("scene {}", row.id), .scene = row.time, .scene_id = row.id};
  entry.text = fmt::format("{} observation{}", summary.observations, summary.observations == 1 ? "" : "s");
  if (!summary.has_pose) entry.text += ", no pose";
  entry.details = fmt::format("scene {} at {}\n{}\nknown from {}", row.id, format_time(row.time), entry.text,
                              format_time(row.known_from));
  if (summary.scene.recording)
    entry.details +=
        fmt::format("\nrecording {}, frame {}", *summary.scene.recording, summary.scene.frame.value_or(0));
  for (const auto& [place, part] : summary.seen_places)
    entry.details += fmt::format("\nobserved {} of {}", fmt::format("{:.0f} %", part * 100), place);
  return entry;
}

}  // namespace

std::vector<LogEntry> memory_log(const std::filesystem::path& path) {
  const memory::Store store = memory::Store::open_read(path);
  std::map<memory::Id, memory::SceneSummary> summaries;
  for (memory::SceneSummary& summary : ask(store, memory::ScenesQuestion{}).scenes)
    summaries[summary.scene.scene] = std::move(summary);
  std::map<memory::Id, std::vector<memory::SceneRow>> scenes;
  for (memory::SceneRow& scene : store.scenes()) scenes[scene.run].push_back(std::move(scene));
  std::vector<LogEntry> entries;
  for (const memory::AnnotatorTimes& times : memory::annotator_times(path))
    entries.push_back(entry_of(times));
  for (const memory::RunRow& run : store.runs()) {
    entries.push_back(entry_of(run, scenes[run.id].size()));
    for (const memory::SceneRow& scene : scenes[run.id])
      entries.push_back(entry_of(scene, summaries[scene.id]));
  }
  return entries;
}

std::string annotator_log(const std::filesystem::path& path, int64_t scene) {
  const std::vector<memory::LogRow> rows = memory::Store::open_read(path).log(scene);
  if (rows.empty()) return "The log of annotators is not stored for this scene.";
  double all = 0;
  std::string text;
  for (const memory::LogRow& row : rows) {
    all += row.milliseconds.value_or(0);
    text += "\n" + row.annotator;
    if (row.milliseconds) text += fmt::format(" {:.1f} ms", *row.milliseconds);
    if (row.level != "info") text += ", " + row.level;
    if (!row.text.empty()) text += ": " + row.text;
  }
  return fmt::format("annotators, {:.1f} ms together:{}", all, text);
}

std::string verify_memory(const std::filesystem::path& path, Progress& progress) {
  memory::VerifyReport report;
  try {
    report = memory::Store::open_read(path).verify(progress);
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    return fmt::format("It cannot be read at all: {}", error.what());
  }
  std::string text =
      report.problems.empty() ? "It is sound." : fmt::format("{} problem(s):", report.problems.size());
  for (const std::string& problem : report.problems) text += "\n" + problem;
  text += fmt::format("\nSchema {}.{}:", report.major, report.minor);
  for (const auto& [table, count] : report.counts)
    if (count > 0) text += fmt::format(" {} {},", count, table);
  text.back() = '.';
  return text;
}

}  // namespace loci::gui
