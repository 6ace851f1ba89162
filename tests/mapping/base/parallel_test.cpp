#include "mapping/base/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace loci {
namespace {

TEST(ParallelEach, DoesEveryTaskOnce) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> done(100, 0);
    parallel_each(done.size(), threads, [&](size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(100, 1));
  }
  parallel_each(0, 2, [](size_t) { FAIL(); });
}

TEST(ParallelEach, PassesAnExceptionOn) {
  const auto task = [](size_t i) {
    if (i == 3) throw std::runtime_error("three");
  };
  EXPECT_THROW(parallel_each(8, 2, task), std::runtime_error);
}

}  // namespace
}  // namespace loci
