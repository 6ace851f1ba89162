#include "mapping/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace loci {

int thread_count(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(size_t count, int threads, const std::function<void(size_t, size_t)>& task) {
  const size_t parts = std::min(count, static_cast<size_t>(thread_count(threads)));
  if (parts <= 1) {
    if (count > 0) task(0, count);
    return;
  }
  std::vector<std::exception_ptr> failures(parts);
  const auto run = [&](size_t part) {
    try {
      task(count * part / parts, count * (part + 1) / parts);
    } catch (...) {
      failures[part] = std::current_exception();
    }
  };
  std::vector<std::jthread> workers;  // They join by themselves if the system refuses to start another one.
  workers.reserve(parts - 1);
  for (size_t part = 1; part < parts; ++part) workers.emplace_back(run, part);
  run(0);
  for (std::jthread& worker : workers) worker.join();
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
