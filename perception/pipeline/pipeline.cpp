#include "perception/pipeline/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"

namespace loci::perception {
namespace {

constexpr const char* kDefaultReader = "RecordingReader";

/// `reader: Name` or `reader: {Name: {options}}`: its name and a map of its options.
std::pair<std::string, YAML::Node> read_reader(const Config& config) {
  const YAML::Node node = config.node("reader");
  if (!node) return {kDefaultReader, YAML::Node(YAML::NodeType::Map)};
  return named(node, "a reader", config.location("reader"));
}

}  // namespace

Config with_every(const Config& pipeline, int every) {
  YAML::Node options;
  options[kDefaultReader]["every"] = every;
  YAML::Node changed(YAML::NodeType::Map);  // A clone of the pipeline would not know its lines.
  for (const auto& entry : pipeline.node())
    if (entry.first.Scalar() != "reader") changed[entry.first] = entry.second;
  changed["reader"] = options;
  return pipeline.over(changed, "");
}

Pipeline Pipeline::parse(const std::string& text, const std::string& file,
                         const AnnotatorRegistry& registry) {
  return parse(Config::parse(text, file), registry);
}

Pipeline Pipeline::parse(const Config& config, const AnnotatorRegistry& registry) {
  Pipeline pipeline;
  const auto [name, options] = read_reader(config);
  pipeline.reader_ = registry.make_reader(name, config.location("reader"));
  pipeline.reader_options_ = read_declared(*pipeline.reader_, config.over(options, "reader." + name));
  pipeline.flow_ = read_flow(config, "flow", registry);
  pipeline.writers_ = read_flow(config, "writers", registry);
  config.finish();
  if (pipeline.flow_.nodes.empty())
    throw Error("the pipeline has no annotators", config.location("flow"), "list them under 'flow:'");
  pipeline.check(registry);
  return pipeline;
}

bool Pipeline::has(const std::string& name) const {
  return has_step(flow_, name) || has_step(writers_, name);
}

void Pipeline::add(const std::string& name, const AnnotatorRegistry& registry) {
  if (has(name)) return;
  append_step(flow_, name, registry);
  check(registry);
}

void Pipeline::add_writer(const std::string& name, const AnnotatorRegistry& registry) {
  if (has(name)) return;
  append_step(writers_, name, registry);
  check(registry);
}

void Pipeline::check(const AnnotatorRegistry& registry) const {
  const AnnotatorDescriptor source = reader_->descriptor();
  std::set<std::string> made(source.outputs.begin(), source.outputs.end());
  check_flow(flow_, made, registry);
  check_flow(writers_, made, registry);
}

Json Pipeline::to_json() const {
  return {{"reader", {{reader_->descriptor().name, reader_options_}}},
          {"flow", loci::perception::to_json(flow_)},
          {"writers", loci::perception::to_json(writers_)}};
}

std::set<std::string> Pipeline::annotating() const {
  std::set<std::string> names;
  for (const Step* step : steps()) {
    const std::vector<std::string>& outputs = step->descriptor().outputs;
    if (std::any_of(outputs.begin(), outputs.end(), is_annotation)) names.insert(step->descriptor().name);
  }
  return names;
}

std::vector<Step*> Pipeline::steps() const {
  std::vector<Step*> all;
  collect_steps(flow_, all);
  collect_steps(writers_, all);
  return all;
}

void Pipeline::start(Context& context) {
  if (started_) return;
  started_ = true;
  context.configuration = to_json();
  reader_->start(context);
  for (Step* step : steps()) step->start(context);
}

void Pipeline::finish(Context& context) {
  for (Step* step : steps()) step->finish(context);
}

void Pipeline::finish_stopped(Context& context) {
  for (Step* step : steps()) try {
      step->finish(context);
    } catch (const std::exception& error) {
      context.warnings.add(fmt::format("{} cannot finish: {}", step->descriptor().name, error.what()));
    }
}

bool Pipeline::asynchronous() const {
  const auto is = [](const FlowNode& node) { return node.asynchronous(); };
  return std::ranges::any_of(flow_.nodes, is) || std::ranges::any_of(writers_.nodes, is);
}

std::vector<Pipeline::Stage> Pipeline::stages() {
  if (asynchronous())
    return {{[this](cas::Cas& cas, Context& context) {
      run_flow(flow_, cas, context);
      run_flow(writers_, cas, context);
    }}};
  std::vector<Stage> stages;
  std::map<std::string, size_t> first;  // batch of the first annotator that shares something
  std::vector<size_t> begins;           // of each stage, the first of its batches
  size_t batch_number = 0;
  for (Flow* flow : {&flow_, &writers_})
    for (size_t batch = 0; batch < flow->batches.size(); ++batch, ++batch_number) {
      stages.push_back(
          {[flow, batch](cas::Cas& cas, Context& context) { run_batch(*flow, batch, cas, context); }});
      begins.push_back(batch_number);
      size_t begin = batch_number;
      for (size_t i = flow->batches[batch].first; i < flow->batches[batch].second; ++i)
        for (const std::string& shared : flow->nodes[i].access.shares)
          begin = std::min(begin, first.try_emplace(shared, batch_number).first->second);
      while (begins.back() > begin) {
        Stage& before = stages[stages.size() - 2];
        before.insert(before.end(), stages.back().begin(), stages.back().end());
        stages.pop_back();
        begins.pop_back();
      }
    }
  return stages;
}

size_t Pipeline::scenes_in_flight(int threads) const {
  constexpr int kMaxScenes = 4;  // a scene holds some ten megabytes
  if (asynchronous() || !reader_->descriptor().shares.empty()) return 1;
  const auto most = static_cast<size_t>(std::min(kMaxScenes, thread_count(threads)));
  return std::clamp<size_t>(reader_->count() - reader_->position(), 1, most);
}

/// A scene on its way through the pipeline.
struct Pipeline::Scene {
  cas::Cas cas;
  Warnings warnings;
  Context context;
  bool left_out = false;

