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

/// An assembly line: begin(item) is called for the items 0, 1, … until it returns false, and work(item,
/// stage) for the stages 0, 1, … of each. A stage takes the items one at a time and in order, while other
/// items are in other stages; at most `in_flight` have begun and not come through (item i + in_flight begins
/// after item i). An exception ends the line: what began before that item comes through, and it is rethrown.
void parallel_stages(size_t in_flight, size_t stages, const std::function<bool(size_t item)>& begin,
                     const std::function<void(size_t item, size_t stage)>& work);

/// `threads` if positive, otherwise the number of cores.
int thread_count(int threads);

}  // namespace loci
