#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "apps/cli/aside.h"
#include "apps/cli/program.h"
#include "mapping/base/terminal.h"
#include "mapping/base/text/json.h"
#include "mapping/base/user_time_zone.h"

namespace loci::apps {
namespace {

using Clock = std::chrono::steady_clock;

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
    if (drawn_ && terminal_) print_aside("\r\033[K");
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
      print_aside(fmt::format("\r\033[K[{}{}] {:3.0f} %  {}{}", std::string(filled, '='),
                              std::string(30 - filled, ' '), 100 * fraction, terminal_text(text), left));
    } else {
      print_aside(fmt::format("{:3.0f} %  {}{}\n", 100 * fraction, terminal_text(text), left));
    }
  }

  bool quiet_;
  bool terminal_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

}  // namespace

Session::Session(const CommonFlags& flags, OutputOptions outputs)
    : flags_(flags),
      outputs_(std::move(outputs)),
      progress_(std::make_unique<TerminalProgress>(flags.quiet)) {}

Session::~Session() = default;

void Session::check_outputs(const std::filesystem::path& folder,
                            const std::vector<std::string>& names) const {
  for (const std::string& name : names) check_output(folder / name, outputs_);
}

void Session::answer(const std::string& text, const Json& json) {
  progress_ = std::make_unique<TerminalProgress>(true);  // Clears the bar before the answer is printed.
  if (flags_.json)                                       // Names of files, for example, need not be UTF-8.
    fmt::print("{}\n", terminal_text(json.dump(2, ' ', false, Json::error_handler_t::replace)));
  else
    fmt::print("{}{}", terminal_text(text), text.ends_with('\n') || text.empty() ? "" : "\n");
}

void Session::log(const std::string& line) {
  if (!flags_.quiet) print_aside(terminal_text(line) + "\n");
}

void Session::timing(const std::string& stage, double seconds) {
  if (flags_.timing) print_aside(fmt::format("{:>10.3f} s  {}\n", seconds, terminal_text(stage)));
}

void Session::show_warnings() {
  progress_.reset();
  if (flags_.quiet) return;
  // What every frame says again is said once.
  std::vector<std::string> texts;
  std::map<std::string, size_t> times;
  for (const std::string& text : warnings_.texts())
    if (++times[text] == 1) texts.push_back(text);
  const size_t shown = flags_.verbose ? texts.size() : std::min<size_t>(texts.size(), 5);
  for (size_t i = 0; i < shown; ++i)
    print_aside(fmt::format("warning: {}{}\n", terminal_text(texts[i]),
                            times[texts[i]] > 1 ? fmt::format(" ({} times)", times[texts[i]]) : ""));
  if (shown < texts.size())
    print_aside(fmt::format("warning: {} more (--verbose shows all)\n", texts.size() - shown));
}

std::string machine_time_zone() {
  return user_time_zone(std::getenv("TZ")).name();
}

}  // namespace loci::apps
