#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/pipeline/pipeline.h"

namespace loci::apps::system_evaluation {

/// Time of one annotator per frame.
struct StepTime {
  std::string name;
  double clock_ms = 0;
  double processor_ms = 0;  ///< of all threads
};

/// Per frame, of a run.
std::vector<StepTime> step_times(const perception::PipelineResult& result);

/// The tabletop pipeline (the default one, without words or memory) over many frames.
struct Throughput {
  size_t frames = 0;
  std::vector<StepTime> steps;  ///< the reader first
  double clock_ms = 0;          ///< per frame of the whole run, in which several are worked on at a time
  double processor_ms = 0;      ///< per frame, of the annotators
  double megabytes_first_tenth = 0, megabytes_half = 0, megabytes_at_end = 0;  ///< resident memory

  double frames_per_second() const { return clock_ms > 0 ? 1000 / clock_ms : 0; }
};

/// Runs over the recording again and again, up to 16 of its frames being kept in memory.
Throughput measure_throughput(const std::shared_ptr<mapping::Recording>& recording,
                              const std::shared_ptr<perception::KnownMap>& map, size_t frames, int threads,
                              Progress& progress);

}  // namespace loci::apps::system_evaluation
