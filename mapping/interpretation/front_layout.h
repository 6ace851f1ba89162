#pragma once

#include <array>
#include <vector>

#include "mapping/interpretation/face_seams.h"
#include "mapping/interpretation/fixtures.h"

namespace loci::mapping {

/// What ends a front at one side.
struct FrontEdge {
  enum class Kind {
    border,  ///< the face ends there
    seam,    ///< a groove or line was resolved
    step,    ///< depth, intensity or colour change there
    regular  ///< nothing was resolved: from the fixtures and how fronts are made
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
};

struct FrontLayout {
  std::vector<PlacedFront> fronts;
  std::vector<size_t> homeless;  ///< fixtures around which no front was found
};

/// Cuts a face into fronts: as long as a line across a part shows a seam or step along its whole length, it
/// is cut there (the strongest first); where several fixtures remain in one part, it is divided by how fronts
/// are made: evenly, with like distances of the fixtures from the edges. A part without fixture is a front
/// only where seams and the face's own border enclose it and it lies in front of what surrounds it.
FrontLayout lay_out_fronts(const SeamMap& seams, const Face& face, const std::vector<FaceFixture>& fixtures);

/// Divides a part with several fixtures where no seam was resolved (front_regularity.cpp).
std::vector<PlacedFront> divide_evenly(const SeamMap& seams, const Face& face, const PlacedFront& part,
                                       const std::vector<FaceFixture>& fixtures,
                                       const std::vector<size_t>& inside);

}  // namespace loci::mapping
