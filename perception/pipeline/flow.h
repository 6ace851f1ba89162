#pragma once

#include <functional>
#include <future>
#include <list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/config.h"
#include "mapping/base/options.h"
#include "perception/pipeline/condition.h"
#include "perception/pipeline/registry.h"
#include "perception/pipeline/statistics.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

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

/// `Name` or `{Name: {options}}`: the name and a map of the options. Error at `place`, which says what `what`
/// ("a reader") has to be.
std::pair<std::string, YAML::Node> named(const YAML::Node& node, const std::string& what,
                                         const FileLocation& place);

/// Thrown when a scene is to be left out because of an annotator whose policy says so.
class SceneSkipped : public Error {
 public:
  using Error::Error;
};

struct ContentsBefore;

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
  void inspect(cas::Cas& cas, const ContentsBefore& before);
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

/// When a cluster counts as unchanged.
struct ChangeOptions {
  int bits = 8;
  double color = 8;
  double place_m = 0.05;
  double growth = 1.3;
  int remembered = 500;

  void declare(OptionTable& table);
};

/// Change detection in front of any annotator (§5.4.5): stores the annotations of clusters by position and
/// appearance (`phash` and `cell_colors` of their image regions) and reuses them for clusters that did not
/// change. Each view is compared with the view that was annotated, so that slow changes do not accumulate.
class ChangeDetector {
 public:
  explicit ChangeDetector(const ChangeOptions& options) : options_(options) {}

  /// Copies the annotations of the most similar stored view to the cluster, marked with their frame
  /// (`taken_from`), and moves their image regions to the cluster's. False when no stored view is similar.
  bool reuse(const types::Cluster& cluster) const;

  /// Stores a view with the annotations of the cluster whose ids are above `known`; a view without
  /// annotations is stored, too. Annotations that refer to older structures are not valid elsewhere: such a
  /// view is not stored.
  void store(const types::Cluster& cluster, size_t known, int64_t frame);

 private:
  struct Appearance {
    uint64_t hash = 0;
    std::vector<float> colors;
    Vector3d place;
    double x = 0, y = 0, width = 0, height = 0;  ///< region of the image, px
  };
  struct StoredView {
    Appearance appearance;
    int64_t frame = 0;
    std::unique_ptr<cas::Cas> cas;  ///< holds the annotations
    std::vector<types::Annotation> annotations;
  };
  static std::optional<Appearance> appearance_of(const types::Cluster& cluster);
  /// Number of different bits of the hashes; nothing when the views differ.
  std::optional<int> difference(const Appearance& now, const Appearance& then) const;

  ChangeOptions options_;
  std::list<StoredView> views_;  ///< newest first
};

struct FlowNode;

/// An aggregate analysis engine: steps in order. Steps whose descriptors do not make one depend on the other
/// run at the same time.
struct Flow {
  std::vector<FlowNode> nodes;
  /// Runs of nodes that may run at the same time, by index: [0, 1), [1, 4), ...
  std::vector<std::pair<size_t, size_t>> batches;
};

/// What a node of a flow reads and writes in the CAS, from the descriptors of its annotators.
struct DataAccess {
  std::set<std::string> reads, outputs, modifies, shares;
  void add(const DataAccess& more);
  void add(const AnnotatorDescriptor& descriptor);
};

/// Whether `later` must wait for `earlier`.
bool depends(const DataAccess& later, const DataAccess& earlier);

/// A step, or a place where the flow branches.
struct FlowNode {
  enum class Kind {
    kStep,
    kCondition,    ///< clusters for which it holds go through branches[0], others through branches[1]
    kRegions,      ///< clusters and supports of places that match patterns[i] go through branches[i]
    kParallel,     ///< each branch on its own; refused when one depends on another
    kUnlessAlike,  ///< unchanged clusters reuse the annotations of branches[0]; others go through it
    kMultiply,     ///< each CAS that the multiplier makes goes through branches[0]
  };
  Kind kind = Kind::kStep;
  FileLocation place;
  std::unique_ptr<Step> step;
  std::optional<Condition> condition;
  std::vector<std::string> patterns;
  std::unique_ptr<ChangeDetector> changes;    ///< of kUnlessAlike
  std::unique_ptr<CasMultiplier> multiplier;  ///< of kMultiply
  Json options;                               ///< of these two, for to_json
  std::vector<Flow> branches;
  DataAccess access;

  bool asynchronous() const { return step && step->policy().asynchronous; }
};

/// Reads the list `key` of a pipeline:
///
///     engines:
///       look: [ColorHistogram, ColorName]        # an aggregate, used by its name
///     flow:
///       - PlaneClusterExtractor: {tolerance_m: 0.02}
///         on_error: skip_scene                   # a policy (StepPolicy)
///       - look
///       - if: "GeometryAnnotation.height > 0.02"
///         then: [PclFeature]
///         else: [{PclFeature: {features: [ESF]}}]
///       - regions: {"counter*": [TextReader], "*": [BarcodeReader]}   # the first pattern that matches
///       - parallel: [ProductRecognition, [PclFeature, FeatureClassifier]]
///       - unless_alike: {bits: 8}      # change detection: ChangeOptions
///         do: [TextReader]
///       - multiply: {ObjectViews: {last: 8}}   # a CAS multiplier: what it makes goes through `do`
///         do: [GeometryAnnotator]
Flow read_flow(const Config& pipeline, const std::string& key, const AnnotatorRegistry& registry);
/// Appends one annotator with default options.
void append_step(Flow& flow, const std::string& name, const AnnotatorRegistry& registry);

/// Whether the type or view `product` satisfies the input `need`: the same, or a subtype.
bool meets(const std::string& product, const std::string& need);
/// Whether it is a type of annotation; types of plugins are recognised by their name.
bool is_annotation(const std::string& product);

/// Throws Error for the first node with an input that is neither in `made` nor output by an earlier node; the
/// message names the annotators that output it. Adds the outputs of the flow to `made`.
void check_flow(const Flow& flow, std::set<std::string>& made, const AnnotatorRegistry& registry);
/// Checks conditions against the types.
void check_types(const Flow& flow, const cas::TypeSystem& types);
/// All steps in order.
void collect_steps(const Flow& flow, std::vector<Step*>& steps);
bool has_step(const Flow& flow, const std::string& name);
/// In the form of the YAML.
Json to_json(const Flow& flow);

/// Runs a flow over a scene.
void run_flow(Flow& flow, cas::Cas& cas, Context& context);
/// Runs one of its batches, which is not asynchronous.
void run_batch(Flow& flow, size_t batch, cas::Cas& cas, Context& context);

}  // namespace loci::perception
