#pragma once

#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "mapping/world/world.h"
#include "memory/annotators/cas_to_scene.h"
#include "memory/annotators/known_planes.h"
#include "memory/recorder/recorder.h"
#include "perception/conversions/furniture_state.h"
#include "perception/pipeline/pipeline.h"

namespace loci::memory {

/// How a run of perception uses a memory.
struct MemorySessionOptions {
  std::filesystem::path memory;
  std::string program = "loci-perceive run";
  Json configuration = Json::object();
  bool resume = false;        ///< go on with a recording that is in the memory already
  std::filesystem::path map;  ///< URDF; empty = none
  People people = People::blurred;
  belief::BeliefOptions belief;
  WriteOptions write;
  /// Of a new memory, when nothing else names one and the recording's times are real; empty = UTC.
  std::string default_time_zone = {};
};

/// What annotators share that read or change the memory (perception::AnnotatorDescriptor::shares).
inline constexpr const char* kSharedMemory = "memory";

/// What run_with_memory() did.
struct MemoryRunResult {
  perception::PipelineResult pipeline;
  size_t skipped = 0;      ///< frames that were in the memory already
  size_t passed_over = 0;  ///< others before the last of these: scenes come in the order of time
};

/// The memory that a run writes to, and what the memory's annotators share. A resource of the pipeline.
class MemorySession {
 public:
  /// Opens or creates the memory and makes recording and map known in it. Error when the recording is in the
  /// memory already and `resume` is not set, or begins before the last scene.
  MemorySession(const MemorySessionOptions& options, const mapping::Recording& recording);

  /// For messages, about a recording that is in the memory.
  std::string how_to_perceive_again() const;

  Store& store() { return store_; }
  Recorder& recorder() { return *recorder_; }
  Id recording() const { return recording_; }
  std::optional<Id> map() const { return map_; }
  KnownPlanes& planes() { return planes_; }
  People people() const { return people_; }
  /// Furniture that the last scene had elsewhere than this map.
  const perception::FurnitureStates& furniture() const { return furniture_; }

  /// What IdentityResolution made of the scene that is being processed, for MemoryWriter.
  struct Pending {
    const perception::cas::Cas* cas = nullptr;
    SceneRecord record;
    ResolvedScene resolved;
  };
  std::optional<Pending> pending;

 private:
  friend MemoryRunResult run_with_memory(perception::Pipeline&, perception::Context&,
                                         const std::shared_ptr<const perception::cas::TypeSystem>&, Progress&,
                                         const std::function<void(perception::cas::Cas&)>&);

  [[noreturn]] void refuse_again(const std::filesystem::path& memory,
                                 const mapping::Recording& recording) const;
  void require_later(const std::filesystem::path& memory, const mapping::Recording& recording) const;

  Store store_;
  Id run_ = 0;
  Id recording_ = 0;
  std::optional<Id> map_;
  People people_;
  /// The time of a frame and its index, because two frames may have one time.
  using Moment = std::pair<TimeNs, int64_t>;
  std::set<int64_t> present_;           ///< indices of the recording's frames that were in the memory
  std::optional<Moment> last_present_;  ///< the last of them
  KnownPlanes planes_;
  perception::FurnitureStates furniture_;
  std::unique_ptr<Recorder> recorder_;
};

/// Makes a pipeline remember what it perceives of the recording among the resources: adds identity, writer
/// and, unless people are kept, the PersonAnnotator where the pipeline has none, and a MemorySession to the
/// resources. The options' configuration becomes that of the pipeline.
void add_memory_session(MemorySessionOptions options, perception::Pipeline& pipeline,
                        const perception::AnnotatorRegistry& registry, perception::Resources& resources);

/// Type of the scene annotation that carries the known planes to the next run.
inline constexpr const char* kKnownPlanesType = "loci.memory.KnownPlanes";

/// Runs a pipeline whose resources have a MemorySession: skips the frames that the memory has, and marks the
/// run as finished cleanly at the end. After Interrupted all scenes that were finished are in the memory.
MemoryRunResult run_with_memory(perception::Pipeline& pipeline, perception::Context& context,
                                const std::shared_ptr<const perception::cas::TypeSystem>& types,
                                Progress& progress,
                                const std::function<void(perception::cas::Cas&)>& done = {});

/// What a recording is, wherever it lies and in whichever layout: its frames' numbers and times, and its
/// first and last depth images.
std::string fingerprint_of(const mapping::Recording& recording);

}  // namespace loci::memory
