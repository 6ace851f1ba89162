#pragma once

#include "perception/annotators/hypotheses/part_assembly.h"

namespace loci::perception {

/// One or several parts that are taken for one thing so far.
struct Piece {
  std::vector<int> points;
  double area = 0;   ///< m², as seen
  double noise = 1;  ///< of the depth relative to that at 1 m
  float bottom = 0;
  float top = 0;
  std::vector<cv::Point2f> footprint;  ///< convex, completed by reflection
  float distance = 0;                  ///< of the mean from the viewpoint, in the plane
  float bearing = 0;                   ///< of the mean as seen from there, radians
  float left = 0, right = 0;           ///< angles between which it is seen, from the bearing
  float facing_out = 0;                ///< whether its walls face its middle (-1) or away from it (1)
};

/// Area and noise, which joining splinters goes by.
void set_area(Piece& piece, const PlaneCloud& cloud);
/// All but those: heights, footprint, where it is seen, where its walls face.
void measure(Piece& piece, const PlaneCloud& cloud);

}  // namespace loci::perception
