#include <fnmatch.h>

#include <algorithm>
#include <exception>
#include <functional>

#include "mapping/base/parallel.h"
#include "perception/pipeline/flow.h"

namespace loci::perception {
namespace {

/// Something to be done on a CAS, for a part of what is in it.
struct Task {
  std::function<void(cas::Cas&, Context&)> work;
  std::vector<cas::FeatureStructure> hidden = {};
};

/// Does every task as if the others did not exist, and brings the results together in the order of the tasks.
/// So they are the same on any number of threads.
void run_side_by_side(const std::vector<Task>& tasks, cas::Cas& cas, Context& context) {
  if (tasks.size() == 1 && tasks[0].hidden.empty()) return tasks[0].work(cas, context);
  struct Side {
    std::unique_ptr<cas::Cas> cas;  ///< null = at home
    Warnings warnings;
    std::exception_ptr failure;
  };
  const int cores = thread_count(context.threads);
  const int threads = std::min(cores, static_cast<int>(tasks.size()));
  std::vector<Side> sides(tasks.size());
  for (size_t i = 0; i < tasks.size(); ++i) {
    // The first may work at home: the others have copies.
    if (i > 0 || !tasks[i].hidden.empty()) sides[i].cas = cas.branch();
    for (const cas::FeatureStructure& each : tasks[i].hidden) sides[i].cas->hide(each);
  }
  parallel_each(tasks.size(), threads, [&](size_t i) {
    Context own{context.resources, sides[i].warnings, std::max(1, cores / threads), {}};
    own.alone = context.alone && threads == 1;
    own.next = context.next;
    try {
      tasks[i].work(sides[i].cas ? *sides[i].cas : cas, own);
    } catch (...) {
      sides[i].failure = std::current_exception();
    }
  });
  for (const Side& side : sides)
    for (const std::string& text : side.warnings.texts()) context.warnings.add(text);
  for (const Side& side : sides)
    if (side.failure) std::rethrow_exception(side.failure);
  for (const Side& side : sides)
    if (side.cas) cas.merge(*side.cas);
}

Task flow_task(Flow& flow) {
  return {[&flow](cas::Cas& cas, Context& context) { run_flow(flow, cas, context); }};
}

/// A cluster or support, and the branch that it goes through; what goes through none is seen by none.
using Assignment = std::vector<std::pair<cas::FeatureStructure, size_t>>;

void run_split(FlowNode& node, const Assignment& assignment, cas::Cas& cas, Context& context) {
  std::vector<Task> tasks;
  for (size_t i = 0; i < node.branches.size(); ++i) {
    Task task = flow_task(node.branches[i]);
    for (const auto& [object, branch] : assignment)
      if (branch != i) task.hidden.push_back(object);
    const bool wanted = task.hidden.size() < assignment.size();
    if (wanted && !node.branches[i].nodes.empty()) tasks.push_back(std::move(task));
  }
  if (!tasks.empty()) run_side_by_side(tasks, cas, context);
}

void run_condition(FlowNode& node, cas::Cas& cas, Context& context) {
  const types::SceneCas scene(cas);
  if (node.condition->about_scene()) {
    Flow& branch = node.branches[node.condition->holds(scene, types::Cluster()) ? 0 : 1];
    return run_flow(branch, cas, context);
  }
  Assignment assignment;
  for (const types::Cluster& cluster : scene.clusters())
    assignment.emplace_back(cluster, node.condition->holds(scene, cluster) ? 0 : 1);
  run_split(node, assignment, cas, context);
}

void run_regions(FlowNode& node, cas::Cas& cas, Context& context) {
  const auto branch_of = [&](const std::string& place) {
    const auto matches = [&](const std::string& pattern) {
      return fnmatch(pattern.c_str(), place.c_str(), 0) == 0;
    };
    return static_cast<size_t>(std::find_if(node.patterns.begin(), node.patterns.end(), matches) -
                               node.patterns.begin());
  };
  const types::SceneCas scene(cas);
  Assignment assignment;
  for (const types::Cluster& cluster : scene.clusters())
    assignment.emplace_back(cluster, branch_of(types::place_of(cluster)));
  for (const types::PlanarSupport& support : scene.supports())
    assignment.emplace_back(support, branch_of(support.name.get()));
  run_split(node, assignment, cas, context);
}

int64_t failures_of(const Flow& flow) {
  std::vector<Step*> steps;
  collect_steps(flow, steps);
  int64_t failures = 0;
  for (const Step* step : steps) failures += step->statistics().failures;
  return failures;
}

void run_unless_alike(FlowNode& node, cas::Cas& cas, Context& context) {
  const types::SceneCas scene(cas);
  Flow& branch = node.branches[0];
  constexpr size_t kThrough = 0, kPast = 1;
  Assignment assignment;
  std::vector<types::Cluster> changed;
  for (const types::Cluster& cluster : scene.clusters()) {
    const bool as_before = node.changes->reuse(cluster);
    if (!as_before) changed.push_back(cluster);
    assignment.emplace_back(cluster, as_before ? kPast : kThrough);
  }
  std::vector<Step*> steps;
  collect_steps(branch, steps);
  for (Step* step : steps) step->note_reused(assignment.size() - changed.size());
  const size_t known = cas.size();
  const int64_t failures = failures_of(branch);
  run_split(node, assignment, cas, context);
  if (failures_of(branch) > failures) return;  // Failed clusters are annotated again.
  for (const types::Cluster& cluster : changed)
    node.changes->store(cluster, known, scene.scene().frame_index.get());
}

void run_multiply(FlowNode& node, cas::Cas& cas, Context& context) {
  const std::vector<std::unique_ptr<cas::Cas>> parts = node.multiplier->split(cas, context);
  for (const auto& part : parts) run_flow(node.branches[0], *part, context);
  for (size_t i = 0; i < parts.size(); ++i) node.multiplier->join(i, *parts[i], cas);
}

void run_node(FlowNode& node, cas::Cas& cas, Context& context) {
  switch (node.kind) {
    case FlowNode::Kind::kStep:
      return node.step->run(cas, context);
    case FlowNode::Kind::kCondition:
      return run_condition(node, cas, context);
    case FlowNode::Kind::kRegions:
      return run_regions(node, cas, context);
    case FlowNode::Kind::kParallel: {
      std::vector<Task> tasks;
      for (Flow& branch : node.branches) tasks.push_back(flow_task(branch));
      return run_side_by_side(tasks, cas, context);
    }
    case FlowNode::Kind::kUnlessAlike:
      return run_unless_alike(node, cas, context);
    case FlowNode::Kind::kMultiply:
      return run_multiply(node, cas, context);
  }
}

/// Asynchronous steps that were launched and whose results are not home yet.
class Outstanding {
 public:
  explicit Outstanding(Flow& flow) : flow_(flow) {}
  Outstanding(const Outstanding&) = delete;
  Outstanding& operator=(const Outstanding&) = delete;
  ~Outstanding() {
    for (const auto& [index, attempt] : attempts_) wait_for(attempt);
  }

