#pragma once

#include <chrono>
#include <ctime>

namespace loci {

/// CPU time of the calling thread, which other programs beside do not lengthen. Never affects a result.
inline double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Wall time of a stage and its laps, and CPU time, for reports. Never affects a result.
class Stopwatch {
 public:
  /// Seconds since construction.
  double seconds() const { return since(start_, Clock::now()); }

  /// CPU time of all threads since construction.
  double cpu_seconds() const { return static_cast<double>(std::clock() - cpu_) / CLOCKS_PER_SEC; }

  /// Seconds since construction or the last lap.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = since(lap_, now);
    lap_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double since(Clock::time_point begin, Clock::time_point end) {
    return std::chrono::duration<double>(end - begin).count();
  }
  Clock::time_point start_ = Clock::now();
  Clock::time_point lap_ = start_;
  std::clock_t cpu_ = std::clock();
};

}  // namespace loci
