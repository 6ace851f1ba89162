#pragma once

#include "mapping/base/math/random.h"
#include "perception/annotators/io/labelled_recording.h"

namespace loci::apps::description_evaluation {

/// Tables with primitive shapes of random size on them, before a Kinect (pinned noise) somewhere around: a
/// recording of `scenes` frames whose images are made when they are asked for. Classes: "box" (standing or
/// lying; no side below 45 mm, the middle one at most four times the smallest), "cylinder" (round about an
/// axis: tins, cups with and without handle, tapered ones and bowls, upright or upside down, and full ones
/// that lie), "flat" (boards and discs, 22 to 30 mm high and at least six times as wide) and "sphere".
/// Objects may hide each other, and stand on each other where there is room. The same bytes for the same
/// random numbers.
perception::LabelledRecording primitive_scenes(size_t scenes, const Random& random);

/// What a scene shows of one object.
struct PrimitiveTruth {
  std::string label;
  perception::PrimitiveShape shape;  ///< in the camera's frame
  bool exact = true;  ///< whether these numbers are all that there is to it: no bowl whose wall is bent
};

/// The objects of a scene of the recording that these random numbers make, in the order of their labels.
std::vector<PrimitiveTruth> primitive_truths(size_t scene, const Random& random);

}  // namespace loci::apps::description_evaluation
