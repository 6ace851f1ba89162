#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "memory/identity/problem.h"
#include "memory/store/store.h"

namespace loci::memory {

/// What identity was decided from in a scene, and what came of it, as in Figure 6.9: rows are the scene's
/// observations, columns the objects believed before it that were considered or whose place was in view.
/// NaN = not comparable, or not kept.
struct PairMatrices {
  struct Column {
    Id object = 0;             ///< 0 = not sure enough to be told at that time
    std::string name;          ///< "object_12"
    double unseen = 0;         ///< probability that it was seen as none of the rows
    std::string outcome = {};  ///< "stay", "disappear", ...; empty = nothing was concluded
  };
  struct Row {
    Id observation = 0;
    double appear = 0, clutter = 0;  ///< probability of something new, of a false cluster
    std::string outcome = {};
    std::optional<size_t> column = {};  ///< what it was taken for
  };
  /// One type of annotation: how far apart, and g of that with the type's scale (§6.1.2), in [0,1].
  struct Kind {
    std::string name;  ///< "mean_color"
    PairTable distance, similarity;
  };
  std::vector<Row> rows;
  std::vector<Column> columns;
  std::vector<Kind> kinds;
  PairTable similar;   ///< geometric mean of the similarities
  PairTable distance;  ///< between the centres, metres
  PairTable is;        ///< probability of being the same, all explanations together
};

/// Unset where none were kept (scenes of other writers and earlier versions). Error when there is no such
/// scene.
std::optional<PairMatrices> pair_matrices(const Store& store, Id scene);

std::string to_text(const PairMatrices& matrices);
Json to_json(const PairMatrices& matrices);

}  // namespace loci::memory
