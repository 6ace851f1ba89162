#pragma once

#include <cstddef>
#include <functional>

namespace loci {

/// Calls task(begin, end) for consecutive parts that cover [0, count), on up to `threads` threads (0 = all
/// cores) including the caller's. The parts depend on the number of threads; results must not depend on them.
/// Rethrows the exception of the first part that failed.
void parallel_for(size_t count, int threads, const std::function<void(size_t begin, size_t end)>& task);

/// Calls task(i) for each i in [0, count) as threads become free: for tasks of very different length.
/// Otherwise as parallel_for.
void parallel_each(size_t count, int threads, const std::function<void(size_t i)>& task);

/// `threads` if positive, otherwise the number of cores.
int thread_count(int threads);

}  // namespace loci
