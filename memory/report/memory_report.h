#pragma once

#include <optional>
#include <string>

#include "mapping/base/progress.h"
#include "memory/store/store.h"

namespace loci::memory {

/// How much of a long memory the page shows; it states what it leaves out.
struct ReportOptions {
  size_t objects = 100;  ///< with a card: those that were seen most often
  size_t scenes = 200;   ///< in timeline, decisions and log: the last ones
};

/// A page about a memory in one file (light and dark, printable, with a search field): questions and their
/// answers, the plan with every object's trace, the time line, a card per object, statistics, identity
/// decisions with how sure they are, the log of each scene and what annotators took. `page` is a page of
/// html_page() to which the sections are added; a section that it has already is replaced. Error when it is
/// no such page.
std::string memory_report(const Store& store, const std::optional<std::string>& page,
                          const ReportOptions& options, Progress& progress);

}  // namespace loci::memory
