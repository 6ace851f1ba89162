#include "perception/pipeline/flow.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <map>

#include "mapping/base/text/json.h"

namespace loci::perception {
namespace {

FileLocation place_of(const Config& config, const YAML::Node& node, const std::string& path) {
  FileLocation place = config.location();
  if (!node.Mark().is_null()) place.line = node.Mark().line + 1;
  place.key = path;
  return place;
}

bool intersects(const std::set<std::string>& products, const std::set<std::string>& inputs) {
  return std::any_of(products.begin(), products.end(), [&](const std::string& product) {
    return std::any_of(inputs.begin(), inputs.end(),
                       [&](const std::string& need) { return meets(product, need); });
  });
}

std::set<std::string> set_of(const std::vector<std::string>& list) {
  return {list.begin(), list.end()};
}

/// Reads flows; engines are read when they are used.
class FlowReader {
 public:
  FlowReader(const Config& pipeline, const AnnotatorRegistry& registry)
      : pipeline_(pipeline), registry_(registry), engines_(pipeline.map("engines")) {
    engine_names_ = engines_.keys();
    StepPolicy policy;
    const OptionTable table = table_of(policy);
    for (const Option& option : table.options()) policy_names_.push_back(option.name);
  }

  /// Unused engines are checked as well.
  void check_engines() {
    const std::vector<std::string> annotators = registry_.annotators();
    for (const std::string& name : engine_names_) {
      if (std::ranges::find(annotators, name) != annotators.end())
        throw Error(fmt::format("the engine '{}' has the name of an annotator", name),
                    engines_.location(name), "give it another name");
      read_list(engines_.node(name), "engines." + name);
    }
  }

  Flow read_list(const YAML::Node& node, const std::string& path) {
    if (!node.IsSequence()) throw Error("a list was expected here", place_of(pipeline_, node, path));
    Flow flow;
    for (size_t i = 0; i < node.size(); ++i) read_item(node[i], fmt::format("{}[{}]", path, i), flow);
    plan(flow);
    return flow;
  }

 private:
  void read_item(const YAML::Node& node, const std::string& path, Flow& flow) {
    const FileLocation place = place_of(pipeline_, node, path);
    if (node.IsMap() && node["if"]) return read_condition(node, path, flow);
    if (node.IsMap() && node["regions"]) return read_regions(node, path, flow);
    if (node.IsMap() && node["parallel"]) return read_parallel(node, path, flow);
    if (node.IsMap() && node["unless_alike"]) return read_unless_alike(node, path, flow);
    if (node.IsMap() && node["multiply"]) return read_multiply(node, path, flow);
    std::string name;
    YAML::Node options(YAML::NodeType::Map), policy(YAML::NodeType::Map);
    if (node.IsScalar()) name = node.as<std::string>();
    if (node.IsMap()) {
      for (const auto& entry : node) {
        const auto key = entry.first.as<std::string>();
        if (std::find(policy_names_.begin(), policy_names_.end(), key) != policy_names_.end()) {
          policy[key] = entry.second;
        } else if (name.empty()) {
          name = key;
          if (!entry.second.IsMap() && !entry.second.IsNull())
            throw Error("the options of '" + name + "' must be a map", place);
          if (entry.second.IsMap()) options = entry.second;
        } else {
          std::string hint = did_you_mean(key, policy_names_);
          throw Error(fmt::format("'{}' beside '{}': one step has one annotator, and beside it {}", key, name,
                                  fmt::join(policy_names_, ", ")),
                      place, hint);
        }
      }
    }
    if (name.empty())
      throw Error("a step is a name, or a name with a map of options", place,
                  "e.g. '- NormalEstimator' or '- NormalEstimator: {iterations: 5}'");
    if (is_engine(name)) {
      if (options.size() + policy.size() > 0)
        throw Error("'" + name + "' is an engine of several steps, which has no options", place,
                    "give them to its steps");
      return splice_engine(name, place, flow);
    }
    add_step(name, pipeline_.over(options, path + "." + name), pipeline_.over(policy, path), place, flow);
  }

