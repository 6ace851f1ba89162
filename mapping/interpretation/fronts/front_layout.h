#pragma once

#include <array>
#include <vector>

#include "mapping/interpretation/fronts/fixtures.h"
#include "mapping/interpretation/fronts/seams.h"

namespace loci::mapping {

/// What bounds a front at one side.
struct FrontEdge {
  enum class Kind {
    border,  ///< the end of the face
    seam,    ///< a resolved groove or line
    step,    ///< a change of depth, intensity or colour
    regular  ///< not resolved: by the fixtures and usual layouts
  };
  Kind kind = Kind::border;
  double z = 0;         ///< evidence, standard score
  bool relief = false;  ///< seen in depth, not only in intensity or colour
  double rise = 0;      ///< of a step: depth inside less depth outside, metres
};
const char* front_edge_name(FrontEdge::Kind kind);

/// A rectangle of a face that is one front.
struct PlacedFront {
  FaceRect rect;
  int fixture = -1;                  ///< index; -1 = none
  std::array<FrontEdge, 4> edges{};  ///< left, right, bottom, top
  double confidence = 0;

  /// By what bounds it: 0.95 within strong seams, less where an edge is but the end of what was seen, least
  /// where all edges are guessed by the layout.
  double edge_confidence() const;
};

struct FrontLayout {
  std::vector<PlacedFront> fronts;
  std::vector<size_t> unassigned;  ///< fixtures without a front
};

/// Cuts a face into fronts along lines that show a seam or step along their whole length, strongest first. A
/// part with several fixtures is divided by usual layouts: evenly, with similar distances of the fixtures
/// from the edges. A part without fixture is a front only where seams and the border of the face enclose it
/// and it protrudes from its surroundings.
FrontLayout lay_out_fronts(const SeamMap& seams, const FurnitureFace& face,
                           const std::vector<FaceFixture>& fixtures);

/// Divides a part with several fixtures where no seam was resolved (front_division.cpp).
std::vector<PlacedFront> divide_evenly(const SeamMap& seams, const FurnitureFace& face,
                                       const PlacedFront& part, const std::vector<FaceFixture>& fixtures,
                                       const std::vector<size_t>& inside);

}  // namespace loci::mapping
