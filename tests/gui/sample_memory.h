#pragma once

#include <filesystem>

#include "mapping/base/time.h"

namespace loci::gui::test {

/// A small memory of the sample kitchen, written through the store: three scenes half an hour apart.
///   07:00  a red cup (object 1) and a blue box (object 2) on counter_1
///   07:30  the table is looked at: the box has moved to table_1; the cup is out of view, drawer_2 is open
///   08:00  the counter again: the cup has gone, a green tin (object 3) has appeared
struct SampleMemory {
  std::filesystem::path path;
  TimeNs first = 0, second = 0, third = 0;
};

SampleMemory write_sample_memory(const std::filesystem::path& path);

}  // namespace loci::gui::test
