#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/annotators/structure/known_map.h"

namespace loci::apps::filter_evaluation {

/// An error of localisation that is added to every pose, in a random direction of its own per frame.
struct PoseError {
  double position_m = 0, angle_deg = 0;
};

/// What the pipeline finds when poses are wrong, with the refinement or without.
struct Phantoms {
  PoseError error;
  bool refined = false;
  size_t frames = 0;
  size_t clusters = 0;
  size_t phantoms = 0;  ///< most of whose pixels belong to nothing that is found with the given poses
  size_t wanted = 0;    ///< clusters that are found with the given poses, without refinement
  size_t lost = 0;      ///< of these, hardly covered
  double position_m = 0, angle_deg = 0;  ///< medians of what is left of the error
  double filter_ms = 0;                  ///< of the filter per frame
};

/// Runs normals, filter and clusters over a recording with poses: as they are, then with errors, with the
/// refinement off and on.
std::vector<Phantoms> measure_phantoms(const std::filesystem::path& recording,
                                       const std::shared_ptr<perception::KnownMap>& map,
                                       const std::vector<PoseError>& errors, int seed, int threads,
                                       Progress& progress);

std::string phantoms_text(const std::vector<Phantoms>& rows);
Json phantoms_json(const std::vector<Phantoms>& rows);

}  // namespace loci::apps::filter_evaluation
