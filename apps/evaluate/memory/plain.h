#pragma once

#include <filesystem>
#include <memory>

#include "apps/evaluate/memory/figures.h"

namespace loci::apps::memory_experiment {

/// The same rows in plain tables with ordinary indexes, without R*Tree, full text and reasoning: object
/// identities is copied from the memory.
class PlainTables {
 public:
  PlainTables(const std::filesystem::path& file, const std::filesystem::path& memory);
  ~PlainTables();

  /// Observations per second of the clock, written scene by scene.
  double write_rate() const;
  size_t near(const Vector3d& point, double radius, TimeNs time);
  size_t at_place(int64_t place, TimeNs time);
  size_t with_text(const std::string& word);
  size_t last_seen(int64_t object);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace loci::apps::memory_experiment
