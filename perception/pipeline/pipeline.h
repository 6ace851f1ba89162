#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/config.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json.h"
#include "perception/pipeline/flow.h"
#include "perception/pipeline/registry.h"

namespace loci::perception {

/// What a run did.
struct PipelineResult {
  size_t frames = 0;
  size_t left_out = 0;  ///< further frames, because of an annotator that failed
  /// Seconds by annotator (and reader), in order of the flow.
  std::vector<std::pair<std::string, double>> seconds;
  /// The same in CPU time of all threads; of asynchronous steps, of their own thread.
  std::vector<std::pair<std::string, double>> cpu_seconds;
  StatisticsTable statistics;  ///< of this run, by annotator
};

/// A pipeline of which every n-th frame is read, whatever it says itself.
Config with_every(const Config& pipeline, int every);

/// A collection processing engine: a reader, a flow of annotators, and writers (annotators that come last),
/// from YAML:
///
///   reader: {RecordingReader: {every: 2}}
///   flow:
///     - NormalEstimator
///     - PlaneClusterExtractor: {tolerance_m: 0.02}
///   writers: [MemoryWriter]
///
/// `reader` and `writers` may be left out. What else a flow may hold is said in flow.h. Reading is strict: an
/// unknown key, annotator or option is an Error that names the nearest known one. What an annotator needs
/// must be made before it.
class Pipeline {
 public:
  static Pipeline parse(const Config& config, const AnnotatorRegistry& registry);
  static Pipeline parse(const std::string& text, const std::string& file, const AnnotatorRegistry& registry);

  /// Adds an annotator with default options: at the end of the flow (before the writers), or as a writer.
  /// Nothing happens when the pipeline has one of this name.
  void add(const std::string& name, const AnnotatorRegistry& registry);
  void add_writer(const std::string& name, const AnnotatorRegistry& registry);
  bool has(const std::string& name) const;
  /// The names of those that make annotations.
  std::set<std::string> annotating() const;
  Reader& reader() { return *reader_; }

  /// Throws Error for the first annotator with an input that no earlier annotator outputs; the message names
  /// the annotators that do.
  void check(const AnnotatorRegistry& registry) const;
  /// The effective configuration, in the form of the YAML.
  Json to_json() const;

  /// Runs over all frames that the reader has left; start() of everybody comes first. Each frame is a fresh
  /// CAS of `type_system` that is handed to `done` (if given) when all annotators are through. An annotator's
  /// failure is treated as its policy says; by default it is passed on with the annotator's name and the
  /// frame. Interrupted when `progress` says stop. Same results on any number of threads.
  PipelineResult run(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                     Progress& progress, const std::function<void(cas::Cas&)>& done = {});

  /// Calls start() of the reader and of everybody, once; run() does it if it was not done before. Between
  /// start() and run() the reader can skip frames.
  void start(Context& context);

 private:
  struct Scene;
  /// Batches that are done with a scene before they begin with the next; other stages meanwhile work on other
  /// scenes.
  using Stage = std::vector<std::function<void(cas::Cas&, Context&)>>;

  bool asynchronous() const;
  std::vector<Stage> stages();
  /// How many are worked on at a time: one where a step is asynchronous or the reader shares something.
  size_t scenes_in_flight(int threads) const;
  void read_scene(Scene& scene);
  void run_frames(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                  Progress& progress, const std::function<void(cas::Cas&)>& done, PipelineResult& result);
  void finish(Context& context);
  /// Of a run that stopped: why it did is what counts, and what fails now is a warning.
  void finish_stopped(Context& context);
  std::vector<Step*> steps() const;

  std::unique_ptr<Reader> reader_;
  Json reader_options_;
  Flow flow_;
  Flow writers_;
  double reader_seconds_ = 0;
  double reader_cpu_seconds_ = 0;
  bool started_ = false;
};

}  // namespace loci::perception
