#include "mapping/base/math/cell_index.h"

#include <gtest/gtest.h>

#include <map>

#include "mapping/base/math/random.h"

namespace loci {
namespace {

TEST(CellIndex, NumbersCellsInOrderOfFirstInsertion) {
  CellIndex index(4);
  EXPECT_EQ(index.insert({0, 0, 0}), 0U);
  EXPECT_EQ(index.insert({-1, 5, 2}), 1U);
  EXPECT_EQ(index.insert({0, 0, 0}), 0U);
  EXPECT_EQ(index.find({-1, 5, 2}), 1U);
  EXPECT_EQ(index.find({9, 9, 9}), CellIndex::kNone);
}

TEST(CellIndex, AgreesWithAMapWhileItGrows) {
  CellIndex index(1);
  std::map<std::array<int, 3>, uint32_t> reference;
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    std::array<int, 3> cell{};
    for (int& value : cell) value = static_cast<int>(random.index(40)) - 20;
    const auto next = static_cast<uint32_t>(reference.size());
    const uint32_t expected = reference.try_emplace(cell, next).first->second;
    ASSERT_EQ(index.insert({cell[0], cell[1], cell[2]}), expected);
  }
  EXPECT_EQ(index.size(), reference.size());
}

TEST(CellIndex, CellOfRoundsDown) {
  EXPECT_EQ(cell_of(Eigen::Vector3d(-0.01, 0.0, 0.199), 0.1), Eigen::Vector3i(-1, 0, 1));
}

}  // namespace
}  // namespace loci
