#pragma once

#include <cstddef>
#include <functional>

namespace loci {

/// Calls task(begin, end) for consecutive parts that cover [0, count), on up to `threads` threads (0 = all
/// cores), the caller's among them. Where a part begins depends on the number of threads: results must not
/// depend on the parts. The first exception of a task is thrown again here.
void parallel_for(size_t count, int threads, const std::function<void(size_t begin, size_t end)>& task);

/// Calls task(i) for each i in [0, count), each as soon as a thread is free: for tasks of very different
/// length. Otherwise as parallel_for.
void parallel_each(size_t count, int threads, const std::function<void(size_t i)>& task);

/// `threads` if positive, otherwise the number of cores.
int thread_count(int threads);

}  // namespace loci
