#pragma once

#include <string>
#include <vector>

#include "mapping/base/pose.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// How far a position is from the nearest edge of an outline, in words: "0.30 m from its left edge". Seen
/// along y of the place's frame: left is −x, right +x, front −y, back +y. `outline`: polygon in that frame.
std::string edge_phrase(const Vector2d& position, const std::vector<Vector2d>& outline);

/// "on table_1", "in drawer_2"; a support without a name is "on a surface".
std::string place_phrase(const std::string& place, const std::string& support_class);

/// Where each object is: its place, its pose there, and a sentence.
class LocationAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void process(cas::Cas& cas, Context& context) override;
};

}  // namespace loci::perception
