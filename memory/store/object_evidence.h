#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// What annotators of one type say about an object.
struct AnnotationSupport {
  std::string type, value;
  size_t sightings = 0;  ///< that say so
  double agreement = 0;  ///< part of the sightings of which this type says anything
};
/// By type, most often first; where it is and how it lies is left out.
std::vector<AnnotationSupport> annotation_support(const Store& store,
                                                  const std::vector<ObjectObservation>& sightings);

}  // namespace loci::memory
