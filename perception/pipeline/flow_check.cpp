#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/json.h"
#include "perception/pipeline/flow.h"

namespace loci::perception {
namespace {

void check_need(const std::string& who, const std::string& need, const FileLocation& place,
                const std::set<std::string>& made, const AnnotatorRegistry& registry) {
  const bool met =
      std::any_of(made.begin(), made.end(), [&](const std::string& product) { return meets(product, need); });
  if (met) return;
  const std::vector<std::string> makers = registry.makers_of(need);
  throw Error(fmt::format("{} needs {}, which nothing before it makes", who, need), place,
              makers.empty() ? "no known annotator makes it"
                             : fmt::format("put {} before it", fmt::join(makers, " or ")));
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

void check_flow(const Flow& flow, std::set<std::string>& made, const AnnotatorRegistry& registry) {
  for (const FlowNode& node : flow.nodes) {
    if (node.step)
      for (const std::string& need : node.step->descriptor().needs)
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
      for (const std::string& need : descriptor.needs)
        check_need(descriptor.name, need, node.place, made, registry);
      seen = {descriptor.makes.begin(), descriptor.makes.end()};
    }
    // A branch does not see what the other ones make.
    for (const Flow& branch : node.branches) {
      std::set<std::string> inside = seen;
      check_flow(branch, inside, registry);
    }
    made.insert(node.footprint.makes.begin(), node.footprint.makes.end());
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
