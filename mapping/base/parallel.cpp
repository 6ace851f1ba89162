#include "mapping/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace loci {
namespace {

/// TBB orders what stands before a loop, its parts, and what follows. The thread sanitizer, which does not
/// look into TBB, sees it by the changes of this.
std::atomic<size_t> tasks_in_order = 0;

/// Lets there be more threads than cores while it lives: for tasks that wait, e.g. for a network.
std::optional<tbb::global_control> allow_threads(size_t count) {
  using Control = tbb::global_control;
  std::optional<Control> more;
  if (count > Control::active_value(Control::max_allowed_parallelism))
    more.emplace(Control::max_allowed_parallelism, count);
  return more;
}

/// The first item of an assembly line at which something failed, and how.
class FirstFailure {
 public:
  /// Runs what is to be done for an item, unless it or an earlier one has failed.
  void run(size_t item, const std::function<void()>& task) {
    if (item >= item_) return;
    ++tasks_in_order;
    try {
      task();
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      if (item < item_) {
        item_ = item;
        exception_ = std::current_exception();
      }
    }
    ++tasks_in_order;
  }
  bool any() const { return item_ != kNone; }
  void rethrow() const {
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  static constexpr size_t kNone = std::numeric_limits<size_t>::max();
  std::atomic<size_t> item_ = kNone;
  std::exception_ptr exception_;
  std::mutex mutex_;
};

}  // namespace

int thread_count(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(size_t count, int threads, const std::function<void(size_t, size_t)>& task) {
  const size_t parts = std::min(count, static_cast<size_t>(thread_count(threads)));
  if (parts <= 1) {
    if (count > 0) task(0, count);
    return;
  }
  const auto more_threads = allow_threads(parts);
  std::vector<std::exception_ptr> failures(parts);
  const auto run = [&](size_t part) {
    ++tasks_in_order;
    try {
      task(count * part / parts, count * (part + 1) / parts);
    } catch (...) {
      failures[part] = std::current_exception();
    }
    ++tasks_in_order;
  };
  ++tasks_in_order;
  // An arena of its own: a thread that waits here takes no other work, of which it might hold a lock.
  tbb::task_arena arena(static_cast<int>(parts));
  arena.execute([&] { tbb::parallel_for(size_t{0}, parts, run, tbb::simple_partitioner()); });
  ++tasks_in_order;
  for (const auto& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

void parallel_each(size_t count, int threads, const std::function<void(size_t)>& task) {
  std::atomic<size_t> next = 0;
  const size_t workers = std::min(count, static_cast<size_t>(thread_count(threads)));
  parallel_for(workers, threads, [&](size_t, size_t) {
    for (size_t i = next++; i < count; i = next++) task(i);
  });
}

void parallel_stages(size_t in_flight, size_t stages, const std::function<bool(size_t)>& begin,
                     const std::function<void(size_t, size_t)>& work) {
  if (in_flight <= 1) {
    for (size_t item = 0; begin(item); ++item)
      for (size_t stage = 0; stage < stages; ++stage) work(item, stage);
    return;
  }
  constexpr auto kInOrder = tbb::filter_mode::serial_in_order;
  FirstFailure failure;
  size_t next = 0;
  tbb::filter<void, size_t> line = tbb::make_filter<void, size_t>(kInOrder, [&](tbb::flow_control& control) {
    ++tasks_in_order;
    bool more = false;
    if (!failure.any()) failure.run(next, [&] { more = begin(next); });
    if (!more) control.stop();
    const size_t item = next++;
    ++tasks_in_order;
    return item;
  });
  for (size_t stage = 0; stage < stages; ++stage)
    line = line & tbb::make_filter<size_t, size_t>(kInOrder, [&failure, &work, stage](size_t item) {
             failure.run(item, [&] { work(item, stage); });
             return item;
           });
  const auto more_threads = allow_threads(in_flight);
  ++tasks_in_order;
  tbb::task_arena arena(static_cast<int>(in_flight));
  arena.execute([&] {
    tbb::parallel_pipeline(in_flight, line & tbb::make_filter<size_t, void>(kInOrder, [](size_t) {}));
  });
  ++tasks_in_order;
  failure.rethrow();
}

}  // namespace loci
