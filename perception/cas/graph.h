#pragma once

#include <functional>
#include <unordered_map>

#include "perception/cas/cas.h"

namespace loci::perception::cas {

/// Calls `visit(feature, target)` for every reference of a structure that is not null or deleted, in order of
/// declaration; elements of an FSArray come with no feature.
void for_each_reference(const FeatureStructure& structure,
                        const std::function<void(Feature, const FeatureStructure&)>& visit);

/// Everything that can be reached, breadth first, each once.
std::vector<FeatureStructure> reachable_from(const std::vector<FeatureStructure>& roots);

/// The roots of a whole CAS: per view in order of name its sofa, then its indexed structures in an order that
/// depends on their content and connections only, not on when they were made.
struct CanonicalView {
  std::string name;
  FeatureStructure sofa;
  std::vector<FeatureStructure> members;
};
std::vector<CanonicalView> canonical_views(const Cas& cas);

}  // namespace loci::perception::cas
