#pragma once

#include <filesystem>

#include "apps/evaluate/memory/simulator.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::memory_experiment {

struct MemoryOptions {
  int observations = 20000;
  int seed = 1;
  int readers = 10;  ///< beside the writer, each asking `reader_hz` questions per second
  double reader_hz = 10;
  int questions = 200;  ///< of each kind
  bool reuse = false;   ///< the memory of an earlier run; not compared with plain tables
  int kills = 0;        ///< random moments at which the writer is killed
  HomeOptions home;

  void declare(OptionTable& table);
};

/// One kind of question, asked of the memory and of plain indexed tables (negative = not asked there).
struct QuestionFigures {
  std::string name;
  double median_ms = 0, p99_ms = 0;
  double plain_median_ms = -1, plain_p99_ms = -1;
  size_t max_rows = 0;  ///< in an answer
};

struct MemoryFigures {
  size_t scenes = 0, observations = 0, objects = 0;
  double processor_rate = 0;  ///< observations per second of CPU time, reasoning and writing
  double wall_rate = 0;       ///< per second of the clock
  double first_tenth_rate = 0, last_tenth_rate = 0;  ///< of CPU time
  double plain_rate = 0;  ///< plain indexed tables written scene by scene, without reasoning
  double megabytes_first_tenth = 0, megabytes_at_end = 0;  ///< resident memory of the writer
  double bytes_per_observation = 0;
  double open_ms = 0;  ///< CPU time to open it and ask where one object is
  double verify_s = 0, statistics_ms = 0, table_bytes_ms = 0;
  double rate_alone = 0, rate_with_readers = 0;  ///< per second of the clock, one after the other
  size_t reader_questions = 0;
  IdentityFigures identity;  ///< of what was taken in alone
  int kills = 0, kills_lost = 0, kills_unsound = 0;
  std::vector<QuestionFigures> questions;
};

/// Simulates, ingests through the full reasoning into a file below `folder`, and measures. The file stays.
MemoryFigures measure(const MemoryOptions& options, const std::filesystem::path& folder, Progress& progress);

std::string text_of(const MemoryFigures& figures);
Json json_of(const MemoryFigures& figures);

}  // namespace loci::apps::memory_experiment
