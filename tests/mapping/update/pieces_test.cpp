#include "mapping/update/pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace loci::mapping {
namespace {

/// Surfaces that are put together from rectangles of surfels.
class Room {
 public:
  void add_plane(const Eigen::Vector3f& corner, const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    for (float s = 0; s <= a.norm(); s += kCell)
      for (float t = 0; t <= b.norm(); t += kCell)
        add(corner + s * a.normalized() + t * b.normalized(), a.cross(b).normalized());
  }
  /// A point that lies on no surface.
  void add_stray(const Eigen::Vector3f& position) { add(position, Eigen::Vector3f::Zero()); }
  /// Points in a row that lie on no surface.
  void add_stray_row(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    for (float s = 0; s <= (to - from).norm(); s += kCell) add_stray(from + s * (to - from).normalized());
  }
  /// A table of 1 m whose top is a support of the map.
  void add_table(const Eigen::Vector2f& corner) {
    const float x = corner.x(), y = corner.y();
    add_plane({x, y, 0.74F}, {1, 0, 0}, {0, 1, 0});
    MapOutlines::Support support{.name = "table_1", .class_name = "table", .outline = {}, .height = 0.74};
    for (const auto& [a, b] :
         {std::pair(0.F, 0.F), std::pair(1.F, 0.F), std::pair(1.F, 1.F), std::pair(0.F, 1.F)})
      support.outline.push_back(Eigen::Vector2f(x + a, y + b).cast<double>());
    map_.supports.push_back(support);
  }
  std::vector<Piece> pieces() const {
    return free_standing_pieces(surface_, std::vector<uint8_t>(surface_.size(), 1), map_);
  }
  std::string class_of(const Piece& piece) const { return shape_class(surface_, piece); }

 protected:
  static constexpr float kCell = 0.025F;

  void add(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) {
    surface_.position.push_back(position);
    surface_.normal.push_back(normal);
    surface_.weight.push_back(normal.norm());
  }

  registration::Surfels surface_;
  MapOutlines map_;
};

/// A seat of 0.42 m with a back, whose legs nobody saw, close to the wall at x = 0.
class ChairAtAWall : public Room {
 public:
  ChairAtAWall() {
    for (float a = 0; a < 0.42F; a += kCell)
      for (float b = 0; b < 0.42F; b += kCell) {
        add({0.08F + a, 1 + b, 0.45F}, {0, 0, 1});
        add({0.08F, 1 + b, 0.45F + a}, {1, 0, 0});
      }
    map_.walls = {{.normal = Vector2d::UnitX(), .along_max = 4, .top = 2.5}};
  }
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

TEST(FreeStandingPieces, AStoolAHandsBreadthBesideAnIslandIsAPieceOfItsOwn) {
  Room room;
  room.add_plane({0, 0, 0.1F}, {0, 1.2F, 0}, {0, 0, 0.75F});            // A side of the island.
  room.add_plane({0.079F, 0.4F, 0.68F}, {0.34F, 0, 0}, {0, 0.34F, 0});  // The seat.
  room.add_plane({0.3F, 0.5F, 0.1F}, {0, 0.1F, 0}, {0, 0, 0.55F});      // Its leg.
  EXPECT_EQ(room.pieces().size(), 2U);
}

TEST(FreeStandingPieces, StrayPointsThatTouchTwoPiecesAreNoThird) {
  Room room;
  for (const float x : {0.F, 0.8F}) {  // Two crates and points of beams that met both.
    room.add_plane({x, 0, 0.3F}, {0.4F, 0, 0}, {0, 0.4F, 0});
    room.add_plane({x, 0, 0.05F}, {0.4F, 0, 0}, {0, 0, 0.25F});
  }
  for (const float y : {0.05F, 0.1F, 0.15F, 0.2F, 0.25F, 0.3F, 0.35F})
    room.add_stray_row({0.42F, y, 0.3F}, {0.79F, y, 0.3F});
  const std::vector<Piece> pieces = room.pieces();
  ASSERT_EQ(pieces.size(), 2U);
  for (const Piece& piece : pieces) EXPECT_LT(piece.box.sizes().x(), 0.65F);
}

TEST(FreeStandingPieces, ClutterOnACounterIsNoFurniture) {
  Room room;
  room.add_plane({0, 0, 0.9F}, {1.2F, 0, 0}, {0, 0.6F, 0});  // The counter, which the map does not have.
  room.add_plane({0, 0, 0.1F}, {1.2F, 0, 0}, {0, 0, 0.8F});
  room.add_plane({0.5F, 0.2F, 0.955F}, {0.3F, 0, 0}, {0, 0, 0.25F});  // A box, of which the foot is hidden.
  room.add_plane({0.5F, 0.2F, 1.2F}, {0.3F, 0, 0}, {0, 0.3F, 0});
  const std::vector<Piece> pieces = room.pieces();
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_LT(pieces[0].box.min().z(), 0.2F);
}

TEST(FreeStandingPieces, ATopWhoseLegsNobodySawIsFurniture) {
  Room room;
  room.add_plane({0, 0, 0.72F}, {1.2F, 0, 0}, {0, 0.7F, 0});
  EXPECT_EQ(room.pieces().size(), 1U);
}

TEST(FreeStandingPieces, TheSeatOfAChairBelowATableGoesWithItsBack) {
  Room room;
  room.add_table({0.5F, 0});
  room.add_plane({0.37F, 0.4F, 0.45F}, {0.4F, 0, 0}, {0, 0.4F, 0});  // The seat, mostly below the table.
  room.add_plane({0.38F, 0.4F, 0.6F}, {0, 0.4F, 0}, {0, 0, 0.28F});  // The back, beside it.
  const std::vector<Piece> pieces = room.pieces();
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_LT(pieces[1].box.min().z(), 0.5F);
}

}  // namespace
}  // namespace loci::mapping