  bool is_engine(const std::string& name) const {
    return std::find(engine_names_.begin(), engine_names_.end(), name) != engine_names_.end();
  }

  void splice_engine(const std::string& name, const FileLocation& place, Flow& flow) {
    if (std::find(within_.begin(), within_.end(), name) != within_.end())
      throw Error(fmt::format("engine '{}' contains itself", name), place);
    within_.push_back(name);
    Flow inner = read_list(engines_.node(name), "engines." + name);
    within_.pop_back();
    std::move(inner.nodes.begin(), inner.nodes.end(), std::back_inserter(flow.nodes));
  }

  void add_step(const std::string& name, const Config& options, const Config& policy,
                const FileLocation& place, Flow& flow) {
    FlowNode node;
    node.place = place;
    if (!engine_names_.empty()) {
      const std::vector<std::string> known = registry_.annotators();
      if (std::find(known.begin(), known.end(), name) == known.end())
        if (const std::string hint = did_you_mean(name, engine_names_); !hint.empty())
          throw Error(fmt::format("there is no annotator or engine '{}'", name), place, hint);
    }
    node.step = std::make_unique<Step>(name, options, policy, place, registry_);
    node.access.add(node.step->descriptor());
    flow.nodes.push_back(std::move(node));
  }

  void read_condition(const YAML::Node& node, const std::string& path, Flow& flow) {
    const Config config = pipeline_.over(node, path);
    FlowNode made = branching(FlowNode::Kind::kCondition, node, path);
    made.condition = Condition::parse(config.require<std::string>("if"), made.place);
    for (const char* key : {"then", "else"})
      add_branch(made, config.has(key) ? read_list(config.node(key), path + "." + key) : Flow());
    config.finish();
    if (made.branches[0].nodes.empty() && made.branches[1].nodes.empty())
      throw Error("'if' without 'then' or 'else'", made.place);
    for (const std::string& type : made.condition->types()) made.access.reads.insert(type);
    made.access.reads.insert("Cluster");
    flow.nodes.push_back(std::move(made));
  }

  void read_regions(const YAML::Node& node, const std::string& path, Flow& flow) {
    const Config config = pipeline_.over(node, path);
    FlowNode made = branching(FlowNode::Kind::kRegions, node, path);
    const Config regions = config.map("regions");
    for (const std::string& pattern : regions.keys()) {
      made.patterns.push_back(pattern);
      add_branch(made, read_list(regions.node(pattern), fmt::format("{}.regions.{}", path, pattern)));
    }
    config.finish();
    made.access.reads.insert({"Cluster", "PlanarSupport", "Cluster.place"});
    flow.nodes.push_back(std::move(made));
  }

  void read_parallel(const YAML::Node& node, const std::string& path, Flow& flow) {
    const Config config = pipeline_.over(node, path);
    FlowNode made = branching(FlowNode::Kind::kParallel, node, path);
    const YAML::Node list = config.node("parallel");
    if (!list.IsSequence()) throw Error("a list was expected here", made.place);
    for (size_t i = 0; i < list.size(); ++i) {
      const std::string item_path = fmt::format("{}.parallel[{}]", path, i);
      Flow branch;
      if (list[i].IsSequence())
        branch = read_list(list[i], item_path);
      else
        read_item(list[i], item_path, branch);
      plan(branch);
      const DataAccess access = access_of(branch);
      for (size_t j = 0; j < made.branches.size(); ++j)
        if (depends(access, access_of(made.branches[j])))
          throw Error(
              fmt::format("branch {} of 'parallel' reads what branch {} outputs or modifies", i + 1, j + 1),
              made.place, "put one after the other");
      add_branch(made, std::move(branch));
    }
    config.finish();
    flow.nodes.push_back(std::move(made));
  }

  void read_unless_alike(const YAML::Node& node, const std::string& path, Flow& flow) {
    const Config config = pipeline_.over(node, path);
    FlowNode made = branching(FlowNode::Kind::kUnlessAlike, node, path);
    ChangeOptions options;
    made.options = read_declared(options, config.map("unless_alike"));
    made.changes = std::make_unique<ChangeDetector>(options);
    made.access.reads = {"Cluster", "StandaloneImageROI", "StandaloneImageROI.phash"};
    read_do(made, config, path, "unless_alike");
    flow.nodes.push_back(std::move(made));
  }