  void launch(size_t index, const cas::Cas& cas, Context& context) {
    attempts_.emplace_back(index, flow_.nodes[index].step->launch(cas, context));
  }
  /// Brings home what the nodes [begin, end) depend on, or everything, in the order of the flow.
  void join(size_t begin, size_t end, cas::Cas& cas, Context& context) {
    for (auto at = attempts_.begin(); at != attempts_.end();) {
      bool needed = begin == end;
      for (size_t i = begin; i < end; ++i)
        needed = needed || depends(flow_.nodes[i].access, flow_.nodes[at->first].access);
      if (!needed) {
        ++at;
        continue;
      }
      const auto [index, attempt] = *at;
      at = attempts_.erase(at);
      flow_.nodes[index].step->join(attempt, cas, context);
    }
  }

 private:
  Flow& flow_;
  std::vector<std::pair<size_t, std::shared_ptr<Step::Attempt>>> attempts_;
};

}  // namespace

void run_batch(Flow& flow, size_t batch, cas::Cas& cas, Context& context) {
  std::vector<Task> tasks;
  for (size_t i = flow.batches[batch].first; i < flow.batches[batch].second; ++i)
    tasks.push_back({[&flow, i](cas::Cas& own, Context& its) { run_node(flow.nodes[i], own, its); }});
  run_side_by_side(tasks, cas, context);
}

void run_flow(Flow& flow, cas::Cas& cas, Context& context) {
  Outstanding outstanding(flow);
  for (size_t batch = 0; batch < flow.batches.size(); ++batch) {
    const auto [begin, end] = flow.batches[batch];
    outstanding.join(begin, end, cas, context);
    if (flow.nodes[begin].asynchronous())
      outstanding.launch(begin, cas, context);
    else
      run_batch(flow, batch, cas, context);
  }
  outstanding.join(0, 0, cas, context);
}

}  // namespace loci::perception
