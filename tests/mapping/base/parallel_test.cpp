#include "mapping/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
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

TEST(ParallelStages, EveryStageTakesTheItemsInOrder) {
  for (const size_t in_flight : {1, 2, 5}) {
    std::vector<std::vector<size_t>> taken(3);
    std::atomic<int> under_way = 0;
    parallel_stages(
        in_flight, taken.size(), [&](size_t item) { return item < 20 && ++under_way > 0; },
        [&](size_t item, size_t stage) {
          EXPECT_LE(under_way, static_cast<int>(in_flight));
          taken[stage].push_back(item);
          if (stage == 2) --under_way;
        });
    std::vector<size_t> all(20);
    std::iota(all.begin(), all.end(), size_t{0});
    EXPECT_EQ(taken, std::vector<std::vector<size_t>>(3, all));
  }
}

TEST(ParallelStages, WhatBeganBeforeAFailureComesThrough) {
  for (const size_t in_flight : {1, 2, 5}) {
    std::vector<size_t> through;
    const auto work = [&](size_t item, size_t stage) {
      if (stage == 0 && item == 4) throw std::runtime_error("four");
      if (stage == 1 && item == 6) throw std::runtime_error("six");
      if (stage == 1) through.push_back(item);
    };
    EXPECT_THROW(parallel_stages(
                     in_flight, 2, [](size_t) { return true; }, work),
                 std::runtime_error);
    EXPECT_EQ(through, (std::vector<size_t>{0, 1, 2, 3}));
  }
}

TEST(ParallelStages, AFailureToBeginEndsTheLine) {
  size_t through = 0;
  const auto begin = [](size_t item) -> bool { return item < 3 ? true : throw std::runtime_error("three"); };
  EXPECT_THROW(parallel_stages(2, 1, begin, [&](size_t, size_t) { ++through; }), std::runtime_error);
  EXPECT_EQ(through, 3U);
}

}  // namespace
}  // namespace loci
