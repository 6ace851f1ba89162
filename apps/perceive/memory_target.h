#pragma once

#include <memory>
#include <string>

#include "apps/cli/program.h"
#include "memory/annotators/memory_session.h"

namespace loci::apps {

/// The part of a run that has to do with the memory: its flags, and what they do to resources and pipeline.
struct MemoryTarget {
  std::string memory;  ///< file; empty = none
  bool resume = false;
  std::string now;  ///< ISO 8601; empty = the machine's clock

  void declare(ArgumentTable& table);
  /// Opens the memory for what the resources hold and adds identity and writer to the pipeline. Nothing
  /// without a memory.
  void prepare(const std::string& map, perception::Pipeline& pipeline,
               const perception::AnnotatorRegistry& registry, perception::Resources& resources) const;
};

}  // namespace loci::apps
