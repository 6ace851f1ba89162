#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/orthophoto/orthophoto.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// A furniture face with what its orthophoto shows.
struct PhotographedFace {
  Orthophoto photo;
  std::vector<Front> fronts;
};

/// Looks for fronts and handles in the colour frames of the recording that a map was made of: makes an
/// orthophoto of each furniture face (not of walls), cuts it into fronts around the handles that it shows and
/// the certain ones of the map, and replaces the map's fronts there. Fronts with certain handles that no
/// rectangle explains stay, and all on faces that no frame shows. Notes say what could not be used. Returns
/// the faces that were photographed; the map keeps their photos. Same result on any number of threads. Error
/// when no frame of the recording has both a pose and colour.
std::vector<PhotographedFace> interpret_photos(const Recording& recording, int threads, Progress& progress,
                                               InterpretedMap& map);

/// The orthophoto with the outlines of fronts (green) and handles (yellow), and its relief below: white 5 cm
/// before the plane, black behind.
cv::Mat drawn(const PhotographedFace& face);

}  // namespace loci::mapping
