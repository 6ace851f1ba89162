#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "perception/pipeline/condition.h"
#include "perception/pipeline/lookalikes.h"
#include "perception/pipeline/step.h"

namespace loci::perception {

struct FlowNode;

/// An aggregate analysis engine: what is done, in order. What does not depend on each other by its
/// declarations runs at the same time.
struct Flow {
  std::vector<FlowNode> nodes;
  /// Runs of nodes that may run at the same time, by index: [0, 1), [1, 4), ...
  std::vector<std::pair<size_t, size_t>> batches;
};

/// What a node of a flow does with the CAS, by the declarations of its annotators.
struct Footprint {
  std::set<std::string> reads, makes, changes;
  void add(const Footprint& more);
  void add(const AnnotatorDescriptor& descriptor);
};

/// Whether `later` must wait for `earlier`.
bool depends(const Footprint& later, const Footprint& earlier);

/// A step, or a place where the flow branches.
struct FlowNode {
  enum class Kind {
    kStep,
    kCondition,    ///< clusters for which it holds go through branches[0], others through branches[1]
    kRegions,      ///< clusters and supports of places that match patterns[i] go through branches[i]
    kParallel,     ///< each branch on its own; refused when one depends on another
    kUnlessAlike,  ///< clusters that look as before keep what branches[0] said then; others go through it
    kMultiply,     ///< each CAS that the multiplier makes goes through branches[0]
  };
  Kind kind = Kind::kStep;
  FileLocation place;
  std::unique_ptr<Step> step;
  std::optional<Condition> condition;
  std::vector<std::string> patterns;
  std::unique_ptr<Lookalikes> known;          ///< of kUnlessAlike
  std::unique_ptr<CasMultiplier> multiplier;  ///< of kMultiply
  Json options;                               ///< of these two, for to_json
  std::vector<Flow> branches;
  Footprint footprint;

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
///       - unless_alike: {bits: 8}      # change detection: AlikeOptions
///         do: [TextReader]
///       - multiply: {ObjectViews: {last: 8}}   # a CAS multiplier: what it makes goes through `do`
///         do: [GeometryAnnotator]
Flow read_flow(const Config& pipeline, const std::string& key, const AnnotatorRegistry& registry);
/// Appends one annotator with default options.
void append_step(Flow& flow, const std::string& name, const AnnotatorRegistry& registry);

/// Whether something of type or view `product` is what `need` asks for: the same, or a subtype.
bool meets(const std::string& product, const std::string& need);
/// Whether it is a kind of annotation; of types that plugins bring the name says it.
bool is_annotation(const std::string& product);

/// Throws Error for the first node whose needs are not in `made` and nobody before it meets, naming who
/// could; adds what the flow makes.
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

}  // namespace loci::perception