  void read_multiply(const YAML::Node& node, const std::string& path, Flow& flow) {
    const Config config = pipeline_.over(node, path);
    FlowNode made = branching(FlowNode::Kind::kMultiply, node, path);
    const auto [name, options] = named(config.node("multiply"), "a CAS multiplier", made.place);
    made.multiplier = registry_.make_multiplier(name, made.place);
    made.options = read_declared(*made.multiplier, config.over(options, path + "." + name));
    const AnnotatorDescriptor descriptor = made.multiplier->descriptor();
    made.access.reads = set_of(descriptor.inputs);
    made.access.reads.insert(descriptor.optional_inputs.begin(), descriptor.optional_inputs.end());
    read_do(made, config, path, "multiply");
    flow.nodes.push_back(std::move(made));
  }

  /// Reads `do`. Only annotations of clusters are copied back from it.
  void read_do(FlowNode& node, const Config& config, const std::string& path, const std::string& keyword) {
    add_branch(node, config.has("do") ? read_list(config.node("do"), path + ".do") : Flow());
    config.finish();
    if (node.branches[0].nodes.empty()) throw Error("'" + keyword + "' without 'do'", node.place);
    const auto refuse = [&](const std::string& what) {
      throw Error(fmt::format("the steps of '{}' {}, but only annotations are copied back", keyword, what),
                  node.place, "put that before or after it");
    };
    if (node.access.outputs.contains("Cluster")) refuse("output Cluster");
    for (const std::string& product : node.access.outputs)
      if (!is_annotation(product)) refuse("output " + product);
    for (const std::string& change : node.access.modifies)
      if (!node.access.reads.contains(change)) refuse("modify " + change);
  }

  FlowNode branching(FlowNode::Kind kind, const YAML::Node& node, const std::string& path) const {
    FlowNode made;
    made.kind = kind;
    made.place = place_of(pipeline_, node, path);
    return made;
  }

  static DataAccess access_of(const Flow& flow) {
    DataAccess all;
    for (const FlowNode& node : flow.nodes) all.add(node.access);
    return all;
  }

  static void add_branch(FlowNode& node, Flow branch) {
    node.access.add(access_of(branch));
    node.branches.push_back(std::move(branch));
  }

 public:
  /// Finds runs of nodes of which none depends on an earlier one of the run.
  static void plan(Flow& flow) {
    flow.batches.clear();
    const std::vector<FlowNode>& nodes = flow.nodes;
    for (size_t begin = 0, end = 0; begin < nodes.size(); begin = end) {
      end = begin + 1;
      while (!nodes[begin].asynchronous() && end < nodes.size() && !nodes[end].asynchronous() &&
             std::none_of(nodes.begin() + static_cast<std::ptrdiff_t>(begin),
                          nodes.begin() + static_cast<std::ptrdiff_t>(end), [&](const FlowNode& earlier) {
                            return depends(nodes[end].access, earlier.access);
                          }))
        ++end;
      flow.batches.emplace_back(begin, end);
    }
  }

