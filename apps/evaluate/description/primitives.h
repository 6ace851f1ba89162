#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

/// Errors of one number over many objects, m (angles: degrees).
struct ParameterErrors {
  std::vector<double> errors;  ///< absolute
  double median() const;
  double at(double share) const;  ///< so many are at most this
};

/// How well primitive shapes and their numbers are found.
struct PrimitivesResult {
  int samples = 0, missed = 0;
  std::map<std::string, std::map<std::string, int>> kinds;  ///< by what is there and what was said
  /// "cylinder radius", "box longest edge", ...: of objects of which the kind was right and that the numbers
  /// describe altogether.
  std::map<std::string, ParameterErrors> parameters;
  double milliseconds = 0;  ///< an object, on average

  std::string text() const;
  Json to_json() const;
};

/// Fits primitive shapes to what the tabletop pipeline finds in so many simulated scenes (primitive_scenes())
/// and compares them with what is there.
PrimitivesResult evaluate_primitives(size_t scenes, const Random& random, Progress& progress,
                                     Warnings& warnings);

}  // namespace loci::apps::description_evaluation
