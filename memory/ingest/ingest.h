#pragma once

#include <filesystem>

#include "mapping/base/math/tally.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/recording/recording.h"
#include "memory/belief/options.h"
#include "memory/store/store.h"

namespace loci::memory {

struct IngestOptions {
  bool strict = false;                ///< refuse the whole file for one bad line
  bool resume = false;                ///< continue a file that the memory has in part
  double noise_m = 0;                 ///< of positions; 0 = estimate it from the file
  std::filesystem::path map;          ///< URDF; empty = none
  std::filesystem::path recording;    ///< that was detected in; empty = none, all detections have positions
  mapping::RecordingOptions reading;  ///< of it
  bool keep_people = false;           ///< store faces, which are blurred otherwise
  std::string default_time_zone;      ///< of a new memory when nothing else names one; empty = UTC
  belief::BeliefOptions belief;
  std::string program = "loci-memory ingest";
  std::string called;  ///< the file in messages; empty = its path

  void declare(OptionTable& table);
};

struct IngestResult {
  size_t scenes = 0, detections = 0;  ///< added
  int64_t unconfirmed = 0;            ///< detections of objects that wait to be seen again, or of clutter
  size_t present = 0;                 ///< lines that the memory had already
  size_t repeated = 0;                ///< lines that equal the line before
  size_t bad = 0;                     ///< skipped lines; the warnings name the first ones
  Tally used{"scene"};                ///< scenes with a detection, and why others have none
  Tally lifted{"detection"};          ///< detections in images, and why some have no place
  double noise_m = 0;
  bool noise_estimated = false;

  std::string summary() const;
  Json report() const;
};

/// Adds the detections of another system (docs/file-formats.md: JSON Lines; with a recording also COCO and
/// YOLO) to a memory, with the same reasoning as for perceived scenes. Detections in images are lifted by the
/// depth of the recording. One scene is one transaction: after an interruption `resume` continues
/// with the first missing line. Error, before anything is added, when most of the first lines are bad, when
/// the file is in the memory already and `resume` is not set, and with `strict` for the first bad line.
IngestResult ingest(const std::filesystem::path& file, const std::filesystem::path& memory,
                    const IngestOptions& options, const WriteOptions& write, Progress& progress,
                    Warnings& warnings);

}  // namespace loci::memory
