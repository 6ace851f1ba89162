#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "memory/belief/decisions.h"

namespace loci::memory::belief {

/// The numbers of all pairs of a scene's observations (rows) with the objects that it is about (columns):
/// those that were considered for an observation, and those whose place was in view at least in part. Rounded
/// and compact: this is kept with the scene. Tables go row by row.
struct SceneMatrices {
  uint32_t rows = 0;
  std::vector<int64_t> keys, objects;           ///< per column: proto object; memory's number, 0 = tentative
  std::vector<std::string> kinds;               ///< of annotations that were compared
  std::vector<std::vector<uint8_t>> distances;  ///< per kind, in steps of kDistanceStep; kNone8
  std::vector<uint16_t> offsets;                ///< between centres, millimetres; kNone16 = farther
  std::vector<uint8_t> closeness;               ///< geometric mean of the similarities, 254 = 1; kNone8

  static constexpr uint8_t kNone8 = 255;  ///< not comparable
  static constexpr uint16_t kNone16 = 65535;
  static constexpr double kDistanceStep = 0.005;  ///< the largest that is told is 254 of them

  template <class Archive>
  void archive(Archive& fields) {
    fields(rows, keys, objects, kinds, distances, offsets, closeness);
  }
};

SceneMatrices matrices_of(const BeliefUpdate& update, const Decisions& decisions);

}  // namespace loci::memory::belief
