#pragma once

#include <cstdint>
#include <vector>

#include "perception/cas/cas.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// What a CAS held before an annotator ran.
struct ContentsBefore {
  size_t structures = 0;           ///< their number
  std::vector<uint32_t> clusters;  ///< ids of those of the scene

  explicit ContentsBefore(cas::Cas& cas);
};

/// Compares what an annotator did with what it declares: new clusters, supports, hypotheses, annotations and
/// views have to be among its outputs (or what it modifies), clusters of others are removed only by one that
/// modifies Cluster, and the images of the cameras keep their sizes. Throws Error that names what was not
/// declared.
void check_contract(const AnnotatorDescriptor& descriptor, const ContentsBefore& before, cas::Cas& cas);

}  // namespace loci::perception
