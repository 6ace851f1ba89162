#pragma once

#include "mapping/base/math/pose.h"
#include "mapping/base/text/json.h"

namespace loci {

/// Three coordinates as sidecars, truth files and reports have them: [x, y, z].
inline Json json_from_vector(const Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

/// Error of the JSON library when there are fewer than three numbers.
inline Vector3d vector_from_json(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace loci