 private:
  const Config& pipeline_;
  const AnnotatorRegistry& registry_;
  Config engines_;
  std::vector<std::string> engine_names_;
  std::vector<std::string> policy_names_;
  std::vector<std::string> within_;  ///< engines that are being read
};

void check_need(const std::string& who, const std::string& need, const FileLocation& place,
                const std::set<std::string>& made, const AnnotatorRegistry& registry) {
  const bool met =
      std::any_of(made.begin(), made.end(), [&](const std::string& product) { return meets(product, need); });
  if (met) return;
  const std::vector<std::string> readers = registry.readers();
  std::vector<std::string> makers = registry.producers_of(need), read_by;
  std::erase_if(makers, [&](const std::string& maker) {
    const bool is_reader = std::ranges::find(readers, maker) != readers.end();
    if (is_reader) read_by.push_back(maker);
    return is_reader;
  });
  const std::string hint = !makers.empty() ? fmt::format("put {} before it", fmt::join(makers, " or "))
                           : !read_by.empty()
                               ? fmt::format("only the reader {} outputs it", fmt::join(read_by, " or "))
                               : "no known annotator outputs it";
  throw Error(fmt::format("{} needs {}, which no earlier step outputs", who, need), place, hint);
}

/// Throws Error for an extractor that an earlier step of the flow is already: it finds every object again,
/// since it does not look at the clusters that there are.
void check_repetition(const Step& step, const FileLocation& place, std::set<std::string>& extractors) {
  const AnnotatorDescriptor& descriptor = step.descriptor();
  DataAccess access;
  access.add(descriptor);
  if (!access.outputs.contains("Cluster") || access.reads.contains("Cluster") || access.reads.contains("*"))
    return;
  if (!extractors.insert(descriptor.name).second)
    throw Error(descriptor.name + " stands twice in one flow, and would find every object twice", place,
                "remove one of them, or put them into branches of a condition");
}

Json steps_json(const std::vector<FlowNode>& nodes);

Json node_json(const FlowNode& node) {
  switch (node.kind) {
    case FlowNode::Kind::kStep:
      return node.step->to_json();
    case FlowNode::Kind::kCondition: {
      Json json = {{"if", node.condition->text()}, {"then", steps_json(node.branches[0].nodes)}};
      if (!node.branches[1].nodes.empty()) json["else"] = steps_json(node.branches[1].nodes);
      return json;
    }
    case FlowNode::Kind::kRegions: {
      Json regions = Json::object();
      for (size_t i = 0; i < node.patterns.size(); ++i)
        regions[node.patterns[i]] = steps_json(node.branches[i].nodes);
      return {{"regions", regions}};
    }
    case FlowNode::Kind::kUnlessAlike:
      return {{"unless_alike", node.options}, {"do", steps_json(node.branches[0].nodes)}};
    case FlowNode::Kind::kMultiply:
      return {{"multiply", {{node.multiplier->descriptor().name, node.options}}},
              {"do", steps_json(node.branches[0].nodes)}};
    case FlowNode::Kind::kParallel:
      break;
  }
  Json branches = Json::array();
  for (const Flow& branch : node.branches) branches.push_back(steps_json(branch.nodes));
  return {{"parallel", branches}};
}

Json steps_json(const std::vector<FlowNode>& nodes) {
  Json json = Json::array();
  for (const FlowNode& node : nodes) json.push_back(node_json(node));
  return json;
}

}  // namespace

std::pair<std::string, YAML::Node> named(const YAML::Node& node, const std::string& what,
                                         const FileLocation& place) {
  const YAML::Node none(YAML::NodeType::Map);
  if (node.IsScalar()) return {node.as<std::string>(), none};
  if (!node.IsMap() || node.size() != 1)
    throw Error(what + " is a name, or a name with a map of options", place);
  const YAML::Node options = node.begin()->second;
  if (!options.IsMap() && !options.IsNull()) throw Error("the options of " + what + " must be a map", place);
  return {node.begin()->first.as<std::string>(), options.IsMap() ? options : none};
}

bool depends(const DataAccess& later, const DataAccess& earlier) {
  return later.reads.contains("*") || intersects(earlier.outputs, later.reads) ||
         intersects(earlier.modifies, later.reads) || intersects(earlier.outputs, later.modifies) ||
         intersects(earlier.modifies, later.modifies) || intersects(earlier.shares, later.shares);
}

void DataAccess::add(const DataAccess& more) {
  reads.insert(more.reads.begin(), more.reads.end());
  outputs.insert(more.outputs.begin(), more.outputs.end());
  modifies.insert(more.modifies.begin(), more.modifies.end());
  shares.insert(more.shares.begin(), more.shares.end());
}

void DataAccess::add(const AnnotatorDescriptor& descriptor) {
  DataAccess own{set_of(descriptor.inputs), set_of(descriptor.outputs), set_of(descriptor.modifies),
                 set_of(descriptor.shares)};
  own.reads.insert(descriptor.optional_inputs.begin(), descriptor.optional_inputs.end());
  add(own);
}

bool meets(const std::string& product, const std::string& need) {
  if (product == need) return true;
  const cas::TypeSystem& types = *types::type_system();
  static const std::map<std::string, cas::Type> by_name = [&] {
    std::map<std::string, cas::Type> map;
    for (const cas::Type type : types.types()) map.emplace(type.short_name(), type);
    return map;
  }();
  const auto made = by_name.find(product);
  if (made == by_name.end()) return product == need + "Annotation";
  for (const std::string& name : {need, need + "Annotation"})
    if (const auto wanted = by_name.find(name); wanted != by_name.end())
      return cas::is_a(made->second, wanted->second);
  return made->second.name() == need;
}

bool is_annotation(const std::string& product) {
  return meets(product, "Annotation") || product.ends_with("Annotation");
}

Flow read_flow(const Config& pipeline, const std::string& key, const AnnotatorRegistry& registry) {
  FlowReader reader(pipeline, registry);
  reader.check_engines();
  return pipeline.has(key) ? reader.read_list(pipeline.node(key), key) : Flow();
}

void append_step(Flow& flow, const std::string& name, const AnnotatorRegistry& registry) {
  const Config list = Config::parse("flow: [" + name + "]", "");
  Flow one = read_flow(list, "flow", registry);
  for (FlowNode& node : one.nodes) node.place = {};  // in no file
  std::move(one.nodes.begin(), one.nodes.end(), std::back_inserter(flow.nodes));
  FlowReader::plan(flow);
}

void check_flow(const Flow& flow, std::set<std::string>& made, const AnnotatorRegistry& registry) {
  std::set<std::string> extractors;
  for (const FlowNode& node : flow.nodes) {
    if (node.step) check_repetition(*node.step, node.place, extractors);
    if (node.step)
      for (const std::string& need : node.step->descriptor().inputs)
        check_need(node.step->descriptor().name, need, node.place, made, registry);
    if (node.condition)
      for (const std::string& type : node.condition->types())
        check_need("the condition '" + node.condition->text() + "'", type, node.place, made, registry);
    if (node.kind == FlowNode::Kind::kRegions)
      check_need("'regions'", "PlanarSupport", node.place, made, registry);
    if (node.kind == FlowNode::Kind::kUnlessAlike)
      check_need("'unless_alike'", "StandaloneImageROI.phash", node.place, made, registry);
    std::set<std::string> seen = made;
    if (node.multiplier) {
      const AnnotatorDescriptor descriptor = node.multiplier->descriptor();
      for (const std::string& need : descriptor.inputs)
        check_need(descriptor.name, need, node.place, made, registry);
      seen = {descriptor.outputs.begin(), descriptor.outputs.end()};
    }
    // A branch does not see what the other ones make.
    for (const Flow& branch : node.branches) {
      std::set<std::string> inside = seen;
      check_flow(branch, inside, registry);
    }
    made.insert(node.access.outputs.begin(), node.access.outputs.end());
  }
}

void check_types(const Flow& flow, const cas::TypeSystem& types) {
  for (const FlowNode& node : flow.nodes) {
    if (node.condition) node.condition->check(types);
    for (const Flow& branch : node.branches) check_types(branch, types);
  }
}

void collect_steps(const Flow& flow, std::vector<Step*>& steps) {
  for (const FlowNode& node : flow.nodes) {
    if (node.step) steps.push_back(node.step.get());
    for (const Flow& branch : node.branches) collect_steps(branch, steps);
  }
}

bool has_step(const Flow& flow, const std::string& name) {
  return std::any_of(flow.nodes.begin(), flow.nodes.end(), [&](const FlowNode& node) {
    return (node.step && node.step->descriptor().name == name) ||
           std::any_of(node.branches.begin(), node.branches.end(),
                       [&](const Flow& branch) { return has_step(branch, name); });
  });
}

Json to_json(const Flow& flow) {
  return steps_json(flow.nodes);
}

}  // namespace loci::perception
