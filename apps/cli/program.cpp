#include "apps/cli/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>

#include "mapping/base/json.h"

namespace loci::apps {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int) {
  interrupt_requested = 1;
}

std::string duration_text(double seconds) {
  const auto total = static_cast<long>(seconds + 0.5);
  return total < 60 ? fmt::format("{} s", total) : fmt::format("{} min {:02} s", total / 60, total % 60);
}

/// A bar on a terminal, a plain line every few seconds in a log. Nothing at all for what takes under a
/// second.
class TerminalProgress : public Progress {
 public:
  explicit TerminalProgress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}
  ~TerminalProgress() override {
    if (drawn_ && terminal_) fmt::print(stderr, "\r\033[K");
  }

  bool update(double fraction, std::string_view text) override {
    if (interrupted()) return false;
    const auto time = Clock::now();
    const double interval = terminal_ ? 0.1 : 5.0;
    const double since_last = std::chrono::duration<double>(time - last_).count();
    const double elapsed = std::chrono::duration<double>(time - start_).count();
    if (quiet_ || elapsed < 1 || (drawn_ && since_last < interval)) return true;
    last_ = time;
    drawn_ = true;
    draw(std::clamp(fraction, 0.0, 1.0), text, elapsed);
    return true;
  }

 private:
  void draw(double fraction, std::string_view text, double elapsed) const {
    const std::string left =
        fraction > 0.02 ? ", " + duration_text(elapsed * (1 - fraction) / fraction) + " left" : "";
    if (terminal_) {
      const auto filled = static_cast<size_t>(fraction * 30);
      fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %  {}{}", std::string(filled, '='),
                 std::string(30 - filled, ' '), 100 * fraction, text, left);
    } else {
      fmt::print(stderr, "{:3.0f} %  {}{}\n", 100 * fraction, text, left);
    }
  }

  bool quiet_;
  bool terminal_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

std::string examples_text(const std::vector<std::string>& examples) {
  return examples.empty() ? "" : fmt::format("Examples:\n  {}\n", fmt::join(examples, "\n  "));
}

void add_common_flags(CLI::App& app, CommonFlags& flags) {
  app.add_flag("--json", flags.json, "The answer as JSON");
  app.add_flag("--quiet", flags.quiet, "No progress, no warnings");
  app.add_flag("--verbose", flags.verbose, "Show every warning");
  app.add_flag("--timing", flags.timing, "Show where the time went");
  app.add_option("--threads", flags.threads, "Threads, 0 = all cores [0]")->check(CLI::Range(0, 1024));
}

/// Images come and go with every frame: their memory is kept for the next one instead of being given back
/// to the system, which would have to clear it again page by page (a seventh of the time of a frame).
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

}  // namespace

bool interrupted() {
  return interrupt_requested != 0;
}

void install_interrupt_handler() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

Session::Session(const CommonFlags& flags)
    : flags_(flags), progress_(std::make_unique<TerminalProgress>(flags.quiet)) {}

Session::~Session() = default;

void Session::answer(const std::string& text, const Json& json) {
  progress_ = std::make_unique<TerminalProgress>(true);  // Clears the bar before the answer is printed.
  if (flags_.json)
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));  // e.g. names of files
  else
    fmt::print("{}{}", text, text.ends_with('\n') || text.empty() ? "" : "\n");
}

void Session::timing(const std::string& stage, double seconds) {
  if (flags_.timing) fmt::print(stderr, "{:>10.3f} s  {}\n", seconds, stage);
}

void Session::show_warnings() {
  progress_.reset();
  if (flags_.quiet) return;
  const auto& texts = warnings_.texts();
  const size_t shown = flags_.verbose ? texts.size() : std::min<size_t>(texts.size(), 5);
  for (size_t i = 0; i < shown; ++i) fmt::print(stderr, "warning: {}\n", texts[i]);
  if (shown < texts.size())
    fmt::print(stderr, "warning: {} more (--verbose shows all)\n", texts.size() - shown);
}

Program::Program(std::string name, std::string description)
    : name_(std::move(name)), app_(std::move(description), name_) {
  app_.require_subcommand(1);
  app_.set_version_flag("--version", std::string("loci " LOCI_VERSION));
  app_.failure_message(CLI::FailureMessage::help);
}

void Program::add(Command command) {
  CLI::App* sub = app_.add_subcommand(command.name, command.description);
  sub->footer(examples_text(command.examples));
  add_common_flags(*sub, flags_);
  runs_.emplace_back(sub, command.declare(*sub));
}

std::vector<std::string> Program::commands() const {
  std::vector<std::string> names;
  for (const CLI::App* sub : app_.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

int Program::run(int argc, char** argv) {
  install_interrupt_handler();
  keep_freed_memory();
  const auto names = commands();
  if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end()) {
    const std::string nearest = did_you_mean(argv[1], names);
    fmt::print(stderr, "{}: unknown command '{}'; {}\n", name_, argv[1],
               nearest.empty() ? name_ + " --help lists the commands" : nearest);
    return 2;
  }
  try {
    app_.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app_.exit(error);
    return code == 0 ? 0 : 2;
  }
  for (const auto& [sub, command] : runs_) {
    if (!sub->parsed()) continue;
    return run_guarded(name_ + " " + sub->get_name(), [&, &body = command] {
      Session session(flags_);
      try {
        body(session);
      } catch (...) {
        session.show_warnings();
        throw;
      }
      session.show_warnings();
      return 0;
    });
  }
  return 2;
}

void add_options(CLI::App& app, const OptionTable& table) {
  for (const Option& option : table.options()) {
    std::string flag = "--" + option.name;
    std::replace(flag.begin(), flag.end(), '_', '-');
    const std::string unit = option.unit.empty() ? "" : " " + option.unit;
    const std::string sentence = fmt::format("{} [{}{}]", option.sentence, option_text(option), unit);
    std::visit(
        [&](auto* value) {
          using T = std::remove_pointer_t<decltype(value)>;
          if constexpr (std::is_same_v<T, bool>)
            app.add_flag(flag + ",!--no-" + flag.substr(2), *value, sentence);
          else
            app.add_option(flag, *value, sentence);
        },
        option.value);
  }
}

int run_guarded(const std::string& program, const std::function<int()>& main) {
  try {
    return main();
  } catch (const Interrupted&) {
    fmt::print(stderr, "{}: interrupted\n", program);
    return 130;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", program, error.what());
    return 1;
  }
}

}  // namespace loci::apps
