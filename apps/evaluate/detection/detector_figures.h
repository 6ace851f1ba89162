#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/evaluate/detection/rendered_tables.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/detection/network_detector.h"

namespace loci::apps::detection_evaluation {

/// How many objects of a class were there, found, and invented.
struct ClassFigures {
  int objects = 0;
  int found = 0;     ///< by a box that overlaps by half, of any class
  int right = 0;     ///< of those found, with the right class
  int detected = 0;  ///< detections of this class
};

struct DetectorFigures {
  int tables = 0;
  double milliseconds = 0;  ///< per image
  ClassFigures all;
  int on_objects = 0;  ///< detections with an object of any class
  std::map<std::string, ClassFigures> by_class;

  std::string text() const;
  Json to_json() const;
};

/// Runs a detector over tables. A detection belongs to the object whose box it overlaps most, at least by
/// half of both together; each object has one detection at most, the best first.
DetectorFigures evaluate_detector(const perception::ObjectDetector& detector, const RenderedTables& tables,
                                  Progress& progress);

}  // namespace loci::apps::detection_evaluation
