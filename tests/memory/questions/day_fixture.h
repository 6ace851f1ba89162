#pragma once

#include <gmock/gmock.h>

#include "memory/questions/time_parser.h"
#include "tests/memory/questions/synthetic_day.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory::testing_support {

/// A test that asks the memory of the synthetic day.
class DayFixture : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    const SyntheticDay day(file_);
    store_.emplace(Store::open_read(file_));
  }
  void TearDown() override {
    store_.reset();
    TemporaryFolder::TearDown();
  }
  static AsOf at(const std::string& clock) { return {.at = day_time(clock)}; }
  template <class Answer>
  std::string text(const Answer& answer) const {
    return to_text(answer, TimeWriter(*store_));
  }

  std::optional<Store> store_;
};

}  // namespace loci::memory::testing_support
