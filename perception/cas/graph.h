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

/// Copies feature structures, with everything that they refer to, from one CAS into another of the same type
/// system. What is reached twice is copied once, over all calls; arrays share their memory. References to
/// what was deleted become null.
class Copier {
 public:
  /// Throws Error when the type systems differ.
  Copier(const Cas& from, Cas& to);

  FeatureStructure operator()(const FeatureStructure& structure);
  /// From now on references to `original` lead to `copy`.
  void stand_in(const FeatureStructure& original, const FeatureStructure& copy);

 private:
  FeatureStructure shell_of(const FeatureStructure& original);
  void fill(const FeatureStructure& original, const FeatureStructure& copy);
  FeatureStructure target_of(const FeatureStructure& original) const;

  Cas& to_;
  std::unordered_map<uint32_t, FeatureStructure> copies_;
};

}  // namespace loci::perception::cas
