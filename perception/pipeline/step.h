#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>

#include "mapping/base/config.h"
#include "perception/pipeline/registry.h"
#include "perception/pipeline/statistics.h"

namespace loci::perception {

/// How a pipeline treats an annotator: what stands beside its name.
///
///     - TextReader: {language: eng}
///       on_error: skip
///       timeout_s: 2
struct StepPolicy {
  std::string on_error = "fail";
  int retry = 0;
  double timeout_s = 0;
  bool asynchronous = false;

  void declare(OptionTable& table);
};

/// Thrown when a scene is to be left out because of an annotator whose policy says so.
class SceneSkipped : public Error {
 public:
  using Error::Error;
};

/// A primitive analysis engine: an annotator with its options and policy, and what is known from its runs.
class Step {
 public:
  /// Reads the options and policy strictly.
  Step(const std::string& name, const Config& options, const Config& policy, const FileLocation& place,
       const AnnotatorRegistry& registry);

  const AnnotatorDescriptor& descriptor() const { return descriptor_; }
  const StepPolicy& policy() const { return policy_; }
  const FileLocation& place() const { return place_; }
  const AnnotatorStatistics& statistics() const { return statistics_; }
  /// Clusters that keep what was said about them before.
  void note_reused(size_t clusters) { statistics_.reused += static_cast<int64_t>(clusters); }
  double cpu_seconds() const { return cpu_seconds_; }
  /// {"Name": options, "on_error": ...}, without policies that are the default.
  Json to_json() const;

  void start(Context& context);
  void finish(Context& context) { annotator_->finish(context); }

  /// Runs the annotator on the CAS as its policy says. What it did before it failed is taken back. A failure
  /// is an exception of the annotator, a number that is none in what it made, or a time-out. Throws Error or
  /// SceneSkipped when the policy says so.
  void run(cas::Cas& cas, Context& context);

  /// A run on a branch, on a thread of its own.
  struct Attempt;
  /// Begins it; join() brings the result home, and applies the policy.
  std::shared_ptr<Attempt> launch(const cas::Cas& cas, Context& context);
  void join(const std::shared_ptr<Attempt>& attempt, cas::Cas& cas, Context& context);

 private:
  void try_until_done(cas::Cas& cas, Context& context, std::shared_ptr<Attempt> first);
  void run_here(cas::Cas& cas, Context& context);
  void bring_home(const std::shared_ptr<Attempt>& attempt, cas::Cas& cas, Context& context);
  void inspect(const cas::Cas& cas, size_t known);
  void fail(const std::string& why, cas::Cas& cas, Context& context);
  std::shared_ptr<Annotator> make_annotator();

  std::function<std::unique_ptr<Annotator>()> maker_;
  std::shared_ptr<Annotator> annotator_;
  AnnotatorDescriptor descriptor_;
  Json options_;
  StepPolicy policy_;
  Json policy_json_;
  FileLocation place_;
  AnnotatorStatistics statistics_;
  double cpu_seconds_ = 0;
};

/// Waits for what was launched, also when an exception is on its way.
void wait_for(const std::shared_ptr<Step::Attempt>& attempt);

/// Reads declared options from a map that holds nothing else.
template <class Declarer>
Json read_declared(Declarer& declarer, const Config& config) {
  OptionTable table;
  declarer.declare(table);
  table.read_all(config);
  return table.to_json();
}

}  // namespace loci::perception
