#pragma once

#include <memory>
#include <vector>

#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Makes CASes of their own out of a scene (a CAS multiplier, §2.1): a flow is run over each, and what it
/// said is brought home. Made for one run; scenes come one after the other. Its descriptor says what it needs
/// of the scene, and makes inside.
class CasMultiplier {
 public:
  virtual ~CasMultiplier() = default;
  virtual AnnotatorDescriptor descriptor() const = 0;
  virtual void declare(OptionTable& /*table*/) {}
  virtual std::vector<std::unique_ptr<cas::Cas>> split(cas::Cas& scene, Context& context) = 0;
  /// Brings home what was done in a part of the last split().
  virtual void join(size_t part, cas::Cas& done, cas::Cas& scene) = 0;
};

}  // namespace loci::perception
