#include "mapping/update/pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace loci::mapping {
namespace {

/// A seat of 0.42 m with a back, whose legs nobody saw, close to the wall at x = 0.
class ChairAtAWall {
 public:
  ChairAtAWall() {
    for (float a = 0; a < 0.42F; a += kCell)
      for (float b = 0; b < 0.42F; b += kCell) {
        add({0.08F + a, 1 + b, 0.45F}, {0, 0, 1});
        add({0.08F, 1 + b, 0.45F + a}, {1, 0, 0});
      }
    map_.walls = {{.normal = Vector2d::UnitX(), .along_max = 4, .top = 2.5}};
  }

  /// A point that lies on no surface.
  void add_stray(const Eigen::Vector3f& position) { add(position, Eigen::Vector3f::Zero()); }

  std::vector<Piece> pieces() const {
    return free_standing_pieces(surface_, std::vector<uint8_t>(surface_.size(), 1), map_);
  }
  std::string class_of(const Piece& piece) const { return shape_class(surface_, piece); }

 private:
  static constexpr float kCell = 0.025F;

  void add(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) {
    surface_.position.push_back(position);
    surface_.normal.push_back(normal);
    surface_.weight.push_back(normal.norm());
  }

  registration::Surfels surface_;
  MapOutlines map_;
};

TEST(FreeStandingPieces, AChairCloseToAWallDoesNotHangThere) {
  const ChairAtAWall room;
  const std::vector<Piece> pieces = room.pieces();
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_EQ(room.class_of(pieces[0]), "chair");
}

TEST(FreeStandingPieces, StrayPointsOverAPieceDoNotMakeItTaller) {
  ChairAtAWall room;
  room.add_stray({0.3F, 1.2F, 1.4F});
  room.add_stray({0.3F, 1.2F, 1.85F});
  const std::vector<Piece> pieces = room.pieces();
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_LT(pieces[0].box.max().z(), 0.9F);
}

}  // namespace
}  // namespace loci::mapping
