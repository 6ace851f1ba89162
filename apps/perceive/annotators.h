#pragma once

#include "apps/cli/arguments.h"
#include "perception/pipeline/plugin.h"
#include "perception/pipeline/statistics.h"

namespace loci::apps {

/// Every annotator and reader that this program knows: where rooms add theirs.
perception::AnnotatorRegistry all_annotators();

/// The annotators of this program and of plugins, and the types of both.
struct Experts {
  perception::AnnotatorRegistry registry;
  std::shared_ptr<const perception::cas::TypeSystem> types;
};

/// The option --plugin, and what it leads to.
struct PluginOption {
  std::vector<std::string> files;

  void declare(ArgumentTable& table);
  Experts load() const;
};

/// Where the statistics of annotators are kept: beside a memory, or in a file of their own.
struct StatisticsTarget {
  std::string file;

  void declare(ArgumentTable& table);
  /// The file, or the one beside `memory`; empty when there is neither.
  std::filesystem::path path(const std::string& memory) const;
  /// Empty when there are none yet.
  perception::StatisticsTable read(const std::string& memory) const;
  /// Likewise, but what is named must be there: Error, "no such file".
  perception::StatisticsTable read_named(const std::string& memory) const;
};

}  // namespace loci::apps
