#include "mapping/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <thread>
#include <vector>

namespace loci {
namespace {

/// TBB orders what stands before a loop, its parts, and what follows. The thread sanitizer, which does not
/// look into TBB, sees it by the changes of this.
std::atomic<size_t> tasks_in_order = 0;

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
  using Control = tbb::global_control;
  std::optional<Control> more_threads;  // Than cores: for tasks that wait, e.g. for a network.
  if (parts > Control::active_value(Control::max_allowed_parallelism))
    more_threads.emplace(Control::max_allowed_parallelism, parts);
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

}  // namespace loci
