#pragma once

#include "memory/annotators/known_planes.h"
#include "memory/belief/options.h"
#include "perception/pipeline/registry.h"

namespace loci::memory {

/// Names supporting planes that were found without a map: plane_1, plane_2, … stay the same over the frames,
/// and from run to run with a memory.
class PlaceNaming : public perception::Annotator {
 public:
  perception::AnnotatorDescriptor descriptor() const override;
  void process(perception::cas::Cas& cas, perception::Context& context) override;

 private:
  KnownPlanes own_;  ///< without a memory
};

/// Decides which cluster is which object, with everything that was believed before (chapter 6).
class IdentityResolution : public perception::Annotator {
 public:
  perception::AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void start(perception::Context& context) override;
  void process(perception::cas::Cas& cas, perception::Context& context) override;

 private:
  belief::BeliefOptions options_;
};

/// Keeps the scene, and all that it changes, in the memory.
class MemoryWriter : public perception::Annotator {
 public:
  perception::AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(perception::cas::Cas& cas, perception::Context& context) override;
  void finish(perception::Context& context) override;

 private:
  bool clouds_ = true;
};

void add_memory_annotators(perception::AnnotatorRegistry& registry);

}  // namespace loci::memory
