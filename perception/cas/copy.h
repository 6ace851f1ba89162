#pragma once

#include <unordered_map>

#include "perception/cas/cas.h"

namespace loci::perception::cas {

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
