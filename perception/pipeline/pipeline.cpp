#include "perception/pipeline/pipeline.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/stopwatch.h"

namespace loci::perception {
namespace {

constexpr const char* kDefaultReader = "RecordingReader";

/// `reader: Name` or `reader: {Name: {options}}`: its name and a map of its options.
std::pair<std::string, YAML::Node> read_reader(const Config& config) {
  const YAML::Node node = config.node("reader");
  const YAML::Node none(YAML::NodeType::Map);
  if (!node) return {kDefaultReader, none};
  if (node.IsScalar()) return {node.as<std::string>(), none};
  if (!node.IsMap() || node.size() != 1)
    throw Error("a reader is a name, or a name with a map of options", config.location("reader"));
  const YAML::Node options = node.begin()->second;
  if (!options.IsMap() && !options.IsNull())
    throw Error("the options of a reader must be a map", config.location("reader"));
  return {node.begin()->first.as<std::string>(), options.IsMap() ? options : none};
}

}  // namespace

Config with_every(const Config& pipeline, int every) {
  YAML::Node options;
  options[kDefaultReader]["every"] = every;
  YAML::Node changed = YAML::Clone(pipeline.node());
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

void Pipeline::run_frames(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                          Progress& progress, const std::function<void(cas::Cas&)>& done,
                          PipelineResult& result) {
  const size_t first = reader_->position();
  const auto left = static_cast<double>(std::max<size_t>(1, reader_->count() - first));
  while (reader_->position() < reader_->count()) {
    const FrameId frame = reader_->upcoming();
    const double fraction = static_cast<double>(reader_->position() - first) / left;
    if (!progress.update(fraction, fmt::format("frame {}", frame.index))) {
      finish(context);
      throw Interrupted();
    }
    cas::Cas cas(type_system);
    const Stopwatch watch;
    reader_->read_next(cas, context);
    reader_seconds_ += watch.seconds();
    reader_cpu_seconds_ += watch.cpu_seconds();
    try {
      run_flow(flow_, cas, context);
      run_flow(writers_, cas, context);
    } catch (const SceneSkipped& skipped) {
      context.warnings.add(skipped.what());
      ++result.left_out;
      continue;
    }
    ++result.frames;
    if (done) done(cas);
  }
}

PipelineResult Pipeline::run(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                             Progress& progress, const std::function<void(cas::Cas&)>& done) {
  check_types(flow_, *type_system);
  check_types(writers_, *type_system);
  start(context);
  PipelineResult result;
  run_frames(context, type_system, progress, done, result);
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
