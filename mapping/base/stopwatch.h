#pragma once

#include <chrono>
#include <ctime>

namespace loci {

/// Seconds of a stage and its parts, by the clock on the wall unless it says otherwise, for reports. Never
/// decides a result.
class Stopwatch {
 public:
  /// Seconds since it was made.
  double seconds() const { return since(start_, Clock::now()); }

  /// Processor time of all threads since it was made.
  double processor_seconds() const { return static_cast<double>(std::clock() - processor_) / CLOCKS_PER_SEC; }

  /// Seconds since it was made or the last lap.
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
  std::clock_t processor_ = std::clock();
};

}  // namespace loci