  Scene(const std::shared_ptr<const cas::TypeSystem>& types, const Context& of_run, int threads, bool alone)
      : cas(types), context{of_run.resources, warnings, threads, of_run.configuration, alone} {}
};

void Pipeline::read_scene(Scene& scene) {
  const Stopwatch watch;
  reader_->read_next(scene.cas, scene.context);
  if (reader_->position() < reader_->count()) scene.context.next = reader_->upcoming();
  reader_seconds_ += watch.seconds();
  reader_cpu_seconds_ += scene.context.alone ? watch.cpu_seconds() : watch.seconds();
}

void Pipeline::run_frames(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                          Progress& progress, const std::function<void(cas::Cas&)>& done,
                          PipelineResult& result) {
  const size_t first = reader_->position();
  const auto left = static_cast<double>(std::max<size_t>(1, reader_->count() - first));
  const size_t in_flight = scenes_in_flight(context.threads);
  const int threads = std::max(1, thread_count(context.threads) / static_cast<int>(in_flight));
  std::vector<std::unique_ptr<Scene>> scenes(in_flight);
  bool interrupted = false;
  const auto begin = [&](size_t item) {
    if (reader_->position() >= reader_->count()) return false;
    const double fraction = static_cast<double>(reader_->position() - first) / left;
    interrupted = !progress.update(fraction, fmt::format("frame {}", reader_->upcoming().index));
    if (interrupted) return false;
    auto& scene = scenes[item % in_flight];
    scene = std::make_unique<Scene>(type_system, context, threads, in_flight == 1 && context.alone);
    read_scene(*scene);
    return true;
  };
  const auto finish_scene = [&](Scene& scene) {
    for (const std::string& text : scene.warnings.texts()) context.warnings.add(text);
    ++(scene.left_out ? result.left_out : result.frames);
    if (!scene.left_out && done) done(scene.cas);
  };
  const std::vector<Stage> line = stages();
  const auto work = [&](size_t item, size_t stage) {
    auto& scene = scenes[item % in_flight];
    if (stage == line.size()) {
      finish_scene(*scene);
      scene.reset();
      return;
    }
    if (scene->left_out) return;
    try {
      for (const auto& batch : line[stage]) batch(scene->cas, scene->context);
    } catch (const SceneSkipped& skipped) {
      scene->warnings.add(skipped.what());
      scene->left_out = true;
    }
  };
  parallel_stages(in_flight, line.size() + 1, begin, work);
  if (interrupted) throw Interrupted();
}

PipelineResult Pipeline::run(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                             Progress& progress, const std::function<void(cas::Cas&)>& done) {
  check_types(flow_, *type_system);
  check_types(writers_, *type_system);
  start(context);
  PipelineResult result;
  try {
    run_frames(context, type_system, progress, done, result);
  } catch (...) {
    finish_stopped(context);
    throw;
  }
  finish(context);
  progress.update(1, "done");
  result.seconds.emplace_back(reader_->descriptor().name, reader_seconds_);
  result.cpu_seconds.emplace_back(reader_->descriptor().name, reader_cpu_seconds_);
  for (const Step* step : steps()) {
    const std::string& name = step->descriptor().name;
    result.seconds.emplace_back(name, step->statistics().seconds);
    result.cpu_seconds.emplace_back(name, step->cpu_seconds());
    result.statistics[name].add(step->statistics());
  }
  return result;
}

}  // namespace loci::perception
