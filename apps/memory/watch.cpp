// Standing questions: watch.

#include <fmt/format.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "memory/fleet/fleet_database.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/routines/standing_question.h"

namespace loci::apps {
namespace {

struct WatchArguments {
  std::string memory, command;
  std::vector<std::string> questions;
  std::optional<double> for_s;
  std::optional<int64_t> count;
};

/// Runs a command of the user; the event is in its environment, never in its text.
void run_command(const std::string& command, const memory::EventWatcher::News& news, const std::string& line,
                 Warnings& warnings) {
  setenv("LOCI_QUESTION", news.question.c_str(), 1);
  setenv("LOCI_EVENT", line.c_str(), 1);
  setenv("LOCI_EVENT_JSON", memory::format::change_record().json(news.change).dump().c_str(), 1);
  std::fflush(stdout);
  const int status = std::system(command.c_str());
  if (WIFSIGNALED(status))
    warnings.add(fmt::format("the command was ended by signal {}", WTERMSIG(status)));
  else if (WEXITSTATUS(status) != 0)
    warnings.add(fmt::format("the command ended with status {}", WEXITSTATUS(status)));
}

/// Whether there is something to wait for. `stopwatch` runs since the command began.
bool goes_on(const WatchArguments& arguments, const Stopwatch& stopwatch) {
  return !interrupted() && (!arguments.for_s || stopwatch.seconds() < *arguments.for_s);
}

void wait_a_moment() {
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
}

/// Waits for a memory that no program has made yet. Whether it was there from the beginning.
bool wait_for_memory(const WatchArguments& arguments, const Stopwatch& stopwatch, Session& session) {
  const auto is_there = [&] {
    return memory::is_fleet_url(arguments.memory) || std::filesystem::exists(arguments.memory);
  };
  if (is_there()) return true;
  session.log(fmt::format("{}: there is no such memory yet, waiting for it", arguments.memory));
  while (!is_there() && goes_on(arguments, stopwatch)) wait_a_moment();
  return false;
}

void watch(const WatchArguments& arguments, Session& session) {
  std::vector<memory::StandingQuestion> questions;
  for (const std::string& text : arguments.questions)
    questions.push_back(memory::parse_standing_question(text));
  memory::EventWatcher watcher(questions);
  const Stopwatch stopwatch;
  const bool was_there = wait_for_memory(arguments, stopwatch, session);
  if (!goes_on(arguments, stopwatch)) return;
  const std::function<std::filesystem::path()> source = memory_source(arguments.memory, session);
  {
    const memory::Store store = memory::Store::open_read(source());
    if (was_there) watcher.begin_now(store);
    for (const std::string& name : watcher.unknown(store))
      session.log(fmt::format("warning: {}: {} yet", arguments.memory, name));
  }
  int64_t count = 0;
  while (goes_on(arguments, stopwatch)) {
    wait_a_moment();
    const memory::Store store = memory::Store::open_read(source());
    const memory::TimeWriter times(store);
    for (const memory::EventWatcher::News& news : watcher.poll(store)) {
      const std::string line =
          fmt::format("{}  {}", memory::format::when_text(news.change, times), to_text(news.change));
      if (session.flags().json) {
        const Json json = {{"question", news.question},
                           {"event", memory::format::change_record().json(news.change)}};
        fmt::print("{}\n", json.dump());
      } else {
        fmt::print("{}{}\n", line, questions.size() > 1 ? fmt::format("  ({})", news.question) : "");
      }
      std::fflush(stdout);
      if (!arguments.command.empty()) run_command(arguments.command, news, line, session.warnings());
      if (arguments.count && ++count >= *arguments.count) return;
    }
  }
}

}  // namespace

Command watch_command() {
  return {
      .name = "watch",
      .description = "Wait for events while a memory is written: print them, or run a command",
      .examples = {"loci-memory watch \"red leaves table_1\" \"anything appears\" -m demo-output/memory.loci "
                   "--for 1",
                   "loci-memory watch \"drawer_1 opens\" -m demo-output/memory.loci --for 1 --run 'echo "
                   "\"$LOCI_EVENT\"'"},
      .declare = [](ArgumentTable& table) {
        auto arguments = std::make_shared<WatchArguments>();
        table.positional("EVENT...", &arguments->questions,
                         "What to wait for: " + memory::standing_question_forms());
        table.memory(arguments->memory);
        table.option("--run COMMAND", &arguments->command,
                     "Command to run at each event, with LOCI_EVENT, LOCI_EVENT_JSON and LOCI_QUESTION "
                     "in its environment");
        table.option("--count N", &arguments->count, "End after this many events",
                     {.default_text = "never", .min = 1});
        table.option("--for SECONDS", &arguments->for_s, "End after this time",
                     {.default_text = "never", .min = 0.1});
        return [arguments](Session& session) { watch(*arguments, session); };
      }};
}

}  // namespace loci::apps
